// SPDX-License-Identifier: GPL-3.0-or-later
// What can be laid over bodies: the one list of it. Switches, keys, addresses and the fresh page follow it.
import { mostMarks } from "./marks.js";

const sum = (list, of) => list.reduce((n, x) => n + of(x), 0);

/** `name` in addresses; `noun` for what a page has none of; `title` of its switch, `about` of its key; `inner`: it lies inside
    the flesh, which is then seen through; `fresh`: it is on in a fresh page; `count(scene)`: how many there are, where they are
    counted; `has(scene)`: whether there is anything to show. */
export const overlayList = [
    { name: "lattice", noun: "tets", title: "Tets", about: "Tet lattice", key: "l", inner: true,
        count: (scene) => sum(scene.bodies, (b) => b.lattice?.count ?? 0), has: (scene) => scene.bodies.some((b) => b.lattice) },
    { name: "fibres", noun: "fibres", title: "Fibres", about: "Fibres", key: "b", inner: true,
        count: (scene) => sum(scene.bodies, (b) => sum(b.fibres, (f) => f.count)), has: (scene) => scene.bodies.some((b) => b.fibres.length > 0) },
    { name: "attachments", noun: "attachments", title: "Attachments", about: "Attachments", key: "a", inner: true,
        count: (scene) => sum(scene.attachments, (a) => a.count), has: (scene) => scene.attachments.length > 0 },
    { name: "marks", noun: "marks", title: "Marks", about: "Marks of forces", key: "k", inner: true,
        count: mostMarks, has: (scene) => scene.frames.some((f) => f.marks?.length > 0) },
    { name: "grid", noun: "ground", title: "Ground", about: "Ground grid", key: "g", inner: false, fresh: true, count: null, has: () => true },
];

export const overlayNames = overlayList.map((o) => o.name);
export const overlay = (name) => overlayList.find((o) => o.name === name);
