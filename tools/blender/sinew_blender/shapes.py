# Shapes of bodies on Blender's meshes: found or made once, then only positions are written.
# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
import numpy as np

from . import links, space
from .module import Problem

_colours = {"zBone": (0.93, 0.885, 0.79), "zCloth": (0.5, 0.55, 0.65)}
_flesh = (0.68, 0.235, 0.2)


# Modifiers that only draw a mesh smoother: what is simulated is the mesh below them.
DISPLAY = ("SUBSURF", "MULTIRES")


def targets(scene):
    """By the name of the body: the mesh object that shows it, of several the first."""
    out = {}
    for ob in scene.objects:
        if ob.sinew.body and ob.type == "MESH":
            out.setdefault(ob.sinew.body, ob)
    return out


def places(scene, state, number):
    """Changes with which meshes show bodies, and with where these are at a frame."""
    return tuple(
        (body, ob.name_full, ob.data.name_full, state.world(number, ob).tobytes())
        for body, ob in targets(scene).items()
    )


def driven(scene, graph):
    """Bodies that Blender moves itself: it shows them already."""
    names = {k.plug.rpartition(".")[0] for k in links.enabled(scene) if k.kind == "MATRIX"}
    meshes = {k.plug + ".outMesh" for k in links.enabled(scene) if k.kind == "MESH"}
    for name, node in graph["nodes"].items():
        mesh = node.get("inputs", {}).get("mesh")
        if node.get("type") == "zBone" and isinstance(mesh, dict) and mesh.get("from") in meshes:
            names.add(name)
    return names


def _sources(scene):
    """By the name of the body: the muscle that it was exported from."""
    return {node_name(ob): ob for ob in scene.objects if ob.sinew.role == "MUSCLE" and ob.type == "MESH"}


def node_name(ob):
    """What an object is called in a graph: names there hold no dots."""
    return "".join("_" if c == "." or ord(c) < 32 else c for c in ob.name)


def _collection(scene):
    """Of this scene alone: another one has other bodies."""
    found = next((c for c in scene.collection.children_recursive if c.name.split(".")[0] == "Sinew"), None)
    if found is None:
        found = bpy.data.collections.new("Sinew")
        scene.collection.children.link(found)
    return found


def _linear(c):
    """sRGB to the linear light of Blender's shaders (IEC 61966-2-1)."""
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def _material(node):
    colour = node.get("inputs", {}).get("colour")
    written = isinstance(colour, list) and len(colour) == 3
    rgb = tuple(colour) if written else _colours.get(node.get("type"), _flesh)
    name = "Sinew {:.3f} {:.3f} {:.3f}".format(*rgb)
    found = bpy.data.materials.get(name)
    if found is None:
        found = bpy.data.materials.new(name)
        found.use_nodes = True
        linear = (*(_linear(c) for c in rgb), 1)
        found.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = linear
        found.diffuse_color = linear
    return found


def _new_mesh(name, body):
    sizes, corners = body.face_sizes, body.face_vertices
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(body.points))
    mesh.loops.add(len(corners))
    mesh.polygons.add(len(sizes))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.foreach_set("loop_start", np.concatenate(([0], np.cumsum(sizes)[:-1])).astype(np.int32))
    mesh.polygons.foreach_set("loop_total", sizes)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(sizes), bool))
    mesh.update(calc_edges=True)
    return mesh


def make(scene, state, frame):
    """Meshes for the bodies that have none; what came from a mesh of the scene is a copy of that. Gives their names."""
    there, moved, sources, made = targets(scene), driven(scene, state.graph), _sources(scene), []
    for name in frame.names:
        if name in there or name in moved:
            continue
        body, source = frame[name], sources.get(name)
        mesh = None if source is None else _copy(source, body)
        if mesh is not None:
            source.hide_render = True
            if source.name in bpy.context.view_layer.objects:
                source.hide_set(True)
        else:
            mesh = _new_mesh(name, body)
            mesh.materials.append(_material(state.graph["nodes"].get(name, {})))
        ob = bpy.data.objects.new(name + " (Sinew)", mesh)
        ob.sinew.body = name
        _collection(scene).objects.link(ob)
        if source is not None:
            _take_looks(ob, source)
        made.append(name)
    return made


