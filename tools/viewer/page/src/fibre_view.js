// SPDX-License-Identifier: GPL-3.0-or-later
// Fibre directions: a short line in each tet, turned and stretched with it, coloured by the excitation. What a tet holds
// of the flesh was found when the page was written (tools/viewer/flesh.cpp).
import { Group } from "three";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { rangeOf, tableOf, writeColour } from "./colour_maps.js";

export class FibreView {
    constructor(bodyView) {
        this.view = bodyView;
        this.group = new Group();
        this.fields = bodyView.body.fibres.map((fibres) => {
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
                for (let c = 0; c < 3; ++c) {
                    let middle = 0;
                    for (let k = 0; k < 4; ++k) middle += fibres.centre[4 * i + k] * p[3 * lattice.tets[4 * t + k] + c];
                    const d = F[q + 3 * c] * dx + F[q + 3 * c + 1] * dy + F[q + 3 * c + 2] * dz;
                    positions.array[o + c] = middle - fibres.reach[2 * i] * d;
                    positions.array[o + 3 + c] = middle + fibres.reach[2 * i + 1] * d;
                }
                for (let c = 0; c < 6; ++c) colours.array[o + c] = paint[c % 3];
            }
            positions.needsUpdate = colours.needsUpdate = true;
        }
    }
}
