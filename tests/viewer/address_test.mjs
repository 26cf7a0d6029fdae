// SPDX-License-Identifier: GPL-3.0-or-later
// The page's address: frame, camera and what is shown, for a link that opens the page as it was.
import assert from "node:assert/strict";
import { mkdtemp, rm } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { closeBrowser, openPage, sinew } from "./browser.mjs";

let folder, file, link;
before(async () => {
    folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"));
    file = path.join(folder, "arm.html");
    link = pathToFileURL(file).href;
    const view = await sinew("view", "graphs/scenes/arm.json", "--frames", "1-4", "-o", file, "--quiet");
    assert.equal(view.code, 0, view.err);
});
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});
/** The address's fragment once it has settled; the machine may be busy. */
async function hash(page) {
    let last = null;
    for (let same = 0; same < 3; await page.waitForTimeout(300)) {
        const now = await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(() => done(location.hash), 0))));
        same = now === last ? same + 1 : 0;
        last = now;
    }
    return last;
}
const seen = (page) => page.evaluate(() => {
    const { frame, colourBy, overlays, opacity, selectedNode, selectedBodies } = sinew.state;
    // Where points are on the page, to a quarter of a pixel: the address rounds the camera.
    const places = ["hand", "biceps", "scapula"].map((b) => sinew.project(sinew.vertexPosition(b, 5)).map((x) => Math.round(4 * x) / 4));
    return { frame, colourBy, overlays, opacity, selectedNode, selectedBodies, places };
});

test("a copied address opens the page as it was: frame, camera, colours, overlays, selection", async () => {
    const page = await openPage(file);
    assert.equal(await hash(page), "", "a fresh page has a plain address");
    await page.setViewportSize({ width: 1100, height: 760 });
    assert.equal(await hash(page), "", "and keeps it in a window of another size");
    const box = await page.locator(".canvas").boundingBox();
    await page.mouse.move(box.x + 300, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(box.x + 420, box.y + 260, { steps: 4 });
    await page.mouse.up();
    await page.mouse.wheel(0, -300);
    await page.evaluate(() => {
        sinew.setFrame(3);
        sinew.set({ colourBy: "stretch" });
        sinew.toggle("attachments", true);
        sinew.toggle("grid", false);
        sinew.selectBody("biceps");
    });
    const address = await hash(page);
    assert.match(address, /frame=3/);
    assert.match(address, /camera=(-?[\d.e-]+,){5}-?[\d.e-]+/);
    const again = await openPage(file, { viewport: { width: 1100, height: 760 } }, link + address);
    assert.deepEqual(await seen(again), await seen(page));
    const fresh = await openPage(file, { viewport: { width: 1100, height: 760 } }, `${link}#frame=3`);
    assert.notDeepEqual((await seen(fresh)).places, (await seen(page)).places);
    assert.equal(await hash(again), address, "and says the same");
    assert.deepEqual([...page.problems, ...again.problems], []);
});

test("an address that is changed is followed, and what it does not name is as in a fresh page", async () => {
    const page = await openPage(file);
    await page.evaluate(() => (location.hash = "frame=4&body=radius&show=fibres"));
    await page.waitForFunction(() => sinew.frame === 4);
    assert.deepEqual(await page.evaluate(() => [sinew.state.selectedNode, sinew.state.overlays.fibres, sinew.state.overlays.grid]), ["radius", true, false]);
    const places = () => sinew.project(sinew.vertexPosition("hand", 5)).join();
    const before = await page.evaluate(places);
    await page.evaluate(() => (location.hash = "frame=4&body=radius&show=fibres&camera=0,100,300,0,90,0"));
    await page.waitForFunction((was) => sinew.project(sinew.vertexPosition("hand", 5)).join() !== was, before);
    await page.evaluate(() => (location.hash = "frame=2"));
    await page.waitForFunction(() => sinew.frame === 2);
    assert.deepEqual(await page.evaluate(() => [sinew.state.selectedNode, sinew.state.overlays.fibres, sinew.state.overlays.grid]), [null, false, true]);
    const fresh = await openPage(file, {}, `${link}#frame=2`);
    assert.equal(await page.evaluate(places), await fresh.evaluate(places), "and its camera is back");
});

test("an address that is changed just as the page is about to write its own is followed", async () => {
    const page = await openPage(file);
    await page.evaluate(() => {
        // What the page does a moment after a change is done here between the new address and the event that tells of it.
        const later = window.setTimeout, due = [];
        window.setTimeout = (call, ...rest) => (due.push(call), later(call, ...rest));
        sinew.setFrame(3);
        window.setTimeout = later;
        location.hash = "frame=2&show=fibres";
        for (const call of due) call();
    });
    await page.waitForFunction(() => sinew.frame === 2);
    assert.deepEqual(await page.evaluate(() => [sinew.state.overlays.fibres, sinew.state.overlays.grid]), [true, false]);
    assert.equal(await hash(page), "#frame=2&show=fibres");
});

test("what cannot be followed is told, and the rest is", async () => {
    for (const [words, told, frame] of [["frame=77", /no frame 77/, 1], ["frame=2&camera=1,2,3", /camera/, 2], ["frame=2&camera=1,2,3,1,2,3", /camera/, 2],
        ["frame=3&colour=temperature", /temperature/, 3], ["frame=3&show=marks", /marks/, 3], ["node=nobody&frame=2", /nobody/, 2]]) {
        const page = await openPage(file, {}, `${link}#${words}`);
        assert.match(await page.locator(".toast").innerText(), told, words);
        assert.equal(await page.evaluate(() => sinew.frame), frame, words);
        assert.deepEqual(page.problems, []);
        await page.context().close();
    }
});
