// SPDX-License-Identifier: GPL-3.0-or-later
// The bar with play, step, scrub, speed and repeat.
import { h, icon, iconButton } from "./dom.js";

const speeds = [0.125, 0.25, 0.5, 1, 2, 4];

export function transport(scene, store, player) {
    const last = player.last;
    const play = iconButton("play", "Play or pause (space)", () => player.toggle(), { class: "icon-button play" });
    const slider = h("input", { type: "range", class: "scrub", min: "0", max: String(Math.max(0, last)), step: "1", "aria-label": "Frame",
        oninput: () => {
            store.set({ playing: false });
            player.goTo(Number(slider.value));
        } });
    const number = h("input", { type: "number", class: "frame-number", "aria-label": "Frame number", onchange: () => {
        const wanted = Number(number.value);
        const near = scene.frames.reduce((best, f, i) => (Math.abs(f.frame - wanted) < Math.abs(scene.frames[best].frame - wanted) ? i : best), 0);
        player.goTo(near);
        update();
    } });
    const range = h("span", { class: "soft" }, last > 0 ? `of ${scene.frames[0].frame}–${scene.frames[last].frame}` : last === 0 ? "the only frame" : "no frames");
    const clock = h("span", { class: "clock" });
    const speed = h("select", { "aria-label": "Speed", title: "Speed", onchange: () => store.set({ speed: Number(speed.value) }) },
        speeds.map((s) => h("option", { value: String(s) }, s < 1 ? `1/${1 / s} ×` : `${s} ×`)));
    const loop = iconButton("loop", "Repeat (R)", () => store.set({ loop: !store.state.loop }));
    const element = h("div", { class: "transport" },
        iconButton("first", "First frame (Home)", () => player.goTo(0), { class: "icon-button ends" }), iconButton("back", "One frame back (←)", () => player.step(-1)), play,
        iconButton("next", "One frame on (→)", () => player.step(1)), iconButton("last", "Last frame (End)", () => player.goTo(last), { class: "icon-button ends" }),
        number, range, slider, clock, speed, loop);
    let shown = null;
    function update() {
        const { frame, playing } = store.state;
        slider.value = frame;
        slider.style.setProperty("--done", last > 0 ? frame / last : 0);
        if (last >= 0) {
            number.value = scene.frames[frame].frame;
            clock.textContent = `${((scene.frames[frame].frame - scene.frames[0].frame) / scene.fps).toFixed(2)} s`;
        }
        speed.value = store.state.speed;
        loop.classList.toggle("on", store.state.loop);
        if (shown !== playing) (play.innerHTML = icon(playing ? "pause" : "play")), (shown = playing);
    }
    store.on(["frame", "playing", "speed", "loop"], update);
    update();
    return element;
}
