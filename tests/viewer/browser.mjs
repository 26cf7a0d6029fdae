// SPDX-License-Identifier: GPL-3.0-or-later
// A browser, pages from disk, and the program that makes them.
import { execFile } from "node:child_process";
import { existsSync } from "node:fs";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { promisify } from "node:util";
import { chromium } from "playwright-core";

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
export const program = process.env.SINEW_PROGRAM ?? path.join(root, "build/release/tools/sinew");
if (!existsSync(program)) throw new Error(`${program} is not built; say where it is with SINEW_PROGRAM`);

/** Runs sinew; gives {code, out, err}. */
export async function sinew(...words) {
    try {
        const { stdout, stderr } = await promisify(execFile)(program, words, {
            cwd: root, maxBuffer: 1 << 26, env: { ...process.env, SINEW_KEEP_FRAMES: "off" },
        });
        return { code: 0, out: stdout, err: stderr };
    } catch (e) {
        return { code: e.code, out: e.stdout, err: e.stderr };
    }
}

let browser = null;
export async function openBrowser() {
    browser ??= await chromium.launch({
        executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
        args: ["--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
    });
    return browser;
}
export async function closeBrowser() {
    await browser?.close();
    browser = null;
}

/** Opens a page from disk and waits until it is ready. `page.problems` and `page.requests` collect what must not be. */
export async function openPage(file, options = {}, link = pathToFileURL(file).href) {
    const context = await (await openBrowser()).newContext({ viewport: { width: 1280, height: 800 }, offline: true, ...options });
    const page = await context.newPage();
    page.problems = [];
    page.requests = [];
    page.on("console", (m) => m.type() === "error" && page.problems.push(m.text()));
    page.on("pageerror", (e) => page.problems.push(e.message));
    page.on("request", (r) => page.requests.push(r.url()));
    await page.goto(link);
    await page.waitForFunction(() => document.documentElement.dataset.ready, null, { timeout: 120000 });
    return page;
}

/** Whether a 5 x 5 patch of the canvas shows nothing but the background; points of the page in CSS pixels. The ground must
    be off. */
export async function isEmpty(page, points) {
    const url = await page.evaluate(() => sinew.picture());
    return page.evaluate(async ([data, list]) => {
        const image = new Image();
        image.src = data;
        await image.decode();
        const canvas = document.createElement("canvas"), r = document.querySelector(".canvas").getBoundingClientRect();
        (canvas.width = image.width), (canvas.height = image.height);
        const g = canvas.getContext("2d"), s = image.width / r.width;
        g.drawImage(image, 0, 0);
        const [a, b, c] = g.getImageData(0, 0, 1, 1).data;
        return list.map(([x, y]) => {
            const p = g.getImageData(Math.round((x - r.left) * s) - 2, Math.round((y - r.top) * s) - 2, 5, 5).data;
            for (let i = 0; i < p.length; i += 4) if (Math.abs(p[i] - a) + Math.abs(p[i + 1] - b) + Math.abs(p[i + 2] - c) > 6) return false;
            return true;
        });
    }, [url, points]);
}

/** Share of the canvas's pixels that differ from its corner, and the number of colours. */
export async function pixels(page) {
    const url = await page.evaluate(() => window.sinew.picture());
    return page.evaluate(async (data) => {
        const image = new Image();
        image.src = data;
        await image.decode();
        const canvas = document.createElement("canvas");
        canvas.width = image.width;
        canvas.height = image.height;
        const g = canvas.getContext("2d");
        g.drawImage(image, 0, 0);
        const p = g.getImageData(0, 0, image.width, image.height).data, colours = new Set();
        let different = 0;
        for (let i = 0; i < p.length; i += 4) {
            if (Math.abs(p[i] - p[0]) + Math.abs(p[i + 1] - p[1]) + Math.abs(p[i + 2] - p[2]) > 24) ++different;
            colours.add((p[i] << 16) | (p[i + 1] << 8) | p[i + 2]);
        }
        return { share: different / (p.length / 4), colours: colours.size };
    }, url);
}
