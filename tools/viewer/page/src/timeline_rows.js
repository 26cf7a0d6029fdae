// SPDX-License-Identifier: GPL-3.0-or-later
// The rows of the time line: what each draws, taken from the frames' reports. A row without any data is left out.
import { show } from "./dom.js";

export const phases = [
    ["assembly", "#4f8fd0"],
    ["factor", "#8a63c9"],
    ["solve", "#e0913a"],
    ["other", "#8d98a5"],
];

/** The value farthest from 0. */
const largest = (values) => values.reduce((m, v) => (Number.isFinite(v) && Math.abs(v) > Math.abs(m) ? v : m), 0);

/** Volume change farthest from 0 over all bodies, per frame. */
function volumeError(scene) {
    return scene.frames.map((_, f) => {
        let worst = NaN;
        for (const b of scene.bodies) {
            const v = b.volume ? 100 * (b.volume[f] - 1) : NaN;
            if (b.isThere(f) && Number.isFinite(v) && !(Math.abs(v) <= Math.abs(worst))) worst = v;
        }
        return worst;
    });
}

/** Time of one frame by phase, in ms; a frame without phases has its wall time as "other". */
export function phaseTimes(frame) {
    if (!frame.phases) return phases.map(([name]) => (name === "other" ? 1000 * (frame.wall_s ?? 0) : 0));
    return phases.map(([name]) => 1000 * (frame.phases[name] ?? 0));
}

/** A row for each number that a term reports, lengths in millimetres. */
function measureRows(scene) {
    return (scene.measures ?? []).map(({ term, name, title, unit }) => {
        const scale = unit === "m" ? 1000 : 1;
        const values = scene.frames.map((f) => scale * Number(f.terms?.[term]?.[name] ?? NaN));
        return { key: `${term}.${name}`, title: title[0].toUpperCase() + title.slice(1), unit: unit === "m" ? "mm" : unit, kind: "line", usual: 30, values, colour: "#b0713a" };
    });
}

/** The rows of the first run; `others` are the values of the run it is compared with, at the same frames. */
export function timelineRows(scene) {
    const rows = rowsOf(scene);
    if (!scene.other) return rows;
    const there = new Map(rowsOf(scene.other).map((r) => [r.key, r])), at = new Map(scene.other.frames.map((f, i) => [f.frame, i]));
    for (const row of rows) {
        const other = there.get(row.key);
        if (!other || row.kind === "stack") continue;
        row.others = scene.frames.map((f) => (at.has(f.frame) ? other.values[at.get(f.frame)] : NaN));
        row.scaled = [...row.scaled, ...row.others.filter((_, i) => !scene.other.frames[at.get(scene.frames[i].frame)]?.faults)];
        row.most = largest(row.scaled);
    }
    return rows;
}

function rowsOf(scene) {
    const { frames } = scene;
    const of = (key) => frames.map((f) => (f[key] === undefined || f[key] === null ? NaN : Number(f[key])));
    const stacks = frames.map(phaseTimes);
    const rows = [
        { key: "time", title: "Time a frame", unit: "ms", kind: "stack", usual: 54, stacks, values: stacks.map((s) => s.reduce((a, b) => a + b, 0)) },
        { key: "newton", title: "Newton iterations", unit: "", kind: "bars", usual: 30, values: of("newton"), colour: "#4f8fd0" },
        { key: "residual", title: "Residual", unit: "", kind: "log", usual: 34, values: of("residual"), colour: "#8a63c9" },
        { key: "energy", title: "Energy", unit: "J", kind: "line", usual: 34, values: of("energy"), colour: "#e0913a" },
        { key: "volume", title: "Volume error", unit: "%", kind: "line", usual: 34, values: volumeError(scene), colour: "#2f9e75", zero: true },
        { key: "minJ", title: "Least det F", unit: "", kind: "line", usual: 30, values: of("minJ"), colour: "#2b93a8", zero: true },
        ...measureRows(scene),
    ];
    // A frame that flies apart would flatten all others; its bars are cut off at the top.
    const isGood = (i) => !frames[i].faults || frames.every((f) => f.faults);
    for (const row of rows) {
        row.scaled = row.values.filter((_, i) => isGood(i));
        row.most = largest(row.scaled);
    }
    return rows.filter((r) => r.values.some(Number.isFinite) && !(r.key === "time" && r.most === 0));
}

/** Lines of text about one frame. */
export function frameSummary(scene, index) {
    const f = scene.frames[index];
    const out = [`Frame ${f.frame}${f.reused ? " (reused)" : ""}`, ...(f.faults ?? [])];
    if (f.phases) {
        out.push(phaseTimes(f).map((ms, i) => [phases[i][0], ms]).filter(([, ms]) => ms > 0).map(([n, ms]) => `${n} ${show(ms)} ms`).join(", ") || "no time");
        out.push(`${f.newton} Newton in ${f.substeps} step${f.substeps === 1 ? "" : "s"}, residual ${show(f.residual)}${f.converged ? "" : ": not converged"}`);
        out.push(`energy ${show(f.energy)} J, least det F ${show(f.minJ)}${f.inverted ? `, ${f.inverted} inverted` : ""}`);
    } else if (f.wall_s) out.push(`${show(1000 * f.wall_s)} ms`);
    return out;
}
