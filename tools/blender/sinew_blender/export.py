# A graph of a scene: bones and muscles as their objects say, meshes, paint and motion in files beside it.
# SPDX-License-Identifier: GPL-3.0-or-later
import json
import os
from contextlib import contextmanager

import bpy
import numpy as np

from . import links, presence, shapes, space, stepping
from .files import FileNames, PointCache, Staged
from .module import Problem
from .shapes import node_name


class Done:
    def __init__(self, bones, muscles):
        self.bones, self.muscles, self.warnings = bones, muscles, []


class _Graph:
    """Nodes in the order in which they are added, each name once."""

    def __init__(self):
        self.nodes = {}

    def add(self, name, kind, **inputs):
        if name in self.nodes:
            raise Problem(f'Two nodes would be called "{name}"', "Rename one of the objects.")
        self.nodes[name] = {"type": kind, "inputs": inputs} if inputs else {"type": kind}


def _from(plug):
    return {"from": plug}


def parts(scene, role):
    return [ob for ob in scene.objects if ob.type == "MESH" and ob.sinew.role == role]


def write(scene, path):
    """Writes PATH and the folder of the same name without its ending, all of it or nothing. The graph has Blender's
    axes and units; meshes are as posed at the scene's first frame."""
    bones, muscles = parts(scene, "BONE"), parts(scene, "MUSCLE")
    if not muscles:
        raise Problem("No object has the role Muscle", "Choose roles in the sidebar.")
    rigid = [ob for ob in bones if not ob.sinew.deforms]
    presence.check(scene, [ob for ob in bones + muscles if ob not in rigid], rigid)
    with _out_of_edit_mode(bones + muscles):
        return _write(scene, path, bones, muscles)


@contextmanager
def _out_of_edit_mode(objects):
    """What is being edited is not in the mesh yet."""
    editing = any(ob.mode == "EDIT" for ob in objects)
    if editing:
        bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        if editing:
            bpy.ops.object.mode_set(mode="EDIT")


def _write(scene, path, bones, muscles):
    done = Done(len(bones), len(muscles))
    base = os.path.splitext(os.path.basename(path))[0]
    names = FileNames(node_name(ob) for ob in bones + muscles)
    with Staged(os.path.join(os.path.dirname(os.path.abspath(path)), base), path) as stage:
        graph = _Graph()
        motion = _Motion(scene, bones, muscles, stage, names, done.warnings)
        for ob in bones:
            _bone(graph, ob, base, names)
        paint = {}
        for ob in muscles:
            _muscle(graph, ob, base, names, motion, paint, scene)
        attachments = [n for n, node in graph.nodes.items() if node["type"] == "zAttachment"]
        if not attachments:
            done.warnings.append("No muscle has an attachment: they will fall")
        graph.add(
            "solver",
            "zSolver",
            bodies=[_from(node_name(ob) + ".outBody") for ob in bones + muscles],
            attachments=[_from(n + ".outAttachment") for n in attachments],
            scale=1 / space.decimal(scene.unit_settings.scale_length),
            gravity=[space.decimal(g) for g in scene.sinew.gravity],
        )
        motion.write(stage.file("motion.json"))
        if paint:
            with open(stage.file("paint.json"), "w", encoding="utf-8") as file:
                json.dump(paint, file)
        timing = {
            "fps": scene.render.fps / space.decimal(scene.render.fps_base),
            "start": scene.frame_start,
            "end": scene.frame_end,
        }
        stage.commit(_text(timing, graph.nodes))
    return done


def _text(timing, nodes):
    """A line a node, as hands write graphs."""
    lines = [f"    {json.dumps(name)}: {json.dumps(node)}" for name, node in nodes.items()]
    return (
        '{\n  "format": "sinew 1",\n'
        f'  "timing": {json.dumps(timing)},\n'
        '  "nodes": {\n' + ",\n".join(lines) + "\n  }\n}\n"
    )


