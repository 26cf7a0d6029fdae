# What the tests in Blender share: the installed add-on, small scenes, the command line to compare with.
# SPDX-License-Identifier: GPL-3.0-or-later
import contextlib
import io
import math
import os
import subprocess
import sys
import tempfile
import unittest

import bpy
import numpy as np

ROOT = os.environ["SINEW_SOURCE_DIR"]
PROGRAM = os.environ["SINEW_PROGRAM"]


def install():
    bpy.ops.preferences.addon_install(filepath=os.environ["SINEW_BLENDER_ZIP"])
    bpy.ops.preferences.addon_enable(module="sinew_blender")


def run_class(module):
    """Runs the class that the environment names and ends Blender with its result."""
    suite = unittest.defaultTestLoader.loadTestsFromName(os.environ["SINEW_TEST_CLASS"], module)
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
    sys.stdout.flush()
    sys.exit(0 if result.wasSuccessful() and result.testsRun > 0 else 3)


class Case(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        if "sinew_blender" not in bpy.context.preferences.addons:
            install()
        self.folder = tempfile.mkdtemp(dir=os.environ["SINEW_TEST_FOLDER"])
        self.scene = bpy.context.scene
        self.settings = self.scene.sinew

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def load(self, graph, keep=False):
        self.settings.keep_frames = keep
        self.settings.graph = os.path.join(ROOT, graph)
        self.assertEqual(bpy.ops.sinew.load(), {"FINISHED"})
        self.settings.live = True

    def state(self):
        from sinew_blender import session

        return session.peek(self.scene)

    def simulated(self):
        return self.state().session.counts.simulated

    def points(self, body):
        from sinew_blender import shapes

        return coordinates(shapes.targets(self.scene)[body].data)

    @contextlib.contextmanager
    def refused(self, *words):
        """An operator fails with these words in its report."""
        with self.assertRaises(RuntimeError) as caught:
            yield
        for word in words:
            self.assertIn(word, str(caught.exception))

    @contextlib.contextmanager
    def told(self, *words):
        """A frame change says this on the console and keeps it for the panel."""
        out = io.StringIO()
        with contextlib.redirect_stderr(out):
            yield
        for word in words:
            self.assertIn(word, out.getvalue())
        from sinew_blender import session

        kept = " ".join(str(m) for m in session.messages(self.scene))
        for word in words:
            self.assertIn(word, kept)


class MuscleCase(Case):
    """The muscle between two plates, exported."""

    def setUp(self):
        super().setUp()
        muscle_scene()
        self.settings.keep_frames = False

    def export(self, name="pull.json", **more):
        self.graph = self.path(name)
        self.assertEqual(bpy.ops.sinew.export(filepath=self.graph, **more), {"FINISHED"})

    def live(self):
        self.export()
        self.settings.live = True
        bpy.ops.sinew.read_motion()

    def exported(self, mesh):
        """The vertices and faces of an exported mesh."""
        with open(self.path("pull", "meshes", mesh + ".obj")) as file:
            rows = [line.split() for line in file]
        points = np.array([row[1:] for row in rows if row[0] == "v"], np.float64)
        return points, [[int(v) - 1 for v in row[1:]] for row in rows if row[0] == "f"]

    def volume(self, mesh):
        points, faces = self.exported(mesh)
        return sum(np.dot(points[f[0]], np.cross(points[f[i]], points[f[i + 1]]))
                   for f in faces for i in range(1, len(f) - 1)) / 6


def coordinates(mesh):
    out = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", out)
    return out.reshape(-1, 3)


def program(*words):
    """What the command line says."""
    done = subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise AssertionError(f"sinew {' '.join(words)}: {done.returncode}\n{done.stdout}")
    return done.stdout


def frames_of_program(graph, first, last, out):
    """By frame and body the positions that `sinew run` writes, 64 bits."""
    program("run", graph, "--frames", f"{first}-{last}", "--no-cache", "--out", out, "--format", "obj", "--quiet")
    found = {}
    for name in os.listdir(os.path.join(out, "obj")):
        body, frame, _ = name.rsplit(".", 2)
        with open(os.path.join(out, "obj", name)) as file:
            rows = [line.split()[1:4] for line in file if line.startswith("v ")]
        found[int(frame), body] = np.array(rows, np.float64)
    return found


def box(name, size, place):
    x, y, z = (s / 2 for s in size)
    corners = [(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    ob = bpy.data.objects.new(name, mesh)
    ob.location = place
    bpy.context.scene.collection.objects.link(ob)
    return ob


def tube(name, radius, length, around, along):
    """Closed, along z, around the middle of `place`."""
    rings = [(radius * math.cos(math.tau * i / around), radius * math.sin(math.tau * i / around)) for i in range(around)]
    points = [(x, y, length * (k / along - 0.5)) for k in range(along + 1) for x, y in rings]
    faces = [
        (k * around + i, k * around + (i + 1) % around, (k + 1) * around + (i + 1) % around, (k + 1) * around + i)
        for k in range(along)
        for i in range(around)
    ]
    faces.append(tuple(reversed(range(around))))
    faces.append(tuple(along * around + i for i in range(around)))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    ob = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def key(ob, path, frame, value, interpolation="LINEAR"):
    target, _, attribute = path.rpartition(".")
    setattr(ob.path_resolve(target) if target else ob, attribute, value)
    ob.keyframe_insert(path, frame=frame)
    for curve in ob.id_data.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = interpolation


def muscle_scene(last=6):
    """A muscle in metres between a plate that stands still and one that an armature's bone swings."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, last
    scene.frame_set(1)
    upper = box("plate.upper", (0.1, 0.1, 0.01), (0, 0, 0.1))
    lower = box("lower", (0.1, 0.1, 0.01), (0, 0, -0.1))
    armature = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones.new("arm")
    bone.head, bone.tail = (0.2, 0, -0.1), (0.2, 0, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")
    world = lower.matrix_world.copy()
    lower.parent, lower.parent_type, lower.parent_bone = armature, "BONE", "arm"
    bpy.context.view_layer.update()
    lower.matrix_world = world
    pose = armature.pose.bones["arm"]
    pose.rotation_mode = "XYZ"
    for frame in range(1, last + 1):
        pose.rotation_euler = (0.02 * (frame - 1), 0, 0.03 * (frame - 1))
        pose.keyframe_insert("rotation_euler", frame=frame)
    for curve in armature.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "CONSTANT"
    belly = tube("belly", 0.02, 0.18, 12, 9)
    ends = {"top": [], "bottom": []}
    for v in belly.data.vertices:
        if abs(v.co.z) > 0.085:
            ends["top" if v.co.z > 0 else "bottom"].append(v.index)
    for name, vertices in ends.items():
        belly.vertex_groups.new(name=name).add(vertices, 1, "REPLACE")
    s = belly.sinew
    s.role, s.fibres, s.origin, s.insertion, s.strength = "MUSCLE", True, "top", "bottom", 30000
    s.tet_size = 0.02
    for group, target in (("top", upper), ("bottom", lower)):
        a = s.attachments.add()
        a.group, a.target = group, target
    key(belly, "sinew.excitation", 1, 0)
    key(belly, "sinew.excitation", last, 1)
    upper.sinew.role = lower.sinew.role = "BONE"
    scene.frame_set(1)
    return scene


def pixels(path):
    image = bpy.data.images.load(path)
    out = np.array(image.pixels[:])
    bpy.data.images.remove(image)
    return out


class Layout:
    """Stands in for Blender's, which draws only with a window: knows what is drawn, and that it exists."""

    def __init__(self):
        self.drawn = []

    def prop(self, data, name, **_):
        assert name in data.bl_rna.properties, name
        self.drawn.append(name)

    def prop_search(self, data, name, other, collection, **_):
        assert name in data.bl_rna.properties and hasattr(other, collection), name
        self.drawn.append(name)

    def operator(self, name, **_):
        kind, _, word = name.partition(".")
        self.drawn.append(name)
        assert getattr(getattr(bpy.ops, kind), word).get_rna_type().identifier
        return type("Arguments", (), {})()

    def label(self, text, icon="NONE"):
        self.drawn.append(text)

    def box(self, **_):
        return self

    row = column = box
