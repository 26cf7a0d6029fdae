// SPDX-License-Identifier: GPL-3.0-or-later
// Two runs on one page: side by side, and their difference as colours and numbers.
import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, openPage, pixels, sinew } from "./browser.mjs";

let folder;
before(async () => (folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"))));
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

const cube = (side, x = 0, extra = 0) =>
    "# sinew: tissue, y up, 100 units a metre\n" +
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]].map((p) => `v ${p.map((c, i) => side * c + (i ? 0 : x)).join(" ")}`).join("\n") +
    "\nv 0 0 0".repeat(extra) + "\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
async function run(name, files) {
    const place = await mkdtemp(path.join(folder, name));
    for (const [file, text] of Object.entries(files)) await writeFile(path.join(place, file), text);
    return place;
}
async function compared(first, second) {
    const a = await run("a", first), b = await run("b", second), file = path.join(folder, `${Math.random()}.html`);
    const said = await sinew("view", a, "--against", b, "-o", file);
    assert.equal(said.code, 0, said.err);
    return { ...said, page: await openPage(file, { viewport: { width: 1200, height: 800 } }) };
}

test("the difference is the distance of vertices, in millimetres, at the same frame", async () => {
    // At frame 2 the second run's box lies 0.3 cm further: 3 mm at every vertex. At frame 1 they are the same.
    const { page, err } = await compared({ "box.1.obj": cube(1), "box.2.obj": cube(1.5), "lid.1.obj": cube(2, 4), "lid.2.obj": cube(2, 4) },
        { "box.1.obj": cube(1), "box.2.obj": cube(1.5, 0.3), "lid.1.obj": cube(2, 4), "lid.2.obj": cube(2, 4) });
    assert.equal(err, "");
    await page.keyboard.press("d");
    assert.equal(await page.evaluate(() => sinew.state.colourBy), "difference");
    assert.match(await page.locator(".legend-card[data-quantity=difference]").innerText(), /Difference mm/);
    const ends = await page.locator(".legend-card input").evaluateAll((list) => list.map((i) => Number(i.value)));
    assert.deepEqual(ends, [0, 3], "the run's range");
    const range = async (frame) => (await page.evaluate((f) => (sinew.setFrame(f), sinew.measuredRange("difference")), frame)).map((x) => 1000 * x);
    assert.ok((await range(1)).every((mm) => Math.abs(mm) < 0.002), `${await range(1)}`);
    const [least, most] = await range(2);
    assert.ok(Math.abs(least) < 0.002 && Math.abs(most - 3) < 0.002, `${least} to ${most}: the lid stays, the box does not`);
    await page.evaluate(() => sinew.selectBody("box"));
    await page.locator(".inspector .fold").click(); // its head alone leaves the second run in sight
    assert.match(await page.locator(".inspector").innerText(), /Difference\s+3 mm, at most 3 mm/);
    // Under the pointer, on both sides.
    for (const side of [0, 1]) {
        const at = await page.evaluate((s) => sinew.project(s ? [1.05, 0.75, 1.5] : [0.75, 0.75, 1.5], s), side);
        await page.mouse.move(...at);
        await page.waitForTimeout(600);
        assert.match(await page.locator(".probe").innerText(), /box\nDifference 3 mm/, `side ${side}`);
    }
    assert.deepEqual(page.problems, []);
});

