// SPDX-License-Identifier: GPL-3.0-or-later
// Other ways to a page and to a drawing: sinew run --open, sinew graph --svg; what a page shows that no solver gives yet.
import assert from "node:assert/strict";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { closeBrowser, openBrowser, openPage, pixels, sinew } from "./browser.mjs";

let folder;
before(async () => (folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"))));
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

test("sinew run --open says where the page is, and the page has the run's times", async () => {
    const out = path.join(folder, "learn #1%41 ü");
    const run = await sinew("run", "graphs/learn/02_muscle_pulls.json", "--frames", "1-5", "--out", out, "--open");
    assert.equal(run.code, 0, run.err);
    const link = run.out.match(/^open (file:.*)$/m)[1], file = fileURLToPath(link);
    assert.equal(file, path.join(out, "view.html"));
    assert.equal(link, pathToFileURL(file).href);
    const page = await openPage(file, {}, link);
    assert.deepEqual(await page.evaluate(() => sinew.frames), [1, 2, 3, 4, 5]);
    assert.ok(await page.evaluate(() => sinew.scene.frames[3].wall_s > 0 && !sinew.scene.frames[3].reused));
    assert.ok((await pixels(page)).share > 0.01);
    assert.deepEqual(page.problems, []);
    assert.equal((await sinew("run", "graphs/learn/02_muscle_pulls.json", "--open")).code, 2);

    // Marks of forces: lines and dots, a colour range for each unit over the frames without faults.
    const plain = await page.evaluate(() => sinew.picture());
    await page.evaluate(() => {
        sinew.scene.frames[0].marks = [
            { term: "field", what: "wind", unit: "N/m^3", numbers: new Float32Array([0, 0, 6, 0, 4, 6, 5, 1, 1, 6, 1, 5, 6, 10]) },
            { term: "hold", what: "distance", unit: "m", numbers: new Float32Array([0, 0, 6, 0, 0, 6, 0.002]) },
        ];
        sinew.toggle("marks", true);
        sinew.set({ ranges: { ...sinew.state.ranges, "marks N/m^3": [0, 10], "marks m": [0, 4] } });
    });
    assert.notEqual(await page.evaluate(() => sinew.picture()), plain);
    assert.match(await page.locator('.legend-card[data-quantity="marks N/m^3"]').innerText(), /Wind N\/m³/);
    assert.match(await page.locator('.legend-card[data-quantity="marks m"]').innerText(), /Distance mm/);
    // Half, the end, and half of 4 mm: #f5bb2e is 0.913 0.497 0.027 in linear light.
    const dots = await page.evaluate(() => sinew.drawnColours("marks"));
    assert.equal(dots.length, 9);
    for (const first of [0, 6]) [0.913, 0.497, 0.027].forEach((c, i) => assert.ok(Math.abs(dots[first + i] - c) < 0.02, `${dots}`));
    [0.366, 0.0075, 0.205].forEach((c, i) => assert.ok(Math.abs(dots[3 + i] - c) < 0.01, `${dots}`));
    await page.locator('.legend-card[data-quantity="marks m"] button').click();
    assert.deepEqual(await page.evaluate(() => sinew.state.ranges["marks m"]), [0, 2]);
    assert.deepEqual(page.problems, []);
});

test("sinew graph --svg gives a drawing that a browser shows, with every node", async () => {
    const file = path.join(folder, "arm.svg");
    const { code, err } = await sinew("graph", "graphs/scenes/arm.json", "--svg", file);
    assert.equal(code, 0, err);
    const page = await (await openBrowser()).newPage();
    await page.goto("file://" + file);
    const nodes = Object.keys(JSON.parse(await readFile("graphs/scenes/arm.json", "utf8").catch(() => readFile(new URL("../../graphs/scenes/arm.json", import.meta.url), "utf8"))).nodes);
    assert.deepEqual((await page.locator("g.node").evaluateAll((all) => all.map((g) => g.dataset.node))).sort(), nodes.sort());
    // No text leaves its box.
    const outside = await page.locator("g.node").evaluateAll((all) => all.flatMap((g) => {
        const width = Number(g.querySelector("rect").getAttribute("width"));
        return [...g.querySelectorAll("text")].filter((t) => t.getBBox().x < 0 || t.getBBox().x + t.getBBox().width > width).map((t) => t.textContent);
    }));
    assert.deepEqual(outside, []);
    assert.equal((await sinew("graph", "graphs/scenes/arm.json", "--svg", file, "--dot")).code, 2);
});

test("reused frames and a solve without convergence are marked on the time line", async () => {
    const obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    const place = await mkdtemp(path.join(folder, "run-"));
    const frames = [];
    for (let f = 1; f <= 4; ++f) {
        await writeFile(path.join(place, `a.${f}.obj`), obj);
        frames.push({ frame: f, reused: f === 2, wall_s: 0.1, phases: { assembly: 0.02, solve: 0.05 }, newton: 3 * f, residual: 1e-6, converged: f !== 3 });
    }
    await writeFile(path.join(place, "report.json"), JSON.stringify({ frames }));
    const view = await sinew("view", place);
    assert.equal(view.code, 0, view.err);
    const page = await openPage(path.join(place, "view.html"));
    const colourAbove = (frame) => page.evaluate((f) => {
        const canvas = document.querySelector(".timeline-canvas"), r = canvas.getBoundingClientRect();
        const p = canvas.getContext("2d").getImageData(sinew.timelineX(f) - r.left - 12, 17, 1, 1).data;
        return [p[0], p[1], p[2], p[3]].join();
    }, frame);
    assert.equal(await colourAbove(2), "58,160,160,255");
    assert.equal(await colourAbove(3), "210,59,59,255");
    assert.equal((await colourAbove(4)).endsWith(",0"), true);
    assert.match(await page.locator(".timeline-key").innerText(), /reused/);
    assert.deepEqual(page.problems, []);
});
