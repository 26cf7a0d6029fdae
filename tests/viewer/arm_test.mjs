// SPDX-License-Identifier: GPL-3.0-or-later
// The arm, 128 frames: its page in a browser against the files that the same run wrote.
import assert from "node:assert/strict";
import { mkdtemp, readFile, rm, stat } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, isEmpty, openPage, pixels, root, sinew } from "./browser.mjs";

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

// How long it takes is a benchmark: opening_bench.mjs.
test("it opens from disk, without an error and without a request", async () => {
    console.log(`loaded in ${Math.round(await page.evaluate(() => sinew.loadMs))} ms, ${((await stat(file)).size / 1e6).toFixed(1)} MB`);
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
        const longest = told.terms.attachment.max_stretch_m;
        // The page draws the samples on the skin, which is flat between its vertices; the tets that carry them bend.
        assert.ok(Math.abs(stretch - longest) < 0.05 * longest + 1e-5, `frame ${frame}: ${stretch} for ${longest}`);
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
    const picture = () => page.evaluate(() => sinew.picture());
    // Each of these changes what is seen, and pressed again brings it back.
    for (const [key, get] of [["t", (s) => s.theme], ["s", (s) => s.smooth], ["l", (s) => s.overlays.lattice], ["x", (s) => s.opacity],
        ["b", (s) => s.overlays.fibres], ["a", (s) => s.overlays.attachments], ["g", (s) => s.overlays.grid], ["c", (s) => s.cut.on],
        ["v", (s) => s.colourBy]]) {
        const was = get(await state()), seen = await picture();
        await page.keyboard.press(key);
        assert.notEqual(get(await state()), was, key);
        assert.notEqual(await picture(), seen, `${key} changes the picture`);
        await page.keyboard.press(key);
        assert.equal(get(await state()), was, key);
        assert.equal(await picture(), seen, `${key} brings it back`);
    }
    const surfaces = [await picture()];
    for (const name of ["edges", "wire", "shaded"]) {
        await page.keyboard.press("w");
        assert.equal((await state()).surface, name);
        surfaces.push(await picture());
    }
    assert.equal(surfaces[3], surfaces[0]);
    assert.equal(new Set(surfaces).size, 3);
    for (const [key, get] of [["n", (s) => s.panel], ["p", (s) => s.panelOpen], ["r", (s) => s.loop]]) {
        const was = get(await state());
        await page.keyboard.press(key);
        assert.notEqual(get(await state()), was, key);
        await page.keyboard.press(key);
        assert.equal(get(await state()), was, key);
    }
    await page.keyboard.press("+");
    assert.equal((await state()).speed, 2);
    await page.keyboard.press("-");
    assert.equal((await state()).speed, 1);
    // The panel is gone and back: the view is as large as before.
    const tall = () => page.evaluate(() => document.querySelector(".panel-body").clientHeight), before = await tall();
    await page.keyboard.press("m");
    assert.ok((await tall()) > before + 100);
    await page.keyboard.press("m");
    assert.equal(await tall(), before);
    const seen = new Set();
    for (const key of ["1", "2", "3", "4"]) {
        await page.keyboard.press(key);
        seen.add(await picture());
    }
    assert.equal(seen.size, 4, "four sides look different");
    // Bodies: alone, hidden, all; and F brings the selected one close.
    await page.evaluate(() => sinew.selectBody("biceps"));
    await page.keyboard.press("f");
    assert.ok(!seen.has(await picture()));
    await page.keyboard.press("i");
    assert.deepEqual(await page.evaluate(() => sinew.drawn()), ["biceps"]);
    await page.keyboard.press("i");
    await page.keyboard.press("h");
    assert.equal((await page.evaluate(() => sinew.drawn())).includes("biceps"), false);
    await page.keyboard.press("u");
    assert.equal((await page.evaluate(() => sinew.drawn())).length, 12);
    await page.keyboard.press("Escape");
    assert.equal((await state()).selectedNode, null);
    await page.keyboard.press("4");
    // No force shows marks: the key says so and leaves all as it is.
    await page.keyboard.press("k");
    assert.equal((await state()).overlays.marks, false);
    assert.equal(await page.locator(".legend-card").count(), 0);
    assert.match(await page.locator(".toast").innerText(), /no marks/);
    await page.keyboard.press("?");
    assert.ok(await page.isVisible(".sheet"));
    await page.keyboard.press("Escape");
    assert.ok(!(await page.isVisible(".sheet")));
});

