// SPDX-License-Identifier: GPL-3.0-or-later
// `sinew live` in a browser: what a save, a broken save and a change in the page do to what is seen.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { cp, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, openBrowser, program, root } from "./browser.mjs";

const running = new Set();
let folder;
before(async () => (folder = await mkdtemp(path.join(os.tmpdir(), "sinew-live-"))));
after(async () => {
    for (const child of running) child.kill("SIGKILL");
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

/** Starts the program; gives {page, url, file, stop}. */
async function live(graph, ...words) {
    const copy = path.join(folder, "graphs");
    await cp(path.join(root, "graphs"), copy, { recursive: true, force: true });
    const file = path.join(copy, graph);
    const child = spawn(program, ["live", file, "--no-cache", ...words]);
    running.add(child);
    child.on("exit", () => running.delete(child));
    let told = "";
    const url = await new Promise((resolve, reject) => {
        child.stdout.on("data", (text) => {
            const found = (told += text).match(/open (http:\S+)/);
            if (found) resolve(found[1]);
        });
        child.stderr.on("data", (text) => (told += text));
        child.on("exit", (code) => reject(new Error(`ended with ${code}: ${told}`)));
    });
    const page = await (await (await openBrowser()).newContext({ viewport: { width: 1280, height: 800 } })).newPage();
    page.problems = [];
    page.hosts = new Set();
    page.on("pageerror", (e) => page.problems.push(e.message));
    page.on("request", (r) => page.hosts.add(new URL(r.url()).hostname));
    await page.goto(url);
    const stop = async () => {
        const ended = new Promise((resolve) => child.on("exit", (code) => resolve(code)));
        child.kill("SIGINT");
        return ended;
    };
    return { page, url, file, stop, status: async () => (await fetch(`${url}status`)).json() };
}

const isReady = (page, run) => page.waitForFunction((run) => {
    const { state, run: at, page: number, newest } = document.documentElement.dataset, frames = document.querySelectorAll("iframe");
    return state === "ready" && Number(at) >= run && frames.length === 1 && number === newest;
}, run, { timeout: 20000, polling: 50 });
/** Runs in the page that is shown. */
const inside = (page, action, ...words) => page.frames().find((f) => f.url().includes("/page/")).evaluate(action, ...words);

test("a save shows the new run, keeps camera and frame, and a broken save keeps the last picture", async () => {
    const { page, file, stop, status } = await live("learn/02_muscle_pulls.json", "--frames", "1-12");
    await isReady(page, 1);
    assert.deepEqual(await inside(page, () => sinew.frames), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
    await inside(page, () => (sinew.setFrame(9), sinew.look("left")));
    const body = await inside(page, () => sinew.scene.bodies.findIndex((b) => b.lattice));
    const before = await inside(page, (b) => sinew.vertexPosition(b, 0), body), first = await status();
    assert.equal(first.simulated, 12);

    const text = await readFile(file, "utf8");
    const graph = JSON.parse(text), solver = Object.keys(graph.nodes).find((n) => graph.nodes[n].type === "zSolver");
    graph.nodes[solver].inputs.gravity = [0, -30, 0];
    // The first new frame is seen in the page of the last run, before there is another one.
    const previews = page.evaluate(() => new Promise((resolve) => new MutationObserver(() => {
        const sinew = document.querySelector("iframe:not(.next)").contentWindow.sinew;
        resolve([sinew.frame, ...sinew.scene.bodies.map((b) => [...b.positionsAt(sinew.frames.indexOf(sinew.frame)).slice(0, 30)])]);
    }).observe(document.documentElement, { attributeFilter: ["data-preview"] })));
    const framesBefore = await inside(page, () => sinew.scene.bodies.map((b) => [...b.positionsAt(1).slice(0, 30)]));
    await writeFile(file, JSON.stringify(graph));
    const [previewed, ...there] = await previews;
    assert.equal(previewed, 2); // the start is as it was
    await isReady(page, first.run + 1);
    const framesAfter = await inside(page, () => sinew.scene.bodies.map((b) => [...b.positionsAt(1).slice(0, 30)]));
    assert.notDeepEqual(framesAfter, framesBefore);
    there.forEach((positions, b) => positions.forEach((x, k) => assert.ok(Math.abs(x - framesAfter[b][k]) < 1e-3, `${b} ${k}`)));
    assert.equal(await inside(page, () => sinew.frame), 9);
    assert.notDeepEqual(await inside(page, (b) => sinew.vertexPosition(b, 0), body), before);

    // Back to what it was: nothing is simulated again.
    await writeFile(file, text);
    await isReady(page, first.run + 2);
    assert.equal((await status()).simulated, 0);
    assert.deepEqual(await inside(page, (b) => sinew.vertexPosition(b, 0), body), before);

    await writeFile(file, text.replace('"zSolver"', '"zSolvr"'));
    await page.waitForFunction(() => document.documentElement.dataset.state === "wrong", null, { timeout: 20000, polling: 50 });
    assert.match(await page.locator("#told").innerText(), /zSolvr/);
    assert.deepEqual(await inside(page, (b) => sinew.vertexPosition(b, 0), body), before);
    await writeFile(file, text);
    await isReady(page, first.run + 4);
    assert.equal(await page.locator("#told").isVisible(), false);
    assert.deepEqual(page.problems, []);
    assert.deepEqual([...page.hosts], ["127.0.0.1"]);
    assert.equal(await stop(), 0);
});

test("an attribute changed in the page runs anew, is marked, and is written to the file with its order and comments", async () => {
    const { page, file, stop, status } = await live("learn/01_hanging_ball.json", "--frames", "1-4");
    await isReady(page, 1);
    const text = await readFile(file, "utf8");
    await page.getByRole("button", { name: "Attributes" }).click();
    const solver = Object.entries(JSON.parse(text).nodes).find(([, n]) => n.type === "zSolver")[0];
    await page.locator("#node").selectOption(solver);
    await page.locator("#input-substeps").fill("3");
    await page.locator("#input-substeps").press("Enter");
    await isReady(page, 2);
    assert.equal((await status()).simulated, 4);
    assert.match(await page.locator("#unsaved").innerText(), /^1 not in the file/);
    assert.equal(await readFile(file, "utf8"), text);
    await page.locator("#input-substeps").fill("-3");
    await page.locator("#input-substeps").press("Enter");
    await page.waitForFunction(() => document.getElementById("told").innerText.includes("substeps"));
    assert.equal((await status()).changes.length, 1);
    await page.getByRole("button", { name: "Write to file" }).click();
    await page.waitForFunction(() => document.getElementById("save").hidden);
    const written = JSON.parse(await readFile(file, "utf8"));
    assert.equal(written.nodes[solver].inputs.substeps, 3);
    assert.deepEqual(Object.keys(written.nodes), Object.keys(JSON.parse(text).nodes));
    assert.deepEqual(page.problems, []);
    assert.equal(await stop(), 0);
});

test("a key at the frame that is shown begins there: the frames before it are reused", async () => {
    const { page, stop, status } = await live("learn/01_hanging_ball.json", "--frames", "1-8");
    await isReady(page, 1);
    await inside(page, () => sinew.setFrame(6));
    const name = await page.evaluate(async () => (await (await fetch("nodes")).json()).find((n) => n.type === "zMaterial").name);
    await page.getByRole("button", { name: "Attributes" }).click();
    await page.locator("#node").selectOption(name);
    for (const [frame, value] of [[5, "1060"], [6, "2120"]]) {
        await inside(page, (f) => sinew.setFrame(f), frame);
        await page.locator("#input-massDensity").fill(value);
        await page.locator(".row", { has: page.locator("#input-massDensity") }).getByRole("button", { name: "Key" }).click();
        await isReady(page, frame - 3);
    }
    assert.equal((await status()).simulated, 3);
    assert.deepEqual(page.problems, []);
    await stop();
});
