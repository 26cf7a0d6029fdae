// SPDX-License-Identifier: GPL-3.0-or-later
// The run: bodies, tets, fibres and attachments with their positions at every frame. Frames are indices here; the
// number of a frame is frames[i].frame.
import { BlockStore } from "./blocks.js";

/** Positions on 16-bit grids, frame after frame. A frame that flies apart has a grid of its own. */
class GridMotion {
    constructor(numbers, chunks) {
        this.numbers = numbers;
        this.chunks = chunks;
    }
    static async load(about, numbers, blocks) {
        const chunks = await Promise.all(
            about.chunks.map(async (c) => ({ ...c, values: await blocks.get(c.block) })),
        );
        return new GridMotion(numbers, chunks);
    }
    write(frame, out) {
        const chunk = this.chunks.find((c) => frame >= c.first && frame < c.first + c.count);
        const n = this.numbers;
        if (!chunk || n === 0) return;
        const values = chunk.values;
        const [ox, oy, oz] = chunk.origin;
        const [sx, sy, sz] = chunk.step;
        for (let i = 0, k = (frame - chunk.first) * n; i < n; i += 3, k += 3) {
            out[i] = ox + sx * values[k];
            out[i + 1] = oy + sy * values[k + 1];
            out[i + 2] = oz + sz * values[k + 2];
        }
    }
}

/** Bytes, `group` of them together, as weights whose sum is 1. */
function sharesOf(bytes, group) {
    const out = new Float32Array(bytes.length);
    for (let i = 0; i < bytes.length; i += group) {
        let sum = 0;
        for (let k = 0; k < group; ++k) sum += bytes[i + k];
        for (let k = 0; k < group; ++k) out[i + k] = bytes[i + k] / (sum || 1);
    }
    return out;
}

class LatticeData {
    constructor(about) {
        this.count = about.count;
        this.vertices = about.vertices;
        this.at = -1;
        this.positions = new Float32Array(3 * about.vertices);
    }
    static async load(about, blocks) {
        const out = new LatticeData(about);
        out.tets = await blocks.get(about.tets);
        out.rest = await blocks.get(about.rest);
        [out.skin, out.skinWeights] = [await blocks.get(about.skin.places), sharesOf(await blocks.get(about.skin.weights), 3)];
        out.motion = await GridMotion.load(about, 3 * about.vertices, blocks);
        return out;
    }
    /** Where the vertices are drawn: those beside the flesh on its skin, which `surface` are the positions of. */
    drawnAt(frame, surface) {
        const { skin, skinWeights } = this, out = (this.drawn ??= new Float32Array(this.positions.length));
        out.set(this.positionsAt(frame));
        for (let i = 0; i < skin.length / 4; ++i)
            for (let c = 0; c < 3; ++c) {
                let x = 0;
                for (let k = 0; k < 3; ++k) x += skinWeights[3 * i + k] * surface[3 * skin[4 * i + 1 + k] + c];
                out[3 * skin[4 * i] + c] = x;
            }
        return out;
    }
    positionsAt(frame) {
        if (this.at !== frame) this.motion.write(frame, this.positions);
        this.at = frame;
        return this.positions;
    }
}

export class BodyData {
    constructor(about, index) {
        Object.assign(this, { index, name: about.name, node: about.node, kind: about.kind, matter: about.matter, colour: about.colour });
        this.stripes = about.stripes;
        this.gloss = about.gloss;
        this.vertices = about.vertices;
        this.motionKind = about.motion.kind;
        this.at = -1;
    }
    static async load(about, index, blocks) {
        const b = new BodyData(about, index);
        [b.rest, b.triangles, b.edges, b.shading, b.present, b.volume] = await Promise.all(
            ["rest", "triangles", "edges", "shading", "present", "volume"].map((k) => blocks.get(about[k])),
        );
        b.lattice = about.lattice ? await LatticeData.load(about.lattice, blocks) : null;
        const m = about.motion;
        if (m.kind === "rigid") {
            b.pivot = m.pivot;
            b.poses = await blocks.get(m.poses);
        } else if (m.kind === "embedded") {
            b.hostTet = await blocks.get(m.tet);
            b.hostWeights = await blocks.get(m.weights);
        } else {
            b.motion = await GridMotion.load(m, 3 * about.vertices, blocks);
        }
        b.fibres = await Promise.all(
            about.fibres.map(async (f) => ({
                node: f.node,
                count: f.count,
                tets: await blocks.get(f.tets),
                directions: await blocks.get(f.directions),
                centre: sharesOf(await blocks.get(f.centre), 4),
                reach: Float32Array.from(await blocks.get(f.reach), (r) => (f.longest * r) / 255),
                excitation: await blocks.get(f.excitation),
            })),
        );
        b.maps = await Promise.all(
            about.maps.map(async (w) => ({ node: w.node, name: w.name, values: await blocks.get(w.values) })),
        );
        b.positions = new Float32Array(3 * b.vertices);
        return b;
    }

