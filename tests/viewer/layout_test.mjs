// SPDX-License-Identifier: GPL-3.0-or-later
// Windows of all sizes: phones, tablets, desks; the lower panel, the graph's neighbourhoods, little motion.
import assert from "node:assert/strict";
import { mkdtemp, rm } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, openPage, sinew } from "./browser.mjs";

let folder, file;
before(async () => {
    folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"));
    file = path.join(folder, "arm.html");
    const view = await sinew("view", "graphs/scenes/arm.json", "--frames", "1-3", "-o", file, "--quiet");
    assert.equal(view.code, 0, view.err);
});
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});
const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
const tablet = { viewport: { width: 820, height: 1180 }, hasTouch: true, isMobile: true };

/** Of all that can be pressed and is shown: what is smaller than a finger, and what lies outside of the window or over the
    edge of what scrolls sideways. Links in running text are text. */
const faultsOf = (page) => page.evaluate(() => {
    const small = [], outside = [];
    for (const e of document.querySelectorAll("button, select, input:not([type=checkbox]), label.toggle, .body-row")) {
        if (!e.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
        const r = e.getBoundingClientRect(), name = e.getAttribute("aria-label") ?? e.textContent;
        if (r.width < 44 - 0.5 || r.height < 44 - 0.5) if (!e.closest(".find") || e.closest(".find").getBoundingClientRect().height < 43.5) small.push([name, r.width, r.height]);
        if (r.left < -0.5 || r.right > innerWidth + 0.5) outside.push([name, r.left, r.right]);
    }
    for (const e of document.querySelectorAll(".top, .transport, .tabs, .side, .work, .legend, .inspector, .timeline-key"))
        if (e.checkVisibility({ visibilityProperty: true }) && e.scrollWidth > e.clientWidth + 1) outside.push([e.className, e.clientWidth, e.scrollWidth]);
    if (document.documentElement.scrollWidth > innerWidth) outside.push(["page", document.documentElement.scrollWidth]);
    return { small, outside };
});

for (const [name, device] of [["phone", phone], ["tablet", tablet], ["phone that lies", { ...phone, viewport: { width: 844, height: 390 } }]])
    test(`on a ${name} everything can be pressed with a finger, and nothing is cut off`, async () => {
        const page = await openPage(file, device);
        const none = { small: [], outside: [] };
        assert.deepEqual(await faultsOf(page), none);
        const view = await page.locator("main.view").boundingBox();
        assert.equal(view.width, device.viewport.width, "the view has the whole width");
        assert.ok(view.height > 0.4 * device.viewport.height, `${view.height}`);
        // The drawer, as a finger opens and closes it.
        assert.equal(await page.locator(".side").isVisible(), false);
        await page.locator(".drawer-button").tap();
        await page.waitForFunction(() => document.querySelector(".side").getBoundingClientRect().left === 0);
        assert.deepEqual(await faultsOf(page), none);
        await page.locator("label.toggle", { hasText: "Attachments" }).tap();
        await page.locator('select[aria-label="Colour by"]').selectOption("stretch");
        await page.locator('.body-row[data-body="biceps"]').scrollIntoViewIfNeeded();
        await page.locator('.body-row[data-body="biceps"] .name').tap();
        assert.deepEqual(await faultsOf(page), none);
        await page.touchscreen.tap(device.viewport.width - 12, 200);
        await page.locator(".side").waitFor({ state: "hidden" });
        assert.equal(await page.evaluate(() => sinew.state.selectedNode), "biceps");
        assert.equal(await page.evaluate(() => sinew.state.overlays.attachments), true);
        // With legends and what is selected, and with the graph.
        for (const panel of ["timeline", "graph"]) {
            await page.evaluate((p) => sinew.set({ panel: p, panelOpen: true }), panel);
            await page.waitForTimeout(100);
            assert.deepEqual(await faultsOf(page), none, panel);
        }
        if (device.viewport.width < 700) {
            assert.ok((await page.locator(".inspector").boundingBox()).height < 80, "its head alone, at first");
            await page.locator(".inspector .fold").tap();
            assert.match(await page.locator(".inspector").innerText(), /1,181 vertices/);
            assert.deepEqual(await faultsOf(page), none);
        }
        assert.deepEqual(page.problems, []);
    });

test("a tap tells the value under the finger", async () => {
    const page = await openPage(file, phone);
    const at = await page.evaluate(() => {
        sinew.setFrame(3);
        sinew.set({ colourBy: "stretch" });
        const n = sinew.scene.bodies.find((b) => b.name === "biceps").vertices;
        for (let v = 0; v < n; v += 3) {
            const p = sinew.project(sinew.vertexPosition("biceps", v));
            if ([-5, 0, 5].every((d) => sinew.bodyAt(p[0] + d, p[1] + d) === "biceps")) return p;
        }
        return null;
    });
    await page.touchscreen.tap(...at);
    await page.locator(".probe").waitFor();
    assert.match(await page.locator(".probe").innerText(), /^biceps\nLargest stretch [\d.]+ %\nvertex \d+$/);
    assert.equal(await page.evaluate(() => sinew.state.selectedNode), "biceps");
});

test("two fingers zoom the graph", async () => {
    const page = await openPage(file, phone);
    await page.evaluate(() => sinew.set({ panel: "graph" }));
    await page.waitForTimeout(100);
    const box = await page.locator(".graph-host").boundingBox(), wide = () => page.locator(".graph-host svg").evaluate((s) => Number(s.getAttribute("viewBox").split(" ")[2]));
    const before = await wide(), client = await page.context().newCDPSession(page), x = box.x + 195, y = box.y + box.height / 2;
    const touch = (type, half) => client.send("Input.dispatchTouchEvent", { type, touchPoints: half ? [{ x: x - half, y, id: 0 }, { x: x + half, y, id: 1 }] : [] });
    await touch("touchStart", 40);
    for (const half of [50, 60, 70, 80]) await touch("touchMove", half);
    await touch("touchEnd", 0);
    const ratio = before / (await wide());
    assert.ok(ratio > 1.6 && ratio < 2.4, `fingers twice as far apart, ${ratio} times as large`);
});

test("the lower panel takes a third of the window at most", async () => {
    for (const [width, height] of [[1440, 900], [1280, 800], [1920, 1080], [820, 1180], [390, 844], [1024, 600]]) {
        const page = await openPage(file, { viewport: { width, height } });
        for (const panel of ["timeline", "graph"]) {
            await page.evaluate((p) => sinew.set({ panel: p }), panel);
            const { height: tall } = await page.locator(".panel").boundingBox();
            assert.ok(tall <= height / 3 + 1 && tall > 100, `${tall} of ${height} at ${width}, ${panel}`);
        }
        await page.context().close();
    }
});

test("the graph panel fits the neighbourhood of what is selected", async () => {
    const page = await openPage(file, { viewport: { width: 1440, height: 900 } });
    await page.evaluate(() => sinew.set({ panel: "graph" }));
    const wires = await page.evaluate(() => sinew.scene.graph.wires.map((w) => w.slice(0, 2).map((i) => sinew.scene.graph.nodes[i].name)));
    for (const name of ["biceps", "solver", "bicepsToScapula", "scapulaMesh", "tricepsLong"]) {
        await page.evaluate((n) => sinew.selectNode(n), name);
        const found = await page.evaluate(() => {
            const host = document.querySelector(".graph-host").getBoundingClientRect();
            return [...document.querySelectorAll(".graph-host g.node")].map((g) => {
                const r = g.querySelector(".box").getBoundingClientRect();
                return [g.dataset.node, r.left >= host.left && r.right <= host.right && r.top >= host.top && r.bottom <= host.bottom, g.querySelector(".name").getBoundingClientRect().height];
            });
        });
        const wanted = [...new Set(wires.filter((w) => w.includes(name)).flat())].sort();
        assert.deepEqual(found.map(([n]) => n).sort(), wanted, name);
        assert.ok(found.every(([, inside]) => inside), `${name}: all in sight`);
        const least = Math.min(...found.map(([, , tall]) => tall));
        assert.ok(least > 7, `${name}: names of ${least} px`);
        assert.equal(await page.locator(".graph-host .wire").count(), wires.filter((w) => w.includes(name)).length);
    }
    // A click walks to a neighbour; the button shows the same node in the whole graph.
    await page.locator('.graph-host g.node[data-node="tricepsLongFibre"]').click();
    assert.equal(await page.evaluate(() => sinew.state.selectedNode), "tricepsLongFibre");
    await page.locator(".near-button").click();
    const all = await page.evaluate(() => sinew.scene.graph.nodes.length);
    assert.equal(await page.locator(".graph-host g.node").count(), all);
    const isSeen = await page.locator('.graph-host g.node[data-node="tricepsLong"]').evaluate((g) => {
        const r = g.getBoundingClientRect(), host = g.closest(".graph-host").getBoundingClientRect();
        return r.left >= host.left && r.right <= host.right;
    });
    assert.ok(isSeen, "its neighbour is in sight there too");
    await page.locator(".near-button").click();
    await page.evaluate(() => sinew.selectNode(null));
    assert.equal(await page.locator(".graph-host g.node").count(), all, "nothing selected: the whole graph");
    assert.deepEqual(page.problems, []);
});

test("who wants little motion gets none that was not asked for", async () => {
    const times = (page) => page.evaluate(() => [".switch", ".side"].map((s) => getComputedStyle(document.querySelector(s)).transitionDuration));
    const usual = await openPage(file, tablet);
    assert.ok((await times(usual)).some((t) => !/^(0s, )*0s$/.test(t)));
    assert.equal(await usual.evaluate(() => sinew.state.loop), true);
    const calm = await openPage(file, { ...tablet, reducedMotion: "reduce" });
    for (const t of await times(calm)) assert.match(t, /^(0s, )*0s$/);
    assert.equal(await calm.evaluate(() => sinew.state.loop), false, "played once, not round and round");
    assert.equal(await calm.evaluate(() => sinew.state.playing), false);
});
