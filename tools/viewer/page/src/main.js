// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the page together.
import "./style.css";
import { keepAddress } from "./address.js";
import { makeApi } from "./api.js";
import { count, h, icon, iconButton } from "./dom.js";
import { graphPanel } from "./graph_panel.js";
import { inspector } from "./inspector.js";
import { helpSheet, listenToKeys } from "./keys.js";
import { legend } from "./legend.js";
import { Player } from "./player.js";
import { probe } from "./probe.js";
import { loadScene } from "./scene_data.js";
import { Selection } from "./selection.js";
import { drawer, sidePanel } from "./side_panel.js";
import { initialState, Store } from "./store.js";
import { timelinePanel } from "./timeline.js";
import { transport } from "./transport.js";
import { World } from "./world.js";

const root = document.getElementById("app");

function rememberedTheme() {
    try {
        const kept = localStorage.getItem("sinew-theme");
        if (kept === "light" || kept === "dark") return kept;
    } catch {
        // Some browsers refuse storage to files; then the system's choice is taken.
    }
    return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

function applyTheme(theme) {
    document.documentElement.dataset.theme = theme;
    try {
        localStorage.setItem("sinew-theme", theme);
    } catch {
        // see above
    }
}

function message(title, ...lines) {
    return h("div", { class: "message" }, h("h1", {}, title), lines.map((line) => h("p", {}, line)));
}

function notesPanel(scene) {
    const list = scene.notes.map((n) => h("li", { class: n.warning ? "warning" : "" }, h("span", { html: n.warning ? icon("warning") : "" }), n.text));
    return { element: h("ul", { class: "notes" }, list), opened() {} };
}

function topBar(scene, store, world, app) {
    const vertices = scene.bodies.reduce((n, b) => n + b.vertices, 0);
    const tets = scene.bodies.reduce((n, b) => n + (b.lattice?.count ?? 0), 0);
    const counted = (n, one, several) => `${count(n)} ${n === 1 ? one : several}`;
    const facts = [counted(scene.bodies.length, "body", "bodies"), counted(vertices, "vertex", "vertices"), tets ? counted(tets, "tet", "tets") : "",
        `${counted(scene.frames.length, "frame", "frames")} at ${scene.fps} fps`].filter(Boolean).join(" · ");
    const theme = iconButton("moon", "Light or dark (T)", () => store.set({ theme: store.state.theme === "dark" ? "light" : "dark" }));
    const update = () => (theme.innerHTML = icon(store.state.theme === "dark" ? "sun" : "moon"));
    store.on(["theme"], update);
    update();
    const views = [["front", "Front"], ["left", "Left"], ["top", "Top"], ["corner", "Corner"]].map(([name, label]) =>
        h("button", { type: "button", onclick: () => world.look(name) }, label));
    const save = iconButton("camera", "Save a picture", () =>
        h("a", { href: world.stage.picture(), download: `${scene.title}.${scene.frames[store.state.frame]?.frame ?? 0}.png` }).click());
    return h("header", { class: "top" }, world.stage ? app.drawer.button : null, h("span", { class: "brand" }, "Sinew"), h("span", { class: "title", title: `${scene.source}\n${scene.generator}` }, scene.title),
        h("span", { class: "facts" }, facts), h("span", { class: "space" }),
        world.stage ? h("div", { class: "choice views" }, views) : null, world.stage ? iconButton("focus", "Frame the selection (F)", () => world.frameSelection()) : null,
        world.stage ? save : null, theme, iconButton("help", "Keyboard and mouse (?)", () => app.help.toggle()));
}

function lowerPanel(scene, store, panels) {
    const tabs = Object.entries(panels).map(([name, p]) =>
        h("button", { type: "button", role: "tab", "data-panel": name, onclick: () => store.set({ panel: name, panelOpen: true }) }, p.title));
    const fold = iconButton("down", "Open or close (P)", () => store.set({ panelOpen: !store.state.panelOpen }));
    const body = h("div", { class: "panel-body" }, Object.values(panels).map((p) => p.element));
    let usual = null;
    const grow = iconButton("grow", "Large or usual (M)", () => {
        const tall = Math.round(innerHeight * 0.72);
        usual = body.clientHeight < tall - 4 ? body.clientHeight : (usual ?? 280);
        body.style.setProperty("height", `${body.clientHeight < tall - 4 ? tall : usual}px`);
        store.set({ panelOpen: true });
    });
    const grip = h("div", { class: "grip", title: "Drag to resize" });
    const element = h("div", { class: "panel" }, grip, h("div", { class: "tabs" }, tabs, h("span", { class: "space" }), Object.values(panels).map((p) => p.tools), grow, fold), body);
    grip.addEventListener("pointerdown", (e) => {
        grip.setPointerCapture(e.pointerId);
        const from = e.clientY, before = body.clientHeight;
        grip.onpointermove = (m) => body.style.setProperty("height", `${Math.max(60, Math.min(innerHeight - 220, before + from - m.clientY))}px`);
        grip.onpointerup = () => (grip.onpointermove = null);
    });
    const update = () => {
        const { panel, panelOpen } = store.state;
        element.classList.toggle("closed", !panelOpen);
        Object.entries(panels).forEach(([name, p], i) => {
            tabs[i].classList.toggle("on", panelOpen && name === panel);
            p.element.hidden = !panelOpen || name !== panel;
            if (p.tools) p.tools.hidden = p.element.hidden;
            if (panelOpen && name === panel) p.opened();
        });
    };
    store.on(["panel", "panelOpen"], update);
    return { element, update, grow: () => grow.click() };
}

/** Stands in for the 3D view where there is none: no bodies, or no WebGL. */
const noWorld = { stage: null, look() {}, frameSelection() {}, pickBody: () => -1 };

/** A word to the user that goes by itself. */
function speaker(host) {
    const line = h("div", { class: "toast", role: "status", hidden: true });
    host.append(line);
    let timer = 0;
    return (text) => {
        line.textContent = text;
        line.hidden = false;
        clearTimeout(timer);
        timer = setTimeout(() => (line.hidden = true), 2600);
    };
}

function banner(notes, store) {
    const warnings = notes.filter((n) => n.warning);
    if (warnings.length === 0) return null;
    const element = h("div", { class: "banner" }, h("span", { html: icon("warning") }), h("span", {}, warnings[0].text),
        warnings.length > 1 ? h("button", { type: "button", onclick: () => store.set({ panel: "notes", panelOpen: true }) }, `${warnings.length - 1} more`) : null,
        iconButton("close", "Close", () => element.remove()));
    return element;
}

/** Keeps the inspector off the transport and the tabs: in the view, or in the lower panel where that is the larger. In a
    narrow window it lies along the lower edge of the view. */
function keepInside(inspector, view, lower, store) {
    const { style } = inspector;
    const place = () => {
        const frame = inspector.offsetParent.getBoundingClientRect(), isNarrow = innerWidth <= 700;
        const at = isNarrow || view.clientHeight >= 220 || lower.clientHeight < view.clientHeight ? view : lower, box = at.getBoundingClientRect();
        style.top = isNarrow ? "auto" : `${box.top - frame.top + 10}px`;
        style.bottom = isNarrow ? `${frame.bottom - box.bottom + 8}px` : "auto";
        style.maxHeight = `${isNarrow ? Math.max(120, 0.6 * at.clientHeight) : at.clientHeight - 20}px`;
    };
    const observer = new ResizeObserver(() => inspector.offsetParent && place());
    for (const element of [view, lower, inspector]) observer.observe(element);
    store.on(["selectedNode", "selectedBodies"], () => inspector.offsetParent && place());
}

/** Side by side: which run is which. */
function sideTitles(scene, store) {
    if (!scene.other) return "";
    const element = h("div", { class: "side-titles" }, ...[scene, scene.other].map((s) => h("div", {}, h("span", { title: s.source }, s.title))));
    const missing = h("p", { class: "soft", hidden: true }, "has no such frame");
    element.lastChild.append(missing);
    const update = () => {
        element.hidden = store.state.compare !== "side";
        document.documentElement.classList.toggle("side-by-side", !element.hidden);
        const number = scene.frames[store.state.frame]?.frame;
        missing.hidden = scene.other.frames.some((f) => f.frame === number);
    };
    store.on(["compare", "frame"], update);
    update();
    return element;
}

/** What lies over the canvas at its sides, for framing: the legend on the left or below, the inspector on the right. */
function coveredBy(view, legend, inspector) {
    return () => {
        const w = view.clientWidth, h = view.clientHeight, a = legend.getBoundingClientRect(), over = { left: 0, right: 0, top: 0, bottom: 0 };
        if (legend.childElementCount) {
            if (a.width > 0.7 * w) over.top = a.height + 14;
            else if (a.width / w < a.height / h) over.left = a.width + 14;
            else over.bottom = a.height + 14;
        }
        const i = inspector.getBoundingClientRect();
        if (!inspector.hidden && i.top < view.getBoundingClientRect().bottom) {
            if (i.width > 0.7 * w) over.bottom = i.height + 14; // then the legend is above
            else over.right = i.width + 14;
        }
        if (over.left + over.right > 0.5 * w) over.left = 0; // a small window: the legend is only in its corner
        return over;
    };
}

async function start() {
    const loading = message("Loading …");
    root.replaceChildren(loading);
    if (!window.DecompressionStream) throw new Error("This browser is too old: it cannot unpack the data (DecompressionStream).");
    const bar = h("div", { class: "loading-bar" });
    loading.append(bar);
    const scene = await loadScene((share) => (bar.style.width = `${Math.round(100 * share)}%`));
    const store = new Store(initialState(scene));
    store.on(["theme"], ({ theme }) => applyTheme(theme));
    store.set({ theme: rememberedTheme() });
    applyTheme(store.state.theme);
    const selection = new Selection(scene, store), player = new Player(store, scene);
    const view = h("main", { class: "view" });
    const app = { scene, store, selection, player, world: noWorld, say: speaker(view) };
    let why = ["Nothing to show"];
    try {
        if (scene.bodies.length && scene.frames.length) app.world = new World(view, scene, store);
    } catch (error) {
        why = ["No 3D view", `The 3D view cannot start: ${error.message}. The time line and the graph still work.`];
    }
    const { world } = app, hasView = world !== noWorld;
    app.help = helpSheet(app);
    app.timeline = timelinePanel(scene, store, player);
    const panels = { timeline: { title: "Time line", ...app.timeline }, graph: { title: "Node graph", ...graphPanel(scene, store, selection) } };
    if (scene.notes.length) panels.notes = { title: `Notes (${scene.notes.length})`, ...notesPanel(scene) };
    const panel = lowerPanel(scene, store, panels);
    app.growPanel = panel.grow;
    const work = h("div", { class: "work" }, view, transport(scene, store, player), panel.element);
    if (hasView) {
        const colours = legend(scene, store, world), about = inspector(scene, store, selection, world);
        view.append(colours, sideTitles(scene, store), banner(scene.notes, store) ?? "", probe(scene, store, world, colours));
        work.append(about);
        keepInside(about, view, panel.element.querySelector(".panel-body"), store);
        world.stage.covered = coveredBy(view, colours, about);
    } else view.append(message(...why, ...scene.notes.map((n) => n.text)));
    app.drawer = drawer(store);
    root.replaceChildren(topBar(scene, store, world, app),
        h("div", { class: "middle" }, ...(hasView ? [sidePanel(scene, store, selection, world)] : []), work), app.drawer.scrim, app.help.element);
    panel.update();
    if (hasView) {
        clicks(app);
        world.stage.resize();
        world.stage.lookHome();
        world.stage.draw();
    }
    listenToKeys(app);
    keepAddress(app);
    return app;
}

/** A click that is not a drag selects. */
function clicks({ world, selection }) {
    const { canvas } = world.stage;
    let down = null;
    canvas.addEventListener("pointerdown", (e) => (down = [e.clientX, e.clientY, e.button]));
    canvas.addEventListener("pointerup", (e) => {
        if (!down || down[2] !== 0 || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 4) return;
        selection.selectBody(world.pickBody(e.clientX, e.clientY));
    });
    canvas.addEventListener("dblclick", () => world.frameSelection());
}

window.sinewReady = start().then(
    (app) => {
        window.sinew = makeApi(app, performance.now());
        document.documentElement.dataset.ready = "yes";
    },
    (error) => {
        root.replaceChildren(message("This page cannot be shown", error.message));
        document.documentElement.dataset.ready = "failed";
    },
);
