// SPDX-License-Identifier: GPL-3.0-or-later
// The arm, 128 frames: its page in a browser against the files that the same run wrote.
import assert from "node:assert/strict";
import { mkdtemp, readFile, rm, stat } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, openPage, pixels, sinew } from "./browser.mjs";

const graph = "graphs/scenes/arm.json";
let folder, file, page, size;

function positionsOf(obj) {
    return obj.split("\n").filter((l) => l.startsWith("v ")).map((l) => l.slice(2).trim().split(/\s+/).map(Number));
}
const objOf = async (body, frame) =>
    positionsOf(await readFile(path.join(folder, "run/obj", `${body}.${String(frame).padStart(4, "0")}.obj`), "utf8"));
const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));

before(async () => {
    folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"));
    file = path.join(folder, "arm.html");
    const run = await sinew("run", graph, "--out", path.join(folder, "run"), "--format", "obj", "--report", path.join(folder, "run/report.json"), "--quiet");
    assert.equal(run.code, 0, run.err);
    const view = await sinew("view", graph, "-o", file, "--quiet");
    assert.equal(view.code, 0, view.err);
    console.log(view.out.trim());
    page = await openPage(file);
    size = await page.evaluate(() => {
        const [low, high] = sinew.scene.bounds;
        return Math.hypot(...high.map((x, i) => x - low[i]));
    });
});
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

test("it opens from disk in less than 3 s, without an error and without a request", async () => {
    const ms = await page.evaluate(() => sinew.loadMs);
    console.log(`loaded in ${Math.round(ms)} ms, ${((await stat(file)).size / 1e6).toFixed(1)} MB`);
    assert.ok(ms < 3000, `${ms} ms`);
    assert.deepEqual(page.problems, []);
    assert.deepEqual(page.requests.filter((u) => u !== "file://" + file && !u.startsWith("data:") && !u.startsWith("blob:")), []);
    assert.ok((await stat(file)).size < 8e6);
});

test("the canvas shows something, and another frame looks different", async () => {
    await page.evaluate(() => sinew.setFrame(1));
    const first = await pixels(page), picture = await page.evaluate(() => sinew.picture());
    assert.ok(first.share > 0.02 && first.share < 0.9, `${first.share}`);
    assert.ok(first.colours > 500, `${first.colours}`);
    await page.evaluate(() => sinew.setFrame(64));
    assert.notEqual(await page.evaluate(() => sinew.picture()), picture);
});

test("scrubbing moves vertices to where the run's own files have them", async () => {
    let worst = 0;
    for (const frame of [1, 40, 64, 128])
        for (const [body, vertices] of [["biceps", [0, 500, 1180]], ["tricepsLateral", [3, 400, 800]], ["radius", [0, 300, 833]], ["hand", [11, 5600, 2500]]]) {
            const expected = await objOf(body, frame);
            const found = await page.evaluate(([f, b, list]) => {
                sinew.setFrame(f);
                return list.map((v) => [sinew.vertexPosition(b, v), sinew.drawnPosition(b, v)]);
            }, [frame, body, vertices]);
            found.forEach(([data, drawn], i) => {
                worst = Math.max(worst, distance(data, expected[vertices[i]]) / size);
                assert.ok(distance(data, expected[vertices[i]]) < 1e-4 * size, `${body} ${vertices[i]} at ${frame}`);
                assert.ok(distance(drawn, expected[vertices[i]]) < 1e-4 * size, `${body} ${vertices[i]} as drawn at ${frame}`);
            });
        }
    console.log(`farthest vertex off by ${worst.toExponential(1)} of the scene's size`);
    assert.ok(worst < 1e-5, `${worst}`);
});

