// SPDX-License-Identifier: GPL-3.0-or-later
// Runs with something wrong: the page opens with what there is, and says what is not.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtemp, readdir, readFile, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { closeBrowser, openPage, pixels, root, sinew } from "./browser.mjs";

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

test("a body that is missing in the first frame is seen in the others", async () => {
    const { err, page } = await run({ "a.1.obj": "", "a.2.obj": cube(0), "a.3.obj": cube(1) });
    assert.match(err, /nothing for frame 1/);
    await page.evaluate(() => sinew.setFrame(2));
    assert.ok((await pixels(page)).share > 0.02);
    assert.deepEqual(await page.evaluate(() => sinew.scene.bounds), [[0, 0, 0], [2, 1, 1]]);
});

/** A sphere of `n` x `n` vertices that breathes; `wild(v, f)` gives a factor. */
function sphere(f, wild = () => 1, n = 24) {
    const lines = [];
    for (let i = 0; i < n; ++i) for (let k = 0; k < n; ++k) {
        const a = (Math.PI * i) / (n - 1), b = (2 * Math.PI * k) / n, r = (10 + Math.sin(f / 3 + 3 * a)) * wild(i * n + k, f);
        lines.push(`v ${r * Math.sin(a) * Math.cos(b)} ${r * Math.cos(a)} ${r * Math.sin(a) * Math.sin(b)}`);
    }
    for (let i = 1; i < n; ++i) for (let k = 0; k < n; ++k) {
        const [p, q] = [(i - 1) * n + k + 1, (i - 1) * n + ((k + 1) % n) + 1];
        lines.push(`f ${p} ${p + n} ${q + n} ${q}`);
    }
    return lines.join("\n");
}
const positions = (obj) => obj.split("\n").filter((l) => l.startsWith("v ")).map((l) => l.slice(2).split(" ").map(Number));

test("a frame that flies apart is named and marked, and leaves the others exact and in sight", async () => {
    const files = {};
    for (let f = 1; f <= 22; ++f) files[`ball.${f}.obj`] = sphere(f, (v) => (f === 20 && v % 29 === 0 ? 1e4 : 1));
    const { code, err, page } = await run(files);
    assert.equal(code, 0);
    assert.match(err, /Frame 20: ball reaches \S+ times as far/);
    assert.match(await page.locator(".banner").innerText(), /Frame 20/);
    const good = positions(files["ball.10.obj"]);
    await page.evaluate(() => sinew.setFrame(10));
    for (const v of [0, 29, 100, 333, 575]) {
        const found = await page.evaluate((i) => sinew.drawnPosition("ball", i), v);
        assert.ok(Math.hypot(...found.map((x, c) => x - good[v][c])) < 1e-4 * 20, `${found} for ${good[v]}`);
    }
    assert.ok((await pixels(page)).share > 0.1, "the camera stays with the good frames");
    const far = await page.evaluate(() => (sinew.setFrame(20), sinew.drawnPosition("ball", 29)));
    assert.ok(Math.hypot(...far) > 5e4, `${far}`);
    const before = await page.evaluate(() => sinew.picture());
    await page.keyboard.press("f");
    assert.notEqual(await page.evaluate(() => sinew.picture()), before);
    await page.evaluate(() => sinew.setFrame(10));
    await page.keyboard.press("f");
    assert.ok((await pixels(page)).share > 0.1, "and back");
    const mark = (frame) => page.evaluate((f) => {
        const canvas = document.querySelector(".timeline-canvas"), r = canvas.getBoundingClientRect();
        return [...canvas.getContext("2d").getImageData(sinew.timelineX(f) - r.left, 16, 1, 1).data].join();
    }, frame);
    assert.equal(await mark(20), "192,38,168,255");
    assert.notEqual(await mark(12), "192,38,168,255");
    assert.match(await page.locator(".timeline-key").innerText(), /flies apart/);
    assert.deepEqual(page.problems, []);
});

