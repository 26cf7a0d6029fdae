// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts on the page: marks with the bodies that they are about, those of the selected ones alone, the value under the
// pointer, and the one list of overlays that switches, keys and addresses follow.
import assert from "node:assert/strict";
import { mkdtemp, rm } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { overlayList } from "../../tools/viewer/page/src/overlays.js";
import { closeBrowser, openPage, sinew } from "./browser.mjs";

let folder, file;
before(async () => {
    folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"));
    file = path.join(folder, "collisions.html");
    const view = await sinew("view", "graphs/learn/14_collisions.json", "--frames", "1-26", "-o", file, "--quiet");
    assert.equal(view.code, 0, view.err);
});
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

/** Pairs of body names with how many marks each has at the shown frame, by the program's own numbers. */
async function pairsOf(frame) {
    const { code, out, err } = await sinew("eval", "graphs/learn/14_collisions.json", "solver.outContacts", "--frame", String(frame), "--json");
    assert.equal(code, 0, err);
    const names = ["ramp", "sliding", "sticking", "upper"];
    return JSON.parse(out).value.map((p) => [names[p.source], names[p.target], p.contacts]);
}
const drawn = (page) => page.evaluate(() => sinew.markCount());

test("contacts know their bodies, and a filter leaves those of the selected ones, at either end", async () => {
    const page = await openPage(file), pairs = await pairsOf(26), all = pairs.reduce((n, [, , k]) => n + k, 0);
    const of = (name) => pairs.reduce((n, [a, b, k]) => n + (a === name || b === name ? k : 0), 0);
    assert.ok(all > 0 && of("ramp") > 0 && of("upper") < all, `${JSON.stringify(pairs)}`);
    await page.evaluate(() => (sinew.setFrame(26), sinew.toggle("marks", true)));
    assert.equal(await drawn(page), all);
    await page.locator("label:has(input[name=marksOfSelection])").click();
    assert.equal(await drawn(page), all, "nothing is selected");
    for (const name of ["ramp", "sliding", "sticking"]) {
        await page.evaluate((n) => sinew.selectBody(n), name);
        assert.equal(await drawn(page), of(name), name);
    }
    await page.keyboard.press("o");
    assert.equal(await drawn(page), all);
    assert.deepEqual(page.problems, []);
});

test("over a contact the pointer shows its force and its bodies, and the legend marks it", async () => {
    const page = await openPage(file);
    const [at, value] = await page.evaluate(() => {
        sinew.setFrame(26);
        sinew.toggle("marks", true);
        sinew.look("front");
        const group = sinew.scene.frames[25].marks.find((g) => g.term === "contact"), sliding = sinew.scene.bodies.findIndex((b) => b.name === "sliding");
        const i = Array.from({ length: group.numbers.length / 7 }, (_, k) => k).find((k) => group.bodies[2 * k] === sliding);
        return [sinew.project(Array.from(group.numbers.subarray(7 * i, 7 * i + 3))), group.numbers[7 * i + 6]];
    });
    assert.ok(value >= 0);
    await page.mouse.move(...at);
    await page.waitForTimeout(600);
    const lines = (await page.locator(".probe").innerText()).split("\n").filter(Boolean);
    assert.match(lines[0], /^Contact: force \S+ N$/);
    assert.equal(lines[1], "sliding in ramp");
    assert.notEqual(await page.locator('.legend-card[data-quantity="marks N"] .legend-tick').evaluate((e) => (e.hidden ? null : e.style.left)), null);
    assert.deepEqual(page.problems, []);
});

test("the address holds the filter", async () => {
    const link = `${pathToFileURL(file).href}#frame=26&show=marks&marks=selection&body=sticking`, page = await openPage(file, {}, link);
    assert.equal(await page.evaluate(() => sinew.state.marksOfSelection), true);
    await page.evaluate(() => sinew.setFrame(20));
    await page.waitForTimeout(400);
    assert.match(await page.evaluate(() => location.hash), /marks=selection/);
    await page.keyboard.press("o");
    await page.waitForTimeout(400);
    assert.doesNotMatch(await page.evaluate(() => location.hash), /marks=selection/);
    assert.deepEqual(page.problems, []);
});

test("switches, keys and the fresh page follow the one list of overlays", async () => {
    const page = await openPage(file);
    assert.deepEqual(await page.evaluate(() => Object.entries(sinew.state.overlays)), overlayList.map((o) => [o.name, Boolean(o.fresh)]));
    for (const { name, key, noun } of overlayList) {
        const was = await page.evaluate((n) => sinew.state.overlays[n], name);
        const there = ["lattice", "marks", "grid"].includes(name); // this run has no fibres and no attachments
        await page.keyboard.press(key);
        assert.equal(await page.evaluate((n) => sinew.state.overlays[n], name), there ? !was : was, name);
        if (!there) assert.match(await page.locator(".toast").innerText(), new RegExp(`no ${noun}`));
    }
    assert.deepEqual(page.problems, []);
});
