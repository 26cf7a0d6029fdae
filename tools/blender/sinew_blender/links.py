# What Blender sends to a graph: motion, meshes and numbers, read at the current frame.
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np

from . import presence, space
from .module import Problem


def enabled(scene):
    return [link for link in scene.sinew.links if link.enabled]


def signature(scene):
    """Changes with what is linked, not with how it moves."""
    return tuple(
        (k.kind, k.plug, k.object.name_full if k.object else "", k.bone, k.path, k.rest) for k in enabled(scene)
    )


def kind_and_name(block):
    """Of a datablock: a mesh may be called as an object is."""
    return type(block).__name__, block.name_full


def owners(scene):
    """What must not change, or what was sent is no longer true: the kinds and names of objects, and of their data, that
    must not move, and of those of whose properties some are sent."""
    moving, dials = set(), set()
    for link in enabled(scene):
        ob = link.object
        if link.kind == "VALUE" and ob is not None:
            dials.add(kind_and_name(ob))
        while ob is not None:
            moving.add(kind_and_name(ob))
            if ob.data is not None:
                moving.add(kind_and_name(ob.data))
            ob = ob.parent
    return moving, dials


def check(scene, types):
    """Raises Problem for links that lead nowhere. types: of the graph's nodes, by name."""
    seen = set()
    for link in enabled(scene):
        if link.object is None:
            raise Problem(f'Nothing sends to "{link.plug}": its link has no object')
        if link.plug in seen:
            raise Problem(f'Two links send to "{link.plug}"', "Switch one of them off.")
        seen.add(link.plug)
        node = link.plug if link.kind == "MESH" else link.plug.rpartition(".")[0]
        if node not in types:
            hint = "Write node.attribute, or for a mesh the name of the node."
            raise Problem(f'{link.object.name} sends to "{link.plug}", but the graph has no node "{node}"', hint)
        if link.kind == "MESH" and link.object.type != "MESH":
            raise Problem(f'{link.object.name} is no mesh and cannot be sent to "{link.plug}"')
        if link.bone and (link.object.type != "ARMATURE" or link.bone not in link.object.pose.bones):
            raise Problem(f'{link.object.name} has no bone "{link.bone}", which shall move "{link.plug}"')


def check_presence(scene):
    """Raises Problem where Blender does not move what is linked."""
    linked = enabled(scene)
    whole = [link.object for link in linked if link.kind != "MATRIX"]
    presence.check(scene, whole, [link.object for link in linked if link.kind == "MATRIX"])


def value_of(link, depsgraph):
    ob = link.object.evaluated_get(depsgraph)
    try:
        found = ob.path_resolve(link.path)
        return np.array(found, dtype=np.float64)
    except (ValueError, TypeError) as error:
        hint = 'Write a data path, as location or sinew.excitation or ["strain"].'
        raise Problem(f'{ob.name} has no number at "{link.path}" for "{link.plug}": {error}', hint) from error


def world_of(link, depsgraph):
    """Where the object or bone is now, in Blender's world."""
    ob = link.object.evaluated_get(depsgraph)
    world = space.array(ob.matrix_world)
    return world @ space.array(ob.pose.bones[link.bone].matrix) if link.bone else world


def rest_of(link, depsgraph):
    """Where it is while the mesh is as modelled; called at the first frame."""
    if link.rest == "START":
        return world_of(link, depsgraph)
    if not link.bone:
        return np.eye(4)
    ob = link.object.evaluated_get(depsgraph)
    return space.array(ob.matrix_world) @ space.array(link.object.data.bones[link.bone].matrix_local)


def own_points(ob, depsgraph):
    """The vertices of a mesh with its modifiers, in the object's own space."""
    evaluated = ob.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
    finally:
        evaluated.to_mesh_clear()
    return points.reshape(-1, 3).astype(np.float64)


def world_points(ob, depsgraph):
    """The same in Blender's world."""
    return space.moved(space.array(ob.evaluated_get(depsgraph).matrix_world), own_points(ob, depsgraph))


def faces(mesh):
    """(sizes, corners) of a Blender mesh."""
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return sizes, corners


def outward(sizes, corners, world):
    """The same faces, looking outwards after a matrix that mirrors: each keeps its first corner."""
    if np.linalg.det(world[:3, :3]) >= 0:
        return sizes, corners
    out, ends = corners.copy(), np.cumsum(sizes)
    for begin, end in zip(ends - sizes, ends):
        out[begin + 1 : end] = corners[begin + 1 : end][::-1]
    return sizes, out


def single(points):
    """What point caches hold of points: 32 bits. What is sent and what is exported are then the same numbers."""
    return points.astype(np.float32).astype(np.float64)