class _Motion:
    """What is read in one pass over the frames: matrices of bones, excitations, vertices of deforming bones. Meshes are
    written at the first frame. warnings: takes what is lost."""

    def __init__(self, scene, bones, muscles, stage, names, warnings):
        self.frames, self.excitations = [], {node_name(ob): [] for ob in muscles}
        rests, caches = {}, {}
        rigid = [ob for ob in bones if not ob.sinew.deforms]
        deforming = [ob for ob in bones if ob.sinew.deforms]
        here, between = scene.frame_current, scene.frame_subframe
        modelled = {}  # of rigid bones: their points in their own space at the first frame
        try:
            with stepping.alone(scene), _without_display(muscles):
                presence.tag(muscles)
                for frame in range(scene.frame_start, scene.frame_end + 1):
                    scene.frame_set(frame)
                    depsgraph = presence.depsgraph(scene)
                    if frame == scene.frame_start:
                        for ob in bones + muscles:
                            _write_mesh(ob, depsgraph, stage.file("meshes", names.of(node_name(ob)) + ".obj"))
                    entry = {"frame": frame, "bones": {}}
                    for ob in rigid:
                        now = space.array(ob.evaluated_get(depsgraph).matrix_world)
                        rest = rests.setdefault(ob.name, now)
                        entry["bones"][node_name(ob)] = space.motion(now, rest, np.eye(4), ob.name).ravel().tolist()
                    for ob in rigid if frame in (scene.frame_start, scene.frame_end) else ():
                        points = links.own_points(ob, depsgraph)
                        before = modelled.setdefault(ob.name, points)
                        if not _is_rigid(before, points):
                            warnings.append(f"{ob.name} changes its shape, but Deforms is off: its first one is kept")
                    for ob in muscles:
                        value = ob.evaluated_get(depsgraph).sinew.excitation
                        entry[node_name(ob) + ".excitation"] = value
                        self.excitations[node_name(ob)].append(value)
                    for ob in deforming:
                        points = links.world_points(ob, depsgraph)
                        if ob.name not in caches:
                            file = stage.file("meshes", names.of(node_name(ob)) + ".pc2")
                            caches[ob.name] = PointCache(file, len(points), scene.frame_start)
                        caches[ob.name].add(points)
                    self.frames.append(entry)
            for cache in caches.values():
                cache.finish()
        except BaseException:
            for cache in caches.values():
                cache.discard()
            raise
        finally:
            with stepping.alone(scene):
                scene.frame_set(here, subframe=between)

    def write(self, path):
        head = {"description": "Motion of a Blender scene, in its units and axes", "convention": "row-major"}
        frames = ",\n".join(json.dumps(f) for f in self.frames)
        with open(path, "w", encoding="utf-8") as file:
            file.write(json.dumps(head)[:-1] + ', "frames": [\n' + frames + "\n]}\n")


@contextmanager
def _without_display(muscles):
    """Without the modifiers that only draw muscles smoother."""
    off = [m for ob in muscles for m in ob.modifiers if m.type in shapes.DISPLAY and m.show_viewport]
    for modifier in off:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in off:
            modifier.show_viewport = True


def _is_rigid(before, now):
    """Whether two shapes in an object's own space are one, but for rounding."""
    if before.shape != now.shape:
        return False
    return len(now) == 0 or np.abs(now - before).max() <= 1e-5 * max(np.abs(now).max(), 1e-30)


def _write_mesh(ob, depsgraph, path):
    """An OBJ of what is seen at the first frame: the mesh with its modifiers and shape keys, of a muscle but for those
    that only draw it smoother. Faces look outwards where the object mirrors."""
    evaluated = ob.evaluated_get(depsgraph)
    sizes, corners = links.faces(evaluated.data)
    points = links.world_points(ob, depsgraph)
    if ob.sinew.role == "BONE":
        points = links.single(points) if ob.sinew.deforms else points
    elif any(not np.array_equal(a, b) for a, b in zip(links.faces(ob.data), (sizes, corners))) or len(points) != len(
        ob.data.vertices
    ):
        raise Problem(
            f"Modifiers of {ob.name} give it other vertices or faces, which its vertex groups do not have",
            "Apply them before the muscle is set up, or switch them off in viewports.",
        )
    sizes, corners = links.outward(sizes, corners, space.array(evaluated.matrix_world))
    if len(sizes) == 0:
        raise Problem(f"{ob.name} has no faces")
    ends = np.cumsum(sizes)
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        for begin, end in zip(ends - sizes, ends):
            file.write("f " + " ".join(str(v + 1) for v in corners[begin:end]) + "\n")


def _bone(graph, ob, base, names):
    n = node_name(ob)
    mesh = f"{base}/meshes/{names.of(n)}"
    if ob.sinew.deforms:
        graph.add(n + "Model", "meshFile", file=mesh + ".obj")
        graph.add(n + "Mesh", "meshSequence", file=mesh + ".pc2", mesh=_from(n + "Model.outMesh"))
        graph.add(n, "zBone", mesh=_from(n + "Mesh.outMesh"))
        return
    graph.add(n + "Mesh", "meshFile", file=mesh + ".obj")
    graph.add(n + "Move", "transform", track=f"{base}/motion.json", trackName=n)
    graph.add(n, "zBone", mesh=_from(n + "Mesh.outMesh"), matrix=_from(n + "Move.outMatrix"))


