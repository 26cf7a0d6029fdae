// SPDX-License-Identifier: GPL-3.0-or-later
// Fibre directions: a short line in each tet, turned and stretched with it, coloured by the excitation.
import { Group } from "three";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { rangeOf, tableOf, writeColour } from "./colour_maps.js";
import { InsideTest } from "./inside.js";

/** 1 for each tet whose middle lies in the flesh at rest, or null where the surface has no inside. A lattice is coarser
    than the surface, and a stick drawn beside the muscle would look like a wrong fibre. */
function tetsInside({ lattice, rest, triangles, shading, volume }) {
    if (!volume) return null;
    const test = new InsideTest(rest, shading ? triangles.map((v) => shading[v]) : triangles);
    return Uint8Array.from({ length: lattice.count }, (_, t) => {
        const middle = [0, 1, 2].map((c) => [0, 1, 2, 3].reduce((s, k) => s + 0.25 * lattice.rest[3 * lattice.tets[4 * t + k] + c], 0));
        return test.contains(...middle) ? 1 : 0;
    });
}

/** The fibres of the tets that are `inside`; all if few are, as in a sheet thinner than a tet. */
function insideOnly(fibres, inside) {
    if (!inside) return fibres;
    const kept = [...fibres.tets.keys()].filter((i) => inside[fibres.tets[i]]);
    if (kept.length === fibres.count || kept.length < 0.25 * fibres.count) return fibres;
    return {
        ...fibres,
        count: kept.length,
        tets: Uint32Array.from(kept, (i) => fibres.tets[i]),
        weights: Uint8Array.from(kept, (i) => fibres.weights[i]),
        directions: Float32Array.from(kept.flatMap((i) => [...fibres.directions.subarray(3 * i, 3 * i + 3)])),
    };
}

export class FibreView {
    constructor(bodyView) {
        this.view = bodyView;
        this.group = new Group();
        const inside = tetsInside(bodyView.body);
        this.fields = bodyView.body.fibres.map((all) => {
            const fibres = insideOnly(all, inside);
            const positions = new Float32Array(6 * fibres.count), colours = new Float32Array(6 * fibres.count);
            const geometry = new LineSegmentsGeometry();
            geometry.setPositions(positions);
            geometry.setColors(colours);
            const object = new LineSegments2(geometry, new LineMaterial({ vertexColors: true, linewidth: 1.7, transparent: true, opacity: 0.95 }));
            object.frustumCulled = false;
            object.renderOrder = 1;
            this.group.add(object);
            // setPositions copies into an interleaved buffer; that one is written from now on.
            return { fibres, positions: geometry.attributes.instanceStart.data, colours: geometry.attributes.instanceColorStart.data };
        });
    }

    update(state) {
        const { lattice } = this.view.body, solver = this.view.fields;
        solver.update(state.frame);
        const p = lattice.positionsAt(state.frame), F = solver.gradient;
        const table = tableOf("heat"), [least, most] = rangeOf(state, "excitation"), paint = [0, 0, 0];
        for (const { fibres, positions, colours } of this.fields) {
            writeColour(table, 100 * fibres.excitation[state.frame], least, most, paint, 0);
            for (let i = 0; i < fibres.count; ++i) {
                const t = fibres.tets[i], q = 9 * t, o = 6 * i;
                const [dx, dy, dz] = [0, 1, 2].map((c) => fibres.directions[3 * i + c]);
                // Half a tet's size on each side, less where few fibres are painted.
                const half = 0.42 * Math.cbrt(Math.abs(solver.volume[t])) * (0.4 + (0.6 * fibres.weights[i]) / 255);
                for (let c = 0; c < 3; ++c) {
                    const middle = 0.25 * (p[3 * lattice.tets[4 * t] + c] + p[3 * lattice.tets[4 * t + 1] + c] +
                        p[3 * lattice.tets[4 * t + 2] + c] + p[3 * lattice.tets[4 * t + 3] + c]);
                    const d = half * (F[q + 3 * c] * dx + F[q + 3 * c + 1] * dy + F[q + 3 * c + 2] * dz);
                    positions.array[o + c] = middle - d;
                    positions.array[o + 3 + c] = middle + d;
                }
                for (let c = 0; c < 6; ++c) colours.array[o + c] = paint[c % 3];
            }
            positions.needsUpdate = colours.needsUpdate = true;
        }
    }
}
