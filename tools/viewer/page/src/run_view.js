// SPDX-License-Identifier: GPL-3.0-or-later
// All bodies and overlays of one run, brought up to date when the state changes.
import { Group } from "three";
import { AttachmentView } from "./attachment_view.js";
import { BodyView } from "./body_view.js";
import { FibreView } from "./fibre_view.js";
import { LatticeView } from "./lattice_view.js";
import { MarksView } from "./marks_view.js";
import { isShown } from "./store.js";

export class RunView {
    constructor(scene) {
        this.scene = scene;
        this.group = new Group();
        this.bodies = scene.bodies.map((b) => new BodyView(b, scene));
        this.lattices = new Map();
        this.fibres = new Map();
        this.attachments = [];
        this.marks = new MarksView(scene);
        for (const view of this.bodies) this.group.add(view.group);
        this.group.add(this.marks.group);
    }

    /** `plane`: [nx, ny, nz, w] or null. */
    refresh(state, plane) {
        const { overlays } = state;
        for (const view of this.bodies) view.update(state);
        this.showLayer(state, this.lattices, overlays.lattice, (v) => v.body.lattice, (v) => new LatticeView(v), plane);
        this.showLayer(state, this.fibres, overlays.fibres, (v) => v.body.fibres.length > 0, (v) => new FibreView(v));
        this.showAttachments(state, overlays.attachments);
        this.marks.group.visible = false;
        if (overlays.marks) this.marks.update(state);
    }

    /** Made when first shown: a layer that is off costs nothing. */
    showLayer(state, layer, on, has, make, plane = null) {
        for (const view of this.bodies) {
            const index = view.body.index;
            const wanted = on && has(view) && isShown(state, index) && view.body.isThere(state.frame);
            if (wanted && !layer.has(index)) {
                layer.set(index, make(view));
                this.group.add(layer.get(index).group);
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
    showAttachments(state, on) {
        if (!on && this.attachments.length === 0) return;
        for (const view of this.allAttachments()) {
            if (!view.group.parent) this.group.add(view.group);
            view.group.visible = on;
            if (on) view.update(state);
        }
    }
}

/** The same choices for the run that is compared with: its own frame, its own bodies of the same names. Null where it has no
    such frame. */
export function stateOfOther(state, scene, other) {
    const number = scene.frames[state.frame]?.frame, frame = other.frames.findIndex((f) => f.frame === number);
    if (frame < 0) return null;
    const here = (b) => scene.bodies.findIndex((a) => a.name === b.name);
    const solo = state.solo < 0 ? -1 : other.bodies.findIndex((b) => b.name === scene.bodies[state.solo].name);
    return {
        ...state,
        frame,
        visible: other.bodies.map((b) => (state.solo >= 0 && solo < 0 ? false : (state.visible[here(b)] ?? true))),
        solo,
        selectedBodies: state.selectedBodies.map((i) => other.bodies.findIndex((b) => b.name === scene.bodies[i].name)).filter((i) => i >= 0),
    };
}
