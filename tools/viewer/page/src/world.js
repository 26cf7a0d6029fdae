// SPDX-License-Identifier: GPL-3.0-or-later
// All bodies and overlays in one stage, brought up to date when the state changes.
import { Triangle, Vector3 } from "three";
import { AttachmentView } from "./attachment_view.js";
import { cutPlane } from "./body_material.js";
import { BodyView } from "./body_view.js";
import { quantities } from "./colour_maps.js";
import { FibreView } from "./fibre_view.js";
import { LatticeView } from "./lattice_view.js";
import { MarksView } from "./marks_view.js";
import { samplePoints, Stage } from "./stage.js";
import { isShown } from "./store.js";

export class World {
    constructor(host, scene, store) {
        this.scene = scene;
        this.store = store;
        this.stage = new Stage(host, scene);
        this.bodies = scene.bodies.map((b) => new BodyView(b));
        this.lattices = new Map();
        this.fibres = new Map();
        this.attachments = [];
        this.marks = new MarksView(scene);
        for (const view of this.bodies) this.stage.world.add(view.group);
        this.stage.world.add(this.marks.group);
        this.restBox = this.findRestBox();
        store.on([], (_, changed) => {
            if (changed.has("theme")) this.stage.setTheme(store.state.theme);
            this.dirty = true;
            this.stage.invalidate();
        });
        this.stage.beforeDraw.push(() => this.refresh());
        this.stage.setTheme(store.state.theme);
        this.dirty = true;
    }

    /** Of everything soft, as modelled: what the cut plane moves through. */
    findRestBox() {
        const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
        for (const b of this.scene.bodies) {
            if (b.kind === "bone") continue;
            for (let i = 0; i < b.rest.length; ++i) {
                low[i % 3] = Math.min(low[i % 3], b.rest[i]);
                high[i % 3] = Math.max(high[i % 3], b.rest[i]);
            }
        }
        return low[0] <= high[0] ? [low, high] : [[0, 0, 0], [1, 1, 1]];
    }

    /** [nx, ny, nz, w], or null where nothing is cut. */
    plane() {
        const { on, axis, at, flip } = this.store.state.cut;
        if (!on) return null;
        const n = [0, 0, 0];
        const w = this.restBox[0][axis] + at * (this.restBox[1][axis] - this.restBox[0][axis]);
        n[axis] = flip ? -1 : 1;
        return [...n, flip ? -w : w];
    }

    refresh() {
        if (!this.dirty) return;
        this.dirty = false;
        const { state } = this.store, { overlays } = state;
        const plane = this.plane();
        if (plane) cutPlane.value.set(...plane);
        this.stage.grid.visible = overlays.grid;
        for (const view of this.bodies) view.update(state);
        this.showLayer(this.lattices, overlays.lattice, (v) => v.body.lattice, (v) => new LatticeView(v), plane);
        this.showLayer(this.fibres, overlays.fibres, (v) => v.body.fibres.length > 0, (v) => new FibreView(v));
        this.showAttachments(overlays.attachments);
        this.marks.group.visible = false;
        if (overlays.marks) this.marks.update(state);
    }

    /** Made when first shown: a layer that is off costs nothing. */
    showLayer(layer, on, has, make, plane = null) {
        const { state } = this.store;
        for (const view of this.bodies) {
            const index = view.body.index;
            const wanted = on && has(view) && isShown(state, index) && view.body.isThere(state.frame);
            if (wanted && !layer.has(index)) {
                layer.set(index, make(view));
                this.stage.world.add(layer.get(index).group);
            }
            const shown = layer.get(index);
            if (!shown) continue;
            shown.group.visible = Boolean(wanted);
            if (wanted) shown.update(state, plane);
        }
    }

    allAttachments() {
        if (this.attachments.length === 0)
            this.attachments = this.scene.attachments.map((a) => new AttachmentView(a, this.scene));
        return this.attachments;
    }
    showAttachments(on) {
        if (!on && this.attachments.length === 0) return;
        for (const view of this.allAttachments()) {
            if (!view.group.parent) this.stage.world.add(view.group);
            view.group.visible = on;
            if (on) view.update(this.store.state);
        }
    }

    /** The body under a point of the page, or -1. */
    pickBody(x, y) {
        return this.pickSurface(x, y)?.object.userData.body ?? -1;
    }
    pickSurface(x, y) {
        const { state } = this.store;
        if (this.dirty) this.refresh();
        const meshes = this.bodies.filter((v) => v.group.visible).map((v) => (v.mesh.visible ? v.mesh : v.edges));
        return this.stage.pick(x, y, meshes).find((h) => !this.isCutAway(h, state)) ?? null;
    }

