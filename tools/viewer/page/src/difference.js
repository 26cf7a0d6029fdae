// SPDX-License-Identifier: GPL-3.0-or-later
// How far apart two runs are: each vertex of a body from the same vertex of the body of the same name, at the same frame.

/** The body in the other run that a body can be compared with, or null. */
export function twinOf(body, scene) {
    return scene.other?.bodies.find((b) => b.name === body.name && b.vertices === body.vertices) ?? null;
}

/** Distances in metres, one a vertex; false where the other run has no such body or frame. */
export function writeDifference(body, scene, frame, out) {
    const twin = twinOf(body, scene), number = scene.frames[frame].frame;
    const there = twin ? scene.other.frames.findIndex((f) => f.frame === number) : -1;
    if (there < 0 || !body.isThere(frame) || !twin.isThere(there)) return false;
    const p = body.positionsAt(frame), q = twin.positionsAt(there), here = 1 / scene.unitsPerMetre, other = 1 / scene.other.unitsPerMetre;
    for (let i = 0; i < out.length; ++i)
        out[i] = Math.hypot(...[0, 1, 2].map((c) => here * p[3 * i + c] - other * q[3 * i + c]));
    return true;
}
