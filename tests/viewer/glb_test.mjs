// SPDX-License-Identifier: GPL-3.0-or-later
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { sinew } from "./browser.mjs";

test("the arm's GLB has no error and no warning", async () => {
    const folder = mkdtempSync(path.join(os.tmpdir(), "sinew-glb-"));
    try {
        const run = await sinew("run", "graphs/scenes/arm.json", "--out", folder, "--quiet");
        assert.equal(run.code, 0, run.err);
        const script = fileURLToPath(new URL("validate_glb.mjs", import.meta.url));
        console.log(execFileSync(process.execPath, [script, path.join(folder, "arm.glb")], { encoding: "utf8" }).trim());
    } finally {
        rmSync(folder, { recursive: true, force: true });
    }
});
