// SPDX-License-Identifier: GPL-3.0-or-later
// What lies under the pointer: the body, and the value that its colour stands for, in words and as a tick on the legend.
import { quantities } from "./colour_maps.js";
import { h, show } from "./dom.js";
import { aboutMarks, isMarks, markLines, unitOf } from "./marks.js";

const least = 60; // milliseconds of stillness before the scene is searched; more where a search takes long

/** Shares to a hundredth of a percent: what positions on the page's grid can tell. */
const inWords = (value, unit) => `${show(unit === "%" ? Math.round(100 * value) / 100 : value)} ${unit}`.trim();

const factorOf = (quantity) => (isMarks(quantity) ? aboutMarks.of(unitOf(quantity)) : quantities[quantity]).factor;

/** Lines for people about a hit of `World.probe`. */
export function probeLines(hit) {
    if (hit.mark) return markLines(hit.mark, hit.scene, show);
    const { body, quantity, value, tet, vertex, excitation } = hit;
    const lines = [body.name];
    if (quantity) {
        const { title, unit, factor } = quantities[quantity];
        lines.push(Number.isFinite(value) ? `${title} ${inWords(factor * value, unit)}` : "no value here");
    }
    if (excitation !== null) lines.push(`Fibre excitation ${show(100 * excitation)} %`);
    lines.push(tet >= 0 ? `tet ${tet}` : `vertex ${vertex}`);
    return lines;
}

export function probe(scene, store, world, legend) {
    const tip = h("div", { class: "probe", hidden: true }), { canvas } = world.stage;
    let timer = 0, at = null, rest = least;
    function tick(quantity, value) {
        for (const card of legend.querySelectorAll(".legend-card")) {
            const mark = card.querySelector(".legend-tick"), isIt = card.dataset.quantity === quantity && Number.isFinite(value);
            mark.hidden = !isIt;
            if (!isIt) continue;
            const [low, high] = [...card.querySelectorAll("input")].map((i) => Number(i.value));
            mark.style.left = `${Math.round(1000 * Math.min(1, Math.max(0, (factorOf(quantity) * value - low) / (high - low)))) / 10}%`;
        }
    }
    function hide() {
        clearTimeout(timer);
        at = null;
        if (!tip.hidden) (tip.hidden = true), tick(null);
    }
    function search() {
        const begin = performance.now(), hit = at && !store.state.playing ? world.probe(...at) : null;
        rest = Math.min(600, Math.max(least, 3 * (performance.now() - begin)));
        tip.hidden = !hit;
        if (!hit) return tick(null);
        tip.replaceChildren(...probeLines(hit).map((line) => h("div", {}, line)));
        tick(hit.quantity, hit.value);
        const r = canvas.getBoundingClientRect(), x = at[0] - r.left, y = at[1] - r.top;
        // Beside the pointer, on the side where there is room.
        tip.style.left = `${x + 16 + tip.offsetWidth < r.width ? x + 16 : Math.max(4, x - 16 - tip.offsetWidth)}px`;
        tip.style.top = `${y + 14 + tip.offsetHeight < r.height ? y + 14 : Math.max(4, y - 14 - tip.offsetHeight)}px`;
    }
    const soon = () => (clearTimeout(timer), (timer = setTimeout(search, rest)));
    canvas.addEventListener("pointermove", (e) => {
        if (e.pointerType === "touch") return;
        if (e.buttons) return hide();
        at = [e.clientX, e.clientY];
        soon();
    });
    canvas.addEventListener("pointerdown", hide);
    canvas.addEventListener("pointerleave", (e) => e.pointerType !== "touch" && hide());
    // A finger rests nowhere: a tap asks.
    canvas.addEventListener("click", (e) => {
        if (e.pointerType === "touch") (at = [e.clientX, e.clientY]), search();
    });
    world.stage.controls.addEventListener("change", hide);
    store.on(["frame", "colourBy", "overlays", "cut", "playing", "visible", "solo", "ranges", "map", "marksOfSelection", "selectedBodies"], () => at && soon());
    return tip;
}
