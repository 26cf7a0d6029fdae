// SPDX-License-Identifier: GPL-3.0-or-later
// The tets of a tissue: the skin of those that the cut leaves, with its edges. The cut goes through the rest shape, so it
// moves with the flesh and the same tets stay in sight.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial } from "three";
import { quantities, rangeOf, tableOf, writeColour } from "./colour_maps.js";

const faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]; // outward for a positive tet

/** Faces that only one kept tet has: [tet, a, b, c …]. */
function openFaces(lattice, keep) {
    const seen = new Map(), { tets, count, vertices } = lattice;
    for (let t = 0; t < count; ++t) {
        if (!keep(t)) continue;
        for (const f of faces) {
            const v = f.map((k) => tets[4 * t + k]);
            const [x, y, z] = v.slice().sort((p, q) => p - q);
            const key = (x * vertices + y) * vertices + z;
            if (seen.has(key)) seen.delete(key);
            else seen.set(key, [t, ...v]);
        }
    }
    return [...seen.values()];
}

export class LatticeView {
    constructor(bodyView) {
        this.view = bodyView;
        this.lattice = bodyView.body.lattice;
        this.group = new Group();
        this.mesh = new Mesh(new BufferGeometry(), new MeshLambertMaterial({ vertexColors: true, side: DoubleSide, flatShading: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
        this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.6 }));
        this.mesh.frustumCulled = this.lines.frustumCulled = false;
        this.group.add(this.mesh, this.lines);
        this.cutKey = null;
        this.base = new Color(bodyView.body.colour).lerp(new Color("#ffffff"), 0.25);
    }

    /** `plane` = [nx, ny, nz, w] keeps n·rest <= w, or null. */
    setCut(plane) {
        const key = plane ? plane.join() : "none";
        if (key === this.cutKey) return;
        this.cutKey = key;
        const { tets, rest } = this.lattice;
        const keep = (t) => {
            if (!plane) return true;
            let s = 0;
            for (let k = 0; k < 4; ++k)
                for (let c = 0; c < 3; ++c) s += 0.25 * plane[c] * rest[3 * tets[4 * t + k] + c];
            return s <= plane[3];
        };
        this.open = openFaces(this.lattice, keep);
        const edges = new Set(), n = this.lattice.vertices;
        for (const [, a, b, c] of this.open)
            for (const [p, q] of [[a, b], [b, c], [c, a]]) edges.add(Math.min(p, q) * n + Math.max(p, q));
        const index = new Uint32Array(2 * edges.size);
        let i = 0;
        for (const e of edges) (index[i++] = Math.floor(e / n)), (index[i++] = e % n);
        this.lines.geometry.dispose();
        this.lines.geometry = new BufferGeometry()
            .setAttribute("position", new BufferAttribute(new Float32Array(3 * n), 3))
            .setIndex(new BufferAttribute(index, 1));
        this.mesh.geometry.dispose();
        this.mesh.geometry = new BufferGeometry();
        for (const name of ["position", "color"])
            this.mesh.geometry.setAttribute(name, new BufferAttribute(new Float32Array(9 * this.open.length), 3));
    }

    update(state, plane) {
        this.setCut(plane);
        const p = state.wholeTets ? this.lattice.positionsAt(state.frame)
            : this.lattice.drawnAt(state.frame, this.view.body.positionsAt(state.frame));
        const linePositions = this.lines.geometry.attributes.position;
        linePositions.array.set(p);
        linePositions.needsUpdate = true;
        // Edges alone are grey: flesh is red, fibres blue, attachments green to violet.
        const dark = state.theme === "dark";
        this.lines.material.color.set(state.filledLattice ? (dark ? "#101418" : "#2a323b") : dark ? "#aeb9c5" : "#4c5866");
        this.lines.material.opacity = state.filledLattice ? 0.5 : 0.45;
        this.mesh.visible = state.filledLattice;
        if (!state.filledLattice) return;
        const { position, color } = this.mesh.geometry.attributes;
        const field = this.fieldValues(state);
        const { factor, scale } = quantities[field ? state.colourBy : "volume"];
        const table = tableOf(scale), [least, most] = rangeOf(state, field ? state.colourBy : "volume");
        this.open.forEach(([t, ...v], f) => {
            for (let k = 0; k < 3; ++k) {
                const o = 9 * f + 3 * k;
                for (let c = 0; c < 3; ++c) position.array[o + c] = p[3 * v[k] + c];
                if (field) writeColour(table, factor * field[t], least, most, color.array, o);
                else color.array[o] = this.base.r, (color.array[o + 1] = this.base.g), (color.array[o + 2] = this.base.b);
            }
        });
        position.needsUpdate = color.needsUpdate = true;
        this.mesh.geometry.boundingSphere = null; // for searching it
    }

    fieldValues(state) {
        if (state.colourBy !== "volume" && state.colourBy !== "stretch") return null;
        this.view.fields.update(state.frame);
        return this.view.fields.values[state.colourBy];
    }
}