def _copy(source, body):
    """The mesh of an object, with all that hangs on its vertices and faces, as the body has it; None if it has others."""
    mesh = source.data.copy()
    if mesh.shape_keys is not None:  # they would stand above what is written
        keyed = bpy.data.objects.new(source.name, mesh)
        keyed.shape_key_clear()
        bpy.data.objects.remove(keyed)
    if not _same_faces(mesh, body):
        mesh.flip_normals()  # the object mirrors
    if _same_faces(mesh, body):
        return mesh
    bpy.data.meshes.remove(mesh)
    return None


def _take_looks(ob, source):
    """Materials that hang on the object instead of its mesh, and modifiers that draw it smoother."""
    for own, slot in zip(ob.material_slots, source.material_slots):
        if slot.link == "OBJECT":
            own.link, own.material = "OBJECT", slot.material
    for modifier in source.modifiers:
        if modifier.type != "SUBSURF":
            continue
        own = ob.modifiers.new(modifier.name, modifier.type)
        for name in ("levels", "render_levels", "subdivision_type", "uv_smooth", "boundary_smooth", "use_creases",
                     "show_viewport", "show_render", "show_on_cage", "quality"):
            setattr(own, name, getattr(modifier, name))


def _same_faces(mesh, body):
    if len(mesh.vertices) != len(body.points) or len(mesh.polygons) != len(body.face_sizes):
        return False
    sizes, corners = links.faces(mesh)
    return np.array_equal(sizes, body.face_sizes) and np.array_equal(corners, body.face_vertices)


def pairs(scene, state, frame):
    """(object, body) of all that can be shown, and a Problem for each mesh that cannot; faces are compared once for each
    graph."""
    out, problems = [], []
    for name, ob in targets(scene).items():
        found = _wrong(scene, state, frame, name, ob)
        if found is None:
            out.append((ob, frame[name]))
        else:
            problems.append(found)
    return out, problems


def _wrong(scene, state, frame, name, ob):
    """Why an object cannot show the body of that name; None if it can."""
    if name not in frame:
        there = ", ".join(frame.names)
        return Problem(
            f'{ob.name} shows "{name}", but there is no such body',
            f'Delete it, or let it show another one of what there is: {there}.',
        )
    others = [o.name for o in scene.objects if o.type == "MESH" and o.sinew.body == name and o != ob]
    if others:
        return Problem(f'{ob.name} and {others[0]} both show "{name}"', 'Clear "Shows" of one of them.')
    if ob.data.shape_keys is not None:
        return Problem(f"{ob.name} has shape keys, which stand above the shape of {name}", "Remove them.")
    body = frame[name]
    key = (ob.data.name_full, len(ob.data.vertices), len(ob.data.loops))
    if state.mapped.get(name) != key:
        if not _same_faces(ob.data, body):
            return Problem(
                f'{ob.name} shows "{name}" but has other faces: {len(ob.data.vertices)} vertices and '
                f"{len(ob.data.polygons)} faces, the body has {len(body.points)} and {len(body.face_sizes)}",
                "Delete it and use Make Shapes, or give it the mesh that the graph reads.",
            )
        state.mapped[name] = key
    return None


def local(body, ob, world, from_sinew):
    """What Blender holds of a body's points, in an object whose matrix is `world`: (n, 3) of 32 bits."""
    return space.moved(space.inverse(world, ob.name) @ from_sinew, body.points).astype(np.float32)


def moves(ob):
    """Whether the object itself may be elsewhere at another frame."""
    return ob.parent is not None or ob.animation_data is not None or len(ob.constraints) > 0


def write(scene, state, number, frame):
    """Positions of a frame on the meshes that show them. Raises Problem where one cannot, after the others."""
    from_sinew = state.space(scene)
    found, problems = pairs(scene, state, frame)
    for ob, body in found:
        ob.data.vertices.foreach_set("co", local(body, ob, state.world(number, ob), from_sinew).ravel())
        ob.data.update()
    if problems:
        raise problems[0]
