// SPDX-License-Identifier: GPL-3.0-or-later
// The node graph: the drawing that `sinew graph --svg` makes, with pan, zoom and selection. A selected node is shown with
// its neighbours alone, or in the whole graph.
import { h, iconButton } from "./dom.js";
import { nearGraph } from "./near_graph.js";

export function graphPanel(scene, store, selection) {
    const host = h("div", { class: "graph-host", tabIndex: 0 });
    if (!scene.graph) {
        host.append(h("p", { class: "empty" }, "No graph is known for this run. `sinew view GRAPH` shows one."));
        return { element: host, opened() {} };
    }
    host.innerHTML = scene.graph.svg;
    const svg = host.querySelector("svg");
    svg.removeAttribute("width");
    svg.removeAttribute("height");
    const { width, height } = scene.graph;
    let view = [0, 0, width, height], near = null; // `near`: the neighbours' drawing, where that is what is seen
    const apply = () => (near?.svg ?? svg).setAttribute("viewBox", view.join(" "));
    /** CSS pixels per unit of the drawing. */
    const scale = () => Math.min(host.clientWidth / view[2], host.clientHeight / view[3]) || 1;
    let wholeView = null, isSearching = false;

    /** Changes between the whole graph and the neighbours of what is selected. */
    function choose() {
        const { selectedNode, graphNear } = store.state;
        const wanted = graphNear && !isSearching && selectedNode !== null && box(selectedNode) && host.clientWidth > 0;
        if (!near) wholeView = view;
        near = wanted ? nearGraph(svg, box, selectedNode, selection.neighbours(selectedNode), [host.clientWidth, host.clientHeight]) : null;
        host.replaceChildren(near?.svg ?? svg);
        if (near) show(near.width / 2, near.height / 2, Math.max(near.width, (near.height * host.clientWidth) / Math.max(1, host.clientHeight)), 1);
        else (view = wholeView), apply();
    }

    function show(x, y, w, most = 1.1) {
        const ratio = host.clientHeight / Math.max(1, host.clientWidth);
        const wide = Math.max(w, host.clientWidth / most);
        view = [x - wide / 2, y - (wide * ratio) / 2, wide, wide * ratio];
        apply();
    }
    function fit() {
        const ratio = host.clientHeight / Math.max(1, host.clientWidth);
        show(width / 2, height / 2, Math.max(width, height / ratio), 1.5);
    }
    const box = (name) => scene.graph.nodes.find((n) => n.name === name)?.box;
    /** Fits some nodes; where they would be too small to be recognised, as many of them as fit around the first. */
    function gather(names, least = 0.4) {
        const boxes = names.map(box).filter(Boolean);
        if (boxes.length === 0) return;
        const low = [0, 1].map((c) => Math.min(...boxes.map((b) => b[c]))), high = [0, 1].map((c) => Math.max(...boxes.map((b) => b[c] + b[c + 2])));
        const pad = 40, ratio = host.clientHeight / Math.max(1, host.clientWidth);
        const wide = Math.max(high[0] - low[0] + pad, (high[1] - low[1] + pad) / ratio);
        if (wide <= host.clientWidth / least) return show((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, wide, 1);
        const room = [host.clientWidth / least, host.clientHeight / least];
        const middle = [0, 1].map((c) => {
            const [from, size] = [boxes[0][c], boxes[0][c + 2]], free = Math.max(0, (room[c] - size - pad) / 2);
            return Math.min(from + size / 2 + free, Math.max(from + size / 2 - free, (low[c] + high[c]) / 2));
        });
        show(...middle, room[0]);
    }
    /** At first: all of a small graph; of a large one the end where everything comes together, large enough to read. */
    function begin() {
        if (scale0() >= 0.6) return fit();
        const end = scene.graph.nodes.find((n) => n.type === "zSolver") ?? scene.graph.nodes[scene.graph.nodes.length - 1];
        const [x, y, w] = end.box, s = 0.8, wide = host.clientWidth / s;
        show(x + w + 30 - wide / 2, y + Math.min(end.box[3], host.clientHeight / s) / 2, wide);
    }
    const scale0 = () => Math.min(host.clientWidth / width, host.clientHeight / height);
    /** A panel that grows shows more at the same scale, around the same middle. */
    let size = null;
    new ResizeObserver(() => {
        if (host.clientWidth === 0 || host.clientHeight === 0) return;
        if (!size) begin();
        else if (near) {
            wholeView = [wholeView[0], wholeView[1], (wholeView[2] * host.clientWidth) / size[0], (wholeView[3] * host.clientHeight) / size[1]];
            choose();
        } else {
            const s = size[0] / view[2], middle = [view[0] + view[2] / 2, view[1] + view[3] / 2];
            view = [middle[0] - host.clientWidth / s / 2, middle[1] - host.clientHeight / s / 2, host.clientWidth / s, host.clientHeight / s];
            apply();
        }
        const isFirst = !size;
        size = [host.clientWidth, host.clientHeight];
        if (isFirst) highlight();
    }).observe(host);
    function centreOn(name) {
        if (!box(name) || host.clientWidth === 0 || near) return;
        const { before, after } = selection.neighbours(name), names = [name, ...before, ...after];
        const isSeen = names.map(box).every(([x, y, w, hgt]) => x > view[0] && y > view[1] && x + w < view[0] + view[2] && y + hgt < view[1] + view[3]);
        if (!isSeen || scale() < 0.4) gather(names);
    }
    /** Zooms so that the point of the drawing under a point of the page stays there. */
    function zoom(clientX, clientY, factor) {
        const r = host.getBoundingClientRect(), s = scale();
        const wide = Math.min(6 * width + 2000, Math.max(160, view[2] * factor)), f = wide / view[2];
        const x = view[0] + (clientX - r.left) / s, y = view[1] + (clientY - r.top) / s;
        view = [x - (x - view[0]) * f, y - (y - view[1]) * f, view[2] * f, view[3] * f];
        apply();
    }

    host.addEventListener("wheel", (e) => {
        e.preventDefault();
        zoom(e.clientX, e.clientY, Math.exp(Math.sign(e.deltaY) * Math.min(0.35, Math.abs(e.deltaY) / 300)));
    }, { passive: false });
    const fingers = new Map(); // all pointers that are down: two of them zoom
    let drag = null;
    host.addEventListener("pointerdown", (e) => {
        if (e.target.closest("button, input")) return;
        fingers.set(e.pointerId, [e.clientX, e.clientY]);
        drag = fingers.size === 1 ? { x: e.clientX, y: e.clientY, view: [...view], moved: false } : null;
    });
    host.addEventListener("pointermove", (e) => {
        if (fingers.size === 2 && fingers.has(e.pointerId)) {
            const apart = () => Math.max(1, Math.hypot(...[0, 1].map((c) => [...fingers.values()][0][c] - [...fingers.values()][1][c])));
            const before = apart();
            fingers.set(e.pointerId, [e.clientX, e.clientY]);
            const [p, q] = [...fingers.values()];
            return zoom((p[0] + q[0]) / 2, (p[1] + q[1]) / 2, before / apart());
        }
        if (!drag || !(e.buttons & 1)) return;
        const dx = e.clientX - drag.x, dy = e.clientY - drag.y, s = scale();
        if (!drag.moved && Math.hypot(dx, dy) > 4) {
            drag.moved = true;
            host.setPointerCapture(e.pointerId);
        }
        if (drag.moved) (view = [drag.view[0] - dx / s, drag.view[1] - dy / s, view[2], view[3]]), apply();
    });
    for (const name of ["pointerup", "pointercancel"]) window.addEventListener(name, (e) => fingers.delete(e.pointerId));
    host.addEventListener("pointerup", (e) => {
        if (drag && !drag.moved) {
            const node = e.target.closest?.("g.node");
            if (node) selection.selectNode(node.dataset.node);
            else if (e.target.closest("svg")) selection.clear();
        }
        drag = null;
    });

    const groups = new Map([...svg.querySelectorAll("g.node")].map((g) => [g.dataset.node, g]));
    const wires = [...svg.querySelectorAll("path.wire")];
    // Wires of the selection are drawn over the boxes that they pass.
    const above = document.createElementNS("http://www.w3.org/2000/svg", "g");
    above.setAttribute("class", "above");
    svg.append(above);
    for (const [name, g] of groups) {
        g.setAttribute("tabindex", "-1");
        const title = document.createElementNS("http://www.w3.org/2000/svg", "title");
        title.textContent = name;
        g.prepend(title);
    }
    function highlight() {
        const { selectedNode, selectedBodies } = store.state;
        const bodyNodes = new Set(selectedBodies.map((i) => scene.bodies[i].node)), near = new Set([selectedNode, ...bodyNodes]);
        above.replaceChildren();
        for (const wire of wires) {
            const { from, to } = wire.dataset;
            if (selectedNode === null || (from !== selectedNode && to !== selectedNode)) continue;
            near.add(from), near.add(to);
            const copy = wire.cloneNode();
            copy.classList.add("selected");
            above.append(copy);
        }
        for (const [name, g] of groups) {
            g.classList.toggle("selected", name === selectedNode);
            g.classList.toggle("related", name !== selectedNode && bodyNodes.has(name));
            g.classList.toggle("aside", selectedNode !== null && !near.has(name));
        }
        svg.classList.toggle("has-selection", selectedNode !== null);
        choose();
        if (selectedNode) centreOn(selectedNode);
    }
    store.on(["selectedNode", "selectedBodies", "graphNear"], highlight);

    const searching = (on) => on !== isSearching && ((isSearching = on), choose()); // finds in the whole graph
    const search = h("input", { type: "search", class: "search", "aria-label": "Find a node", oninput: () => {
        const word = search.value.trim().toLowerCase();
        for (const [name, g] of groups) g.classList.toggle("found", word !== "" && name.toLowerCase().includes(word));
        searching(word !== "");
    }, onkeydown: (e) => {
        const found = [...groups.keys()].find((n) => groups.get(n).classList.contains("found"));
        if (e.key === "Enter" && found) searching(false), selection.selectNode(found), near || gather([found]);
        if (e.key === "Enter" || e.key === "Escape") searching(false);
    } });
    // Beside the tabs, not over the nodes.
    const alone = h("button", { type: "button", class: "near-button", "aria-pressed": "true", title: "Show a selected node with its neighbours alone, or in the whole graph",
        onclick: () => store.set({ graphNear: !store.state.graphNear }) }, "Neighbours");
    store.on(["graphNear"], ({ graphNear }) => alone.setAttribute("aria-pressed", graphNear));
    const whole = iconButton("focus", "Show the whole graph", () => (store.set({ graphNear: false }), fit()));
    const tools = h("div", { class: "graph-tools" }, h("label", { class: "find" }, h("span", {}, "Find"), search), alone, whole);
    return { element: host, tools, opened() {} };
}
