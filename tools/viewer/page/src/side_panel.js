// SPDX-License-Identifier: GPL-3.0-or-later
// The left side: bodies, and what is shown of them.
import { count, h, icon, iconButton, toggle } from "./dom.js";
import { overlay, overlayList } from "./overlays.js";
import { hasData, setOverlay } from "./store.js";

function section(title, ...children) {
    return h("section", {}, h("h3", {}, title), ...children);
}

function bodyList(scene, store, selection, world) {
    const rows = scene.bodies.map((b, i) => {
        const eye = iconButton("eye", "Show or hide", (e) => {
            e.stopPropagation();
            const { visible, solo } = store.state;
            const next = solo >= 0 ? visible.map((_, k) => k === solo || k === i) : visible.map((v, k) => (k === i ? !v : v));
            store.set({ visible: next, solo: -1 });
        });
        const solo = iconButton("solo", "Show it alone", (e) => {
            e.stopPropagation();
            store.set({ solo: store.state.solo === i ? -1 : i });
        });
        const row = h("li", { class: "body-row", "data-body": b.name, onclick: () => selection.selectBody(i),
            ondblclick: () => (selection.selectBody(i), world.frameSelection()) },
            h("span", { class: "swatch", style: `background:${b.colour}` }),
            h("span", { class: "name", title: `${b.name} (${b.matter})` }, b.name), solo, eye);
        return { row, eye, solo };
    });
    function update() {
        const { visible, solo, selectedBodies, frame } = store.state;
        rows.forEach(({ row, eye, solo: button }, i) => {
            const shown = solo >= 0 ? solo === i : visible[i];
            row.classList.toggle("off", !shown);
            row.classList.toggle("absent", !scene.bodies[i].isThere(frame));
            row.classList.toggle("selected", selectedBodies.includes(i));
            button.classList.toggle("on", solo === i);
            if (eye.dataset.shown !== String(shown)) (eye.innerHTML = icon(shown ? "eye" : "hidden")), (eye.dataset.shown = shown);
        });
        const [first] = selectedBodies;
        if (first !== undefined) rows[first].row.scrollIntoView({ block: "nearest" });
    }
    store.on(["visible", "solo", "selectedBodies", ...(scene.bodies.some((b) => b.present) ? ["frame"] : [])], update);
    update();
    const matters = [...new Set(scene.bodies.map((b) => b.matter))];
    const chips = matters.length < 2 ? null : h("div", { class: "chips" }, matters.map((matter) =>
        h("button", { type: "button", class: "chip", title: `Show or hide all that is ${matter}`, onclick: () => {
            const all = scene.bodies.every((b, i) => b.matter !== matter || store.state.visible[i]);
            store.set({ solo: -1, visible: store.state.visible.map((v, i) => (scene.bodies[i].matter === matter ? !all : v)) });
        } }, matter)),
        h("button", { type: "button", class: "chip", onclick: () => store.set({ visible: store.state.visible.map(() => true), solo: -1 }) }, "all"));
    return section("Bodies", chips, h("ul", { class: "bodies" }, rows.map((r) => r.row)));
}

function choice(options, get, set, store, key) {
    const buttons = options.map(([value, label]) =>
        h("button", { type: "button", "data-value": value, onclick: () => set(value) }, label));
    const update = () => buttons.forEach((b, i) => b.classList.toggle("on", options[i][0] === get()));
    store.on([key], update);
    update();
    return h("div", { class: "choice" }, buttons);
}

function surfaceSection(scene, store) {
    const smooth = toggle("Smooth shading", (on) => store.set({ smooth: on }), "S");
    const ground = overlay("grid"), grid = toggle(ground.title, (on) => setOverlay(store, scene, ground.name, on), ground.key.toUpperCase());
    const slider = h("input", { type: "range", min: "0", max: "1", step: "0.01", "aria-label": "Opacity of tissues",
        oninput: () => store.set({ opacity: Number(slider.value), opacityIsAutomatic: false }) });
    const update = () => {
        smooth.input.checked = store.state.smooth;
        grid.input.checked = store.state.overlays.grid;
        slider.value = store.state.opacity;
    };
    store.on(["smooth", "opacity", "overlays"], update);
    update();
    return section("Surface",
        choice([["shaded", "Shaded"], ["edges", "+ edges"], ["wire", "Wireframe"]], () => store.state.surface, (surface) => store.set({ surface }), store, "surface"),
        h("div", { class: "field" }, h("span", {}, "Flesh opacity"), slider), smooth.element, grid.element);
}

/** Entries for the list of painted maps: groups first, then each map. */
function mapEntries(scene) {
    const names = new Set(), single = new Map();
    for (const b of scene.bodies)
        for (const m of b.maps) {
            names.add(m.name);
            single.set(`${m.node}|${m.name}`, `${b.name}: ${m.name} (${m.node})`);
        }
    return [...[...names].map((n) => [`all:${n}`, `all ${n}`]), ...single];
}

