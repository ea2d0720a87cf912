// SPDX-License-Identifier: GPL-3.0-or-later
// k-DOPs as polytopes: supports[2a] is the most along axis a, supports[2a + 1] against it.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// Counter-clockwise seen from outside.
function boxFaces([hx, lx, hy, ly, hz, lz]) {
    const p = i => [i & 1 ? hx : -lx, i & 2 ? hy : -ly, i & 4 ? hz : -lz];
    return [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]].map(face => face.map(p));
}

// Distinct points of a plane with normal n, counter-clockwise.
function inOrder(points, n, near) {
    const distinct = [];
    for (const p of points)
        if (!distinct.some(q => Math.abs(p[0] - q[0]) + Math.abs(p[1] - q[1]) + Math.abs(p[2] - q[2]) <= near))
            distinct.push(p);
    const centre = [0, 1, 2].map(r => distinct.reduce((sum, p) => sum + p[r], 0) / distinct.length);
    const u = cross(n, Math.abs(n[0]) < Math.abs(n[1]) + Math.abs(n[2]) ? [1, 0, 0] : [0, 1, 0]), v = cross(n, u);
    const angle = p => Math.atan2(dot(minus(p, centre), v) / Math.hypot(...v), dot(minus(p, centre), u) / Math.hypot(...u));
    return distinct.map(p => [angle(p), p]).sort((a, b) => a[0] - b[0]).map(([, p]) => p);
}

// The part of a convex polytope where n·p ≤ d.
function clip(faces, n, d, near) {
    const kept = [], rim = [];
    let cut = false;
    for (const face of faces) {
        const above = face.map(p => dot(n, p) - d);
        cut = cut || above.some(s => s > near);
        const part = [];
        face.forEach((p, i) => {
            const next = (i + 1) % face.length, s = above[i], t = above[next];
            if (s <= near)
                part.push(p);
            if (Math.abs(s) <= near)
                rim.push(p);
            if (Math.min(s, t) < -near && Math.max(s, t) > near) {
                const q = face[next], share = s / (s - t), between = p.map((x, r) => x + share * (q[r] - x));
                part.push(between);
                rim.push(between);
            }
        });
        if (part.length >= 3)
            kept.push(part);
    }
    if (!cut)
        return faces;
    const lid = inOrder(rim, n, 4 * near);
    if (lid.length >= 3)
        kept.push(lid);
    return kept;
}

// Faces of the polytope with these supports along `axes`, the coordinate axes first.
function polytope(supports, axes) {
    const near = 1e-6 + 1e-10 * Math.max(...supports.map(Math.abs));
    let faces = boxFaces(supports);
    for (let a = 3; a < axes.length; ++a) {
        const n = axes[a];
        faces = clip(faces, n, supports[2 * a], near);
        faces = clip(faces, n.map(x => -x), supports[2 * a + 1], near);
    }
    return faces;
}

function measures(faces) {
    let area = 0, volume = 0;
    const origin = faces.length ? faces[0][0] : [0, 0, 0];
    for (const face of faces)
        for (let i = 2; i < face.length; ++i) {
            const n = cross(minus(face[i - 1], face[0]), minus(face[i], face[0]));
            area += Math.hypot(...n) / 2;
            volume += dot(n, minus(face[0], origin)) / 6;
        }
    return {area, volume};
}
