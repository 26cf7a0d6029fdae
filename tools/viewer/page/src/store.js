// SPDX-License-Identifier: GPL-3.0-or-later
// What the user has chosen. Everything that shows something listens here; nothing else knows of the others.

import { twinOf } from "./difference.js";
import { usualMarkRanges } from "./marks.js";
import { overlay, overlayList } from "./overlays.js";

export class Store {
    constructor(state) {
        this.state = state;
        this.listeners = [];
    }
    /** Calls `call(state, changed)` when one of `keys` changes (any key if there are none). */
    on(keys, call) {
        this.listeners.push({ keys: new Set(keys), call });
    }
    set(patch) {
        const changed = new Set();
        for (const [key, value] of Object.entries(patch)) {
            if (Object.is(this.state[key], value)) continue;
            this.state[key] = value;
            changed.add(key);
        }
        if (changed.size === 0) return;
        for (const { keys, call } of this.listeners)
            if (keys.size === 0 || [...changed].some((k) => keys.has(k))) call(this.state, changed);
    }
}

/** Attachments and marks: what the run reaches, so that frames compare. */
function usualRanges(scene) {
    const longest = 1000 * scene.frames.reduce((m, f) => Math.max(m, f.faults ? 0 : (f.terms?.attachment?.max_stretch_m ?? 0)), 0);
    return { ...(longest > 0 ? { distance: [0, Number(longest.toPrecision(2))] } : {}), ...usualMarkRanges(scene) };
}

/** Whether the page has anything to show for an overlay or a colouring. */
export function hasData(scene, name) {
    const over = overlay(name);
    if (over) return over.has(scene);
    switch (name) {
        case "volume": case "stretch": return scene.bodies.some((b) => b.lattice && b.hostTet);
        case "area": return scene.bodies.some((b) => !b.isRigid);
        case "difference": return Boolean(scene.other) && scene.bodies.some((b) => twinOf(b, scene));
        case "weights": return scene.bodies.some((b) => b.maps.length > 0);
        default: return true;
    }
}

/** What a fresh page shows. */
export function initialState(scene) {
    return {
        frame: 0,
        playing: false,
        speed: 1,
        loop: !matchMedia("(prefers-reduced-motion: reduce)").matches, // who wants little motion is shown it once
        theme: "light",
        surface: "shaded", // "shaded", "edges" or "wire"
        smooth: true,
        visible: scene.bodies.map(() => true),
        solo: -1,
        selectedBodies: [],
        selectedNode: null,
        overlays: Object.fromEntries(overlayList.map((o) => [o.name, Boolean(o.fresh)])),
        marksOfSelection: false, // of the selected bodies alone, where there are some
        filledLattice: true,
        wholeTets: false, // also where they reach beyond the flesh
        cut: { on: false, axis: 0, at: 0.5, flip: false },
        compare: scene.other ? "side" : "one", // or side by side; the difference is a colour
        colourBy: "material", // "difference", "volume", "stretch", "area", "weights"
        map: "",
        ranges: usualRanges(scene), // by quantity: [least, most]
        opacity: 1, // of tissues and cloth
        opacityIsAutomatic: true,
        panel: "timeline",
        panelOpen: innerHeight >= 480, // a phone that lies has no room for it
        drawerOpen: false, // small windows: the side panel
        graphNear: true, // the graph panel shows a selected node with its neighbours alone
    };
}

/** Turns an overlay on or off. Inner things are shown through the tissue unless the user has set it otherwise. False if
    the page has no data for it; then nothing changes. */
export function setOverlay(store, scene, name, on) {
    if (on && !hasData(scene, name)) return false;
    const overlays = { ...store.state.overlays, [name]: on };
    const patch = { overlays };
    if (store.state.opacityIsAutomatic) {
        const inner = overlayList.some((o) => o.inner && overlays[o.name]);
        patch.opacity = inner ? 0.28 : 1;
    }
    store.set(patch);
    return true;
}

export function isShown(state, body) {
    return state.solo >= 0 ? state.solo === body : state.visible[body];
}
