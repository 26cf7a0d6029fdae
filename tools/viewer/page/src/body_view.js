// SPDX-License-Identifier: GPL-3.0-or-later
// One body in the 3D view: its surface, polygon edges and the rim of a selection.
import {
    BufferAttribute, BufferGeometry, DoubleSide, FrontSide, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, Quaternion, Vector3,
} from "three";
import { bodyMaterial, outlineMask, outlineMaterial } from "./body_material.js";
import { rangeOf, quantities, tableOf, writeColour } from "./colour_maps.js";
import { writeDifference } from "./difference.js";
import { LatticeFields, SurfaceArea } from "./fields.js";
import { grainMatrix } from "./grain.js";
import { isShown } from "./store.js";

/** Area-weighted vertex normals, written into `out`. */
function writeNormals(p, triangles, out) {
    out.fill(0);
    for (let i = 0; i < triangles.length; i += 3) {
        const a = 3 * triangles[i], b = 3 * triangles[i + 1], c = 3 * triangles[i + 2];
        const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
        const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
        const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
        out[a] += x, out[a + 1] += y, out[a + 2] += z;
        out[b] += x, out[b + 1] += y, out[b + 2] += z;
        out[c] += x, out[c + 1] += y, out[c + 2] += z;
    }
    for (let i = 0; i < out.length; i += 3) {
        const s = 1 / (Math.hypot(out[i], out[i + 1], out[i + 2]) || 1);
        out[i] *= s, out[i + 1] *= s, out[i + 2] *= s;
    }
}

