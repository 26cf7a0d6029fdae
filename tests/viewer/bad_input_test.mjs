// SPDX-License-Identifier: GPL-3.0-or-later
// Runs with something wrong: the page opens with what there is, and says what is not.
import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { closeBrowser, openPage, pixels, sinew } from "./browser.mjs";

let folder;
before(async () => (folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"))));
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

function cube(x, extra = 0) {
    const corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    return corners.map(([a, b, c]) => `v ${a + x} ${b} ${c}`).join("\n") + "\nv 0 0 0".repeat(extra) +
        "\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}
async function run(files) {
    const place = await mkdtemp(path.join(folder, "run-"));
    for (const [name, text] of Object.entries(files)) await writeFile(path.join(place, name), text);
    return { place, ...(await sinew("view", place)), page: await openPage(path.join(place, "view.html")) };
}

test("an empty folder gives a page with the reason, and exit code 1", async () => {
    const { code, err, page } = await run({});
    assert.equal(code, 1);
    assert.match(err, /no OBJ sequences/);
    assert.match(await page.locator("main").innerText(), /no OBJ sequences/);
    assert.deepEqual(page.problems, []);
});

test("missing frames, another vertex count and a broken file: the rest plays", async () => {
    const { code, err, page } = await run({
        "a.1.obj": cube(0), "a.2.obj": cube(1), "a.5.obj": cube(4), "b.1.obj": cube(2), "b.2.obj": cube(2, 3), "b.5.obj": cube(2), "c.1.obj": "v 1 2\n",
    });
    assert.equal(code, 0);
    assert.match(err, /Frames 3-4 are missing/);
    assert.match(err, /b has 8 vertices, but another number in frame 2/);
    assert.match(await page.locator(".banner").innerText(), /missing/);
    await page.evaluate(() => sinew.setFrame(5));
    assert.ok(Math.abs((await page.evaluate(() => sinew.drawnPosition("a", 1)))[0] - 5) < 1e-4);
    assert.ok((await pixels(page)).share > 0.01);
    await page.evaluate(() => sinew.setFrame(2));
    assert.equal(await page.locator('.body-row.absent[data-body="b"]').count(), 1);
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.evaluate(() => sinew.frame), 5);
    assert.deepEqual(page.problems, []);
});

test("a body of a million vertices opens", async () => {
    const side = 1000, lines = [];
    for (let y = 0; y < side; ++y) for (let x = 0; x < side; ++x) lines.push(`v ${x / 10} ${Math.round(20 * Math.sin(x / 90) * Math.cos(y / 70)) / 10} ${y / 10}`);
    for (let y = 1; y < side; ++y) for (let x = 1; x < side; ++x) {
        const a = (y - 1) * side + x;
        lines.push(`f ${a} ${a + side} ${a + side + 1} ${a + 1}`);
    }
    const { code, err, page } = await run({ "sheet.1.obj": lines.join("\n") });
    assert.equal(code, 0, err);
    assert.equal(await page.evaluate(() => sinew.scene.bodies[0].vertices), 1000000);
    assert.ok((await pixels(page)).share > 0.05);
    console.log(`a million vertices: loaded in ${Math.round(await page.evaluate(() => sinew.loadMs))} ms`);
    assert.deepEqual(page.problems, []);
});

test("a folder that is not there, and wrong flags, are usage errors", async () => {
    assert.equal((await sinew("view", path.join(folder, "nowhere"))).code, 1);
    assert.equal((await sinew("view", folder, "--surfaces")).code, 2);
    assert.equal((await sinew("view", "graphs/scenes/arm.json", "--frames", "x")).code, 2);
});

test("without WebGL the page says so, and the time line and the graph still work", async () => {
    const place = await mkdtemp(path.join(folder, "run-"));
    for (const f of [1, 2]) await writeFile(path.join(place, `a.${f}.obj`), cube(f));
    await sinew("view", place);
    const plain = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-3d-apis"] });
    const page = await plain.newPage();
    await page.goto("file://" + path.join(place, "view.html"));
    await page.waitForFunction(() => document.documentElement.dataset.ready === "yes");
    assert.match(await page.locator("main").innerText(), /3D view cannot start/);
    await page.keyboard.press("ArrowRight");
    assert.equal(await page.locator(".frame-number").inputValue(), "2");
    await plain.close();
});

test("a long run of a large body: 100,000 vertices, 200 frames", { skip: !process.env.SINEW_LARGE }, async () => {
    const side = 316, files = {};
    for (let f = 1; f <= 200; ++f) {
        const lines = [];
        for (let y = 0; y < side; ++y) for (let x = 0; x < side; ++x)
            lines.push(`v ${x / 10} ${(2 * Math.sin(x / 30 + f / 20) * Math.cos(y / 25)).toFixed(5)} ${(y / 10).toFixed(5)}`);
        for (let y = 1; y < side; ++y) for (let x = 1; x < side; ++x) {
            const a = (y - 1) * side + x;
            lines.push(`f ${a} ${a + side} ${a + side + 1} ${a + 1}`);
        }
        files[`sheet.${f}.obj`] = lines.join("\n");
    }
    const { code, out, page } = await run(files);
    assert.equal(code, 0);
    console.log(out.trim(), `\nloaded in ${Math.round(await page.evaluate(() => sinew.loadMs))} ms`);
    await page.evaluate(() => sinew.setFrame(200));
    assert.ok((await pixels(page)).share > 0.05);
});
