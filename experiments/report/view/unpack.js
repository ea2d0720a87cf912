// SPDX-License-Identifier: GPL-3.0-or-later
// Undoes pack.cpp: base64, zlib, byte planes, zigzag, prediction.

async function inflate(text) {
    const packed = Uint8Array.from(atob(text), c => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// See parallelograms() there: for every vertex three others, one after the other.
function parallelograms(corners, vertices) {
    const out = new Uint32Array(3 * vertices), beyond = new Map();
    const edge = (a, b) => Math.min(a, b) * 2 ** 26 + Math.max(a, b);
    let next = 0;
    for (let t = 0; t + 3 <= corners.length; t += 3) {
        for (let i = 0; i < 3; ++i) {
            const v = corners[t + i], a = corners[t + (i + 1) % 3], b = corners[t + (i + 2) % 3];
            if (v !== next)
                continue;
            const tip = a < v && b < v ? beyond.get(edge(a, b)) : undefined;
            const known = a < v ? a : b < v ? b : Math.max(v - 1, 0);
            out.set(tip < v ? [a, b, tip] : [known, known, known], 3 * v);
            ++next;
        }
        for (let i = 0; i < 3; ++i)
            beyond.set(edge(corners[t + i], corners[t + (i + 1) % 3]), corners[t + (i + 2) % 3]);
    }
    return out;
}

// Values as an array of `Type`, in which whatever wraps around in between comes right.
async function unpack({shape: [frames, items, components], planes, data}, Type = Int32Array, references = null) {
    const bytes = await inflate(data);
    const frame = items * components, count = frames * frame, out = new Type(count);
    for (let i = 0; i < count; ++i) {
        let z = 0;
        for (let p = planes - 1; p >= 0; --p)
            z = z << 8 | bytes[p * count + i];
        out[i] = (z >>> 1) ^ -(z & 1);
    }
    for (let f = 0; f < frames; ++f) // what each item changed by, then what it is
        for (let i = 1; i < items; ++i)
            for (let c = 0; c < components; ++c) {
                const first = f * frame + c, at = first + i * components;
                if (references)
                    out[at] += out[first + references[3 * i] * components] + out[first + references[3 * i + 1] * components] - out[first + references[3 * i + 2] * components];
                else
                    out[at] += out[at - components];
            }
    for (let i = frame; i < count; ++i)
        out[i] += out[i - frame];
    return out;
}
