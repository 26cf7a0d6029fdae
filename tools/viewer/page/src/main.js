// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the page together.
import "./style.css";
import { makeApi } from "./api.js";
import { count, h, icon, iconButton } from "./dom.js";
import { graphPanel } from "./graph_panel.js";
import { inspector } from "./inspector.js";
import { helpSheet, listenToKeys } from "./keys.js";
import { legend } from "./legend.js";
import { Player } from "./player.js";
import { loadScene } from "./scene_data.js";
import { Selection } from "./selection.js";
import { sidePanel } from "./side_panel.js";
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
    return { element: list.length ? h("ul", { class: "notes" }, list) : h("p", { class: "empty" }, "Nothing to remark."), opened() {} };
}

function topBar(scene, store, world, app) {
    const vertices = scene.bodies.reduce((n, b) => n + b.vertices, 0);
    const tets = scene.bodies.reduce((n, b) => n + (b.lattice?.count ?? 0), 0);
    const facts = [`${scene.bodies.length} bodies`, `${count(vertices)} vertices`, tets ? `${count(tets)} tets` : "", `${scene.frames.length} frames at ${scene.fps} fps`].filter(Boolean).join(" · ");
    const theme = iconButton("moon", "Light or dark (T)", () => store.set({ theme: store.state.theme === "dark" ? "light" : "dark" }));
    const update = () => (theme.innerHTML = icon(store.state.theme === "dark" ? "sun" : "moon"));
    store.on(["theme"], update);
    update();
    const views = [["front", "Front"], ["left", "Left"], ["top", "Top"], ["corner", "Corner"]].map(([name, label]) =>
        h("button", { type: "button", onclick: () => world?.stage.look(name) }, label));
    const save = iconButton("camera", "Save a picture", () =>
        h("a", { href: world.stage.picture(), download: `${scene.title}.${scene.frames[store.state.frame]?.frame ?? 0}.png` }).click());
    return h("header", { class: "top" }, h("span", { class: "brand" }, "Sinew"), h("span", { class: "title" }, scene.title),
        h("span", { class: "facts" }, facts), h("span", { class: "space" }),
        world ? h("div", { class: "choice views" }, views) : null, world ? iconButton("focus", "Frame the selection (F)", () => world.frameSelection()) : null,
        world ? save : null, theme, iconButton("help", "Keyboard and mouse (?)", () => app.help.toggle()));
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
    const element = h("div", { class: "panel" }, grip, h("div", { class: "tabs" }, tabs, h("span", { class: "space" }), grow, fold), body);
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
            if (panelOpen && name === panel) p.opened();
        });
    };
    store.on(["panel", "panelOpen"], update);
    return { element, update, grow: () => grow.click() };
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
    const app = { scene, store, selection, player };
    const view = h("main", { class: "view" });
    let noView = null;
    try {
        if (scene.bodies.length && scene.frames.length) app.world = new World(view, scene, store);
    } catch (error) {
        noView = `The 3D view cannot start: ${error.message}. The time line and the graph still work.`;
    }
    app.help = helpSheet({ ...app, world: app.world ?? { frameSelection() {}, stage: { look() {} } } });
    app.timeline = timelinePanel(scene, store, player);
    const panels = { timeline: { title: "Time line", ...app.timeline }, graph: { title: "Node graph", ...graphPanel(scene, store, selection) } };
    if (scene.notes.length) panels.notes = { title: `Notes (${scene.notes.length})`, ...notesPanel(scene) };
    const panel = lowerPanel(scene, store, panels);
    app.growPanel = panel.grow;
    if (app.world) view.append(legend(scene, store, app.world), inspector(scene, store, selection, app.world));
    else view.append(message(noView ? "No 3D view" : "Nothing to show", noView ?? "", ...scene.notes.map((n) => n.text)));
    const warnings = scene.notes.filter((n) => n.warning);
    if (app.world && warnings.length) {
        const banner = h("div", { class: "banner" }, h("span", { html: icon("warning") }), h("span", {}, warnings[0].text),
            warnings.length > 1 ? h("button", { type: "button", onclick: () => store.set({ panel: "notes", panelOpen: true }) }, `${warnings.length - 1} more`) : null,
            iconButton("close", "Close", () => banner.remove()));
        view.append(banner);
    }
    root.replaceChildren(topBar(scene, store, app.world, app),
        h("div", { class: "middle" }, ...(app.world ? [sidePanel(scene, store, selection, app.world)] : []),
            h("div", { class: "work" }, view, transport(scene, store, player), panel.element)), app.help.element);
    panel.update();
    if (app.world) {
        clicks(app);
        app.world.stage.resize();
        app.world.stage.look("corner");
        app.world.stage.draw();
    }
    listenToKeys({ ...app, world: app.world ?? { frameSelection() {}, stage: { look() {} } } });
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
        if (app.world) window.sinew = makeApi(app, performance.now());
        else window.sinew = { scene: app.scene, frames: [], loadMs: performance.now() };
        document.documentElement.dataset.ready = "yes";
    },
    (error) => {
        root.replaceChildren(message("This page cannot be shown", error.message));
        document.documentElement.dataset.ready = "failed";
    },
);