test("volume ratios and attachments agree with what the solver reports", async () => {
    const report = JSON.parse(await readFile(path.join(folder, "run/report.json"), "utf8"));
    for (const frame of [2, 30, 90]) {
        const told = report.frames.find((f) => f.frame === frame);
        const [least, stretch] = await page.evaluate((f) => {
            sinew.setFrame(f);
            return [sinew.leastVolumeRatio(), Math.max(...sinew.scene.attachments.map((_, i) => sinew.stretch(i)))];
        }, frame);
        assert.ok(Math.abs(least - told.min_J) < 0.01, `frame ${frame}: ${least} for ${told.min_J}`);
        assert.ok(Math.abs(stretch - told.max_stretch_m) < 0.02 * told.max_stretch_m + 1e-5, `frame ${frame}: ${stretch} for ${told.max_stretch_m}`);
    }
});

test("the keyboard plays, steps and toggles", async () => {
    const state = () => page.evaluate(() => sinew.state);
    await page.evaluate(() => sinew.setFrame(10));
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.evaluate(() => sinew.frame), 11);
    await page.keyboard.press("Shift+ArrowLeft");
    assert.equal(await page.evaluate(() => sinew.frame), 1);
    await page.keyboard.press("ArrowLeft"); // round the corner, because it repeats
    assert.equal(await page.evaluate(() => sinew.frame), 128);
    await page.keyboard.press("Home");
    assert.equal(await page.evaluate(() => sinew.frame), 1);
    await page.keyboard.press("End");
    assert.equal(await page.evaluate(() => sinew.frame), 128);
    await page.keyboard.press("Home");
    await page.keyboard.press("Space");
    assert.equal((await state()).playing, true);
    await page.waitForFunction(() => sinew.frame > 3);
    await page.keyboard.press("Space");
    const stopped = (await state()).frame;
    await page.waitForTimeout(200);
    assert.equal((await state()).frame, stopped);
    for (const [key, get] of [["t", (s) => s.theme], ["w", (s) => s.surface], ["s", (s) => s.smooth], ["l", (s) => s.overlays.lattice],
        ["b", (s) => s.overlays.fibres], ["a", (s) => s.overlays.attachments], ["g", (s) => s.overlays.grid], ["c", (s) => s.cut.on],
        ["v", (s) => s.colourBy], ["n", (s) => s.panel], ["p", (s) => s.panelOpen], ["r", (s) => s.loop]]) {
        const was = get(await state());
        await page.keyboard.press(key);
        assert.notEqual(get(await state()), was, key);
        await page.keyboard.press(key);
        if (key === "w") await page.keyboard.press(key);
        assert.equal(get(await state()), was, key);
    }
    await page.keyboard.press("?");
    assert.ok(await page.isVisible(".sheet"));
    await page.keyboard.press("Escape");
    assert.ok(!(await page.isVisible(".sheet")));
});

test("every overlay and every colouring changes the picture, and off brings it back", async () => {
    await page.evaluate(() => (sinew.setFrame(60), sinew.look("corner")));
    const plain = await page.evaluate(() => sinew.picture());
    for (const overlay of ["lattice", "fibres", "attachments"]) {
        await page.evaluate((name) => sinew.toggle(name, true), overlay);
        assert.notEqual(await page.evaluate(() => sinew.picture()), plain, overlay);
        await page.evaluate((name) => sinew.toggle(name, false), overlay);
        assert.equal(await page.evaluate(() => sinew.picture()), plain, overlay);
    }
    for (const colourBy of ["volume", "strain", "area", "weights"]) {
        await page.evaluate((value) => sinew.set({ colourBy: value }), colourBy);
        assert.notEqual(await page.evaluate(() => sinew.picture()), plain, colourBy);
        const card = page.locator(".legend-card");
        assert.equal(await card.count(), 1, colourBy);
        await card.locator("button").click(); // fit
    }
    await page.evaluate(() => sinew.set({ colourBy: "material", cut: { on: true, axis: 0, at: 0.5, flip: false } }));
    assert.notEqual(await page.evaluate(() => sinew.picture()), plain, "cut");
    await page.evaluate(() => sinew.set({ cut: { on: false, axis: 0, at: 0.5, flip: false } }));
    assert.deepEqual(page.problems, []);
});