def _weights(ob, group):
    """What is painted: a number a vertex."""
    found = ob.vertex_groups.get(group)
    if found is None:
        raise Problem(f'{ob.name} has no vertex group "{group}"', "Paint it, or choose another one.")
    out = [0.0] * len(ob.data.vertices)
    for v in ob.data.vertices:
        for g in v.groups:
            if g.group == found.index:
                out[v.index] = space.decimal(g.weight)
    if not any(out):
        raise Problem(f'The vertex group "{group}" of {ob.name} is empty')
    return out


def _muscle(graph, ob, base, names, motion, paint, scene):
    n, s = node_name(ob), ob.sinew
    mesh = _from(n + "Mesh.outMesh")
    graph.add(n + "Mesh", "meshFile", file=f"{base}/meshes/{names.of(n)}.obj")
    graph.add(n + "Tets", "zTet", mesh=mesh, tetSize=space.decimal(s.tet_size))
    graph.add(
        n + "Flesh",
        "zMaterial",
        youngsModulus=space.decimal(s.youngs_modulus),
        poissonsRatio=space.decimal(s.poissons_ratio),
        massDensity=space.decimal(s.mass_density),
    )
    painted = {}

    def paint_of(group):
        """The node that reads a vertex group; written once."""
        if group not in painted:
            key = str(len(painted))
            paint.setdefault(n, {})[key] = _weights(ob, group)
            painted[group] = f"{n}Paint{key}"
            pointer = "/" + n.replace("~", "~0").replace("/", "~1") + "/" + key
            graph.add(painted[group], "weights", mesh=mesh, mode="file", file=f"{base}/paint.json", key=pointer)
        return _from(painted[group] + ".outWeights")

    tissue = {"mesh": mesh, "tets": _from(n + "Tets.outTets"), "material": s.law}
    tissue["materials"] = [_from(n + "Flesh.outMaterial")]
    if s.fibres:
        for end, group in (("Origin", s.origin), ("Insertion", s.insertion)):
            if not group:
                raise Problem(f"The fibres of {ob.name} have no {end}", "Choose the vertex group where they begin and end.")
        graph.add(n + "Ends", "endPoints", mesh=mesh, source=paint_of(s.origin), sink=paint_of(s.insertion))
        values = motion.excitations[n]
        excitation = values[0]
        if any(v != excitation for v in values):
            graph.add(n + "Drive", "trackChannel", file=f"{base}/motion.json", channel=n + ".excitation")
            excitation = _from(n + "Drive.outValue")
        graph.add(
            n + "Fibre",
            "zFiber",
            endPoints=_from(n + "Ends.outEndPoints"),
            strength=space.decimal(s.strength),
            contractionLimit=space.decimal(s.contraction_limit),
            excitation=excitation,
        )
        tissue["fibers"] = [_from(n + "Fibre.outFiber")]
    graph.add(n, "zTissue", **tissue)
    for i, a in enumerate(s.attachments):
        if a.target is None or a.target.sinew.role == "NONE" or a.target.name not in scene.objects:
            target = "nothing"
            if a.target is not None:
                gone = a.target.name not in scene.objects
                target = f"{a.target.name}, which is " + (
                    "not in this scene: it may have been deleted" if gone else "neither bone nor muscle"
                )
            raise Problem(f"Attachment {i + 1} of {ob.name} leads to {target}", "Choose a bone or a muscle.")
        inputs = {"source": _from(n + ".outBody"), "target": _from(node_name(a.target) + ".outBody")}
        if a.group:
            inputs["weights"] = paint_of(a.group)
        if a.mode != "fixed":
            inputs["attachmentMode"] = a.mode
        graph.add(f"{n}Hold{i + 1}", "zAttachment", stiffness=space.decimal(a.stiffness), **inputs)


def connect(scene, path):
    """Lets the scene drive the graph that was written of it."""
    settings = scene.sinew
    settings.graph = path
    settings.plug = ""
    settings.up_axis, settings.units, settings.exported = "Z", "SAME", path
    settings.links.clear()

    def add(kind, plug, ob, link_path=""):
        link = settings.links.add()
        link.kind, link.plug, link.object, link.path, link.rest = kind, plug, ob, link_path, "START"

    for ob in parts(scene, "BONE"):
        if ob.sinew.deforms:
            add("MESH", node_name(ob) + "Mesh", ob)
        else:
            add("MATRIX", node_name(ob) + ".matrix", ob)
    for ob in parts(scene, "MUSCLE"):
        if ob.sinew.fibres:
            add("VALUE", node_name(ob) + "Fibre.excitation", ob, "sinew.excitation")
