// SPDX-License-Identifier: GPL-3.0-or-later
// What the colours mean: one bar for each coloured thing that is on, with units and an editable range.
import { cssGradient, quantities, rangeOf } from "./colour_maps.js";
import { h } from "./dom.js";

function shownQuantities({ colourBy, overlays }) {
    return [colourBy !== "material" && colourBy, overlays.fibres && "excitation", overlays.attachments && "stretch",
        overlays.contacts && "depth"].filter(Boolean);
}

export function legend(scene, store, world) {
    const host = h("div", { class: "legend" });
    const set = (quantity, range) => {
        if (range.every(Number.isFinite) && range[0] < range[1]) store.set({ ranges: { ...store.state.ranges, [quantity]: range } });
        else update();
    };
    /** A range that holds what is shown now: round, and even about the middle where there is one. */
    function fitted(quantity) {
        const { factor, middle } = quantities[quantity];
        let measured = null;
        if (quantity === "stretch") measured = [0, Math.max(0, ...world.allAttachments().map((a) => a.measure(store.state.frame)))];
        else if (quantity === "excitation") measured = [0, 1];
        else if (quantity !== "depth") measured = world.measuredRange(quantity);
        if (!measured) return null;
        const round = (x) => Number(Math.max(1e-6, Math.abs(x)).toPrecision(2));
        let [low, high] = measured.map((x) => x * factor);
        if (middle !== undefined) {
            const far = round(Math.max(Math.abs(low), Math.abs(high)));
            return [middle - far, middle + far];
        }
        return [low < 0 ? -round(low) : 0, round(high)];
    }
    function card(quantity) {
        const { title, unit, scale } = quantities[quantity];
        const [low, high] = rangeOf(store.state, quantity);
        const field = (value, which) => {
            const input = h("input", { type: "number", value: String(value), step: "any", "aria-label": `${title}, ${which}`,
                onchange: () => {
                    const range = [...rangeOf(store.state, quantity)];
                    range[which === "least" ? 0 : 1] = Number(input.value);
                    set(quantity, range);
                } });
            return input;
        };
        return h("div", { class: "legend-card", "data-quantity": quantity },
            h("div", { class: "legend-title" }, h("span", {}, title, unit ? h("span", { class: "unit" }, ` ${unit}`) : null),
                h("button", { type: "button", title: "Fit the range to this frame", onclick: () => {
                    const range = fitted(quantity);
                    if (range) set(quantity, range);
                } }, "fit")),
            h("div", { class: "legend-bar", style: `background:${cssGradient(scale)}` }),
            h("div", { class: "legend-ends" }, field(low, "least"),
                h("span", {}, String(Number(((low + high) / 2).toPrecision(3)))), field(high, "most")));
    }
    function update() {
        host.replaceChildren(...shownQuantities(store.state).map(card));
    }
    store.on(["colourBy", "overlays", "ranges", "map"], update);
    update();
    return host;
}
