// SPDX-License-Identifier: GPL-3.0-or-later
// The node graph: the drawing that `sinew graph --svg` makes, with pan, zoom and selection.
import { h, iconButton } from "./dom.js";

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
    let view = [0, 0, width, height];
    const apply = () => svg.setAttribute("viewBox", view.join(" "));
    /** CSS pixels per unit of the drawing. */
    const scale = () => Math.min(host.clientWidth / view[2], host.clientHeight / view[3]) || 1;

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
    /** The nodes as large as they can be read, around the first of them if they do not fit. */
    function gather(names, least = 0.62) {
        const boxes = names.map(box).filter(Boolean);
        if (boxes.length === 0) return;
        const low = [0, 1].map((c) => Math.min(...boxes.map((b) => b[c]))), high = [0, 1].map((c) => Math.max(...boxes.map((b) => b[c] + b[c + 2])));
        const pad = 40, ratio = host.clientHeight / Math.max(1, host.clientWidth);
        const wide = Math.max(high[0] - low[0] + pad, (high[1] - low[1] + pad) / ratio);
        if (wide <= host.clientWidth / least) return show((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, wide, 1);
        const [x, y, w, hgt] = boxes[0];
        show(x + w / 2, y + hgt / 2, host.clientWidth / 0.8);
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
        else {
            const s = size[0] / view[2], middle = [view[0] + view[2] / 2, view[1] + view[3] / 2];
            view = [middle[0] - host.clientWidth / s / 2, middle[1] - host.clientHeight / s / 2, host.clientWidth / s, host.clientHeight / s];
            apply();
        }
        const isFirst = !size;
        size = [host.clientWidth, host.clientHeight];
        if (isFirst) highlight();
    }).observe(host);
    function centreOn(name) {
        const at = box(name);
        if (!at || host.clientWidth === 0) return;
        const [x, y, w, hgt] = at;
        const isSeen = x > view[0] && y > view[1] && x + w < view[0] + view[2] && y + hgt < view[1] + view[3];
        if (isSeen && scale() > 0.45) return;
        const { before, after } = selection.neighbours(name);
        gather([name, ...before, ...after]);
    }

    host.addEventListener("wheel", (e) => {
        e.preventDefault();
        const r = host.getBoundingClientRect(), s = scale();
        const factor = Math.exp(Math.sign(e.deltaY) * Math.min(0.35, Math.abs(e.deltaY) / 300));
        const wide = Math.min(6 * width + 2000, Math.max(160, view[2] * factor)), f = wide / view[2];
        const x = view[0] + (e.clientX - r.left) / s, y = view[1] + (e.clientY - r.top) / s;
        view = [x - (x - view[0]) * f, y - (y - view[1]) * f, view[2] * f, view[3] * f];
        apply();
    }, { passive: false });
    let drag = null;
    host.addEventListener("pointerdown", (e) => {
        if (e.target.closest("button, input")) return;
        drag = { x: e.clientX, y: e.clientY, view: [...view], moved: false };
    });
    host.addEventListener("pointermove", (e) => {
        if (!drag || !(e.buttons & 1)) return;
        const dx = e.clientX - drag.x, dy = e.clientY - drag.y, s = scale();
        if (!drag.moved && Math.hypot(dx, dy) > 4) {
            drag.moved = true;
            host.setPointerCapture(e.pointerId);
        }
        if (drag.moved) (view = [drag.view[0] - dx / s, drag.view[1] - dy / s, view[2], view[3]]), apply();
    });
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
        if (selectedNode) centreOn(selectedNode);
    }
    store.on(["selectedNode", "selectedBodies"], highlight);

    const search = h("input", { type: "search", class: "search", "aria-label": "Find a node", oninput: () => {
        const word = search.value.trim().toLowerCase();
        for (const [name, g] of groups) g.classList.toggle("found", word !== "" && name.toLowerCase().includes(word));
    }, onkeydown: (e) => {
        const found = [...groups.keys()].find((n) => groups.get(n).classList.contains("found"));
        if (e.key === "Enter" && found) selection.selectNode(found), gather([found]);
    } });
    // Beside the tabs, not over the nodes.
    const tools = h("div", { class: "graph-tools" }, h("label", { class: "find" }, "Find", search), iconButton("focus", "Show the whole graph", fit));
    return { element: host, tools, opened() {} };
}