    get isRigid() {
        return this.motionKind === "rigid";
    }
    isThere(frame) {
        return !this.present || this.present[frame] !== 0;
    }
    /** Quaternion x y z w and translation of a rigid body: p = t + q (rest - pivot). */
    pose(frame) {
        return this.poses.subarray(7 * frame, 7 * frame + 7);
    }
    /** From now on `positions` at `frame`; null: its own again. */
    showInstead(frame, positions) {
        this.instead = positions && { frame, positions };
    }
    /** Positions of all vertices; the array is reused by the next call. */
    positionsAt(frame) {
        if (this.instead?.frame === frame) return this.instead.positions;
        if (this.at === frame) return this.positions;
        this.at = frame;
        if (this.isRigid) this.writeRigid(frame);
        else if (this.motionKind === "embedded") this.writeEmbedded(frame);
        else this.motion.write(frame, this.positions);
        return this.positions;
    }
    writeRigid(frame) {
        const [x, y, z, w, tx, ty, tz] = this.pose(frame);
        const [px, py, pz] = this.pivot;
        const { rest, positions: out } = this;
        for (let i = 0; i < rest.length; i += 3) {
            const a = rest[i] - px, b = rest[i + 1] - py, c = rest[i + 2] - pz;
            const u = 2 * (y * c - z * b), v = 2 * (z * a - x * c), q = 2 * (x * b - y * a);
            out[i] = a + w * u + y * q - z * v + tx;
            out[i + 1] = b + w * v + z * u - x * q + ty;
            out[i + 2] = c + w * q + x * v - y * u + tz;
        }
    }
    writeEmbedded(frame) {
        const p = this.lattice.positionsAt(frame), tets = this.lattice.tets;
        const { hostTet, hostWeights, positions: out } = this;
        for (let i = 0; i < hostTet.length; ++i) {
            let x = 0, y = 0, z = 0;
            for (let k = 0; k < 4; ++k) {
                const w = hostWeights[4 * i + k], v = 3 * tets[4 * hostTet[i] + k];
                x += w * p[v];
                y += w * p[v + 1];
                z += w * p[v + 2];
            }
            out[3 * i] = x;
            out[3 * i + 1] = y;
            out[3 * i + 2] = z;
        }
    }
}

async function loadRun(header, blocks, onBody) {
    const scene = {
        title: header.title,
        source: header.source,
        fps: header.fps,
        unitsPerMetre: header.unitsPerMetre,
        up: header.up,
        bounds: header.bounds,
        frames: header.frames,
        measures: header.measures,
        notes: header.notes,
        graph: header.graph,
        bodies: [],
        attachments: [],
        other: null, // a run to compare with
    };
    for (const about of header.bodies) {
        scene.bodies.push(await BodyData.load(about, scene.bodies.length, blocks));
        onBody();
    }
    for (const a of header.attachments) {
        const [from, to] = await Promise.all([a.from, a.to].map(async ({ hosts, weights }) =>
            ({ hosts: await blocks.get(hosts), weights: await blocks.get(weights) })));
        scene.attachments.push({ ...a, from, to, offsets: await blocks.get(a.offsets) });
    }
    for (const frame of scene.frames) for (const group of frame.marks ?? []) {
        group.numbers = await blocks.get(group.numbers);
        if (group.bodies !== undefined) group.bodies = await blocks.get(group.bodies);
    }
    if (scene.graph) scene.graph.svg = new TextDecoder().decode(await blocks.get(scene.graph.svg));
    return scene;
}

/** Reads all out of the document. `onProgress(share)` is told how far it is. */
export async function loadScene(onProgress = () => {}) {
    const header = JSON.parse(document.getElementById("sinew-scene").textContent);
    const blocks = new BlockStore(header.blocks), all = header.bodies.length + (header.other?.bodies.length ?? 0);
    let loaded = 0;
    const onBody = () => onProgress(++loaded / all);
    const scene = await loadRun(header, blocks, onBody);
    scene.generator = header.generator;
    if (header.other) {
        scene.other = await loadRun(header.other, blocks, onBody);
        scene.other.other = scene; // each is the other's other: colours of the difference are on both sides
    }
    return scene;
}