test("short-cuts work after a field was used, and leave it alone while it is used", async () => {
    const state = () => page.evaluate(() => sinew.state);
    await page.evaluate(() => sinew.setFrame(1));
    await page.locator(".frame-number").click();
    await page.locator(".frame-number").fill("20");
    await page.keyboard.press("Enter");
    assert.equal(await page.evaluate(() => sinew.frame), 20);
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.evaluate(() => sinew.frame), 21);
    await page.keyboard.press("Space");
    assert.equal((await state()).playing, true);
    await page.keyboard.press("Space");

    const colours = page.locator('select[aria-label="Colour by"]');
    await colours.selectOption("volume");
    await colours.focus();
    await page.keyboard.press("l");
    assert.deepEqual([(await state()).colourBy, (await state()).overlays.lattice], ["volume", true]);
    await page.keyboard.press("l");
    await colours.selectOption("material");

    await page.evaluate(() => sinew.setFrame(20));
    await page.locator('[aria-label="Opacity of tissues"]').focus();
    const opacity = (await state()).opacity;
    await page.keyboard.press("ArrowLeft");
    assert.ok((await state()).opacity < opacity);
    assert.equal(await page.evaluate(() => sinew.frame), 20);
    await page.keyboard.press("ArrowRight");

    await page.locator('[aria-label^="Last frame"]').focus(); // by the keyboard: space presses it
    await page.keyboard.press("Space");
    assert.deepEqual([await page.evaluate(() => sinew.frame), (await state()).playing], [128, false]);
    await page.locator('[aria-label^="First frame"]').click(); // by the mouse: space plays
    await page.keyboard.press("Space");
    assert.equal((await state()).playing, true);
    await page.keyboard.press("Space");
    await page.locator(".search").evaluate((e) => e.closest(".graph-tools").hidden); // the graph is closed
    await page.evaluate(() => (sinew.set({ panel: "graph" }), sinew.setFrame(5)));
    await page.locator(".search").fill("bl");
    await page.keyboard.press("Escape");
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.evaluate(() => sinew.frame), 6);
    await page.locator(".search").fill("");
    await page.keyboard.press("Escape");
    await page.evaluate(() => sinew.set({ panel: "timeline", opacity: 1, opacityIsAutomatic: true }));
});

test("colours stand for the solver's numbers, and legends have units", async () => {
    const found = await page.evaluate(() => {
        sinew.setFrame(64);
        sinew.toggle("fibres", true);
        sinew.toggle("attachments", true);
        const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
        const body = sinew.scene.bodies.find((b) => b.name === "biceps"), at = sinew.state.frame;
        const longest = sinew.scene.attachments.map((_, i) => sinew.stretch(i));
        const which = longest.indexOf(Math.max(...longest)), most = sinew.state.ranges.distance[1];
        const dots = sinew.drawnColours("attachments", which);
        const wanted = sinew.colourAt("distance", (1000 * longest[which]) / most).map(linear);
        let nearest = Infinity;
        for (let i = 0; i < dots.length; i += 3) nearest = Math.min(nearest, Math.max(...wanted.map((c, k) => Math.abs(c - dots[i + k]))));
        return {
            fibre: sinew.drawnColours("fibres", "biceps").slice(0, 3),
            excitation: sinew.colourAt("heat", body.fibres[0].excitation[at]).map(linear),
            share: body.fibres[0].excitation[at],
            nearest,
        };
    });
    assert.ok(found.share > 0.3 && found.share < 1);
    found.fibre.forEach((c, k) => assert.ok(Math.abs(c - found.excitation[k]) < 0.01, `fibre colour ${found.fibre} for ${found.excitation}`));
    assert.ok(found.nearest < 0.01, "the longest attachment has the colour of its length");
    assert.match(await page.locator(".legend-card[data-quantity=excitation]").innerText(), /%/);
    assert.match(await page.locator(".legend-card[data-quantity=distance]").innerText(), /mm/);
    assert.match(await page.locator(".legend-card[data-quantity=distance]").innerText(), /fixed/);
    await page.evaluate(() => (sinew.toggle("fibres", false), sinew.toggle("attachments", false), sinew.set({ colourBy: "stretch" })));
    assert.match(await page.locator(".legend-card[data-quantity=stretch]").innerText(), /Largest stretch %/);
    await page.evaluate(() => sinew.set({ colourBy: "material" }));
});

