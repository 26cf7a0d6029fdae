// SPDX-License-Identifier: GPL-3.0-or-later
// The value under the pointer, and the legend's range when a colouring is first shown.
import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, openPage, sinew } from "./browser.mjs";

let folder;
before(async () => (folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"))));
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

/** A cube of a side. */
const cube = (side) =>
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]].map((p) => `v ${p.map((x) => side * x).join(" ")}`).join("\n") +
    "\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/** A page of a cube that is 10 % longer in each direction at frame 3: 21 % more area. */
async function growing() {
    const place = await mkdtemp(path.join(folder, "run-"));
    for (const [frame, side] of [[1, 1], [2, 1], [3, 1.1]]) await writeFile(path.join(place, `box.${frame}.obj`), cube(side));
    assert.equal((await sinew("view", place)).code, 0);
    return openPage(path.join(place, "view.html"));
}
const ends = (page, quantity) => page.locator(`.legend-card[data-quantity=${quantity}] input`).evaluateAll((list) => list.map((i) => Number(i.value)));
async function pointAt(page, at) {
    await page.mouse.move(...at);
    await page.waitForTimeout(600);
    const tip = page.locator(".probe");
    return (await tip.isVisible()) ? (await tip.innerText()).split("\n").filter(Boolean) : null;
}

test("the legend opens with the range of the run, whatever frame it opens at, and is not fitted to rounding", async () => {
    const page = await growing();
    await page.evaluate(() => sinew.set({ colourBy: "area" }));
    assert.deepEqual(await ends(page, "area"), [-21, 21]);
    // Typed ends stay when it is shown again.
    const most = page.locator(".legend-card input").last();
    await most.fill("50");
    await most.press("Enter");
    await page.evaluate(() => (sinew.set({ colourBy: "material" }), sinew.set({ colourBy: "area" })));
    assert.deepEqual(await ends(page, "area"), [-21, 50]);
    const still = await mkdtemp(path.join(folder, "run-"));
    // Off by 1e-5 from each other: nothing worth a full range of colours.
    for (const frame of [1, 2]) await writeFile(path.join(still, `box.${frame}.obj`), cube(1).replace("v 1 1 1", `v ${1 + 1e-5 * frame} 1 1`));
    await sinew("view", still);
    const calm = await openPage(path.join(still, "view.html"));
    await calm.evaluate(() => sinew.set({ colourBy: "area" }));
    assert.deepEqual(await ends(calm, "area"), [-0.5, 0.5]);
});

test("the value under the pointer is that of the body there, with its unit, and the legend marks it", async () => {
    const page = await growing();
    await page.evaluate(() => (sinew.set({ colourBy: "area" }), sinew.setFrame(3)));
    const middle = await page.evaluate(() => sinew.project([0.55, 0.55, 1.1]));
    assert.deepEqual((await pointAt(page, middle)).slice(0, 2), ["box", "Surface area change 21 %"]);
    const tick = () => page.locator(".legend-tick").evaluate((e) => (e.hidden ? null : e.style.left));
    assert.equal(await tick(), "100%");
    await page.evaluate(() => sinew.setFrame(1)); // the pointer rests: the value goes with the frame
    await page.waitForTimeout(600);
    assert.match(await page.locator(".probe").innerText(), /Surface area change 0 %/);
    assert.equal(await tick(), "50%");
    const box = await page.locator(".canvas").boundingBox();
    assert.equal(await pointAt(page, [box.x + box.width - 8, box.y + 8]), null);
    assert.equal(await tick(), null);
    await page.evaluate(() => sinew.set({ colourBy: "material" }));
    assert.deepEqual((await pointAt(page, middle))[0], "box");
    assert.deepEqual(page.problems, []);
});

test("over filled tets it is the value of the tet that is seen", async () => {
    const file = path.join(folder, "muscle.html");
    const view = await sinew("view", "graphs/learn/02_muscle_pulls.json", "--frames", "1-12", "-o", file, "--quiet");
    assert.equal(view.code, 0, view.err);
    const page = await openPage(file);
    const at = await page.evaluate(() => {
        sinew.setFrame(12);
        sinew.toggle("lattice", true);
        sinew.set({ colourBy: "volume" });
        const belly = sinew.scene.bodies.find((b) => b.name === "belly"), n = belly.vertices;
        for (let v = 0; v < n; ++v) {
            const p = sinew.project(sinew.vertexPosition("belly", v));
            if (sinew.bodyAt(p[0] + 6, p[1]) === "belly" && sinew.bodyAt(p[0] - 6, p[1]) === "belly") return p;
        }
        return null;
    });
    const lines = await pointAt(page, at);
    assert.equal(lines[0], "belly");
    const tet = Number(lines[2].match(/^tet (\d+)$/)[1]), told = Number(lines[1].match(/^Volume change (\S+) %$/)[1].replace("−", "-"));
    const expected = await page.evaluate((t) => {
        const { lattice } = sinew.scene.bodies.find((b) => b.name === "belly");
        const volume = (p) => {
            const [a, b, c, d] = [0, 1, 2, 3].map((k) => [0, 1, 2].map((i) => p[3 * lattice.tets[4 * t + k] + i]));
            const [u, v, w] = [b, c, d].map((q) => q.map((x, i) => x - a[i]));
            return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
        };
        return 100 * (volume(lattice.positionsAt(sinew.state.frame)) / volume(lattice.rest) - 1);
    }, tet);
    assert.ok(Math.abs(told - expected) < 0.0051, `${told} for ${expected}: it is told to a hundredth`);
    assert.ok(Math.abs(expected) > 0.05, `${expected}`);
});
