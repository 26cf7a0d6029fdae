// SPDX-License-Identifier: GPL-3.0-or-later
// Tets and fibres of the arm as they are drawn: in the flesh, or on its skin.
import assert from "node:assert/strict";
import { mkdtemp, rm } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { closeBrowser, openPage, sinew } from "./browser.mjs";
import { InsideTest } from "./inside.mjs";

let folder, page;
before(async () => {
    folder = await mkdtemp(path.join(os.tmpdir(), "sinew-view-"));
    const file = path.join(folder, "arm.html");
    const view = await sinew("view", "graphs/scenes/arm.json", "--frames", "1-20", "-o", file, "--quiet");
    assert.equal(view.code, 0, view.err);
    page = await openPage(file);
});
after(async () => {
    await closeBrowser();
    await rm(folder, { recursive: true, force: true });
});

/** Distance of a point from a triangle. */
function apart(p, a, b, c) {
    const sub = (x, y) => x.map((v, i) => v - y[i]), dot = (x, y) => x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    const edge = (u, v) => {
        const d = sub(v, u), t = Math.min(1, Math.max(0, dot(sub(p, u), d) / (dot(d, d) || 1)));
        return Math.hypot(...u.map((x, i) => x + t * d[i] - p[i]));
    };
    const u = sub(b, a), v = sub(c, a), w = sub(p, a), n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v), d = uv * uv - uu * vv;
    const s = (uv * wv - vv * wu) / d, t = (uv * wu - uu * wv) / d;
    if (s >= 0 && t >= 0 && s + t <= 1) return Math.abs(dot(w, n)) / Math.hypot(...n);
    return Math.min(edge(a, b), edge(b, c), edge(c, a));
}

/** The farthest that any of `points` lies outside of a body. */
function farthest({ rest, triangles }, points) {
    const inside = new InsideTest(rest, triangles);
    const corner = (v) => rest.slice(3 * v, 3 * v + 3);
    let worst = 0;
    for (let i = 0; i < points.length; i += 3) {
        const p = points.slice(i, i + 3);
        if (inside.contains(...p)) continue;
        let near = Infinity;
        for (let t = 0; t < triangles.length; t += 3) near = Math.min(near, apart(p, ...[0, 1, 2].map((k) => corner(triangles[t + k]))));
        worst = Math.max(worst, near);
    }
    return worst;
}
const bodyOf = (name) => page.evaluate((n) => {
    const b = sinew.scene.bodies.find((x) => x.name === n);
    return { rest: Array.from(b.positionsAt(sinew.state.frame)), triangles: Array.from(b.triangles, (v) => (b.shading ? b.shading[v] : v)) };
}, name);

test("tets are drawn to the skin and not beyond, at rest and moved; whole ones on demand", async () => {
    await page.evaluate(() => sinew.toggle("lattice", true));
    for (const [name, frame] of [["biceps", 1], ["coracobrachialis", 1], ["biceps", 20], ["tricepsLong", 20]]) {
        await page.evaluate((f) => (sinew.set({ wholeTets: false }), sinew.setFrame(f)), frame);
        const body = await bodyOf(name), drawn = await page.evaluate((n) => sinew.drawnTets(n), name);
        const own = farthest(body, drawn);
        await page.evaluate(() => sinew.set({ wholeTets: true }));
        const whole = farthest(body, await page.evaluate((n) => sinew.drawnTets(n), name));
        console.log(`${name} at ${frame}: ${own.toFixed(4)} cm beyond the flesh, whole tets ${whole.toFixed(2)} cm`);
        assert.ok(own < 0.05, `${name} at ${frame}: ${own}`);
        assert.ok(whole > 0.5, `${whole}`);
    }
    await page.evaluate(() => (sinew.toggle("lattice", false), sinew.set({ wholeTets: false })));
});

test("fibres begin and end in the flesh", async () => {
    await page.evaluate(() => sinew.toggle("fibres", true));
    for (const [name, frame, most] of [["biceps", 1, 0.05], ["coracobrachialis", 1, 0.05], ["tricepsLong", 1, 0.05], ["biceps", 20, 0.12]]) {
        await page.evaluate((f) => sinew.setFrame(f), frame);
        const ends = await page.evaluate((n) => sinew.drawnFibres(n), name), far = farthest(await bodyOf(name), ends);
        console.log(`${name} at ${frame}: ${ends.length / 6} fibres, ${far.toFixed(4)} cm beyond the flesh`);
        assert.ok(far < most, `${name} at ${frame}: ${far}`);
        assert.ok(ends.length / 6 > 100);
    }
    await page.evaluate(() => sinew.toggle("fibres", false));
    assert.deepEqual(page.problems, []);
});
