// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of the shown frame: a short line along each normal, coloured by depth. Seven numbers a contact: point,
// normal, depth.
import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments } from "three";
import { rangeOf, tableOf, writeColour } from "./colour_maps.js";

export class ContactView {
    constructor(scene, size) {
        this.scene = scene;
        this.length = 0.02 * size;
        this.group = new Group();
        this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true, depthTest: false }));
        this.lines.frustumCulled = false;
        this.group.add(this.lines);
    }
    update(state) {
        const list = this.scene.frames[state.frame]?.contacts;
        this.group.visible = Boolean(list && list.length);
        if (!this.group.visible) return;
        const count = list.length / 7, points = new Float32Array(6 * count), colours = new Float32Array(6 * count);
        const table = tableOf("distance"), [least, most] = rangeOf(state, "depth");
        for (let i = 0; i < count; ++i) {
            for (let c = 0; c < 3; ++c) {
                points[6 * i + c] = list[7 * i + c];
                points[6 * i + 3 + c] = list[7 * i + c] + this.length * list[7 * i + 3 + c];
            }
            const depth = (1000 * list[7 * i + 6]) / this.scene.unitsPerMetre;
            writeColour(table, depth, least, most, colours, 6 * i);
            writeColour(table, depth, least, most, colours, 6 * i + 3);
        }
        this.lines.geometry.dispose();
        this.lines.geometry = new BufferGeometry()
            .setAttribute("position", new BufferAttribute(points, 3))
            .setAttribute("color", new BufferAttribute(colours, 3));
    }
}
