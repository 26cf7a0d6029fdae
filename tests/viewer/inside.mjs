// SPDX-License-Identifier: GPL-3.0-or-later
// Whether points lie inside a closed surface: how often a line along z from the point crosses it. Triangles are sorted
// into squares of the xy plane, so that a point meets few of them.

export class InsideTest {
    constructor(points, triangles) {
        this.points = points;
        this.triangles = triangles;
        this.low = [Infinity, Infinity];
        const high = [-Infinity, -Infinity];
        for (let i = 0; i < points.length; i += 3)
            for (const c of [0, 1]) {
                this.low[c] = Math.min(this.low[c], points[i + c]);
                high[c] = Math.max(high[c], points[i + c]);
            }
        this.side = Math.max(1, Math.min(512, Math.round(Math.sqrt(triangles.length / 6))));
        this.step = [0, 1].map((c) => (high[c] - this.low[c]) / this.side || 1);
        this.squares = new Map();
        for (let t = 0; t < triangles.length; t += 3) {
            const range = (c) => {
                const at = [0, 1, 2].map((k) => points[3 * triangles[t + k] + c]);
                return [this.square(Math.min(...at), c), this.square(Math.max(...at), c)];
            };
            const [x0, x1] = range(0), [y0, y1] = range(1);
            for (let x = x0; x <= x1; ++x)
                for (let y = y0; y <= y1; ++y) {
                    const key = x * 1024 + y;
                    if (!this.squares.has(key)) this.squares.set(key, []);
                    this.squares.get(key).push(t);
                }
        }
    }
    square(value, axis) {
        return Math.min(this.side - 1, Math.max(0, Math.floor((value - this.low[axis]) / this.step[axis])));
    }
    contains(x, y, z) {
        const { points: p, triangles } = this;
        let above = 0;
        for (const t of this.squares.get(this.square(x, 0) * 1024 + this.square(y, 1)) ?? []) {
            const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[t + k]);
            // Signed areas of the corners' triangles with the point, in the xy plane.
            const area = (i, k) => (p[i] - x) * (p[k + 1] - y) - (p[k] - x) * (p[i + 1] - y);
            const u = area(b, c), v = area(c, a), w = area(a, b);
            if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0)) || u + v + w === 0) continue;
            if ((u * p[a + 2] + v * p[b + 2] + w * p[c + 2]) / (u + v + w) > z) ++above;
        }
        return above % 2 === 1;
    }
}
