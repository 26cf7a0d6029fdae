// SPDX-License-Identifier: GPL-3.0-or-later
// What the page computes itself, without a browser: strains of tets, colours, and what lies inside a surface.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { colourAt, quantities, tableOf, writeColour } from "../../tools/viewer/page/src/colour_maps.js";
import { LatticeFields } from "../../tools/viewer/page/src/fields.js";
import { InsideTest } from "./inside.mjs";
import { Player } from "../../tools/viewer/page/src/player.js";
import { Store } from "../../tools/viewer/page/src/store.js";
import { timelinePanel } from "../../tools/viewer/page/src/timeline.js";
import { frameSummary, phaseTimes, timelineRows } from "../../tools/viewer/page/src/timeline_rows.js";

const rest = [0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2];
/** One tet moved by a matrix (rows) and a shift. */
function fieldsOf(matrix) {
    const moved = [];
    for (let v = 0; v < 4; ++v) for (let r = 0; r < 3; ++r) moved.push(7 + [0, 1, 2].reduce((s, c) => s + matrix[r][c] * rest[3 * v + c], 0));
    const fields = new LatticeFields({ tets: new Uint32Array([0, 1, 2, 3]), rest: new Float32Array(rest), count: 1, vertices: 4, positionsAt: () => new Float32Array(moved) });
    fields.update(0);
    return [fields.values.volume[0], fields.values.stretch[0]];
}
const near = (found, expected, text) => found.forEach((x, i) => assert.ok(Math.abs(x - expected[i]) < 1e-5, `${text}: ${found} for ${expected}`));

