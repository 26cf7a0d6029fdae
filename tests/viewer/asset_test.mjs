// SPDX-License-Identifier: GPL-3.0-or-later
// The committed asset is what the sources give.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const viewer = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../tools/viewer");

test("tools/viewer/asset is up to date (tools/viewer/build_page makes it)", () => {
    const folder = mkdtempSync(path.join(os.tmpdir(), "sinew-asset-"));
    try {
        execFileSync(path.join(viewer, "build_page"), [folder], { stdio: "pipe" });
        for (const name of ["viewer.js", "viewer.css"])
            assert.ok(readFileSync(path.join(folder, name)).equals(readFileSync(path.join(viewer, "asset", name))), name);
        assert.equal(readFileSync(path.join(viewer, "page/node_modules/three/LICENSE"), "utf8"),
            readFileSync(path.join(viewer, "asset/LICENSE.three.txt"), "utf8"));
    } finally {
        rmSync(folder, { recursive: true, force: true });
    }
});

test("sources are short, carry the licence, and the lock files name no registry", () => {
    for (const name of readdirSync(path.join(viewer, "page/src"))) {
        const text = readFileSync(path.join(viewer, "page/src", name), "utf8");
        assert.ok(text.includes("SPDX-License-Identifier: GPL-3.0-or-later"), name);
        assert.ok(text.split("\n").length < 400, name);
    }
    for (const lock of [path.join(viewer, "page/package-lock.json"), fileURLToPath(new URL("package-lock.json", import.meta.url))])
        assert.ok(!/"resolved"|https?:\/\/(?!github|opencollective|paulmillr)/.test(readFileSync(lock, "utf8")), lock);
});
