// SPDX-License-Identifier: GPL-3.0-or-later
// What the colours mean: one bar for each coloured thing that is on, with units and an editable range.
import { cssGradient, quantities, rangeOf } from "./colour_maps.js";
import { h, show } from "./dom.js";
import { aboutQuantity, isMarks, quantitiesOfMarks, rangeOfMarks } from "./marks.js";
import { hasData } from "./store.js";

function shownQuantities(scene, { colourBy, overlays }) {
    const on = (name) => overlays[name] && hasData(scene, name);
    return [quantities[colourBy] && hasData(scene, colourBy) && colourBy, on("fibres") && "excitation",
        on("attachments") && "distance", ...(on("marks") ? quantitiesOfMarks(scene) : [])].filter(Boolean);
}

/** Dots and rings of attachments. */
function endsKey(scene) {
    const modes = new Set(scene.attachments.map((a) => (a.mode === "sliding" ? "sliding" : "fixed")));
    return h("div", { class: "legend-key" }, [...modes].map((mode) => h("span", {}, h("i", { class: mode }), mode)));
}

export function legend(scene, store, world) {
    const host = h("div", { class: "legend" });
    const set = (quantity, range) => {
        if (range.every(Number.isFinite) && range[0] < range[1]) store.set({ ranges: { ...store.state.ranges, [quantity]: range } });
        else update();
    };
    const about = (quantity) => (isMarks(quantity) ? aboutQuantity(scene, quantity) : quantities[quantity]);
    /** A range that holds what is shown now, or over the whole run: round, and even about the middle where there is one. */
    function fitted(quantity, ofRun = false) {
        const { factor, middle, finest = 0 } = about(quantity);
        let measured = null;
        if (quantity === "distance") measured = [0, Math.max(0, ...world.allAttachments().map((a) => a.measure(store.state.frame)))];
        else if (isMarks(quantity)) measured = rangeOfMarks([scene.frames[store.state.frame]], quantity);
        else measured = ofRun ? world.measuredRangeOfRun(quantity) : world.measuredRange(quantity);
        if (!measured) return null;
        const least = ofRun ? finest : 1e-6, round = (x) => Number(Math.max(least, Math.abs(x)).toPrecision(2));
        let [low, high] = measured.map((x) => x * factor);
        if (middle !== undefined) {
            const far = round(Math.max(Math.abs(low), Math.abs(high)));
            return [middle - far, middle + far];
        }
        return [low < 0 && -low > 0.01 * high ? -round(low) : 0, round(Math.max(0, high))];
    }
    /** What is shown for the first time gets the range of the run. */
    function open() {
        const ranges = { ...store.state.ranges };
        for (const quantity of shownQuantities(scene, store.state)) {
            if (ranges[quantity] || quantities[quantity]?.finest === undefined) continue;
            ranges[quantity] = fitted(quantity, true) ?? rangeOf(store.state, quantity);
            store.set({ ranges });
        }
    }
    function card(quantity) {
        const { title, unit, scale } = about(quantity);
        const [low, high] = rangeOf(store.state, quantity);
        const field = (value, which) => {
            const input = h("input", { type: "number", value: Math.abs(value) >= 1e5 ? value.toExponential(1) : String(value), step: "any", "aria-label": `${title}, ${which}`,
                onchange: () => {
                    const range = [...rangeOf(store.state, quantity)];
                    range[which === "least" ? 0 : 1] = Number(input.value);
                    set(quantity, range);
                } });
            return input;
        };
        // Excitation is a share of the most there can be: nothing to fit.
        const fit = quantity === "excitation" ? null : h("button", { type: "button", title: "Fit the range to this frame", onclick: () => {
            const range = fitted(quantity);
            if (range) set(quantity, range);
        } }, "fit");
        return h("div", { class: "legend-card", "data-quantity": quantity },
            h("div", { class: "legend-title" }, h("span", {}, title, unit ? h("span", { class: "unit" }, ` ${unit}`) : null),
                quantity === "distance" ? endsKey(scene) : null, fit),
            h("div", { class: "legend-ends" }, field(low, "least"),
                h("div", { class: "legend-bar", style: `background:${cssGradient(scale)}`, title: `middle: ${show((low + high) / 2)} ${unit}` },
                    h("i", { class: "legend-tick", hidden: true })), field(high, "most")));
    }
    function update() {
        host.replaceChildren(...shownQuantities(scene, store.state).map(card));
    }
    store.on(["colourBy", "overlays"], open);
    store.on(["colourBy", "overlays", "ranges", "map"], update);
    open();
    update();
    return host;
}
