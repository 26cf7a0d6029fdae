// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles the page into one script and one style: `node build.mjs [FOLDER]`, by default into ../asset.
import { build } from "esbuild";
import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import path from "node:path";

const here = path.dirname(fileURLToPath(import.meta.url));
const out = path.resolve(process.argv[2] ?? path.join(here, "../asset"));
const { version } = JSON.parse(await readFile(path.join(here, "node_modules/three/package.json"), "utf8"));
const notice = `Sinew viewer, GPL-3.0-or-later. Contains three.js ${version}, Copyright © 2010-2026 three.js authors, MIT licence (asset/LICENSE.three.txt).`;
await build({
    absWorkingDir: here,
    entryPoints: { viewer: "src/main.js" },
    outdir: out,
    bundle: true,
    minify: true,
    format: "iife",
    target: ["es2022"],
    charset: "utf8",
    legalComments: "none",
    banner: { js: `/* ${notice} */`, css: "/* Sinew viewer, GPL-3.0-or-later. */" },
});