test("side by side each run is on its own side, seen by one camera, and a click on either selects", async () => {
    const { page } = await compared({ "box.1.obj": cube(1), "extra.1.obj": cube(1, 3) }, { "box.1.obj": cube(1), "more.1.obj": cube(1, 3) });
    await page.evaluate(() => sinew.toggle("grid", false));
    assert.deepEqual(await page.evaluate(() => [sinew.drawn(), sinew.otherDrawn()]), [["box", "extra"], ["box", "more"]]);
    const titles = await page.locator(".side-titles span").allInnerTexts();
    assert.equal(titles.length, 2);
    assert.notEqual(titles[0], titles[1]);
    // The halves of the picture are the same where the runs are: shift one onto the other.
    const halves = await page.evaluate(async () => {
        const image = new Image();
        image.src = sinew.picture();
        await image.decode();
        const canvas = document.createElement("canvas"), g = canvas.getContext("2d");
        (canvas.width = image.width), (canvas.height = image.height);
        g.drawImage(image, 0, 0);
        const wide = image.width >> 1, [a, b] = [0, wide].map((x) => g.getImageData(x, 0, wide, image.height).data);
        let flesh = 0, same = 0;
        for (let i = 0; i < a.length; i += 4) {
            const isFlesh = Math.abs(a[i] - a[0]) + Math.abs(a[i + 1] - a[1]) > 40;
            flesh += isFlesh;
            same += isFlesh && Math.abs(a[i] - b[i]) < 30;
        }
        return { flesh: flesh / (a.length / 4), same: same / flesh };
    });
    assert.ok(halves.flesh > 0.02 && halves.same > 0.9, JSON.stringify(halves));
    const at = await page.evaluate(() => [0, 1].map((s) => sinew.project([0.5, 0.5, 1], s)));
    const box = await page.locator(".canvas").boundingBox();
    assert.ok(at[0][0] < box.x + box.width / 2 && at[1][0] > box.x + box.width / 2);
    for (const [x, y] of at) {
        await page.keyboard.press("Escape");
        await page.mouse.click(x, y);
        assert.deepEqual(await page.evaluate(() => sinew.state.selectedBodies), [0]);
    }
    // Hidden here is hidden there; alone takes the whole view.
    await page.evaluate(() => sinew.show("box", false));
    assert.deepEqual(await page.evaluate(() => sinew.otherDrawn()), ["more"]);
    await page.evaluate(() => sinew.show("box", true));
    await page.keyboard.press("y");
    assert.deepEqual(await page.evaluate(() => [sinew.state.compare, sinew.otherDrawn()]), ["one", []]);
    assert.equal(await page.locator(".side-titles").isVisible(), false);
    assert.ok((await pixels(page)).share > 0.02);
    await page.waitForFunction(() => location.hash.includes("compare=one"));
    assert.deepEqual(page.problems, []);
});

test("in an upright window the two are one above the other", async () => {
    const { page } = await compared({ "box.1.obj": cube(1) }, { "box.1.obj": cube(1) });
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForTimeout(300);
    const box = await page.locator(".canvas").boundingBox(), at = await page.evaluate(() => [0, 1].map((s) => sinew.project([0.5, 0.5, 1], s)));
    assert.ok(Math.abs(at[0][0] - at[1][0]) < 1);
    assert.ok(Math.abs(at[1][1] - at[0][1] - box.height / 2) < 1);
    for (const [x, y] of at) assert.equal(await page.evaluate((p) => sinew.bodyAt(...p), [x, y]), "box");
    const [first, second] = await page.locator(".side-titles span").evaluateAll((list) => list.map((e) => e.getBoundingClientRect().top));
    assert.ok(second > first + 0.3 * box.height);
});

test("what the runs do not have in common is said, and other frames are missing on one side alone", async () => {
    const { page, err } = await compared({ "box.1.obj": cube(1), "box.2.obj": cube(2), "lid.1.obj": cube(1, 3), "lid.2.obj": cube(1.2, 3) },
        { "box.2.obj": cube(2), "lid.2.obj": cube(1, 3, 2) });
    assert.match(err, /lid has 8 vertices here and 10 in /);
    assert.equal(await page.locator(".side-titles p").isVisible(), true);
    assert.deepEqual(await page.evaluate(() => sinew.otherDrawn()), []);
    await page.evaluate(() => sinew.setFrame(2));
    assert.equal(await page.locator(".side-titles p").isVisible(), false);
    assert.deepEqual(await page.evaluate(() => sinew.otherDrawn()), ["box", "lid"]);
    const none = await compared({ "a.1.obj": cube(1) }, { "b.1.obj": cube(1) });
    assert.match(none.err, /no body in common/);
    await none.page.keyboard.press("d");
    assert.equal(await none.page.evaluate(() => sinew.state.colourBy), "material");
    assert.match(await none.page.locator(".toast").innerText(), /both runs/);
});

test("a graph with other values against the graph itself", async () => {
    const graph = "graphs/learn/02_muscle_pulls.json", file = path.join(folder, "graph.html");
    const said = await sinew("view", graph, "--frames", "1-18", "--set", "fibre.strength=30000", "--against", graph, "-o", file, "--quiet");
    assert.equal(said.code, 0, said.err);
    const page = await openPage(file);
    await page.evaluate(() => sinew.set({ colourBy: "difference" }));
    const most = async (frame) => (await page.evaluate((f) => (sinew.setFrame(f), sinew.measuredRange("difference")), frame))[1];
    assert.ok((await most(1)) < 1e-5, "the same at the start");
    assert.ok((await most(18)) > 1e-4, `${await most(18)} m apart later`);
    assert.deepEqual(await page.locator(".side-titles span").allInnerTexts(), ["02_muscle_pulls, fibre.strength=30000", "02_muscle_pulls"]);
    for (const overlay of ["lattice", "fibres", "attachments"]) await page.evaluate((o) => sinew.toggle(o, true), overlay);
    assert.deepEqual(page.problems, []);
    assert.match((await sinew("view", graph, "--against", path.join(folder, "nowhere"))).err, /nowhere/);
});
