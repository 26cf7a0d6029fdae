// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies and graph nodes point at each other: choosing one highlights the other.

export class Selection {
    constructor(scene, store) {
        this.scene = scene;
        this.store = store;
        this.nodes = new Map((scene.graph?.nodes ?? []).map((n, i) => [n.name, i]));
        this.bodyOfNode = new Map();
        scene.bodies.forEach((b, i) => b.node && this.bodyOfNode.set(b.node, i));
    }

    selectBody(index) {
        if (index < 0) return this.clear();
        this.store.set({ selectedBodies: [index], selectedNode: this.scene.bodies[index].node || null });
    }
    selectNode(name) {
        this.store.set({ selectedNode: name, selectedBodies: this.bodiesOf(name) });
    }
    clear() {
        this.store.set({ selectedBodies: [], selectedNode: null });
    }

    /** The body that a node is; the two ends of an attachment; the bodies that it goes into; or those that go into it. */
    bodiesOf(name) {
        if (this.bodyOfNode.has(name)) return [this.bodyOfNode.get(name)];
        const ends = this.scene.attachments.filter((a) => a.node === name);
        if (ends.length) return [...new Set(ends.flatMap((a) => [a.source, a.target]))];
        const into = this.bodiesAlong(name, (wire) => wire);
        return into.length ? into : this.bodiesAlong(name, ([from, to]) => [to, from]);
    }

    /** The first bodies on the ways out of a node; `turned` gives a wire's two ends in the order of walking. */
    bodiesAlong(name, turned) {
        const start = this.nodes.get(name);
        if (start === undefined) return [];
        const found = new Set(), seen = new Set([start]), open = [start];
        while (open.length) {
            const at = open.pop();
            for (const [from, to] of this.scene.graph.wires.map(turned)) {
                if (from !== at || seen.has(to)) continue;
                seen.add(to);
                const body = this.bodyOfNode.get(this.scene.graph.nodes[to].name);
                if (body !== undefined) found.add(body);
                else open.push(to);
            }
        }
        return [...found].sort((a, b) => a - b);
    }

    /** Nodes directly before and after a node. */
    neighbours(name) {
        const at = this.nodes.get(name), { wires = [], nodes = [] } = this.scene.graph ?? {};
        return {
            before: wires.filter(([, to]) => to === at).map(([from]) => nodes[from].name),
            after: wires.filter(([from]) => from === at).map(([, to]) => nodes[to].name),
        };
    }
}
