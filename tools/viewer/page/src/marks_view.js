// SPDX-License-Identifier: GPL-3.0-or-later
// What forces show of themselves at the shown frame: a dot where each mark begins and a line to where it ends, coloured
// by its value. Seven numbers a mark: from, to, value; and where marks are about bodies, two of those for each, or -1.
import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial } from "three";
import { rangeOf, tableOf, writeColour } from "./colour_maps.js";
import { aboutMarks, marksQuantity, shownMarks } from "./marks.js";

export class MarksView {
    constructor(scene) {
        this.scene = scene;
        this.group = new Group();
        this.shown = []; // what is drawn: {group, i}
        this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true, transparent: true }));
        this.dots = new Points(new BufferGeometry(), new PointsMaterial({ vertexColors: true, size: 4, sizeAttenuation: false, transparent: true }));
        for (const object of [this.lines, this.dots]) {
            object.frustumCulled = false;
            object.renderOrder = 5;
            this.group.add(object);
        }
    }
    update(state) {
        const shown = shownMarks(this.scene.frames[state.frame]?.marks ?? [], state), count = shown.length;
        this.shown = shown;
        this.group.visible = count > 0;
        if (count === 0) return;
        const ends = new Float32Array(6 * count), colours = new Float32Array(6 * count);
        const dots = new Float32Array(3 * count), dotColours = new Float32Array(3 * count);
        const table = tableOf(aboutMarks.scale);
        shown.forEach(({ group: { unit, numbers }, i: mark }, i) => {
            const [least, most] = rangeOf(state, marksQuantity(unit)), { factor } = aboutMarks.of(unit), at = 7 * mark;
            ends.set(numbers.subarray(at, at + 6), 6 * i);
            dots.set(numbers.subarray(at, at + 3), 3 * i);
            const value = factor * numbers[at + 6];
            writeColour(table, value, least, most, colours, 6 * i);
            writeColour(table, value, least, most, colours, 6 * i + 3);
            writeColour(table, value, least, most, dotColours, 3 * i);
        });
        const fill = (object, positions, colour) => {
            object.geometry.dispose();
            object.geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(positions, 3))
                .setAttribute("color", new BufferAttribute(colour, 3));
        };
        fill(this.lines, ends, colours);
        fill(this.dots, dots, dotColours);
        this.dots.material.size = 4 * Math.min(2, window.devicePixelRatio || 1);
    }
}