test("numbers that no float holds leave the good frames as they are", async () => {
    const { err, page } = await run({ "a.1.obj": cube(0), "a.2.obj": cube(0).replace("v 1 0 0", "v 1e50 0 0"), "a.3.obj": cube(1) });
    assert.match(err, /Frame 2: a has coordinates that are no numbers/);
    for (const frame of [1, 2, 3]) {
        await page.evaluate((f) => sinew.setFrame(f), frame);
        assert.ok((await pixels(page)).share > 0.02, `${frame}`);
    }
    assert.ok(Math.abs((await page.evaluate(() => sinew.drawnPosition("a", 1)))[0] - 2) < 1e-4);
});

test("a frame beyond what any mesh may be is named and hidden, the good frames play", async () => {
    const { err, page } = await run({ "a.1.obj": cube(0), "a.2.obj": cube(0).replace("v 1 0 0", "v 1e300 0 0"), "a.3.obj": cube(1) });
    assert.match(err, /a\.2\.obj: vertex 1 lies more than 1e60 from the origin/);
    assert.match(err, /a: nothing for frame 2; hidden there/);
    for (const frame of [1, 3]) {
        await page.evaluate((f) => sinew.setFrame(f), frame);
        assert.ok((await pixels(page)).share > 0.02, `${frame}`);
    }
    assert.ok(Math.abs((await page.evaluate(() => sinew.drawnPosition("a", 1)))[0] - 2) < 1e-4);
});

const graph = "graphs/learn/02_muscle_pulls.json";
const runaway = ["--set", 'plateLift.translate={"keys":[[3,[0,10.5,0]],[4,[1e9,0,0]]]}'];

test("a run that fails says so: in its page, in its report, and to whoever looks at its folder", async () => {
    const out = path.join(folder, "failed"), bare = path.join(folder, "failed bare");
    const failed = await sinew("run", graph, "--frames", "1-6", ...runaway, "--out", out, "--report", path.join(out, "report.json"), "--open");
    assert.equal(failed.code, 3);
    assert.match(failed.out, /^open file:/m);
    const report = JSON.parse(await readFile(path.join(out, "report.json"), "utf8"));
    assert.deepEqual([report.error.frame, report.error.code, report.frames.length], [4, "FE302", 3]);
    const page = await openPage(path.join(out, "view.html"));
    assert.match(await page.locator(".banner").innerText(), /ended before frame 4.*FE302/);
    assert.deepEqual(await page.evaluate(() => sinew.frames), [1, 2, 3]);
    const later = await sinew("view", out);
    assert.equal(later.code, 0);
    assert.match(later.err, /ended before frame 4/);
    assert.match(later.out, /kept .*view\.html/); // that one has more in it
    assert.ok((await readdir(out)).includes("view_files.html"));

    await sinew("run", graph, "--frames", "1-6", ...runaway, "--out", bare, "--quiet");
    assert.match((await sinew("view", bare)).err, /ended before frame 4.*FE302/);
    assert.equal((await sinew("run", graph, "--frames", "1-6", "--out", bare, "--quiet")).code, 0);
    assert.equal((await sinew("view", bare)).err, "", "a later run that is through clears the mark");
});

test("a killed run says so", async () => {
    const out = path.join(folder, "killed");
    const program = process.env.SINEW_PROGRAM ?? path.join(root, "build/release/tools/sinew");
    const child = spawn(program, ["run", "graphs/scenes/arm.json", "--out", out, "--format", "obj"], { cwd: root, stdio: "ignore" });
    const objs = async () => (await readdir(path.join(out, "obj")).catch(() => [])).length;
    while ((await objs()) < 25) await new Promise((done) => setTimeout(done, 50));
    assert.match((await sinew("view", out, "-o", path.join(folder, "now.html"))).err, /still writing/);
    child.kill("SIGKILL");
    await new Promise((done) => child.on("exit", done));
    const { code, err } = await sinew("view", out);
    assert.equal(code, 0);
    assert.match(err, /was killed before it was through. It was to give 128 frames/);
    assert.ok(err.trim().split("\n").length <= 3, err);
});

