// SPDX-License-Identifier: GPL-3.0-or-later
// What is selected: the body's size and state at this frame, the node's type, values and connections.
import { cssGradient } from "./colour_maps.js";
import { twinOf, writeDifference } from "./difference.js";
import { count, h, iconButton, show } from "./dom.js";

const percent = (x) => (Number.isFinite(x) ? `${x >= 0 ? "+" : "−"}${Math.abs(100 * x).toFixed(2)} %` : "–");

export function inspector(scene, store, selection, world) {
    const host = h("div", { class: "inspector folded", hidden: true }); // folded: in narrow windows its head alone
    let live = []; // what changes with the frame

    function row(name, value) {
        return h("tr", {}, h("td", {}, name), h("td", {}, value));
    }
    function wide(name, nodes) {
        return nodes.length ? h("tr", {}, h("td", { colspan: "2" }, h("b", {}, name), links([...new Set(nodes)]))) : null;
    }
    function bodyPart(body) {
        const triangles = body.triangles.length / 3;
        const rows = [row("Surface", `${count(body.vertices)} vertices, ${count(triangles)} triangles`)];
        if (body.lattice) rows.push(row("Tets", `${count(body.lattice.count)}, ${count(body.lattice.vertices)} vertices`));
        if (body.isRigid) rows.push(row("Motion", "rigid"));
        if (body.volume) {
            const cell = h("span", {});
            live.push((frame) => (cell.textContent = percent(body.volume[frame] - 1)));
            rows.push(row("Volume", cell));
        }
        if (twinOf(body, scene)) {
            const cell = h("span", {}), apart = new Float32Array(body.vertices);
            live.push((frame) => {
                const is = writeDifference(body, scene, frame, apart);
                const most = apart.reduce((m, x) => Math.max(m, x), 0), mean = apart.reduce((s, x) => s + x, 0) / apart.length;
                cell.textContent = is ? `${show(1000 * mean)} mm, at most ${show(1000 * most)} mm` : "not there";
            });
            rows.push(row("Difference", cell));
        }
        const bars = body.fibres.map((f) => {
            const fill = h("i", {}), text = h("b", {});
            live.push((frame) => {
                const e = f.excitation[frame] ?? 0;
                fill.style.width = `${100 - 100 * e}%`;
                text.textContent = `${Math.round(100 * e)} %`;
            });
            return row(h("a", { href: "#", onclick: (e) => (e.preventDefault(), selection.selectNode(f.node)) }, f.node),
                h("span", { class: "bar" }, h("span", { class: "bar-track", style: `background:${cssGradient("heat")}` }, fill), text));
        });
        return h("table", {}, rows, bars);
    }
    function links(names) {
        return names.flatMap((n, i) => [i ? ", " : "", h("a", { href: "#", onclick: (e) => (e.preventDefault(), selection.selectNode(n)) }, n)]);
    }
    function nodePart(node) {
        const { before, after } = selection.neighbours(node.name);
        const values = node.rows.filter(([, text]) => text !== "" && !text.startsWith("[")).map(([name, text]) => row(name, text));
        return h("table", {}, values, wide("from", before), wide("to", after));
    }
    function attachmentPart(name) {
        const found = scene.attachments.map((a, i) => [a, i]).filter(([a]) => a.node === name);
        if (found.length === 0) return null;
        const rows = found.map(([a, i]) => {
            const cell = h("span", {});
            live.push((frame) => (cell.textContent = `${show(1000 * world.allAttachments()[i].measure(frame))} mm`));
            return [row("Mode", `${a.mode}, ${count(a.count)} vertices`),
                row("Ends", `${scene.bodies[a.source].name} → ${scene.bodies[a.target].name}`), row("Longest", cell)];
        });
        return h("table", {}, rows.flat());
    }
    function update() {
        live = [];
        const { selectedNode, selectedBodies } = store.state;
        const node = scene.graph?.nodes.find((n) => n.name === selectedNode);
        const bodies = selectedBodies.map((i) => scene.bodies[i]);
        host.hidden = !node && bodies.length === 0;
        if (host.hidden) return host.replaceChildren();
        const own = bodies.length === 1 && (!node || bodies[0].node === node.name) ? bodies[0] : null;
        const title = node?.name ?? own?.name ?? "";
        const children = [h("header", {}, h("div", {}, h("strong", {}, title), h("span", { class: "soft" }, [node?.type ?? own?.kind, own?.matter].filter((w, i, all) => w && all.indexOf(w) === i).join(", "))),
            h("span", { class: "space" }), iconButton("down", "More or less of it", () => host.classList.toggle("folded"), { class: "icon-button fold" }),
            iconButton("close", "Select nothing", () => selection.clear()))];
        if (own) children.push(bodyPart(own));
        if (node) children.push(attachmentPart(node.name), nodePart(node));
        if (!own && bodies.length && bodies.length < 8)
            children.push(h("p", { class: "soft" }, "Bodies: ", ...bodies.flatMap((b, i) => [i ? ", " : "",
                h("a", { href: "#", onclick: (e) => (e.preventDefault(), selection.selectBody(b.index)) }, b.name)])));
        host.replaceChildren(...children.filter(Boolean));
        live.forEach((call) => call(store.state.frame));
    }
    store.on(["selectedNode", "selectedBodies"], update);
    store.on(["frame"], ({ frame }) => live.forEach((call) => call(frame)));
    return host;
}
