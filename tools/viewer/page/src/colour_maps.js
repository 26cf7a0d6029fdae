// SPDX-License-Identifier: GPL-3.0-or-later
// Colours for numbers. Control points are our own choice: lightness runs evenly, so that a grey print still reads.

const scales = {
    // dark blue - teal - yellow: amounts from nothing to much
    amount: ["#20204c", "#28507f", "#1f8390", "#46ae7e", "#a8cf5a", "#fbe75a"],
    // blue - near white - red: below and above a middle
    balance: ["#1c4a99", "#4f86c6", "#a9c8e4", "#eeeeea", "#f0b79c", "#d5674f", "#94202b"],
    // indigo - blue - bright cyan: from rest to full excitation; flesh is red, so no fibre is
    heat: ["#3b3f73", "#32589f", "#1f7fc4", "#12a7d8", "#3fd0e4", "#a5f3ea"],
    // green - yellow - violet: from fine to far off
    distance: ["#2e9d6a", "#a3bf3c", "#f5bb2e", "#ee7a2c", "#a3157d"],
    // light grey - violet: painted
    paint: ["#e9e6ee", "#c9b5e2", "#a47ed1", "#7d47b8", "#521c8a"],
};

function channels(hex) {
    return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}
const points = Object.fromEntries(Object.entries(scales).map(([name, list]) => [name, list.map(channels)]));

const toLinear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

/** sRGB colour, components 0…1, at `t` in 0…1. */
export function colourAt(scale, t) {
    const list = points[scale];
    const x = Math.min(1, Math.max(0, Number.isFinite(t) ? t : 0)) * (list.length - 1);
    const i = Math.min(list.length - 2, Math.floor(x)), s = x - i;
    return [0, 1, 2].map((c) => list[i][c] * (1 - s) + list[i + 1][c] * s);
}

/** 256 linear-light colours for writing into vertex buffers. */
const tables = new Map();
export function tableOf(scale) {
    if (!tables.has(scale)) {
        const table = new Float32Array(256 * 3);
        for (let i = 0; i < 256; ++i) colourAt(scale, i / 255).forEach((c, k) => (table[3 * i + k] = toLinear(c)));
        tables.set(scale, table);
    }
    return tables.get(scale);
}

/** Writes the colour of a value into out[at…at+2]. */
export function writeColour(table, value, least, most, out, at) {
    const t = (value - least) / (most - least);
    const i = 3 * (t > 0 ? (t < 1 ? (255 * t + 0.5) | 0 : 255) : 0);
    out[at] = table[i];
    out[at + 1] = table[i + 1];
    out[at + 2] = table[i + 2];
}

export function cssGradient(scale, direction = "to right") {
    const stops = scales[scale].map((c, i, all) => `${c} ${(100 * i) / (all.length - 1)}%`);
    return `linear-gradient(${direction}, ${stops.join(", ")})`;
}

/** What can be shown as a colour: title, unit, factor from raw to shown, colours, range where the run gives none (shown
    units). `finest`: the range is that of the run, but no finer than this, so that rounding errors are not painted. */
export const quantities = {
    volume: { title: "Volume change", unit: "%", factor: 100, scale: "balance", range: [-20, 20], middle: 0, finest: 0.5 },
    stretch: { title: "Largest stretch", unit: "%", factor: 100, scale: "amount", range: [0, 50], finest: 0.5 },
    area: { title: "Surface area change", unit: "%", factor: 100, scale: "balance", range: [-40, 40], middle: 0, finest: 0.5 },
    difference: { title: "Difference", unit: "mm", factor: 1000, scale: "paint", range: [0, 1], finest: 0.001 },
    weights: { title: "Painted weight", unit: "", factor: 1, scale: "paint", range: [0, 1] },
    excitation: { title: "Fibre excitation", unit: "%", factor: 100, scale: "heat", range: [0, 100] },
    distance: { title: "Attachments", unit: "mm", factor: 1000, scale: "distance", range: [0, 5] },
};
export const rangeOf = (state, quantity) => state.ranges[quantity] ?? quantities[quantity]?.range ?? [0, 1];
