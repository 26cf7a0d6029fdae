// SPDX-License-Identifier: GPL-3.0-or-later
// Attachments: a dot at attached points and a line to where it holds on, coloured by the distance between them.
import { BufferAttribute, BufferGeometry, CanvasTexture, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial } from "three";
import { rangeOf, tableOf, writeColour } from "./colour_maps.js";
import { isShown } from "./store.js";

/** Dots for fixed attachments, rings for sliding ones. */
function dot(isRing) {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 64;
    const g = canvas.getContext("2d");
    g.beginPath();
    g.arc(32, 32, isRing ? 22 : 26, 0, 2 * Math.PI);
    g.lineWidth = 12;
    g.strokeStyle = g.fillStyle = "#fff";
    if (isRing) g.stroke();
    else g.fill();
    return new CanvasTexture(canvas);
}

/** Positions of what carries points of a body: its tets, or a bone's surface. */
const hostPositions = (body, frame) => (body.lattice ? body.lattice.positionsAt(frame) : body.positionsAt(frame));

function carriedPoints({ hosts, weights }, p, out) {
    for (let i = 0; i < hosts.length / 4; ++i)
        for (let c = 0; c < 3; ++c) {
            let x = 0;
            for (let k = 0; k < 4; ++k) x += weights[4 * i + k] * p[3 * hosts[4 * i + k] + c];
            out[3 * i + c] = x;
        }
    return out;
}

/** The attached points at a frame, 3 numbers each. */
export const attachedPoints = (attachment, bodies, frame, out) =>
    carriedPoints(attachment.from, hostPositions(bodies[attachment.source], frame), out);

/** Where they hold on. Also used by tests through window.sinew. */
export function anchorPoints(attachment, bodies, frame, out) {
    const p = hostPositions(bodies[attachment.target], frame);
    const { offsets, to } = attachment;
    carriedPoints(to, p, out);
    for (let i = 0; i < attachment.count; ++i) {
        const o = [offsets[3 * i], offsets[3 * i + 1], offsets[3 * i + 2]];
        if (o[0] === 0 && o[1] === 0 && o[2] === 0) continue;
        // The triangle's own frame: first edge, across, normal (solver/attach/anchors.cpp).
        const v = [0, 1, 2].map((k) => 3 * to.hosts[4 * i + k]);
        const u = [0, 1, 2].map((c) => p[v[1] + c] - p[v[0] + c]), w = [0, 1, 2].map((c) => p[v[2] + c] - p[v[0] + c]);
        const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));
        const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        const along = unit(u), normal = unit(cross(u, w)), across = cross(normal, along);
        for (let c = 0; c < 3; ++c) out[3 * i + c] += o[0] * along[c] + o[1] * across[c] + o[2] * normal[c];
    }
    return out;
}

export class AttachmentView {
    constructor(attachment, scene) {
        this.attachment = attachment;
        this.scene = scene;
        this.group = new Group();
        const n = attachment.count;
        this.starts = new Float32Array(3 * n);
        this.ends = new Float32Array(3 * n);
        const attribute = (size) => new BufferAttribute(new Float32Array(size), 3);
        const lines = new BufferGeometry().setAttribute("position", attribute(6 * n)).setAttribute("color", attribute(6 * n));
        const dots = new BufferGeometry().setAttribute("position", attribute(3 * n)).setAttribute("color", attribute(3 * n));
        this.lines = new LineSegments(lines, new LineBasicMaterial({ vertexColors: true, transparent: true }));
        this.dots = new Points(dots, new PointsMaterial({
            vertexColors: true, size: 4, sizeAttenuation: false, map: dot(attachment.mode === "sliding"), alphaTest: 0.4,
            transparent: true,
        }));
        for (const object of [this.lines, this.dots]) {
            object.frustumCulled = false;
            object.renderOrder = 5;
            this.group.add(object);
        }
    }

    /** Longest distance, in metres. */
    measure(frame) {
        const { attachment, scene } = this;
        const from = attachedPoints(attachment, scene.bodies, frame, this.starts), to = anchorPoints(attachment, scene.bodies, frame, this.ends);
        let most = 0;
        for (let i = 0; i < 3 * attachment.count; i += 3)
            most = Math.max(most, Math.hypot(from[i] - to[i], from[i + 1] - to[i + 1], from[i + 2] - to[i + 2]));
        return most / scene.unitsPerMetre;
    }

    update(state) {
        const { attachment, scene } = this;
        const { source, target, count } = attachment;
        const there = scene.bodies[source].isThere(state.frame) && scene.bodies[target].isThere(state.frame);
        this.group.visible = there && (isShown(state, source) || isShown(state, target));
        if (!this.group.visible) return;
        attachedPoints(attachment, scene.bodies, state.frame, this.starts);
        anchorPoints(attachment, scene.bodies, state.frame, this.ends);
        const table = tableOf("distance"), [least, most] = rangeOf(state, "distance");
        const line = this.lines.geometry.attributes, dots = this.dots.geometry.attributes;
        for (let i = 0; i < count; ++i) {
            let squared = 0;
            for (let c = 0; c < 3; ++c) {
                const from = this.starts[3 * i + c], to = this.ends[3 * i + c];
                line.position.array[6 * i + c] = dots.position.array[3 * i + c] = from;
                line.position.array[6 * i + 3 + c] = to;
                squared += (from - to) ** 2;
            }
            const millimetres = (1000 * Math.sqrt(squared)) / scene.unitsPerMetre;
            writeColour(table, millimetres, least, most, dots.color.array, 3 * i);
            writeColour(table, millimetres, least, most, line.color.array, 6 * i);
            writeColour(table, millimetres, least, most, line.color.array, 6 * i + 3);
        }
        for (const a of [line.position, line.color, dots.position, dots.color]) a.needsUpdate = true;
        const selected = state.selectedNode && state.selectedNode === attachment.node;
        this.dots.material.size = (selected ? 8 : 4) * Math.min(2, window.devicePixelRatio || 1);
    }
}
