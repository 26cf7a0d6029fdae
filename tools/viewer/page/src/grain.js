// SPDX-License-Identifier: GPL-3.0-or-later
// A body's own axes, longest first, from the spread of its rest points (Jacobi rotations of the covariance).
import { Matrix4 } from "three";

function principalAxes(c) {
    const v = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    for (let sweep = 0; sweep < 12; ++sweep)
        for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
            if (Math.abs(c[p][q]) < 1e-12 * (Math.abs(c[p][p]) + Math.abs(c[q][q]))) continue;
            const t = 0.5 * Math.atan2(2 * c[p][q], c[q][q] - c[p][p]);
            const cos = Math.cos(t), sin = Math.sin(t);
            for (let k = 0; k < 3; ++k) {
                const a = c[k][p], b = c[k][q];
                c[k][p] = cos * a - sin * b;
                c[k][q] = sin * a + cos * b;
            }
            for (let k = 0; k < 3; ++k) {
                const a = c[p][k], b = c[q][k];
                c[p][k] = cos * a - sin * b;
                c[q][k] = sin * a + cos * b;
                const d = v[p][k], e = v[q][k];
                v[p][k] = cos * d - sin * e;
                v[q][k] = sin * d + cos * e;
            }
        }
    return [0, 1, 2].sort((a, b) => c[b][b] - c[a][a]).map((i) => v[i]);
}

/** Matrix from rest positions to grain coordinates: x runs along the body, half its length = 1. */
export function grainMatrix(rest) {
    const n = Math.max(1, rest.length / 3), mean = [0, 0, 0];
    for (let i = 0; i < rest.length; ++i) mean[i % 3] += rest[i] / n;
    const c = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
    for (let i = 0; i < rest.length; i += 3)
        for (let a = 0; a < 3; ++a)
            for (let b = 0; b < 3; ++b) c[a][b] += (rest[i + a] - mean[a]) * (rest[i + b] - mean[b]);
    const axes = principalAxes(c);
    let half = 1e-9;
    for (let i = 0; i < rest.length; i += 3)
        half = Math.max(half, Math.abs(axes[0].reduce((s, x, k) => s + x * (rest[i + k] - mean[k]), 0)));
    const rows = axes.map((axis) => [...axis.map((x) => x / half), -axis.reduce((s, x, k) => s + x * mean[k], 0) / half]);
    return new Matrix4().set(...rows[0], ...rows[1], ...rows[2], 0, 0, 0, 1);
}
