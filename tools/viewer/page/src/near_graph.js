// SPDX-License-Identifier: GPL-3.0-or-later
// One node with what it reads from on its left and what reads from it on its right, drawn from the boxes and wires of the
// whole graph. Neighbours are their heads alone, in as many columns as make everything largest in the room there is.

const head = 40, gapX = 50, gapY = 9, margin = 16;
const readable = 0.55; // below that the node itself is its head alone too

/** As wide as a head's words are, roughly; no wider than the box that it is taken from. */
const headBox = ([x, y, wide], name) => [x, y, Math.min(wide, 24 + 8 * name.length), head];
const svgElement = (tag, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
};

/** Places for `boxes` ([x, y, w, h]) in `columns` columns: {width, height, at: [[x, y] …]}, from 0. `fromRight` fills the
    column nearest to the right first. */
function block(boxes, columns, fromRight) {
    if (boxes.length === 0) return { width: 0, height: 0, at: [] };
    const rows = Math.ceil(boxes.length / columns), wide = Math.max(...boxes.map((b) => b[2]));
    const at = boxes.map(([, , w], i) => {
        const c = Math.floor(i / rows), x = (fromRight ? columns - 1 - c : c) * (wide + gapX);
        return [fromRight ? x + wide - w : x, (i % rows) * (head + gapY)]; // at the edge that wires go to
    });
    return { width: columns * (wide + gapX) - gapX, height: rows * (head + gapY) - gapY, at };
}

/** Leaves name and type of a box. */
function cutToHead(g, wide) {
    for (const part of [...g.querySelectorAll(".port, .attr, .val, .out")]) part.remove();
    g.querySelector(".box").setAttribute("width", wide);
    g.querySelector(".box").setAttribute("height", head);
    g.querySelector(".band").setAttribute("d", `M0 7a7 7 0 0 1 7-7h${wide - 14}a7 7 0 0 1 7 7z`);
}

/** Numbers of columns on both sides that make the drawing largest in `room` ([width, height] in CSS pixels). */
function bestColumns(own, before, after, room) {
    let best = null;
    for (let a = 1; a <= Math.max(1, Math.min(8, before.length)); ++a)
        for (let b = 1; b <= Math.max(1, Math.min(8, after.length)); ++b) {
            const left = block(before, a, true), right = block(after, b, false);
            const width = own[2] + left.width + right.width + 2 * margin + (before.length ? gapX : 0) + (after.length ? gapX : 0);
            const height = Math.max(own[3], left.height, right.height) + 2 * margin;
            const scale = Math.min(room[0] / width, room[1] / height, 1);
            if (!best || scale > best.scale + 1e-6) best = { scale, left, right, width, height };
        }
    return best;
}

/** An <svg> with its size. `whole` is the drawing of the whole graph, `names` are {before, after} of node `name`. */
export function nearGraph(whole, boxOf, name, { before, after }, room) {
    const groups = new Map([...whole.querySelectorAll("g.node")].map((g) => [g.dataset.node, g]));
    const points = (wire) => wire.getAttribute("d").match(/-?[\d.]+(e-?\d+)?/g).map(Number);
    const row = new Map(); // where a neighbour's wire enters: in this order few wires cross
    for (const wire of whole.querySelectorAll(".wires path.wire"))
        if (wire.dataset.to === name && !row.has(wire.dataset.from)) row.set(wire.dataset.from, points(wire)[7]);
    const lists = [before, after].map((names) => [...new Set(names)].filter((n) => n !== name && boxOf(n)));
    lists[0].sort((a, b) => row.get(a) - row.get(b));
    const whole0 = boxOf(name)[1], [left, right] = lists.map((names) => names.map((n) => headBox(boxOf(n), n)));
    let own = boxOf(name), plan = bestColumns(own, left, right, room);
    if (plan.scale < readable) (own = headBox(own, name)), (plan = bestColumns(own, left, right, room));
    const isHead = own[3] === head;
    const svg = svgElement("svg", { class: "sinew-graph near has-selection" }), wires = svgElement("g", { class: "wires" }), nodes = svgElement("g", { class: "nodes" });
    svg.append(...[...whole.querySelectorAll("style")].map((s) => s.cloneNode(true)), wires, nodes);
    const place = new Map(), middle = (h) => (plan.height - h) / 2;
    const ownX = margin + plan.left.width + (left.length ? gapX : 0);
    place.set(name, [ownX, middle(own[3]), own[2]]);
    lists[0].forEach((n, i) => place.set(`<${n}`, [margin + plan.left.at[i][0], middle(plan.left.height) + plan.left.at[i][1], left[i][2]]));
    lists[1].forEach((n, i) => place.set(`>${n}`, [ownX + own[2] + gapX + plan.right.at[i][0], middle(plan.right.height) + plan.right.at[i][1], right[i][2]]));
    for (const [key, [x, y, wide]] of place) {
        const isOwn = key === name, g = groups.get(isOwn ? name : key.slice(1)).cloneNode(true);
        g.classList.remove("aside", "selected", "related", "found");
        g.classList.toggle("selected", isOwn);
        g.setAttribute("transform", `translate(${x} ${y})`);
        if (!isOwn || isHead) cutToHead(g, wide);
        nodes.append(g);
    }
    // A wire keeps its row at the node itself and ends at the middle of a head.
    for (const wire of whole.querySelectorAll(".wires path.wire")) {
        const { from, to } = wire.dataset, ends = points(wire);
        if ((from !== name && to !== name) || from === to) continue;
        const source = from === name ? place.get(name) : place.get(`<${from}`), target = to === name ? place.get(name) : place.get(`>${to}`);
        if (!source || !target) continue;
        const x0 = source[0] + source[2], y0 = source[1] + (from === name && !isHead ? ends[1] - whole0 : head / 2);
        const x1 = target[0], y1 = target[1] + (to === name && !isHead ? ends[7] - whole0 : head / 2), bend = Math.max(24, Math.min(120, 0.5 * (x1 - x0)));
        const isNext = x1 - x0 < 1.5 * gapX; // one that passes other boxes steps back
        wires.append(svgElement("path", { class: isNext ? "wire selected" : "wire selected passing", d: `M${x0} ${y0}C${x0 + bend} ${y0} ${x1 - bend} ${y1} ${x1} ${y1}` }));
    }
    return { svg, width: plan.width, height: plan.height };
}