export class BodyView {
    constructor(body, scene) {
        this.body = body;
        this.scene = scene;
        this.group = new Group();
        const count = body.shading ? body.shading.length : body.vertices;
        const geometry = new BufferGeometry();
        for (const name of ["position", "normal", "rest"])
            geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * count), 3));
        geometry.setIndex(new BufferAttribute(body.triangles, 1));
        this.geometry = geometry;
        this.gather(body.rest, geometry.attributes.rest.array);
        this.gather(body.rest, geometry.attributes.position.array);
        this.material = bodyMaterial(body, grainMatrix(body.rest));
        this.mesh = new Mesh(geometry, this.material);
        this.outline = new Mesh(geometry, outlineMaterial());
        this.mask = new Mesh(geometry, outlineMask());
        this.outline.renderOrder = 9;
        this.mask.renderOrder = 8;
        this.outline.visible = this.mask.visible = false;
        this.edges = new LineSegments(this.edgeGeometry(count), new LineBasicMaterial({ transparent: true, opacity: 0.55 }));
        this.objects = [this.mesh, this.outline, this.mask, this.edges];
        for (const object of this.objects) {
            object.frustumCulled = false;
            object.matrixAutoUpdate = false;
            object.userData.body = body.index;
            object.userData.isBone = body.kind === "bone";
            this.group.add(object);
        }
        if (body.isRigid) writeNormals(geometry.attributes.position.array, body.triangles, geometry.attributes.normal.array);
        this.values = null;
        this.shownFrame = -1;
    }

    edgeGeometry(count) {
        const { shading, edges } = this.body;
        const geometry = new BufferGeometry().setAttribute("position", this.geometry.attributes.position);
        if (!shading) return geometry.setIndex(new BufferAttribute(edges, 1));
        const first = new Uint32Array(this.body.vertices);
        for (let i = count - 1; i >= 0; --i) first[shading[i]] = i;
        return geometry.setIndex(new BufferAttribute(edges.map((v) => first[v]), 1));
    }

    /** Body vertices -> shading vertices. */
    gather(from, to) {
        const { shading } = this.body;
        if (!shading) return to.set(from);
        for (let i = 0; i < shading.length; ++i) {
            const v = 3 * shading[i];
            to[3 * i] = from[v], to[3 * i + 1] = from[v + 1], to[3 * i + 2] = from[v + 2];
        }
    }

    get fields() {
        return (this._fields ??= this.body.lattice ? new LatticeFields(this.body.lattice) : null);
    }

    pose(frame) {
        if (this.shownFrame === frame) return;
        this.shownFrame = frame;
        const { body, geometry } = this;
        if (body.isRigid) {
            const [x, y, z, w, tx, ty, tz] = body.pose(frame);
            const m = new Matrix4().compose(new Vector3(tx, ty, tz), new Quaternion(x, y, z, w), new Vector3(1, 1, 1));
            m.multiply(new Matrix4().makeTranslation(-body.pivot[0], -body.pivot[1], -body.pivot[2]));
            for (const object of this.objects) object.matrix.copy(m), (object.matrixWorldNeedsUpdate = true);
            return;
        }
        const { position, normal } = geometry.attributes;
        this.gather(body.positionsAt(frame), position.array);
        writeNormals(position.array, body.triangles, normal.array);
        position.needsUpdate = normal.needsUpdate = true;
        for (const g of [geometry, this.edges.geometry]) g.boundingSphere = g.boundingBox = null;
    }

    /** Raw values of a quantity at the body's vertices, or null if this body has none. */
    valuesOf(quantity, map, frame) {
        const { body } = this;
        if (body.isRigid && quantity !== "weights" && quantity !== "difference") return null;
        const values = (this.values ??= new Float32Array(body.vertices));
        if (quantity === "difference") return writeDifference(body, this.scene, frame, values) ? values : null;
        if (quantity === "area") {
            (this.area ??= new SurfaceArea(body)).write(frame, values);
            return values;
        }
        if (quantity === "weights") return this.paintedValues(map, values);
        if (!this.fields || !body.hostTet) return null;
        this.fields.update(frame);
        this.fields.atSurface(quantity, body, values);
        return values;
    }

    /** `map`: "all:NAME" takes the largest of all maps of that name, anything else is one map's node and name. */
    paintedValues(map, values) {
        const wanted = this.body.maps.filter((m) => (map.startsWith("all:") ? m.name === map.slice(4) : `${m.node}|${m.name}` === map));
        if (wanted.length === 0) return null;
        values.fill(0);
        for (const m of wanted) for (let i = 0; i < values.length; ++i) values[i] = Math.max(values[i], m.values[i] / 255);
        return values;
    }

    paint(state) {
        const own = this.material.userData.own;
        const quantity = quantities[state.colourBy] ? state.colourBy : "material";
        const values = quantity === "material" ? null : this.valuesOf(quantity, state.map, state.frame);
        own.uMap.value = values ? 1 : 0;
        // What has no value steps back, so that the map is read and not the anatomy.
        this.material.color.set(quantity !== "material" && !values ? (state.theme === "dark" ? "#6d747c" : "#c3c8ce") : this.body.colour);
        own.uStripes.value = quantity === "material" ? this.body.stripes : 0;
        if (!values) return;
        let attribute = this.geometry.attributes.mapColour;
        if (!attribute) {
            attribute = new BufferAttribute(new Float32Array(this.geometry.attributes.rest.array.length), 3);
            this.geometry.setAttribute("mapColour", attribute);
        }
        const { factor, scale } = quantities[quantity];
        const [least, most] = rangeOf(state, quantity), table = tableOf(scale), { shading } = this.body;
        const count = attribute.array.length / 3;
        for (let i = 0; i < count; ++i)
            writeColour(table, factor * values[shading ? shading[i] : i], least, most, attribute.array, 3 * i);
        attribute.needsUpdate = true;
    }

    update(state) {
        const { body, material } = this;
        this.group.visible = isShown(state, body.index) && body.isThere(state.frame);
        if (!this.group.visible) return;
        this.pose(state.frame);
        this.paint(state);
        const soft = body.kind !== "bone";
        const opacity = soft ? state.opacity : 1;
        const transparent = opacity < 1;
        // Inside faces that peep out at the rim of a closed body would be dark dots; a cut or open body shows its inside.
        const side = body.volume && !(soft && state.cut.on) ? FrontSide : DoubleSide;
        if (material.transparent !== transparent || material.flatShading === state.smooth || material.side !== side) {
            material.transparent = transparent;
            material.side = side;
            material.flatShading = !state.smooth;
            material.needsUpdate = true;
        }
        material.opacity = opacity;
        material.depthWrite = !transparent;
        this.mesh.renderOrder = transparent ? 2 : 0;
        const cut = soft && state.cut.on ? 1 : 0;
        material.userData.own.uCutOn.value = cut;
        const selected = state.selectedBodies.includes(body.index);
        material.userData.own.uSelect.value.set(selected ? (state.theme === "dark" ? 0x07162c : 0x061226) : 0);
        this.outline.visible = this.mask.visible = selected && state.surface !== "wire" && !cut;
        this.mesh.visible = state.surface !== "wire";
        this.edges.visible = state.surface !== "shaded";
        this.edges.material.color.set(
            state.surface === "wire" ? (selected ? "#2f81f7" : body.colour) : state.theme === "dark" ? "#0b0d10" : "#1c232b");
        this.edges.material.opacity = state.surface === "wire" ? 0.9 : 0.35;
    }
}
