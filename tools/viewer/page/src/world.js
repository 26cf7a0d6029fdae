// SPDX-License-Identifier: GPL-3.0-or-later
// All bodies and overlays in one stage, brought up to date when the state changes.
import { Triangle, Vector3 } from "three";
import { cutPlane } from "./body_material.js";
import { quantities } from "./colour_maps.js";
import { marksQuantity } from "./marks.js";
import { RunView, stateOfOther } from "./run_view.js";
import { samplePoints, Stage } from "./stage.js";
import { isShown } from "./store.js";

export class World {
    constructor(host, scene, store) {
        this.scene = scene;
        this.store = store;
        this.stage = new Stage(host, scene);
        this.run = new RunView(scene);
        this.stage.world.add(this.run.group);
        this.other = scene.other ? new RunView(scene.other) : null;
        if (this.other) {
            this.other.group.scale.setScalar(scene.unitsPerMetre / scene.other.unitsPerMetre);
            this.stage.world.add(this.other.group);
            this.stage.sides = () => (this.isSideBySide() ? [this.run.group, this.other.group] : null);
        }
        this.restBox = this.findRestBox();
        store.on([], (_, changed) => {
            if (changed.has("theme")) this.stage.setTheme(store.state.theme);
            this.dirty = true;
            if (changed.has("compare")) this.stage.resize();
            this.stage.invalidate();
        });
        this.stage.beforeDraw.push(() => this.refresh());
        this.stage.setTheme(store.state.theme);
        this.dirty = true;
    }
    get bodies() {
        return this.run.bodies;
    }
    get lattices() {
        return this.run.lattices;
    }
    get fibres() {
        return this.run.fibres;
    }
    get marks() {
        return this.run.marks;
    }
    allAttachments() {
        return this.run.allAttachments();
    }
    isSideBySide() {
        return Boolean(this.other) && this.store.state.compare === "side";
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
        const { state } = this.store, plane = this.plane();
        if (plane) cutPlane.value.set(...plane);
        this.stage.grid.visible = state.overlays.grid;
        this.run.refresh(state, plane);
        if (!this.other) return;
        const there = this.isSideBySide() ? stateOfOther(state, this.scene, this.scene.other) : null;
        this.other.group.visible = Boolean(there);
        if (there) this.other.refresh(there, plane);
    }

    /** The run whose side a point of the page lies on. */
    runAt(x, y) {
        return this.isSideBySide() && this.stage.sideAt(x, y) === 1 ? this.other : this.run;
    }
    /** The body of the first run under a point of the page, or that of the same name as the other's; or -1. */
    pickBody(x, y) {
        const hit = this.pickSurface(x, y), run = this.runAt(x, y);
        if (!hit) return -1;
        const index = hit.object.userData.body;
        return run === this.run ? index : this.scene.bodies.findIndex((b) => b.name === run.scene.bodies[index].name);
    }
    pickSurface(x, y) {
        const { state } = this.store;
        if (this.dirty) this.refresh();
        const { bodies } = this.runAt(x, y);
        const meshes = bodies.filter((v) => v.group.visible).map((v) => (v.mesh.visible ? v.mesh : v.edges));
        return this.stage.pick(x, y, meshes).find((h) => !this.isCutAway(h, state)) ?? null;
    }

    /** What is seen under a point of the page: {body, quantity, value, tet, vertex, excitation}, {mark, scene, quantity, value}
        of the nearest mark, or null where nothing is. Marks and filled tets are seen through the flesh, so they come first. */
    probe(x, y) {
        const mark = this.probeMarks(x, y);
        if (mark) return mark;
        const hit = this.probeTets(x, y) ?? this.probeSurface(x, y);
        if (!hit) return null;
        const { overlays } = this.store.state, { frame } = this.stateAt(x, y), all = overlays.fibres ? hit.body.fibres.map((f) => f.excitation[frame] ?? 0) : [];
        return { ...hit, excitation: all.length ? Math.max(...all) : null };
    }
    stateAt(x, y) {
        const { state } = this.store;
        return this.runAt(x, y) === this.run ? state : stateOfOther(state, this.scene, this.scene.other) ?? state;
    }
    probeMarks(x, y) {
        const state = this.stateAt(x, y), run = this.runAt(x, y), side = run === this.run ? 0 : 1, reach = 8; // CSS pixels
        if (!state.overlays.marks) return null;
        if (this.dirty) this.refresh();
        let best = null, nearest = reach;
        for (const mark of run.marks.group.visible ? run.marks.shown : []) {
            const [u, v] = this.stage.project(mark.group.numbers.subarray(7 * mark.i, 7 * mark.i + 3), side), far = Math.hypot(u - x, v - y);
            if (far < nearest) (nearest = far), (best = mark);
        }
        return best && { mark: best, scene: run.scene, quantity: marksQuantity(best.group.unit), value: best.group.numbers[7 * best.i + 6] };
    }
    probeTets(x, y) {
        const state = this.stateAt(x, y);
        if (!state.overlays.lattice || !state.filledLattice) return null;
        if (this.dirty) this.refresh();
        const layers = [...this.runAt(x, y).lattices.values()].filter((l) => l.group.visible);
        const hit = this.stage.pick(x, y, layers.map((l) => l.mesh))[0];
        if (!hit) return null;
        const layer = layers.find((l) => l.mesh === hit.object), tet = layer.open[hit.faceIndex][0], field = layer.fieldValues(state);
        return { body: layer.view.body, quantity: field ? state.colourBy : null, value: field ? field[tet] : NaN, tet, vertex: -1 };
    }
    probeSurface(x, y) {
        const state = this.stateAt(x, y), hit = this.pickSurface(x, y);
        if (!hit) return null;
        const view = this.runAt(x, y).bodies[hit.object.userData.body], { body } = view;
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
        if (!plane || object.userData.isBone || !object.isMesh || state.surface === "wire") return false;
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
        const sorted = Float64Array.from(all).sort();
        return [sorted[Math.floor(0.01 * (all.length - 1))], sorted[Math.ceil(0.99 * (all.length - 1))]];
    }

    /** The same over frames spread through the run, so that frames compare. As many as take no noticeable time. */
    measuredRangeOfRun(quantity) {
        const vertices = this.scene.bodies.reduce((n, b) => n + b.vertices, 0);
        const most = Math.max(2, Math.min(9, Math.floor(6e5 / Math.max(1, vertices))));
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