test("a click finds what the cut plane leaves, and nothing where it leaves nothing", async () => {
    const samples = await page.evaluate(() => {
        sinew.setFrame(64);
        sinew.toggle("grid", false);
        sinew.look("corner");
        const low = [0, 1, 2].map((c) => Math.min(...sinew.scene.bodies.filter((b) => b.kind !== "bone").map((b) => b.rest.reduce((m, x, i) => (i % 3 === c ? Math.min(m, x) : m), Infinity))));
        const high = [0, 1, 2].map((c) => Math.max(...sinew.scene.bodies.filter((b) => b.kind !== "bone").map((b) => b.rest.reduce((m, x, i) => (i % 3 === c ? Math.max(m, x) : m), -Infinity))));
        const middle = (low[1] + high[1]) / 2, kept = [], gone = [];
        for (const b of sinew.scene.bodies.filter((x) => x.kind === "tissue"))
            for (let v = 0; v < b.vertices; v += 11) {
                const at = sinew.project(sinew.vertexPosition(b.name, v));
                if (sinew.bodyAt(...at) !== b.name) continue;
                (b.rest[3 * v + 1] < middle - 0.5 ? kept : b.rest[3 * v + 1] > middle + 0.5 ? gone : []).push([b.name, at]);
            }
        sinew.set({ cut: { on: true, axis: 1, at: 0.5, flip: false } });
        return { kept: kept.map(([name, at]) => [name, sinew.bodyAt(...at)]), gone: gone.map(([, at]) => [at, sinew.bodyAt(...at)]) };
    });
    assert.ok(samples.kept.length > 20 && samples.gone.length > 20, `${samples.kept.length}, ${samples.gone.length}`);
    for (const [name, found] of samples.kept) assert.equal(found, name);
    const empty = await isEmpty(page, samples.gone.map(([at]) => at));
    assert.ok(empty.some(Boolean), "the cut takes something away");
    samples.gone.forEach(([, found], i) => empty[i] && assert.equal(found, null));
    // The other side: what was kept is gone now.
    const flipped = await page.evaluate((points) => (sinew.set({ cut: { on: true, axis: 1, at: 0.5, flip: true } }), points.map((p) => sinew.bodyAt(...p))),
        samples.gone.map(([at]) => at));
    assert.ok(flipped.every((name) => name !== null), "what the one side takes, the other leaves");
    await page.evaluate(() => (sinew.set({ cut: { on: false, axis: 0, at: 0.5, flip: false } }), sinew.toggle("grid", true)));
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
    for (const colourBy of ["volume", "stretch", "area", "weights"]) {
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
    const row = page.locator('.body-row[data-body="humerus"]'), drawn = () => page.evaluate(() => sinew.drawn());
    const all = await drawn(), share = async () => (await pixels(page)).share, full = await share();
    assert.equal(all.length, 12);
    await row.locator('[aria-label="Show or hide"]').click();
    assert.deepEqual(await drawn(), all.filter((name) => name !== "humerus"));
    const without = await share();
    assert.ok(without < full, `${without} of ${full}`);
    await row.locator('[aria-label="Show or hide"]').click();
    assert.deepEqual(await drawn(), all);
    assert.equal(await share(), full);
    await row.hover();
    await row.locator('[aria-label="Show it alone"]').click();
    assert.deepEqual(await drawn(), ["humerus"]);
    const alone = await share();
    assert.ok(alone > 0.001 && alone < 0.6 * full, `${alone} of ${full}`);
    await page.evaluate(() => sinew.solo(null));
    assert.equal(await share(), full);
});

test("bodies look as the graph says, and are chosen by it", async () => {
    const looks = await page.evaluate(() => Object.fromEntries(sinew.scene.bodies.map((b) => [b.name, [b.matter, b.colour]])));
    assert.deepEqual([looks.biceps[0], looks.tricepsTendon[0], looks.humerus[0]], ["muscle", "tendon", "bone"]);
    const [red, green] = [1, 3].map((i) => parseInt(looks.tricepsTendon[1].slice(i, i + 2), 16));
    assert.ok(red > 200 && green > 180, `pale: ${looks.tricepsTendon[1]}`);
    const chip = page.locator(".chip", { hasText: "tendon" });
    await chip.click();
    assert.deepEqual(await page.evaluate(() => sinew.scene.bodies.map((b) => b.name).filter((n) => !sinew.drawn().includes(n))), ["tricepsTendon"]);
    await chip.click();
    assert.equal((await page.evaluate(() => sinew.drawn())).length, 12);
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
    assert.equal(await page.evaluate(() => sinew.bodiesOf("solver").length), 12);
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
    // What forces measure has its rows too.
    assert.ok((await page.evaluate(() => sinew.timelineTitles)).includes("Largest attachment stretch"));
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
    const nodes = JSON.parse(await readFile(path.join(root, graph), "utf8")).nodes;
    assert.equal(await second.evaluate(() => sinew.scene.graph.nodes.length), Object.keys(nodes).length);
    // Keys for what the files do not have change nothing.
    for (const key of ["l", "b", "a", "v", "k"]) await second.keyboard.press(key);
    assert.deepEqual(await second.evaluate(() => [sinew.state.colourBy, Object.entries(sinew.state.overlays).filter(([, on]) => on).map(([name]) => name)]), ["material", ["grid"]]);
    assert.equal(await second.locator(".legend-card").count(), 0);
    assert.deepEqual(second.problems, []);
    await second.context().close();
});