    /** What is seen under a point of the page: {body, quantity, value, tet, vertex, excitation}, or null where nothing is.
        Filled tets are seen through the flesh, so they come first. */
    probe(x, y) {
        const hit = this.probeTets(x, y) ?? this.probeSurface(x, y);
        if (!hit) return null;
        const { overlays, frame } = this.store.state, all = overlays.fibres ? hit.body.fibres.map((f) => f.excitation[frame] ?? 0) : [];
        return { ...hit, excitation: all.length ? Math.max(...all) : null };
    }
    probeTets(x, y) {
        const { state } = this.store;
        if (!state.overlays.lattice || !state.filledLattice) return null;
        if (this.dirty) this.refresh();
        const layers = [...this.lattices.values()].filter((l) => l.group.visible);
        const hit = this.stage.pick(x, y, layers.map((l) => l.mesh))[0];
        if (!hit) return null;
        const layer = layers.find((l) => l.mesh === hit.object), tet = layer.open[hit.faceIndex][0], field = layer.fieldValues(state);
        return { body: layer.view.body, quantity: field ? state.colourBy : null, value: field ? field[tet] : NaN, tet, vertex: -1 };
    }
    probeSurface(x, y) {
        const { state } = this.store, hit = this.pickSurface(x, y);
        if (!hit) return null;
        const view = this.bodies[hit.object.userData.body], { body } = view;
        const corners = hit.face ? [hit.face.a, hit.face.b, hit.face.c] : [view.edges.geometry.index.array[hit.index]];
        const weights = hit.face ? hit.barycoord.toArray() : [1], nearest = corners[weights.indexOf(Math.max(...weights))];
        const vertexOf = (corner) => (body.shading ? body.shading[corner] : corner);
        const out = { body, quantity: quantities[state.colourBy] ? state.colourBy : null, value: NaN, tet: -1, vertex: vertexOf(nearest) };
        const values = out.quantity && view.valuesOf(out.quantity, state.map, state.frame);
        if (values) out.value = corners.reduce((sum, corner, i) => sum + weights[i] * values[vertexOf(corner)], 0);
        return out;
    }

    /** Whether the cut plane has taken away the flesh at a hit; the cut goes through the shape at rest. */
    isCutAway(hit, state) {
        const plane = this.plane(), { object, face, barycoord } = hit;
        if (!plane || this.scene.bodies[object.userData.body].kind === "bone" || !object.isMesh || state.surface === "wire") return false;
        const { rest } = object.geometry.attributes, at = new Vector3();
        Triangle.getInterpolatedAttribute(rest, face.a, face.b, face.c, barycoord, at);
        return at.x * plane[0] + at.y * plane[1] + at.z * plane[2] > plane[3];
    }

    /** Points of what is shown at this frame, or of the selected bodies alone. */
    shownPoints(selectedOnly = false) {
        const { state } = this.store;
        const chosen = this.bodies.filter((v) => v.body.isThere(state.frame) &&
            (selectedOnly ? state.selectedBodies.includes(v.body.index) : isShown(state, v.body.index)));
        return chosen.flatMap((v) => samplePoints(v.body, state.frame, 2000));
    }
    /** Frames the selected bodies, or all that is shown. */
    frameSelection() {
        const points = this.shownPoints(this.store.state.selectedBodies.length > 0);
        this.stage.frame(points.length ? points : this.stage.everything());
    }
    /** Looks from a named side: at what is shown now; while it plays, at the whole motion. */
    look(name) {
        const points = this.store.state.playing ? [] : this.shownPoints();
        this.stage.look(name, points.length ? points : undefined);
    }

    /** Least and largest shown value of a quantity at a frame, leaving out the outermost 1 % on each side. */
    measuredRange(quantity, frame = this.store.state.frame) {
        const { state } = this.store, all = [];
        for (const view of this.bodies) {
            if (!isShown(state, view.body.index) || !view.body.isThere(frame)) continue;
            const values = view.valuesOf(quantity, state.map, frame);
            if (values) for (const v of values) if (Number.isFinite(v)) all.push(v);
        }
        this.dirty = true; // what is drawn reads the same arrays
        if (all.length === 0) return null;
        all.sort((a, b) => a - b);
        return [all[Math.floor(0.01 * (all.length - 1))], all[Math.ceil(0.99 * (all.length - 1))]];
    }

    /** The same over frames spread through the run, so that frames compare. As many as take no noticeable time. */
    measuredRangeOfRun(quantity) {
        const vertices = this.scene.bodies.reduce((n, b) => n + b.vertices, 0);
        const most = Math.max(2, Math.min(9, Math.floor(1e6 / Math.max(1, vertices))));
        const ranges = spread(goodFrames(this.scene), most).map((f) => this.measuredRange(quantity, f)).filter(Boolean);
        return ranges.length ? [Math.min(...ranges.map((r) => r[0])), Math.max(...ranges.map((r) => r[1]))] : null;
    }
}

/** Frames that may be believed, or all if none may. */
function goodFrames({ frames }) {
    const all = [...frames.keys()], good = all.filter((f) => !frames[f].faults);
    return good.length ? good : all;
}

/** Up to `most` of a list, evenly, the last among them. */
const spread = (list, most) =>
    list.length <= most ? list : Array.from({ length: most }, (_, i) => list[Math.round((i * (list.length - 1)) / (most - 1))]);
