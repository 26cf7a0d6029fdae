// SPDX-License-Identifier: GPL-3.0-or-later
// Khronos's glTF validator: node validate_glb.mjs FILE.glb … Exit code 1 if one has an error or a warning.
import { readFile } from "node:fs/promises";
import path from "node:path";
import validator from "gltf-validator";

let wrong = process.argv.length < 3;
for (const file of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(await readFile(file)), { uri: path.basename(file), maxIssues: 20 });
    const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
    const { animationCount, totalVertexCount, totalTriangleCount } = report.info;
    console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ${numHints} hints; ` +
        `${totalVertexCount} vertices, ${totalTriangleCount} triangles, ${animationCount} animations`);
    for (const m of messages.filter((m) => m.severity < 2)) console.log(`  ${m.code} ${m.pointer ?? ""}: ${m.message}`);
    wrong ||= numErrors + numWarnings > 0;
}
process.exit(wrong ? 1 : 0);