test("volume change and largest stretch of a known deformation", () => {
    near(fieldsOf([[1, 0, 0], [0, 1, 0], [0, 0, 1]]), [0, 0], "at rest");
    near(fieldsOf([[1.3, 0, 0], [0, 0.9, 0], [0, 0, 0.8]]), [1.3 * 0.9 * 0.8 - 1, 0.3], "stretched");
    near(fieldsOf([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), [0, 0], "turned");
    near(fieldsOf([[0, -1.5, 0], [1, 0, 0], [0, 0, 1]]), [0.5, 0.5], "turned and stretched");
    const g = 0.4; // simple shear: the largest singular value is (g + sqrt(g² + 4)) / 2
    near(fieldsOf([[1, g, 0], [0, 1, 0], [0, 0, 1]]), [0, (g + Math.sqrt(g * g + 4)) / 2 - 1], "sheared");
    near(fieldsOf([[-1, 0, 0], [0, 1, 0], [0, 0, 1]]), [-2, 0], "turned inside out");
});

test("colours run from one end of a scale to the other, and stay there", () => {
    for (const { scale } of Object.values(quantities)) {
        const table = tableOf(scale), out = [0, 0, 0, 0, 0, 0];
        writeColour(table, -5, 0, 1, out, 0);
        assert.deepEqual(out.slice(0, 3), [...table.slice(0, 3)]);
        writeColour(table, 9, 0, 1, out, 3);
        assert.deepEqual(out.slice(3), [...table.slice(-3)]);
        assert.ok(colourAt(scale, 0.5).every((c) => c >= 0 && c <= 1));
    }
    // What is shown at once must not look alike: fibres (blue), attachments (green to violet), flesh (red).
    for (const t of [0, 0.25, 0.5, 0.75, 1]) {
        const [r, , b] = colourAt(quantities.excitation.scale, t);
        assert.ok(b > r + 0.15, `excitation ${t} is blue`);
    }
});

test("a colour is that of the value's place between least and most", () => {
    const table = tableOf("amount"), out = [0, 0, 0];
    for (const [value, least, most, entry] of [[3, 3, 7, 0], [5, 3, 7, 128], [7, 3, 7, 255], [4, 3, 7, 64], [-1, -5, 3, 128], [-4, -5, -1, 64]]) {
        writeColour(table, value, least, most, out, 0);
        assert.deepEqual(out, [...table.slice(3 * entry, 3 * entry + 3)], `${value} between ${least} and ${most}`);
    }
});

test("numbers of a run become those of the legend: metres millimetres, shares per cent", () => {
    const factors = Object.fromEntries(Object.entries(quantities).map(([name, q]) => [name, `${q.factor} ${q.unit}`.trim()]));
    assert.deepEqual(factors, { volume: "100 %", stretch: "100 %", area: "100 %", difference: "1000 mm", weights: "1", excitation: "100 %", distance: "1000 mm" });
});

/** Frames 1, 2 and 5 of a run with two bodies, of which one is not there at frame 2. */
function smallRun() {
    const frame = (number, more) => ({ frame: number, reused: false, wall_s: 0.5, newton: number, residual: 1e-7, energy: 2, minJ: 0.5, substeps: 1, converged: true,
        phases: { assembly: 0.25, factor: 0.125, solve: 0.0625, other: 0 }, terms: { spring: { stretch_m: 0.004 * number }, touch: { force_N: number } }, ...more });
    const measures = [{ term: "spring", name: "stretch_m", title: "largest stretch", unit: "m" }, { term: "touch", name: "force_N", title: "force", unit: "N" }];
    const bodies = [{ volume: [1, 1.5, 0.75], isThere: (f) => f !== 1 }, { volume: [1.125, 0.875, 1], isThere: () => true }];
    return { frames: [frame(1), frame(2), frame(5, { phases: undefined })], measures, bodies };
}
const rowOf = (scene, key) => timelineRows(scene).find((r) => r.key === key);

test("rows of the time line hold the run's numbers in their units", () => {
    const run = smallRun();
    assert.deepEqual(rowOf(run, "spring.stretch_m").values, [4, 8, 20]);
    assert.equal(rowOf(run, "spring.stretch_m").unit, "mm");
    assert.deepEqual(rowOf(run, "touch.force_N").values, [1, 2, 5]);
    assert.equal(rowOf(run, "touch.force_N").unit, "N");
    // The change farthest from 0, of the bodies that are there.
    assert.deepEqual(rowOf(run, "volume").values, [12.5, -12.5, -25]);
    assert.deepEqual(rowOf(run, "minJ").values, [0.5, 0.5, 0.5]);
    assert.deepEqual(phaseTimes(run.frames[0]), [250, 125, 62.5, 0]);
    assert.deepEqual(phaseTimes(run.frames[2]), [0, 0, 0, 500]);
    assert.deepEqual(rowOf(run, "time").values, [437.5, 437.5, 500]);
    assert.equal(frameSummary(run, 2).at(-1), "500 ms");
});

test("another run is laid beside by frame numbers, not by places", () => {
    const run = smallRun();
    run.other = smallRun();
    run.other.frames = [run.other.frames[1], run.other.frames[0], { ...run.other.frames[2], frame: 9 }];
    run.other.bodies = [];
    assert.deepEqual(rowOf(run, "touch.force_N").others, [1, 2, NaN]);
    assert.deepEqual(rowOf(run, "spring.stretch_m").others, [4, 8, NaN]);
});

test("frames that are missing leave gaps on the time line", () => {
    const context = new Proxy({}, { get: (t, name) => (name === "measureText" ? (text) => ({ width: 6 * text.length }) : () => {}), set: () => true });
    const element = () => ({ style: {}, classList: { toggle() {} }, append() {}, replaceChildren() {}, addEventListener() {}, setAttribute() {},
        getContext: () => context, getBoundingClientRect: () => ({ left: 7 }), clientWidth: 900, clientHeight: 400 });
    const globals = { document: { createElement: element, documentElement: {} }, window: { devicePixelRatio: 1 }, ResizeObserver: class { observe() {} },
        getComputedStyle: () => ({ getPropertyValue: () => "#000" }) };
    Object.assign(globalThis, globals);
    try {
        const panel = timelinePanel(smallRun(), new Store({ frame: 0 }), null);
        panel.opened();
        const [first, second, third] = [0, 1, 2].map(panel.xOf);
        assert.ok(second > first);
        assert.ok(Math.abs(third - second - 3 * (second - first)) < 1e-9, `${first} ${second} ${third}`);
    } finally {
        for (const name of Object.keys(globals)) delete globalThis[name];
    }
});

test("points inside and outside a closed surface", () => {
    const points = [], corner = (x, y, z) => points.push(x, y, z);
    for (const z of [0, 1]) for (const y of [0, 1]) for (const x of [0, 1]) corner(x, y, z);
    const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    const cube = new InsideTest(points, quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]));
    for (const p of [[0.5, 0.4, 0.5], [0.05, 0.1, 0.95], [0.9, 0.85, 0.01]]) assert.equal(cube.contains(...p), true, `${p}`);
    for (const p of [[1.5, 0.4, 0.5], [0.5, -0.1, 0.5], [0.3, 0.4, 1.01], [0.3, 0.4, -0.01], [9, 9, 9]]) assert.equal(cube.contains(...p), false, `${p}`);
});

test("steps of ten wrap around runs that are shorter", () => {
    const scene = { frames: [{ frame: 1 }, { frame: 2 }, { frame: 3 }] };
    for (const [from, by, to] of [[0, -10, 2], [0, 10, 1], [2, 1, 0], [1, -1, 0], [0, -1, 2]]) {
        const store = new Store({ frame: from, loop: true, playing: false });
        new Player(store, scene).step(by);
        assert.equal(store.state.frame, to, `${from} ${by}`);
    }
    const store = new Store({ frame: 1, loop: false, playing: false });
    new Player(store, scene).step(-10);
    assert.equal(store.state.frame, 0);
});

test("pictures made without a browser have the page's colours", () => {
    const source = readFileSync(new URL("../../tools/viewer/shot_overlays.cpp", import.meta.url), "utf8");
    for (const name of ["heat", "distance"]) {
        const there = source.match(new RegExp(`> ${name}\\{([^}]*)\\}`))[1].split(",").map((x) => Number(x));
        there.forEach((hex, i) => {
            const here = colourAt(name, i / (there.length - 1)).map((c) => Math.round(255 * c));
            assert.deepEqual([hex >> 16, (hex >> 8) & 255, hex & 255], here, `${name} ${i}`);
        });
    }
});