test("switches, eyes and solo on the page do what they say", async () => {
    await page.locator("label.toggle", { hasText: "Fibres" }).click();
    assert.equal(await page.evaluate(() => sinew.state.overlays.fibres), true);
    assert.equal(await page.locator(".legend-card[data-quantity=excitation]").count(), 1);
    await page.locator("label.toggle", { hasText: "Fibres" }).click();
    const row = page.locator('.body-row[data-body="humerus"]');
    await row.locator('[aria-label="Show or hide"]').click();
    assert.equal(await page.evaluate(() => sinew.state.visible[sinew.scene.bodies.findIndex((b) => b.name === "humerus")]), false);
    await row.locator('[aria-label="Show or hide"]').click();
    await row.hover();
    await row.locator('[aria-label="Show it alone"]').click();
    assert.ok((await pixels(page)).share > 0.001);
    assert.equal(await page.evaluate(() => sinew.state.solo), 1);
    await page.evaluate(() => sinew.solo(null));
});

test("a click on a body selects its node, and a click on a node selects its bodies", async () => {
    await page.evaluate(() => (sinew.setFrame(1), sinew.look("corner"), sinew.set({ panel: "graph" })));
    const [x, y] = await page.evaluate(() => {
        const n = sinew.scene.bodies.find((b) => b.name === "biceps").vertices;
        for (let v = 0; v < n; v += 7) {
            const at = sinew.project(sinew.vertexPosition("biceps", v));
            if (sinew.bodyAt(...at) === "biceps") return at;
        }
        return [0, 0];
    });
    await page.mouse.click(x, y);
    assert.deepEqual(await page.evaluate(() => [sinew.state.selectedNode, sinew.state.selectedBodies.map((i) => sinew.scene.bodies[i].name)]), ["biceps", ["biceps"]]);
    assert.ok(await page.locator('g.node.selected[data-node="biceps"]').count());
    assert.match(await page.locator(".inspector").innerText(), /1,181 vertices/);
    await page.locator('g.node[data-node="biceps"]').click();
    await page.locator(".search").fill("tricepsLongFibre");
    await page.locator(".search").press("Enter");
    await page.locator('g.node[data-node="tricepsLongFibre"]').click();
    assert.deepEqual(await page.evaluate(() => sinew.state.selectedBodies.map((i) => sinew.scene.bodies[i].name)), ["tricepsLong"]);
    assert.deepEqual(await page.evaluate(() => sinew.bodiesOf("bicepsToRadius").sort()), ["biceps", "radius"]);
    await page.keyboard.press("Escape");
});

test("a click on the time line goes to the frame", async () => {
    await page.evaluate(() => sinew.set({ panel: "timeline" }));
    await page.waitForTimeout(100);
    const box = await page.locator(".timeline-canvas").boundingBox();
    for (const frame of [77, 5, 128]) {
        await page.mouse.click(await page.evaluate((f) => sinew.timelineX(f), frame), box.y + 40);
        assert.equal(await page.evaluate(() => sinew.frame), frame);
    }
    assert.match(await page.locator(".tip").innerText(), /Frame 128/);
    assert.deepEqual(page.problems, []);
});

test("a page of the run's folder has the same vertices", async () => {
    const other = path.join(folder, "folder.html");
    const view = await sinew("view", path.join(folder, "run"), "-o", other);
    assert.equal(view.code, 0, view.err);
    const second = await openPage(other, { colorScheme: "dark" });
    assert.equal(await second.evaluate(() => sinew.state.theme), "dark");
    const expected = await objOf("biceps", 50);
    const found = await second.evaluate(() => (sinew.setFrame(50), sinew.drawnPosition("biceps", 777)));
    assert.ok(distance(found, expected[777]) < 1e-5 * size);
    assert.ok(await second.evaluate(() => sinew.scene.frames[49].newton > 0), "report.json is read");
    assert.equal(await second.evaluate(() => sinew.scene.graph.nodes.length), 108);
    assert.deepEqual(second.problems, []);
    await second.context().close();
});