function colourSection(scene, store) {
    const maps = mapEntries(scene);
    const options = [["material", "Material"], ["difference", `Difference from ${scene.other?.title}`], ["volume", "Volume change"], ["stretch", "Largest stretch"],
        ["area", "Surface area change"], ["weights", "Painted weights"]].filter(([name]) => hasData(scene, name));
    const select = h("select", { "aria-label": "Colour by", onchange: () => store.set({ colourBy: select.value }) },
        options.map(([value, label]) => h("option", { value }, label)));
    const mapSelect = h("select", { "aria-label": "Painted map", onchange: () => store.set({ map: mapSelect.value }) },
        maps.map(([value, label]) => h("option", { value }, label)));
    if (maps.length) store.set({ map: maps[0][0] });
    const update = () => {
        select.value = store.state.colourBy;
        mapSelect.value = store.state.map;
        mapSelect.hidden = store.state.colourBy !== "weights";
    };
    store.on(["colourBy", "map"], update);
    update();
    return section("Colour", select, mapSelect);
}

function overlaySection(scene, store) {
    const toggles = overlayList.filter((o) => o.count).map(({ name, title, key, count: countOf }) => {
        const n = countOf(scene), t = toggle(title, (on) => setOverlay(store, scene, name, on), key.toUpperCase());
        t.element.querySelector(".label").append(h("span", { class: "count" }, n ? count(n) : "none"));
        t.input.disabled = !hasData(scene, name);
        t.input.name = name;
        return [name, t];
    });
    const filled = toggle("Filled", (on) => store.set({ filledLattice: on }));
    const ofSelection = toggle("Of the selection", (on) => store.set({ marksOfSelection: on }), "O");
    ofSelection.input.name = "marksOfSelection";
    const whole = toggle("Beyond the flesh", (on) => store.set({ wholeTets: on }));
    const cut = toggle("Cut plane", (on) => store.set({ cut: { ...store.state.cut, on } }), "C");
    const flip = toggle("Other side", (on) => store.set({ cut: { ...store.state.cut, flip: on } }));
    const slider = h("input", { type: "range", min: "0", max: "1", step: "0.005", "aria-label": "Place of the cut",
        oninput: () => store.set({ cut: { ...store.state.cut, at: Number(slider.value) } }) });
    const axes = choice([[0, "X"], [1, "Y"], [2, "Z"]], () => store.state.cut.axis, (axis) => store.set({ cut: { ...store.state.cut, axis } }), store, "cut");
    const more = h("div", { class: "nested" }, axes, slider, flip.element);
    const fill = h("div", { class: "nested" }, filled.element, whole.element), whose = h("div", { class: "nested" }, ofSelection.element);
    const update = () => {
        const { overlays, cut: c, filledLattice } = store.state;
        for (const [name, t] of toggles) t.input.checked = overlays[name];
        filled.input.checked = filledLattice;
        whole.input.checked = store.state.wholeTets;
        ofSelection.input.checked = store.state.marksOfSelection;
        cut.input.checked = c.on;
        flip.input.checked = c.flip;
        slider.value = c.at;
        more.hidden = !c.on;
        fill.hidden = !overlays.lattice;
        whose.hidden = !overlays.marks;
    };
    store.on(["overlays", "cut", "filledLattice", "wholeTets", "marksOfSelection"], update);
    update();
    const nested = { lattice: fill, marks: whose };
    const rows = toggles.map(([name, t]) => [t.element, nested[name]].filter(Boolean));
    return section("Overlays", ...rows.flat(), cut.element, more);
}

function compareSection(scene, store) {
    if (!scene.other) return null;
    const sides = choice([["one", "This run"], ["side", "Side by side"]], () => store.state.compare, (compare) => store.set({ compare }), store, "compare");
    const difference = toggle("Difference", (on) => store.set({ colourBy: on ? "difference" : "material" }), "D");
    const update = () => (difference.input.checked = store.state.colourBy === "difference");
    difference.input.disabled = !hasData(scene, "difference");
    store.on(["colourBy"], update);
    update();
    return section(`Against ${scene.other.title}`, sides, difference.element);
}

export function sidePanel(scene, store, selection, world) {
    const side = h("aside", { class: "side", id: "side" }, compareSection(scene, store), overlaySection(scene, store), colourSection(scene, store), surfaceSection(scene, store),
        bodyList(scene, store, selection, world));
    store.on(["drawerOpen"], ({ drawerOpen }) => side.classList.toggle("open", drawerOpen));
    return side;
}

/** In small windows the side panel is a drawer: what opens it, and what closes it beside it. */
export function drawer(store) {
    const button = iconButton("menu", "Bodies, overlays and colours", () => store.set({ drawerOpen: !store.state.drawerOpen }),
        { class: "icon-button drawer-button", "aria-controls": "side", "aria-expanded": "false" });
    const scrim = h("div", { class: "scrim", hidden: true, onclick: () => store.set({ drawerOpen: false }) });
    store.on(["drawerOpen"], ({ drawerOpen }) => {
        scrim.hidden = !drawerOpen;
        button.setAttribute("aria-expanded", drawerOpen);
    });
    return { button, scrim };
}
