// SPDX-License-Identifier: GPL-3.0-or-later
// What the tets feel, from their vertices: F = [x1-x0 x2-x0 x3-x0] [X1-X0 X2-X0 X3-X0]^-1 (deformation gradient),
// volume change det F - 1, largest stretch sqrt(largest eigenvalue of F^T F) - 1.

/** Per tet: inverse of the rest edges (9 numbers, by rows) and rest volume. */
function prepareTets(lattice) {
    const { tets, rest, count } = lattice;
    const inverse = new Float32Array(9 * count), volume = new Float32Array(count);
    for (let t = 0; t < count; ++t) {
        const o = 3 * tets[4 * t];
        const e = [];
        for (let k = 1; k < 4; ++k) {
            const v = 3 * tets[4 * t + k];
            e.push(rest[v] - rest[o], rest[v + 1] - rest[o + 1], rest[v + 2] - rest[o + 2]);
        }
        const [a, d, g, b, h, i, c, f, j] = e; // columns are the edges: [a b c; d h f; g i j]
        const det = a * (h * j - f * i) - b * (d * j - f * g) + c * (d * i - h * g);
        volume[t] = det / 6;
        const s = det !== 0 ? 1 / det : 0;
        inverse.set(
            [h * j - f * i, c * i - b * j, b * f - c * h, f * g - d * j, a * j - c * g, c * d - a * f, d * i - h * g, b * g - a * i, a * h - b * d].map(
                (x) => x * s,
            ),
            9 * t,
        );
    }
    return { inverse, volume };
}

/** Largest eigenvalue of a symmetric 3x3 matrix by its characteristic polynomial (trigonometric form). */
function largestEigenvalue(xx, yy, zz, xy, xz, yz) {
    const mean = (xx + yy + zz) / 3;
    const p = ((xx - mean) ** 2 + (yy - mean) ** 2 + (zz - mean) ** 2 + 2 * (xy * xy + xz * xz + yz * yz)) / 6;
    if (!(p > 1e-20)) return mean;
    const r = Math.sqrt(p), a = (xx - mean) / r, b = (yy - mean) / r, c = (zz - mean) / r;
    const d = xy / r, e = xz / r, f = yz / r;
    const half = (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / 2;
    return mean + 2 * r * Math.cos(Math.acos(Math.min(1, Math.max(-1, half))) / 3);
}

export class LatticeFields {
    constructor(lattice) {
        this.lattice = lattice;
        Object.assign(this, prepareTets(lattice));
        this.gradient = new Float32Array(9 * lattice.count);
        this.values = { volume: new Float32Array(lattice.count), stretch: new Float32Array(lattice.count) };
        this.vertexWeight = new Float32Array(lattice.vertices);
        for (let t = 0; t < lattice.count; ++t)
            for (let k = 0; k < 4; ++k) this.vertexWeight[lattice.tets[4 * t + k]] += this.volume[t];
        this.atVertices = new Float32Array(lattice.vertices);
        this.at = -1;
    }

    update(frame) {
        if (this.at === frame) return;
        this.at = frame;
        const p = this.lattice.positionsAt(frame);
        const { tets, count } = this.lattice;
        const { inverse: m, gradient: F } = this;
        const { volume, stretch } = this.values;
        for (let t = 0; t < count; ++t) {
            const o = 3 * tets[4 * t], q = 9 * t;
            const v1 = 3 * tets[4 * t + 1], v2 = 3 * tets[4 * t + 2], v3 = 3 * tets[4 * t + 3];
            for (let r = 0; r < 3; ++r) {
                const a = p[v1 + r] - p[o + r], b = p[v2 + r] - p[o + r], c = p[v3 + r] - p[o + r];
                for (let k = 0; k < 3; ++k) F[q + 3 * r + k] = a * m[q + k] + b * m[q + 3 + k] + c * m[q + 6 + k];
            }
            const f0 = F[q], f1 = F[q + 1], f2 = F[q + 2], f3 = F[q + 3], f4 = F[q + 4], f5 = F[q + 5];
            const f6 = F[q + 6], f7 = F[q + 7], f8 = F[q + 8];
            volume[t] = f0 * (f4 * f8 - f5 * f7) - f1 * (f3 * f8 - f5 * f6) + f2 * (f3 * f7 - f4 * f6) - 1;
            const most = largestEigenvalue(
                f0 * f0 + f3 * f3 + f6 * f6,
                f1 * f1 + f4 * f4 + f7 * f7,
                f2 * f2 + f5 * f5 + f8 * f8,
                f0 * f1 + f3 * f4 + f6 * f7,
                f0 * f2 + f3 * f5 + f6 * f8,
                f1 * f2 + f4 * f5 + f7 * f8,
            );
            stretch[t] = Math.sqrt(Math.max(0, most)) - 1;
        }
    }

    /** The field at surface vertices: means of the tets around each lattice vertex, carried by the embedding. */
    atSurface(name, body, out) {
        const { tets, count } = this.lattice;
        const field = this.values[name], sums = this.atVertices;
        sums.fill(0);
        for (let t = 0; t < count; ++t)
            for (let k = 0; k < 4; ++k) sums[tets[4 * t + k]] += this.volume[t] * field[t];
        for (let i = 0; i < sums.length; ++i) sums[i] /= this.vertexWeight[i] || 1;
        for (let i = 0; i < body.vertices; ++i) {
            let x = 0;
            for (let k = 0; k < 4; ++k) x += body.hostWeights[4 * i + k] * sums[tets[4 * body.hostTet[i] + k]];
            out[i] = x;
        }
    }
}

/** Area around each vertex / that at rest - 1, from shading triangles. */
export class SurfaceArea {
    constructor(body) {
        this.body = body;
        this.rest = this.areas(body.rest, new Float32Array(body.vertices));
        this.now = new Float32Array(body.vertices);
    }
    areas(p, out) {
        const { triangles, shading } = this.body;
        out.fill(0);
        for (let i = 0; i < triangles.length; i += 3) {
            const [a, b, c] = [0, 1, 2].map((k) => (shading ? shading[triangles[i + k]] : triangles[i + k]));
            const ux = p[3 * b] - p[3 * a], uy = p[3 * b + 1] - p[3 * a + 1], uz = p[3 * b + 2] - p[3 * a + 2];
            const vx = p[3 * c] - p[3 * a], vy = p[3 * c + 1] - p[3 * a + 1], vz = p[3 * c + 2] - p[3 * a + 2];
            const area = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
            out[a] += area;
            out[b] += area;
            out[c] += area;
        }
        return out;
    }
    write(frame, out) {
        this.areas(this.body.positionsAt(frame), this.now);
        for (let i = 0; i < out.length; ++i) out[i] = this.rest[i] > 0 ? this.now[i] / this.rest[i] - 1 : 0;
    }
}
