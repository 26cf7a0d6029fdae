// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of marks without drawing them: one colour range for each unit, so that all that is measured alike
// compares.

const prefix = "marks ";
export const marksQuantity = (unit) => prefix + unit;
export const isMarks = (quantity) => quantity.startsWith(prefix);
export const unitOf = (quantity) => quantity.slice(prefix.length);

/** Lengths are shown in millimetres, as elsewhere on the page. */
export const aboutMarks = {
    scale: "distance",
    of: (unit) => (unit === "m" ? { unit: "mm", factor: 1000 } : { unit: unit.replace("^2", "²").replace("^3", "³"), factor: 1 }),
};

/** Title, unit, factor, colours and usual range of the marks of one unit, as those of other quantities. */
export function aboutQuantity(scene, quantity) {
    const unit = unitOf(quantity), whats = new Set();
    for (const f of scene.frames) for (const g of f.marks ?? []) if (g.unit === unit) whats.add(g.what);
    const title = [...whats].slice(0, 3).join(", ") + (whats.size > 3 ? " …" : "");
    return { title: title ? title[0].toUpperCase() + title.slice(1) : "Marks", ...aboutMarks.of(unit), scale: aboutMarks.scale };
}

/** Quantities of all marks of the run, in the order in which they first appear. */
export const quantitiesOfMarks = (scene) =>
    [...new Set(scene.frames.flatMap((f) => (f.marks ?? []).map((g) => marksQuantity(g.unit))))];

/** [least, most] of one quantity over some frames, zero included, not yet in shown units. Null where there is none. */
export function rangeOfMarks(frames, quantity) {
    const out = [0, 0];
    let found = false;
    for (const f of frames)
        for (const g of f.marks ?? []) {
            if (g.unit !== unitOf(quantity)) continue;
            for (let i = 6; i < g.numbers.length; i += 7) {
                found = true;
                out[0] = Math.min(out[0], g.numbers[i]);
                out[1] = Math.max(out[1], g.numbers[i]);
            }
        }
    return found ? out : null;
}

/** Ranges in shown units over the frames without faults, or over all if each has some. */
export function usualMarkRanges(scene) {
    const good = scene.frames.filter((f) => !f.faults), out = {};
    for (const quantity of quantitiesOfMarks(scene)) {
        const { factor } = aboutMarks.of(unitOf(quantity));
        const [low, high] = (rangeOfMarks(good.length ? good : scene.frames, quantity) ?? [0, 0]).map((x) => Number((factor * x).toPrecision(2)));
        out[quantity] = low < high ? [low, high] : [0, 1];
    }
    return out;
}

/** Whether mark `i` of a group is one to show: with a filter those that are about a selected body, at either end. */
export function isMarkShown(group, i, { marksOfSelection, selectedBodies }) {
    if (!marksOfSelection || selectedBodies.length === 0) return true;
    return Boolean(group.bodies) && [0, 1].some((end) => selectedBodies.includes(group.bodies[2 * i + end]));
}

/** The marks of a frame that are shown, one after the other: {group, i}. */
export const shownMarks = (groups, state) =>
    groups.flatMap((group) => Array.from({ length: group.numbers.length / 7 }, (_, i) => ({ group, i })).filter(({ i }) => isMarkShown(group, i, state)));

/** What one mark says, for people: "Contact: force 12 N", and whom it is about: "biceps in humerus". */
export function markLines({ group, i }, scene, show) {
    const { unit, factor } = aboutMarks.of(group.unit), value = factor * group.numbers[7 * i + 6];
    const term = group.term[0].toUpperCase() + group.term.slice(1);
    const [a, b] = group.bodies ? [...group.bodies.slice(2 * i, 2 * i + 2)].map((k) => scene.bodies[k]?.name) : [];
    return [`${term}: ${group.what} ${show(value)} ${unit}`, a && b ? (a === b ? `${a} in itself` : `${a} in ${b}`) : (a ?? b)].filter(Boolean);
}

/** The most marks of any frame. */
export const mostMarks = (scene) =>
    scene.frames.reduce((n, f) => Math.max(n, (f.marks ?? []).reduce((k, g) => k + g.numbers.length / 7, 0)), 0);
