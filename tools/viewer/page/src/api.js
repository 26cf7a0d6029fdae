// SPDX-License-Identifier: GPL-3.0-or-later
// window.sinew: the page by script, for tests and for the console. Frames are frame numbers, bodies names or indices.
import { anchorPoints } from "./attachment_view.js";
import { colourAt } from "./colour_maps.js";
import { LatticeFields } from "./fields.js";
import { overlayNames } from "./overlays.js";
import { setOverlay } from "./store.js";

export function makeApi(app, loadMs) {
    const { scene, store, world, player, selection } = app;
    const bodyIndex = (body) => {
        const index = typeof body === "number" ? body : scene.bodies.findIndex((b) => b.name === body);
        if (!scene.bodies[index]) throw new Error(`no body ${body}`);
        return index;
    };
    const forgetDrawn = () => {
        for (const view of world.bodies) view.shownFrame = -1;
        world.dirty = true;
    };
    const ownFrames = () => {
        if (!scene.bodies.some((b) => b.instead)) return false;
        for (const b of scene.bodies) b.showInstead(0, null);
        forgetDrawn();
        api.draw();
        return true;
    };
    // Tets, marks and heat maps are this run's.
    store.on(["overlays", "colourBy"], ownFrames);
    const api = {
        scene,
        loadMs, // since the browser began to open the page
        frames: scene.frames.map((f) => f.frame),
        get frame() {
            return scene.frames[store.state.frame]?.frame;
        },
        get state() {
            return structuredClone(store.state);
        },
        setFrame(number) {
            const index = api.frames.indexOf(number);
            if (index < 0) throw new Error(`no frame ${number}`);
            player.goTo(index);
            api.draw();
        },
        set: (patch) => (store.set(patch), api.draw()),
        /** As it lies in the buffers that are drawn, where there are any: what is seen is what is measured. */
        vertexPosition(body, vertex) {
            const b = scene.bodies[bodyIndex(body)];
            return Array.from(b.positionsAt(store.state.frame).subarray(3 * vertex, 3 * vertex + 3));
        },
        drawnPosition(body, vertex) {
            api.draw();
            const view = world.bodies[bodyIndex(body)];
            const at = view.body.shading ? view.body.shading.indexOf(vertex) : vertex;
            const p = view.geometry.attributes.position;
            const v = world.stage.centre.clone().fromBufferAttribute(p, at).applyMatrix4(view.mesh.matrix);
            return v.toArray();
        },
        toggle(name, on = !store.state.overlays[name]) {
            if (!overlayNames.includes(name)) throw new Error(`no overlay ${name}`);
            const done = setOverlay(store, scene, name, on);
            api.draw();
            return done;
        },
        show(body, on = true) {
            const index = bodyIndex(body);
            store.set({ solo: -1, visible: store.state.visible.map((v, i) => (i === index ? on : v)) });
            api.draw();
        },
        solo: (body) => (store.set({ solo: body === null ? -1 : bodyIndex(body) }), api.draw()),
        selectBody: (body) => selection.selectBody(bodyIndex(body)),
        selectNode: (name) => selection.selectNode(name),
        bodiesOf: (node) => selection.bodiesOf(node).map((i) => scene.bodies[i].name),
        /** Names of the bodies whose meshes are drawn. */
        drawn: () => (api.draw(), (world.bodies ?? []).filter((v) => v.group.visible && (v.mesh.visible || v.edges.visible)).map((v) => v.body.name)),
        /** Linear-light colours as they lie in the buffers: of a body's fibres, of an attachment's dots, or of the dots of marks. */
        drawnColours(overlay, which) {
            api.draw();
            if (overlay === "marks") return Array.from(world.marks.dots.geometry.attributes.color.array);
            if (overlay === "attachments") return Array.from(world.allAttachments()[which].dots.geometry.attributes.color.array);
            return Array.from(world.fibres.get(bodyIndex(which)).fields[0].colours.array);
        },
        /** How many marks are drawn. */
        markCount: () => (api.draw(), world.marks.group.visible ? world.marks.shown.length : 0),
        /** Positions as they lie in the buffers: of a body's tet vertices, or of its first fibres' ends. */
        drawnTets: (body) => (api.draw(), Array.from(world.lattices.get(bodyIndex(body)).lines.geometry.attributes.position.array)),
        drawnFibres: (body) => (api.draw(), Array.from(world.fibres.get(bodyIndex(body)).fields[0].positions.array)),
        bodyAt: (x, y) => scene.bodies[world.pickBody(x, y)]?.name ?? null,
        project: (point, side = 0) => world.stage?.project(point, side) ?? null,
        /** Of the second run, where there is one. */
        otherDrawn: () => (api.draw(), world.other.group.visible ? world.other.bodies.filter((v) => v.group.visible).map((v) => v.body.name) : []),
        measuredRange: (quantity) => world.measuredRange(quantity),
        /** A frame of a newer run in place of this one's, as `sinew live` gives it. False, and nothing is changed, where that
            run has other bodies or moves its bones otherwise, and where more is shown than bodies. Null: this run's own again. */
        preview(newer) {
            if (!newer) return ownFrames();
            const { frame, bodies } = newer;
            const index = api.frames.indexOf(frame), { overlays, colourBy, playing } = store.state;
            if (index < 0 || playing || !world.stage || bodies.length !== scene.bodies.length) return false;
            if (colourBy !== "material" || overlayNames.some((name) => overlays[name] && name !== "grid")) return false;
            const all = bodies.map((b) => new Float32Array(Uint8Array.from(atob(b.positions), (c) => c.charCodeAt(0)).buffer));
            const nearly = 1e-4 * world.stage.size, stands = (b, p) => b.positionsAt(index).every((x, k) => Math.abs(x - p[k]) < nearly);
            if (!scene.bodies.every((b, i) => b.name === bodies[i].name && b.isThere(index) && all[i].length === 3 * b.vertices
                && (!b.isRigid || stands(b, all[i])))) return false;
            scene.bodies.forEach((b, i) => b.isRigid || b.showInstead(index, all[i]));
            forgetDrawn();
            player.goTo(index);
            api.draw();
            return true;
        },
        look: (name) => (world.look(name), api.draw()),
        colourAt: (scale, t) => colourAt(scale, t),
        draw: () => world.stage?.draw(),
        /** A data URL; null where there is no 3D view. */
        picture: () => world.stage?.picture() ?? null,
        /** Least det F over all tets at this frame, as the solver reports it. */
        leastVolumeRatio() {
            let least = Infinity;
            for (const b of scene.bodies) {
                if (!b.lattice) continue;
                const fields = new LatticeFields(b.lattice);
                fields.update(store.state.frame);
                for (const v of fields.values.volume) least = Math.min(least, v + 1);
            }
            return least;
        },
        /** Distances of an attachment's vertices from their anchors, in metres. */
        stretch: (index) => world.allAttachments()[index].measure(store.state.frame),
        anchors: (index) => Array.from(anchorPoints(scene.attachments[index], scene.bodies, store.state.frame,
            new Float32Array(3 * scene.attachments[index].count))),
        timelineTitles: app.timeline.titles,
        timelineX: (number) => app.timeline.xOf(api.frames.indexOf(number)),
    };
    return api;
}
