// SPDX-License-Identifier: GPL-3.0-or-later
// Keyboard short-cuts and the sheet that lists them.
import { h, iconButton } from "./dom.js";
import { overlay, overlayList } from "./overlays.js";
import { hasData, setOverlay } from "./store.js";

const nouns = { volume: "tets, so no change of volume", difference: "bodies that both runs have" };

/** [keys, what they do, action]. `app` is what main.js has put together. */
export function shortcuts(app) {
    const { scene, store, player, world } = app;
    const none = (name) => app.say(`This page has no ${overlay(name)?.noun ?? nouns[name]}.`);
    const flip = (name) => setOverlay(store, scene, name, !store.state.overlays[name]) || none(name);
    const surfaces = ["shaded", "edges", "wire"];
    return [
        [[" "], "Play or pause", () => player.toggle()],
        [["ArrowRight"], "One frame on (Shift: ten)", (e) => player.step(e.shiftKey ? 10 : 1)],
        [["ArrowLeft"], "One frame back (Shift: ten)", (e) => player.step(e.shiftKey ? -10 : -1)],
        [["Home"], "First frame", () => player.goTo(0)],
        [["End"], "Last frame", () => player.goTo(player.last)],
        [["r"], "Repeat on or off", () => store.set({ loop: !store.state.loop })],
        [["+", "="], "Faster", () => store.set({ speed: Math.min(4, store.state.speed * 2) })],
        [["-"], "Slower", () => store.set({ speed: Math.max(0.125, store.state.speed / 2) })],
        [["f"], "Frame the selection, or everything", () => world.frameSelection()],
        [["1", "2", "3", "4"], "Look from the front, the left, the top, the corner, at what is shown now", (e) =>
            world.look({ 1: "front", 2: "left", 3: "top", 4: "corner" }[e.key])],
        [["w"], "Surface: shaded, with edges, edges alone", () =>
            store.set({ surface: surfaces[(surfaces.indexOf(store.state.surface) + 1) % 3] })],
        [["s"], "Smooth or flat shading", () => store.set({ smooth: !store.state.smooth })],
        [["x"], "See through the flesh, or not", () => store.set({ opacity: store.state.opacity < 1 ? 1 : 0.28, opacityIsAutomatic: false })],
        ...overlayList.map(({ name, about, key }) => [[key], about, () => flip(name)]),
        [["o"], "Marks of the selected bodies alone, or all", () => store.set({ marksOfSelection: !store.state.marksOfSelection })],
        [["c"], "Cut plane", () => store.set({ cut: { ...store.state.cut, on: !store.state.cut.on } })],
        [["v"], "Volume change as colours", () => hasData(scene, "volume")
            ? store.set({ colourBy: store.state.colourBy === "volume" ? "material" : "volume" }) : none("volume")],
        ...(scene.other ? [
            [["d"], `Difference from ${scene.other.title} as colours`, () => hasData(scene, "difference")
                ? store.set({ colourBy: store.state.colourBy === "difference" ? "material" : "difference" }) : none("difference")],
            [["y"], "Side by side, or this run alone", () => store.set({ compare: store.state.compare === "side" ? "one" : "side" })],
        ] : []),
        [["h"], "Hide the selected bodies", () => {
            const visible = store.state.visible.slice();
            for (const i of store.state.selectedBodies) visible[i] = false;
            store.set({ visible, solo: -1 });
        }],
        [["i"], "Show the selected body alone", () => {
            const [first = -1] = store.state.selectedBodies;
            store.set({ solo: store.state.solo >= 0 ? -1 : first });
        }],
        [["u"], "Show everything", () => store.set({ visible: store.state.visible.map(() => true), solo: -1 })],
        [["n"], "Time line or node graph", () => store.set({ panel: store.state.panel === "graph" ? "timeline" : "graph", panelOpen: true })],
        [["p"], "Lower panel open or closed", () => store.set({ panelOpen: !store.state.panelOpen })],
        [["m"], "Lower panel large or usual", () => app.growPanel()],
        [["t"], "Light or dark", () => store.set({ theme: store.state.theme === "dark" ? "light" : "dark" })],
        [["Escape"], "Select nothing", () => (store.state.drawerOpen ? store.set({ drawerOpen: false }) : app.selection.clear())],
        [["?"], "This list", () => app.help.toggle()],
    ];
}

const names = { " ": "Space", ArrowRight: "→", ArrowLeft: "←", Escape: "Esc" };

/** Keys that a focused field keeps for itself. */
function belongsToField(target, key) {
    if (!target.matches) return false;
    if (target.matches("input:not([type=range]):not([type=checkbox]), textarea")) return true;
    if (target.matches("select")) return key.length > 1 || key === " ";
    if (target.matches("input[type=range]:not(.scrub)")) return key.startsWith("Arrow") || ["Home", "End", "PageUp", "PageDown"].includes(key);
    return key === " " && target.matches("button, a, input[type=checkbox]");
}

export function listenToKeys(app) {
    const list = shortcuts(app);
    const actions = new Map(list.flatMap(([keys, , act]) => keys.map((k) => [k, act])));
    window.addEventListener("keydown", (e) => {
        if (e.ctrlKey || e.metaKey || e.altKey || e.defaultPrevented) return;
        // Enter and Escape leave a field that was typed into; what follows is for the view again.
        if (e.target.matches?.("input:not([type=range]):not([type=checkbox])") && (e.key === "Enter" || e.key === "Escape")) return e.target.blur();
        if (belongsToField(e.target, e.key)) return;
        if (e.key === "Escape" && app.help.isOpen()) return app.help.toggle();
        const act = actions.get(e.key) ?? actions.get(e.key.toLowerCase());
        if (!act) return;
        e.preventDefault();
        act(e);
    });
    // A click with the mouse leaves no focus on a button or switch, so that space plays and does not press it again.
    window.addEventListener("click", (e) => {
        const at = document.activeElement;
        if (e.detail > 0 && at?.matches?.("button, input[type=checkbox]")) at.blur();
    });
}

export function helpSheet(app) {
    const rows = shortcuts(app).map(([keys, what]) =>
        h("tr", {}, h("td", {}, keys.map((k) => h("kbd", {}, names[k] ?? k.toUpperCase()))), h("td", {}, what)));
    const half = Math.ceil(rows.length / 2);
    const sheet = h("div", { class: "sheet", role: "dialog", "aria-label": "Keyboard short-cuts", hidden: true },
        h("div", { class: "sheet-card" },
            h("header", {}, h("h2", {}, "Keyboard and mouse"), iconButton("close", "Close", () => api.toggle())),
            h("div", { class: "sheet-columns" },
                h("table", {}, rows.slice(0, half)), h("table", {}, rows.slice(half))),
            h("p", {}, "Drag turns, right-drag (or Shift-drag) moves, the wheel zooms. A click selects a body and its node; a double click frames it."),
            h("p", {}, `This page: ${app.scene.source || app.scene.title}, made by ${app.scene.generator}.`),
            h("p", { class: "soft" }, "Made with Sinew (GPL-3.0-or-later). Drawing by three.js, © three.js authors, MIT licence.")));
    sheet.addEventListener("click", (e) => e.target === sheet && api.toggle());
    const api = { element: sheet, isOpen: () => !sheet.hidden, toggle: () => (sheet.hidden = !sheet.hidden) };
    return api;
}
