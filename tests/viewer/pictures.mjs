// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the pictures of docs/concepts/viewer.md and of one demo: node tests/viewer/pictures.mjs [FOLDER], by default docs/images.
import { mkdtemp, rm } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { closeBrowser, openPage, root, sinew } from "./browser.mjs";

const out = path.resolve(process.argv[2] ?? path.join(root, "docs/images"));
const folder = await mkdtemp(path.join(os.tmpdir(), "sinew-pictures-"));
const file = path.join(folder, "arm.html");
const view = await sinew("view", "graphs/scenes/arm.json", "-o", file, "--quiet");
if (view.code !== 0) throw new Error(view.err);

const page = await openPage(file, { viewport: { width: 1280, height: 800 } });
const shoot = async (name, target = page) => {
    await new Promise((done) => setTimeout(done, 300));
    await target.screenshot({ path: path.join(out, `${name}.png`) });
};
await page.evaluate(() => (sinew.setFrame(64), sinew.set({ theme: "light" }), sinew.look("corner")));
await shoot("viewer_page");
await page.evaluate(() => {
    sinew.set({ theme: "dark", panel: "graph" });
    sinew.selectBody("biceps");
    sinew.look("corner");
});
await shoot("viewer_graph_dark");

// The arm at three frames with fibres, tets and attachments on.
await page.setViewportSize({ width: 1180, height: 520 });
await page.evaluate(() => {
    sinew.selectNode(null);
    sinew.set({ theme: "light", panelOpen: false, filledLattice: false });
    for (const overlay of ["fibres", "lattice", "attachments"]) sinew.toggle(overlay, true);
    sinew.toggle("grid", false);
});
for (const frame of [1, 33, 64]) {
    await page.evaluate((f) => {
        sinew.setFrame(f);
        sinew.look("corner");
        document.querySelector('[aria-label^="Frame the selection"]').click();
    }, frame);
    await shoot(`viewer_overlays_${String(frame).padStart(3, "0")}`, page.locator("main.view"));
}
// A cut through the tets, coloured by what they feel.
await page.evaluate(() => {
    for (const overlay of ["fibres", "attachments"]) sinew.toggle(overlay, false);
    sinew.set({ filledLattice: true, colourBy: "stretch", cut: { on: true, axis: 1, at: 0.45, flip: false } });
    sinew.draw();
});
await shoot("viewer_cut", page.locator("main.view"));
await page.context().close();

// How a hollow ball is filled and refined: the demo of it, cut in the middle and seen from the front.
const balls = path.join(folder, "balls.html");
const made = await sinew("view", "graphs/demos/fill_and_refinement.json", "-o", balls, "--frames", "1", "--quiet");
if (made.code !== 0) throw new Error(made.err);
const tets = await openPage(balls, { viewport: { width: 1180, height: 820 } });
await tets.evaluate(() => {
    sinew.setFrame(1);
    sinew.set({ theme: "light", panelOpen: false, filledLattice: true, wholeTets: true });
    sinew.set({ cut: { on: true, axis: 2, at: 0.5, flip: false } });
    sinew.toggle("lattice", true);
    sinew.toggle("grid", false);
    sinew.look("front");
    sinew.draw();
});
await shoot("fill_and_refinement", tets.locator("main.view"));
page.problems.push(...tets.problems);
await closeBrowser();
await rm(folder, { recursive: true, force: true });
if (page.problems.length) throw new Error(page.problems.join("\n"));
