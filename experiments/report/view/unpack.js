// SPDX-License-Identifier: GPL-3.0-or-later
// Undoes pack.cpp: base64, zlib, byte planes, zigzag, prediction.

async function inflate(text) {
    const packed = Uint8Array.from(atob(text), c => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Values as an array of `Type`, in which whatever wraps around in between comes right.
async function unpack({shape: [frames, items, components], planes, data}, Type = Int32Array) {
    const bytes = await inflate(data);
    const frame = items * components, count = frames * frame, out = new Type(count);
    for (let i = 0; i < count; ++i) {
        let z = 0;
        for (let p = planes - 1; p >= 0; --p)
            z = z << 8 | bytes[p * count + i];
        out[i] = (z >>> 1) ^ -(z & 1);
    }
    for (let f = 0; f < frames; ++f) // what each item changed by, then what it is
        for (let i = f * frame + components; i < (f + 1) * frame; ++i)
            out[i] += out[i - components];
    for (let i = frame; i < count; ++i)
        out[i] += out[i - frame];
    return out;
}
