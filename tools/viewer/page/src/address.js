// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen, in the page's address: #frame=64&camera=…&colour=stretch&show=fibres&select=biceps. A copied address
// opens the page as it was. What is as in a fresh page is left out.
import { overlayNames } from "./overlays.js";
import { hasData, initialState, setOverlay } from "./store.js";

const number = (x) => String(Number(x.toPrecision(6)));

/** The address's fragment without #. `camera`: eye and target, 6 numbers in scene units, or null. */
export function writeAddress(scene, state, camera, fresh = initialState(scene)) {
    const out = [];
    const frame = scene.frames[state.frame]?.frame;
    if (frame !== undefined && state.frame !== fresh.frame) out.push(["frame", frame]);
    if (camera) out.push(["camera", camera.map(number).join(",")]);
    if (state.compare !== fresh.compare) out.push(["compare", state.compare]);
    if (state.colourBy !== fresh.colourBy) out.push(["colour", state.colourBy]);
    const shown = overlayNames.filter((name) => state.overlays[name]), usual = overlayNames.filter((name) => fresh.overlays[name]);
    if (shown.join() !== usual.join()) out.push(["show", shown.join(",")]);
    if (state.marksOfSelection) out.push(["marks", "selection"]);
    if (state.selectedNode) out.push(["node", state.selectedNode]);
    else if (state.selectedBodies.length === 1) out.push(["body", scene.bodies[state.selectedBodies[0]].name]);
    return out.map(([key, value]) => `${key}=${encodeURIComponent(value).replaceAll("%2C", ",")}`).join("&");
}

/** Makes the page show what a fragment says; what it does not name is as in a fresh page. Gives what could not be followed,
    for people. */
export function followAddress(text, { scene, store, selection, world }) {
    const words = new URLSearchParams(text.replace(/^#/, "")), fresh = initialState(scene), problems = [];
    const frame = words.get("frame");
    let index = fresh.frame;
    if (frame !== null) {
        index = scene.frames.findIndex((f) => f.frame === Number(frame));
        if (index < 0 || frame.trim() === "") (index = fresh.frame), problems.push(`There is no frame ${frame}.`);
    }
    const colour = words.get("colour") ?? fresh.colourBy;
    const isColour = ["material", "difference", "volume", "stretch", "area", "weights"].includes(colour) && hasData(scene, colour);
    if (!isColour) problems.push(`There is nothing to colour by ${colour}.`);
    const compare = words.get("compare") ?? fresh.compare, isCompared = compare === "one" || (compare === "side" && Boolean(scene.other));
    if (!isCompared) problems.push("There is no second run.");
    store.set({ frame: index, playing: false, compare: isCompared ? compare : fresh.compare, colourBy: isColour ? colour : fresh.colourBy });
    const shown = words.has("show") ? words.get("show").split(",").filter(Boolean) : overlayNames.filter((name) => fresh.overlays[name]);
    for (const name of shown) if (!overlayNames.includes(name) || !hasData(scene, name)) problems.push(`There are no ${name} to show.`);
    for (const name of overlayNames) if (store.state.overlays[name] !== shown.includes(name)) setOverlay(store, scene, name, shown.includes(name));
    const marks = words.get("marks");
    if (marks !== null && marks !== "selection") problems.push(`There are no marks of ${marks}.`);
    store.set({ marksOfSelection: marks === "selection" });
    const node = words.get("node"), body = scene.bodies.findIndex((b) => b.name === words.get("body"));
    if (node !== null && selection.nodes.has(node)) selection.selectNode(node);
    else if (body >= 0) selection.selectBody(body);
    else if (node !== null || words.has("body")) problems.push(`There is no ${node ?? words.get("body")}.`);
    else selection.clear();
    if (!world.stage) return problems;
    const camera = words.get("camera")?.split(",").map(Number);
    if (camera && world.stage.setView(camera)) return problems;
    if (camera) problems.push("The camera in the address is none.");
    world.stage.lookHome();
    return problems;
}

/** Keeps the address up to date, and follows it when somebody changes it. Not while it plays: some browsers take only so
    many changes a minute. */
export function keepAddress(app) {
    const { scene, store, world, say } = app, { stage } = world;
    const fresh = initialState(scene);
    const fragment = () => location.hash.replace(/^#/, "");
    // What the address held when it was last written or followed. Where it holds something else, somebody has changed it
    // and the event that says so is still to come.
    let timer = 0, known = fragment();
    const write = () => {
        if (fragment() !== known) return;
        const words = writeAddress(scene, store.state, stage && !stage.isHome ? stage.viewNumbers() : null, fresh);
        try {
            history.replaceState(null, "", words ? `#${words}` : location.pathname + location.search);
        } catch {
            // Some browsers refuse it for pages from disk; then the address stays as it is.
        }
        known = fragment();
    };
    const soon = () => {
        clearTimeout(timer);
        if (!store.state.playing) timer = setTimeout(write, 200);
    };
    const follow = () => {
        known = fragment();
        const [problem] = followAddress(location.hash, app);
        if (problem) say(problem);
    };
    if (known) follow();
    store.on(["frame", "playing", "compare", "colourBy", "overlays", "marksOfSelection", "selectedBodies", "selectedNode"], soon);
    stage?.controls.addEventListener("change", soon);
    window.addEventListener("hashchange", () => fragment() !== known && follow());
}