test("frames of an older run are stale: named, and not played", async () => {
    const out = path.join(folder, "stale"), report = ["--report", path.join(out, "report.json"), "--format", "obj", "--quiet"];
    await sinew("run", graph, "--frames", "1-8", "--out", out, ...report);
    await sinew("run", graph, "--frames", "1-5", "--set", "fibre.contractionLimit=0.4", "--out", out, ...report);
    const { err } = await sinew("view", out);
    assert.match(err, /Frames 6-8 are stale/);
    const page = await openPage(path.join(out, "view.html"));
    assert.deepEqual(await page.evaluate(() => sinew.frames), [1, 2, 3, 4, 5]);
    // Ranges that share a folder, each with its own report, belong together.
    const farm = path.join(folder, "farm");
    for (const range of ["1-4", "5-8"])
        await sinew("run", graph, "--frames", range, "--out", farm, "--format", "obj", "--quiet", "--report", path.join(farm, `${range}.json`));
    const whole = await sinew("view", farm);
    assert.equal(whole.err, "");
    assert.match(whole.out, /8 frames/);
});

test("the folder of a default run is shown from its GLB, as exact as the OBJ files", async () => {
    const out = path.join(folder, "plain");
    await sinew("run", graph, "--frames", "1-30", "--out", out, "--format", "glb,obj", "--quiet");
    const expected = positions(await readFile(path.join(out, "obj/belly.0030.obj"), "utf8"));
    await rm(path.join(out, "obj"), { recursive: true });
    const view = await sinew("view", out);
    assert.equal(view.code, 0, view.err);
    assert.equal(view.err, "");
    const page = await openPage(path.join(out, "view.html"));
    assert.deepEqual(await page.evaluate(() => [sinew.frames.length, ...sinew.scene.bodies.map((b) => `${b.name} ${b.kind} ${b.vertices}`)]),
        [30, "plate bone 8", `belly tissue ${expected.length}`]);
    const found = await page.evaluate((n) => (sinew.setFrame(30), [...Array(n).keys()].map((v) => sinew.vertexPosition("belly", v))), expected.length);
    for (const p of expected) assert.ok(found.some((q) => Math.hypot(...q.map((x, c) => x - p[c])) < 1e-3), `${p}`);
    assert.ok((await pixels(page)).share > 0.02);
    await writeFile(path.join(out, "02_muscle_pulls.glb"), "glTF");
    const damaged = await sinew("view", out);
    assert.equal(damaged.code, 1);
    assert.match(damaged.err, /cannot be shown: the file does not begin with glTF/);
});

test("a report that is damaged or odd is told, and the frames play", async () => {
    const broken = await run({ "a.1.obj": cube(0), "report.json": '{"frames": [{"frame": 1, "wa' });
    assert.match(broken.err, /report.json is damaged/);
    const odd = await run({ "a.1.obj": cube(0), "report.json": JSON.stringify({ frames: [{ frame: 1, newton: 1e20, residual: null, phases: { solve: -1, assembly: 0.1 } }] }) });
    assert.match(odd.err, /2 values cannot be right/);
    assert.deepEqual(odd.page.problems, []);
});

test("the number of vertices that most frames have is the right one", async () => {
    const { err, page } = await run({ "a.1.obj": cube(0), "a.2.obj": cube(1, 5), "a.3.obj": cube(2, 5), "a.4.obj": cube(3, 5) });
    assert.match(err, /a has 13 vertices, but another number in frame 1/);
    assert.deepEqual(await page.evaluate(() => sinew.frames.map((f) => (sinew.setFrame(f), sinew.drawn().length))), [0, 1, 1, 1]);
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
    const place = await sinew("view", graph, "-o", folder);
    assert.equal(place.code, 2);
    assert.match(place.err, /names the folder/);
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
