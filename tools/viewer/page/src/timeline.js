// SPDX-License-Identifier: GPL-3.0-or-later
// The time line: rows of small charts over the frames. A click or a drag goes to a frame.
import { h, show } from "./dom.js";
import { frameSummary, phases, timelineRows } from "./timeline_rows.js";

const top = 20, gap = 6, widest = 96; // pixels; a slot of one frame is never wider than that
const narrow = 560; // narrower than that, titles and values lie over their rows instead of beside them

const fault = "#c026a8", font = "11px Inter, 'Segoe UI', Arial, sans-serif";

export function timelinePanel(scene, store, player) {
    const rows = timelineRows(scene);
    const canvas = h("canvas", { class: "timeline-canvas" });
    const tip = h("div", { class: "tip", hidden: true });
    const key = h("div", { class: "timeline-key" }, phases.map(([name, colour]) =>
        h("span", {}, h("i", { style: `background:${colour}` }), name)), h("span", {}, h("i", { class: "reused" }), "reused"),
        h("span", {}, h("i", { style: "background:#d23b3b" }), "not converged"),
        scene.other ? h("span", {}, h("i", { class: "other" }), scene.other.title) : null,
        scene.frames.some((f) => f.faults) ? h("span", { class: "faulty" }, h("i", { style: `background:${fault}` }), "wrong: flies apart or is no number") : null);
    const scroller = h("div", { class: "timeline-scroll" }, canvas, tip);
    const element = h("div", { class: "timeline" }, scroller, key);
    if (scene.frames.length === 0) {
        element.replaceChildren(h("p", { class: "empty" }, "There are no frames to show."));
        return { element, opened() {} };
    }
    const still = document.createElement("canvas"); // everything but the play head
    const numbers = scene.frames.map((f) => f.frame);
    const firstFrame = numbers[0], lastFrame = numbers[numbers.length - 1];
    const span = lastFrame - firstFrame + 1; // by frame number, so that missing frames leave gaps
    let width = 0, height = 0, left = 0, right = 0, above = 0;
    const largestText = (row) => `${row.kind === "log" ? "≤ " : ""}${show(row.most)} ${row.unit}`.trim();

    /** Room for titles and values: beside the rows as wide as they are, or above each row. */
    function layOut() {
        const g = still.getContext("2d");
        g.font = font;
        const widestOf = (texts) => texts.reduce((m, t) => Math.max(m, g.measureText(t).width), 0);
        const isNarrow = width < narrow;
        above = isNarrow ? 15 : 0;
        left = isNarrow ? 10 : Math.ceil(Math.min(0.4 * width, 10 + widestOf(rows.map((r) => r.title)) + 12 + widestOf(rows.map(largestText)) + 8));
        right = isNarrow ? 10 : 86;
    }
    /** Rows share the room there is, within reason; then they scroll. */
    function fitHeights(room) {
        const fixed = top + rows.length * (gap + above) + 4, usual = rows.reduce((sum, r) => sum + r.usual, 0);
        const factor = Math.min(1.6, Math.max(0.42, (room - fixed) / usual));
        for (const row of rows) row.height = Math.floor(row.usual * factor);
        height = fixed + rows.reduce((sum, r) => sum + r.height, 0);
    }
    const slot = () => Math.min(widest, (width - left - right) / span);
    const xOf = (index) => left + (numbers[index] - firstFrame) * slot();
    const colours = () => {
        const style = getComputedStyle(document.documentElement);
        return Object.fromEntries(["text", "soft", "line", "accent", "panel"].map((n) => [n, style.getPropertyValue("--" + n).trim()]));
    };

    function drawRow(g, row, y, c) {
        const { height: tall, values, most } = row;
        const w = Math.max(1, slot()), bar = Math.max(1, w - (w > 4 ? 1 : 0));
        g.fillStyle = c.line;
        g.globalAlpha = 0.35;
        g.fillRect(left, y + tall, width - left - right, 1);
        g.globalAlpha = 1;
        if (row.kind === "stack") {
            row.stacks.forEach((stack, i) => {
                let base = y + tall;
                stack.forEach((ms, k) => {
                    const part = Math.min(base - y, (ms / (most || 1)) * tall);
                    g.fillStyle = phases[k][1];
                    g.globalAlpha = scene.frames[i].reused ? 0.3 : 1;
                    g.fillRect(xOf(i), base - part, bar, part);
                    base -= part;
                });
                g.globalAlpha = 1;
            });
        } else if (row.kind === "bars") {
            values.forEach((v, i) => {
                if (!Number.isFinite(v)) return;
                g.fillStyle = row.key === "newton" && scene.frames[i].converged === false ? "#d23b3b" : row.colour;
                const part = Math.min(tall, (v / (most || 1)) * tall);
                g.fillRect(xOf(i), y + tall - part, bar, part);
            });
            g.fillStyle = c.soft;
            row.others?.forEach((v, i) => Number.isFinite(v) && g.fillRect(xOf(i), y + tall - Math.min(tall, (v / (most || 1)) * tall) - 0.5, bar, 1));
        } else drawLine(g, row, y, c);
    }

    function drawLine(g, row, y, c) {
        const { height: tall, kind, zero } = row;
        const raw = kind === "log" ? row.values.map((v) => (v > 0 ? Math.log10(v) : NaN)) : row.values;
        const scaled = (kind === "log" ? row.scaled.map((v) => (v > 0 ? Math.log10(v) : NaN)) : row.scaled).filter(Number.isFinite);
        let low = scaled.reduce((m, v) => Math.min(m, v), Infinity), high = scaled.reduce((m, v) => Math.max(m, v), -Infinity);
        if (!(low <= high)) (low = 0), (high = 1);
        if (zero) (low = Math.min(0, low)), (high = Math.max(0, high));
        if (!(high > low)) high = low + 1;
        const at = (v) => y + tall - (Math.min(high, Math.max(low, v)) - low) / (high - low) * (tall - 3) - 1;
        if (zero && low < 0) {
            g.fillStyle = c.line;
            g.fillRect(left, at(0), width - left - right, 1);
        }
        const joinsIn = (list) => (i) => i > 0 && numbers[i] === numbers[i - 1] + 1 && Number.isFinite(list[i]) && Number.isFinite(list[i - 1]);
        const stroke = (list, colour, wide) => {
            const joins = joinsIn(list);
            g.strokeStyle = colour;
            g.lineWidth = wide;
            g.beginPath();
            list.forEach((v, i) => {
                if (!Number.isFinite(v)) return;
                const x = xOf(i) + slot() / 2;
                if (joins(i)) g.lineTo(x, at(v));
                else g.moveTo(x, at(v));
            });
            g.stroke();
        };
        if (row.others) {
            g.setLineDash([4, 3]);
            stroke(kind === "log" ? row.others.map((v) => (v > 0 ? Math.log10(v) : NaN)) : row.others, c.soft, 1);
            g.setLineDash([]);
        }
        const joins = joinsIn(raw);
        stroke(raw, row.colour, 1.5);
        g.fillStyle = row.colour;
        raw.forEach((v, i) => {
            if (!Number.isFinite(v) || joins(i) || (i + 1 < raw.length && joins(i + 1))) return;
            g.beginPath(); // a frame on its own has no line
            g.arc(xOf(i) + slot() / 2, at(v), 2.5, 0, 2 * Math.PI);
            g.fill();
        });
    }

    function drawMarks(g, c) {
        const w = Math.max(1, slot());
        scene.frames.forEach((f, i) => {
            if (f.reused) (g.fillStyle = "#3aa0a0"), g.fillRect(xOf(i), top - 4, w, 3);
            if (f.converged === false) (g.fillStyle = "#d23b3b"), g.fillRect(xOf(i), top - 4, w, 3);
            if (!f.faults) return;
            const wide = Math.max(3, w), x = xOf(i) + (w - wide) / 2;
            g.fillStyle = fault;
            g.fillRect(x, top - 6, wide, 6);
            g.globalAlpha = 0.16;
            g.fillRect(x, top, wide, height - top - 4);
            g.globalAlpha = 1;
        });
        g.fillStyle = c.line;
        g.globalAlpha = 0.6;
        for (let i = 1; i < numbers.length; ++i)
            for (let x = xOf(i - 1) + w; x < xOf(i) - 0.5; x += 6) g.fillRect(x, top, 2, height - top - 4);
        g.globalAlpha = 1;
        const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 5000].find((s) => s * w > 46) ?? 10000;
        g.fillStyle = c.soft;
        g.textAlign = "center";
        for (let n = Math.ceil(firstFrame / step) * step; n <= lastFrame; n += step)
            g.fillText(String(n), left + (n - firstFrame + 0.5) * w, 10);
        g.textAlign = "left";
    }

    function drawStill() {
        const ratio = window.devicePixelRatio || 1;
        for (const s of [still, canvas]) (s.width = Math.round(width * ratio)), (s.height = Math.round(height * ratio));
        canvas.style.height = `${height}px`;
        const g = still.getContext("2d"), c = colours();
        g.setTransform(ratio, 0, 0, ratio, 0, 0);
        g.clearRect(0, 0, width, height);
        g.font = font;
        drawMarks(g, c);
        let y = top;
        for (const row of rows) {
            g.fillStyle = c.text;
            g.fillText(row.title, 10, y + 11);
            const titleEnds = 10 + g.measureText(row.title).width + 12;
            g.fillStyle = c.soft;
            g.textAlign = above ? "left" : "right"; // at the height where the row's largest value ends
            g.fillText(largestText(row), above ? titleEnds : left - 8, y + (above ? 11 : 9));
            g.textAlign = "left";
            y += above;
            g.fillStyle = c.line;
            if (!above) g.fillRect(left - 5, y, 3, 1);
            drawRow(g, row, y, c);
            row.y = y;
            y += row.height + gap;
        }
    }
    function draw() {
        if (width <= 0) return;
        const ratio = window.devicePixelRatio || 1, g = canvas.getContext("2d"), c = colours();
        g.setTransform(1, 0, 0, 1, 0, 0);
        g.clearRect(0, 0, canvas.width, canvas.height);
        g.drawImage(still, 0, 0);
        g.setTransform(ratio, 0, 0, ratio, 0, 0);
        const { frame } = store.state, middle = xOf(frame) + slot() / 2, w = Math.min(14, Math.max(2, slot())), x = middle - w / 2;
        g.fillStyle = c.accent;
        g.globalAlpha = 0.22;
        g.fillRect(x, top - 6, w, height - top + 6);
        g.globalAlpha = 1;
        g.fillRect(middle - 0.75, top - 6, 1.5, height - top + 6);
        g.font = font;
        g.textAlign = above ? "right" : "left";
        for (const row of rows)
            g.fillText(`${show(row.values[frame])} ${row.unit}`.trim(), above ? width - 10 : width - right + 10, above ? row.y - 4 : row.y + row.height / 2 + 4);
        g.textAlign = "left";
    }
    function resize() {
        if (scroller.clientWidth === 0) return;
        width = scroller.clientWidth;
        layOut();
        fitHeights(scroller.clientHeight);
        scroller.classList.toggle("more", height > scroller.clientHeight + 2);
        drawStill();
        draw();
    }
    new ResizeObserver(resize).observe(scroller);
    store.on(["frame"], draw);
    store.on(["theme"], () => requestAnimationFrame(resize));

    /** The frame nearest to a point of the page. */
    function frameAt(clientX) {
        const number = firstFrame + (clientX - canvas.getBoundingClientRect().left - left) / slot() - 0.5;
        let best = 0;
        for (let i = 1; i < numbers.length; ++i) if (Math.abs(numbers[i] - number) < Math.abs(numbers[best] - number)) best = i;
        return best;
    }
    canvas.addEventListener("pointerdown", (e) => {
        if (e.pointerType !== "touch") canvas.setPointerCapture(e.pointerId); // a finger may scroll the rows
        store.set({ playing: false });
        player.goTo(frameAt(e.clientX));
    });
    canvas.addEventListener("pointermove", (e) => {
        const index = frameAt(e.clientX);
        if (e.buttons & 1) player.goTo(index);
        tip.hidden = false;
        tip.replaceChildren(...frameSummary(scene, index).map((line) => h("div", {}, line)));
        const r = scroller.getBoundingClientRect();
        tip.style.left = `${Math.max(4, Math.min(e.clientX - r.left + 14, r.width - 300))}px`;
        tip.style.top = `${Math.max(0, e.clientY - r.top - 20) + scroller.scrollTop}px`;
    });
    canvas.addEventListener("pointerleave", () => (tip.hidden = true));
    return { element, opened: resize, xOf: (index) => canvas.getBoundingClientRect().left + xOf(index) + slot() / 2, canvas, titles: rows.map((r) => r.title) };
}
