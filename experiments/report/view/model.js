// SPDX-License-Identifier: GPL-3.0-or-later
// The data of a view, unpacked. Lengths in units of its grid.

const unbounded = 1 << 29; // as grid.hpp has it

class Model {
    static async from(data) {
        const model = new Model();
        Object.assign(model, {data, frames: data.time_s.length, levels: data.bvs.level.length - 1, methods: Object.keys(data.bounds), kdop: data.kdop});
        const below = await unpack(data.corners);
        model.corners = new Uint32Array(below.length);
        for (let i = 0, next = 0; i < below.length; ++i) {
            model.corners[i] = next - below[i];
            next = Math.max(next, model.corners[i] + 1);
        }
        model.vertices = data.positions.shape[1];
        model.positions = await unpack(data.positions, Uint16Array, parallelograms(model.corners, model.vertices));
        model.nodes = await unpack(data.nodes);
        model.bounds = {};
        for (const method of model.methods)
            model.bounds[method] = await unpack(data.bounds[method]);
        if (data.contacts) {
            model.touching = await unpack(data.contacts.triangles);
            model.firstTouching = [0];
            for (const count of data.contacts.count)
                model.firstTouching.push(model.firstTouching[model.firstTouching.length - 1] + count);
        }
        return model;
    }

    // Those k that the bounds have all axes of.
    kdops() { return Object.keys(this.data.axes).map(Number); }

    positionsOf(frame) { return this.positions.subarray(3 * this.vertices * frame, 3 * this.vertices * (frame + 1)); }

    nodesOf(frame) {
        const count = this.nodes.length / this.frames;
        return this.nodes.subarray(count * frame, count * (frame + 1)).filter((x, i, all) => all[i - i % 3] < unbounded);
    }

    touchingOf(frame) { return this.touching ? this.touching.subarray(this.firstTouching[frame], this.firstTouching[frame + 1]) : []; }

    // Supports of a bound along the axes of k.
    bound(method, frame, bv, k) {
        const own = this.data.axes[this.kdop].map(String), first = (frame * this.data.bvs.first.length + bv) * this.kdop;
        return this.data.axes[k].flatMap(axis => {
            const at = first + 2 * own.indexOf(String(axis));
            return [this.bounds[method][at], this.bounds[method][at + 1]];
        });
    }

    // The same of the tight one: of the vertices as they are drawn.
    truth(frame, bv, k) {
        const positions = this.positionsOf(frame), first = 3 * this.data.bvs.first[bv], last = first + 3 * this.data.bvs.count[bv];
        return this.data.axes[k].flatMap(([a, b, c]) => {
            let most = -Infinity, least = Infinity;
            for (let i = first; i < last; ++i) {
                const at = 3 * this.corners[i], x = a * positions[at] + b * positions[at + 1] + c * positions[at + 2];
                if (x > most) most = x;
                if (x < least) least = x;
            }
            return [most, -least];
        });
    }

    // Least and greatest coordinates of the bounds of a level; of the vertices instead where a bound is far from them.
    extent({method, frame, level}) {
        const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], {level: first} = this.data.bvs;
        for (let bv = first[level]; bv < first[level + 1]; ++bv) {
            const truth = this.truth(frame, bv, 6), bound = this.bound(method, frame, bv, 6);
            const near = truth.every((t, d) => bound[d] - t <= truth[d & 6] + truth[d | 1]);
            (near ? bound : truth).forEach((s, d) => {
                const r = d >> 1;
                if (d & 1)
                    low[r] = Math.min(low[r], -s);
                else
                    high[r] = Math.max(high[r], s);
            });
        }
        return {low, high};
    }

    // The BVs of a level in a frame: faces of bound and truth, and how much greater the bound is. null: not known.
    volumes({method, frame, level, k}) {
        const {level: first} = this.data.bvs, out = [], axes = this.data.axes[k];
        for (let bv = first[level]; bv < first[level + 1]; ++bv) {
            const supports = this.bound(method, frame, bv, k);
            const truth = polytope(this.truth(frame, bv, k), axes), of = measures(truth);
            if (supports.some(s => s >= unbounded)) {
                out.push({bound: null, truth, area: null, volume: null});
                continue;
            }
            const bound = polytope(supports, axes), whole = measures(bound);
            out.push({bound, truth, area: of.area > 0 ? whole.area / of.area : null, volume: of.volume > 0 ? whole.volume / of.volume : null});
        }
        return out;
    }
}
