// SPDX-License-Identifier: GPL-3.0-or-later
// How long a save of the arm with another material takes to the first new frame, in the program and in the page, and to
// all frames: tests/viewer/run live_bench.mjs. Wanted on a quiet machine: half a second to the first.
import { spawn } from "node:child_process";
import { cp, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { test } from "node:test";
import { closeBrowser, openBrowser, program, root } from "./browser.mjs";

test("a save of the arm with another material is soon seen", async () => {
    const folder = await mkdtemp(path.join(os.tmpdir(), "sinew-live-bench-"));
    let child;
    try {
        await cp(path.join(root, "graphs"), path.join(folder, "graphs"), { recursive: true });
        const file = path.join(folder, "graphs/scenes/arm.json");
        child = spawn(program, ["live", file, "--no-cache"]);
        let told = "";
        const url = await new Promise((resolve, reject) => {
            child.stdout.on("data", (text) => {
                const found = (told += text).match(/open (http:\S+)/);
                if (found) resolve(found[1]);
            });
            child.on("exit", (code) => reject(new Error(`ended with ${code}: ${told}`)));
        });
        const page = await (await (await openBrowser()).newContext({ viewport: { width: 1280, height: 800 } })).newPage();
        // The page itself notes when: to ask it every few milliseconds would take from the time to draw.
        await page.addInitScript(() => {
            if (window !== window.top) return;
            window.since = {};
            new MutationObserver((changes) => {
                for (const { attributeName: key } of changes) window.since[key] ??= Date.now();
            }).observe(document, { subtree: true, attributeFilter: ["data-preview", "data-page"] });
        });
        await page.goto(url);
        const ready = (run) => page.waitForFunction((run) => {
            const { state, run: at, page: number, newest } = document.documentElement.dataset;
            return state === "ready" && Number(at) >= run && number === newest;
        }, run, { timeout: 120000, polling: 20 });
        const status = async () => (await fetch(`${url}status`)).json();
        await ready(1);
        const text = await readFile(file, "utf8");
        for (let turn = 1; turn <= 5; ++turn) {
            // Nobody saves in the moment in which the run before comes to its end and the browser is at work on its page.
            await new Promise((rested) => setTimeout(rested, 1000));
            const before = await status();
            await page.evaluate(() => (window.since = {}));
            const changed = text.replace(/"youngsModulus": *12000/, `"youngsModulus": ${12000 + 10 * turn}`);
            if (changed === text) throw new Error("the arm has no material of 12000 Pa");
            const begin = Date.now();
            await writeFile(file, changed);
            await ready(before.run + 1);
            const all = Date.now() - begin, after = await status(), since = await page.evaluate(() => window.since);
            const first = since["data-preview"] - begin, whole = since["data-page"] - begin;
            if (!(first > 0 && whole > 0)) throw new Error("the page has shown nothing new");
            const s = (ms) => `${(ms / 1000).toFixed(2)} s`;
            console.log(`first new frame: program ${after.preview_s.toFixed(2)} s, seen after ${s(first)}, its page after ${s(whole)}; `
                + `all: ${after.all_s.toFixed(1)} s, seen after ${s(all)}; ${after.simulated} simulated`);
        }
    } finally {
        child?.kill("SIGKILL");
        await closeBrowser();
        await rm(folder, { recursive: true, force: true });
    }
});
