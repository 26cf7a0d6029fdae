// SPDX-License-Identifier: GPL-3.0-or-later
// Time: play, pause, step, scrub. Frames that the machine cannot draw in time are left out, so speed stays true.

export class Player {
    constructor(store, scene) {
        this.store = store;
        this.scene = scene;
        store.on(["playing"], (state) => state.playing && this.start());
    }
    get last() {
        return this.scene.frames.length - 1;
    }
    goTo(index) {
        if (this.last >= 0) this.store.set({ frame: Math.min(this.last, Math.max(0, index)) });
    }
    step(by) {
        this.store.set({ playing: false });
        const { frame, loop } = this.store.state;
        const count = this.last + 1;
        this.goTo(loop && count > 1 ? (((frame + by) % count) + count) % count : frame + by);
    }
    toggle() {
        if (this.last < 1) return;
        const { playing, frame, loop } = this.store.state;
        if (!playing && !loop && frame === this.last) this.goTo(0);
        this.store.set({ playing: !playing });
    }
    start() {
        let from = performance.now(), base = this.store.state.frame;
        const tick = (now) => {
            const { playing, speed, loop, frame } = this.store.state;
            if (!playing) return;
            if (frame !== this.shown) (base = frame), (from = now), (this.shown = frame); // scrubbed meanwhile
            const ahead = Math.floor(((now - from) / 1000) * this.scene.fps * speed);
            if (ahead > 0) {
                let next = base + ahead;
                if (next > this.last) {
                    if (!loop) return this.store.set({ frame: this.last, playing: false });
                    next %= this.last + 1;
                }
                this.shown = next;
                base = next;
                from += (ahead / (this.scene.fps * speed)) * 1000;
                this.store.set({ frame: next });
            }
            requestAnimationFrame(tick);
        };
        this.shown = base;
        requestAnimationFrame(tick);
    }
}
