// SPDX-License-Identifier: GPL-3.0-or-later
// Camera, light, ground and the canvas. Draws only when something has changed.
import {
    AmbientLight, Color, DirectionalLight, Group, HemisphereLight, LineBasicMaterial, LineSegments, BufferGeometry,
    Float32BufferAttribute, PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const themes = {
    light: { background: 0xeef1f5, grid: 0xc6ced8, sky: 0xffffff, ground: 0x9a928a, hemisphere: 1.35, key: 1.9, fill: 0.5 },
    dark: { background: 0x14181d, grid: 0x2c343d, sky: 0xdfe8f5, ground: 0x3a342f, hemisphere: 1.0, key: 2.0, fill: 0.45 },
};

/** Directions from which one looks, in the scene's own axes (y up); z-up scenes are turned. */
const views = { front: [0, 0, 1], back: [0, 0, -1], left: [1, 0, 0], right: [-1, 0, 0], top: [0, 1, 1e-3], corner: [0.5, 0.28, 0.82] };

/** Up to `most` points of a body, evenly over its vertices. */
export function samplePoints(body, frame, most) {
    const p = body.positionsAt(frame), out = [], step = 3 * Math.max(1, Math.floor(body.vertices / most));
    for (let i = 0; i + 2 < p.length; i += step) out.push(new Vector3(p[i], p[i + 1], p[i + 2]));
    return out;
}

export class Stage {
    constructor(host, data) {
        this.host = host;
        this.data = data;
        this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true, stencil: true });
        this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
        this.canvas = this.renderer.domElement;
        this.canvas.className = "canvas";
        this.canvas.tabIndex = 0;
        this.canvas.setAttribute("aria-label", "3D view; drag to turn, right-drag to move, wheel to zoom");
        host.prepend(this.canvas);
        this.scene = new Scene();
        this.world = new Group();
        this.scene.add(this.world);
        const [low, high] = data.bounds.map((p) => new Vector3(...p));
        this.centre = low.clone().add(high).multiplyScalar(0.5);
        this.size = Math.max(1e-6, high.clone().sub(low).length());
        this.camera = new PerspectiveCamera(32, 1, this.size / 500, this.size * 50);
        if (data.up === "z") this.camera.up.set(0, 0, 1);
        this.controls = new OrbitControls(this.camera, this.canvas);
        this.controls.enableDamping = false;
        this.controls.zoomToCursor = true;
        this.controls.addEventListener("change", () => (this.clip(), this.invalidate()));
        this.controls.addEventListener("start", () => (this.framed = null)); // from now on the user's own view
        /** Pixels at each side of the canvas that something lies over; set by whoever puts it there. */
        this.covered = () => ({ left: 0, right: 0, top: 0, bottom: 0 });
        this.addLights();
        this.addGrid(low, high);
        this.beforeDraw = [];
        /** Two groups to draw side by side, or null. */
        this.sides = () => null;
        new ResizeObserver(() => this.resize()).observe(host);
        this.resize();
    }

    /** Near and far go with the distance, so that what flies far away can still be framed and seen. */
    clip() {
        const distance = this.camera.position.distanceTo(this.controls.target);
        this.camera.near = Math.min(this.size / 500, distance / 50);
        this.camera.far = Math.max(this.size * 50, distance * 100);
        this.camera.updateProjectionMatrix();
    }

    addLights() {
        this.hemisphere = new HemisphereLight(0xffffff, 0x888888, 1);
        if (this.data.up === "z") this.hemisphere.position.set(0, 0, 1);
        this.key = new DirectionalLight(0xfff4e6, 2);
        this.fill = new DirectionalLight(0xd8e6ff, 0.5);
        // The lights go with the eye, so that no side of the scene stays dark.
        this.camera.add(this.key, this.key.target, this.fill, this.fill.target);
        this.key.position.set(-0.45, 0.9, 1);
        this.fill.position.set(1, -0.25, 0.4);
        this.key.target.position.set(0, 0, -1);
        this.fill.target.position.set(0, 0, -1);
        this.scene.add(this.camera, this.hemisphere, new AmbientLight(0xffffff, 0.12));
    }

    addGrid(low, high) {
        const up = this.data.up === "z" ? 2 : 1;
        const [a, b] = up === 2 ? [0, 1] : [0, 2];
        const spacing = 10 ** Math.floor(Math.log10(this.size / 2));
        const floor = low.getComponent(up) - this.size * 0.02;
        const range = (axis) => [
            Math.floor((low.getComponent(axis) - this.size * 0.2) / spacing),
            Math.ceil((high.getComponent(axis) + this.size * 0.2) / spacing),
        ];
        const [a0, a1] = range(a), [b0, b1] = range(b);
        const lines = [];
        const add = (u, v) => {
            const p = [0, 0, 0];
            p[up] = floor;
            p[a] = u * spacing;
            p[b] = v * spacing;
            lines.push(...p);
        };
        for (let u = a0; u <= a1; ++u) add(u, b0), add(u, b1);
        for (let v = b0; v <= b1; ++v) add(a0, v), add(a1, v);
        const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(lines, 3));
        this.grid = new LineSegments(geometry, new LineBasicMaterial({ transparent: true, opacity: 0.55 }));
        this.scene.add(this.grid);
    }

    setTheme(name) {
        const t = themes[name];
        this.scene.background = new Color(t.background);
        this.grid.material.color.set(t.grid);
        this.hemisphere.color.set(t.sky);
        this.hemisphere.groundColor.set(t.ground);
        this.hemisphere.intensity = t.hemisphere;
        this.key.intensity = t.key;
        this.fill.intensity = t.fill;
        this.invalidate();
    }

    /** Size in CSS pixels of what one run is drawn into, and where the second begins: beside the first, or below it where the
        window is upright. */
    part() {
        const { clientWidth: w, clientHeight: h } = this.host;
        if (!this.sides()) return { wide: w, tall: h, dx: 0, dy: 0 };
        return h >= w ? { wide: w, tall: h / 2, dx: 0, dy: h / 2 } : { wide: w / 2, tall: h, dx: w / 2, dy: 0 };
    }
    /** 0 or 1: in which of the two a point of the page lies. */
    sideAt(x, y) {
        const r = this.canvas.getBoundingClientRect(), { dx, dy } = this.part();
        return (dx && x - r.left > dx) || (dy && y - r.top > dy) ? 1 : 0;
    }

    resize() {
        const width = Math.max(1, this.host.clientWidth), height = Math.max(1, this.host.clientHeight);
        this.renderer.setSize(width, height, false);
        const { wide, tall } = this.part();
        this.camera.aspect = Math.max(1, wide) / Math.max(1, tall);
        this.camera.updateProjectionMatrix();
        this.controls.zoomToCursor = !this.sides();
        // What was framed stays framed, until the user turns or zooms.
        if (this.framed) this.frame(...this.framed);
        this.invalidate();
    }

    /** Looks from a named side at `points`, by default at the whole motion. */
    look(name, points = this.everything()) {
        const [x, y, z] = views[name];
        const d = this.data.up === "z" ? new Vector3(x, -z, y) : new Vector3(x, y, z);
        this.frame(points, d.normalize());
    }
    /** The view of a fresh page. */
    lookHome() {
        this.look("corner");
        this.homeDirection = this.framed[1];
    }
    get isHome() {
        return this.framed !== null && this.framed !== undefined && this.framed[0] === this.samples && this.framed[1] === this.homeDirection;
    }

    /** Points of all bodies at a handful of frames: enough to see where the motion goes. Frames that went wrong would
        make all others small; they count only if there are no others. */
    everything() {
        if (this.samples) return this.samples;
        const { frames, bodies } = this.data, out = [];
        const good = [...frames.keys()].filter((f) => !frames[f].faults), all = good.length ? good : [...frames.keys()];
        const step = Math.max(1, Math.floor((all.length - 1) / 8));
        for (const body of bodies) {
            const there = all.filter((f) => body.isThere(f));
            there.forEach((f, i) => {
                if (i % step === 0 || i === there.length - 1) out.push(...samplePoints(body, f, 240));
            });
        }
        return (this.samples = out);
    }

    /** The camera nearest to `points` that sees them all, from where it looks now unless `direction` says otherwise. */
    frame(points, direction = null) {
        if (points.length === 0) return;
        const d = direction ?? this.camera.position.clone().sub(this.controls.target).normalize();
        this.framed = [points, d];
        const right = new Vector3().crossVectors(this.camera.up, d).normalize();
        const up = new Vector3().crossVectors(d, right);
        // Slopes of the four planes that hold what is free of the canvas, with a margin.
        const tall = Math.tan((this.camera.fov * Math.PI) / 360), wide = tall * this.camera.aspect;
        const { wide: w, tall: h } = this.part(), margin = 0.035;
        const over = this.sides() ? { left: 0, right: 0, top: 36, bottom: 0 } : this.covered(); // 36: the titles
        const free = (before, after, size) => {
            const from = before / Math.max(1, size), to = 1 - after / Math.max(1, size);
            return to - from > 0.45 ? [2 * (from + margin) - 1, 2 * (to - margin) - 1] : [2 * margin - 1, 1 - 2 * margin];
        };
        const [left, rightward] = free(over.left, over.right, w).map((s) => s * wide);
        const [low, high] = free(over.bottom, over.top, h).map((s) => s * tall);
        // The planes pushed out until they hold every point; the eye is where they meet.
        const extent = { left: Infinity, right: -Infinity, low: Infinity, high: -Infinity };
        let middle = 0;
        for (const p of points) {
            const x = p.dot(right), y = p.dot(up), z = p.dot(d);
            extent.left = Math.min(extent.left, x + left * z);
            extent.right = Math.max(extent.right, x + rightward * z);
            extent.low = Math.min(extent.low, y + low * z);
            extent.high = Math.max(extent.high, y + high * z);
            middle += z / points.length;
        }
        const back = Math.max((extent.right - extent.left) / (rightward - left), (extent.high - extent.low) / (high - low), middle + 1e-3 * this.size);
        const eye = new Vector3().addScaledVector(d, back)
            .addScaledVector(right, (extent.left - left * back + extent.right - rightward * back) / 2)
            .addScaledVector(up, (extent.low - low * back + extent.high - high * back) / 2);
        this.camera.position.copy(eye);
        this.controls.target.copy(eye).addScaledVector(d, middle - back);
        this.controls.update();
        this.clip();
        this.invalidate();
    }

    /** Eye and target in scene units, 6 numbers: all that a view is made of. */
    viewNumbers() {
        return [...this.camera.position.toArray(), ...this.controls.target.toArray()];
    }
    /** Looks as `viewNumbers` said; false if these are no view. */
    setView(numbers) {
        const [x, y, z, ...target] = numbers;
        if (numbers.length !== 6 || !numbers.every((n) => Number.isFinite(n) && Math.abs(n) < 1e9 * this.size)) return false;
        if (Math.hypot(x - target[0], y - target[1], z - target[2]) < 1e-6 * this.size) return false;
        this.framed = null;
        this.camera.position.set(x, y, z);
        this.controls.target.set(...target);
        this.controls.update();
        this.clip();
        this.invalidate();
        return true;
    }

    invalidate() {
        if (this.requested) return;
        this.requested = true;
        requestAnimationFrame(() => this.requested && this.draw());
    }
    draw() {
        this.requested = false;
        for (const call of this.beforeDraw) call();
        const sides = this.sides(), { renderer } = this;
        if (!sides) return renderer.render(this.scene, this.camera);
        const { clientWidth: w, clientHeight: h } = this.host, { wide, tall, dx, dy } = this.part(), shown = sides.map((group) => group.visible);
        renderer.setScissorTest(true);
        sides.forEach((_, i) => {
            sides.forEach((group, k) => (group.visible = shown[k] && k === i));
            renderer.setViewport(i * dx, h - tall - i * dy, wide, tall); // from below
            renderer.setScissor(i * dx, h - tall - i * dy, wide, tall);
            renderer.render(this.scene, this.camera);
        });
        sides.forEach((group, k) => (group.visible = shown[k]));
        renderer.setScissorTest(false);
        renderer.setViewport(0, 0, w, h);
    }

    /** What of `meshes` lies under a point of the page, the nearest first. */
    pick(x, y, meshes) {
        const r = this.canvas.getBoundingClientRect(), { wide, tall, dx, dy } = this.part(), side = this.sideAt(x, y);
        const at = new Vector2(((x - r.left - side * dx) / wide) * 2 - 1, 1 - ((y - r.top - side * dy) / tall) * 2);
        const ray = new Raycaster();
        ray.setFromCamera(at, this.camera);
        return ray.intersectObjects(meshes, false);
    }
    /** Where a point of the scene is on the page, in CSS pixels; side by side on one of the two. */
    project(point, side = 0) {
        const p = new Vector3(...point).project(this.camera);
        const r = this.canvas.getBoundingClientRect(), { wide, tall, dx, dy } = this.part();
        return [r.left + side * dx + ((p.x + 1) / 2) * wide, r.top + side * dy + ((1 - p.y) / 2) * tall];
    }
    picture() {
        this.draw();
        return this.canvas.toDataURL("image/png");
    }
}
