# What of the add-on for Blender needs no Blender: file names, files that are whole or not there, axes, what is sent.
# SPDX-License-Identifier: GPL-3.0-or-later
import errno
import json
import os
import types
import unittest
from unittest import mock

import numpy as np
import sinew
from blender_stand_ins import PYRAMID, TET, InFolder, Mesh, Objects, part, show
from scenes import hanging

files, space, module = part("files"), part("space"), part("module")


class Names(unittest.TestCase):
    def test_no_name_leads_out_of_a_folder_or_stands_for_numbers(self):
        names = files.FileNames()
        for name, wanted in (("arm/left", "arm_left"), ("/home/u/x", "_home_u_x"), ("../x", "___x"), ("a#1", "a_1"),
                             ("a\\b:c", "a_b_c"), ("belly (Sinew)", "belly (Sinew)"), ("Bizeps-ä", "Bizeps-ä")):
            self.assertEqual(names.of(name), wanted)

    def test_each_name_has_a_file_of_its_own_and_plain_ones_keep_theirs(self):
        given = ["a.b", "a/b", "a_b", "A_B", "c"]
        names = files.FileNames(given)
        self.assertEqual([names.of(name) for name in given], ["a_b_3", "a_b_4", "a_b", "A_B_2", "c"])
        self.assertEqual(names.of("a.b"), "a_b_3")
        self.assertEqual(names.of("a b."), "a b_")


class Caches(InFolder):
    def test_a_cache_appears_when_it_is_whole(self):
        cache = files.PointCache(self.path("a.pc2"), 2, 5)
        cache.add(np.arange(6.0).reshape(2, 3))
        self.assertEqual(os.listdir(self.folder), ["a.pc2.part"])
        cache.finish()
        cache.discard()
        self.assertEqual(os.listdir(self.folder), ["a.pc2"])
        with open(self.path("a.pc2"), "rb") as file:
            data = file.read()
        self.assertEqual(data[:12], b"POINTCACHE2\0")
        self.assertEqual(np.frombuffer(data[12:20], "<i4").tolist() + np.frombuffer(data[20:28], "<f4").tolist()
                         + np.frombuffer(data[28:32], "<i4").tolist(), [1, 2, 5, 1, 1])
        self.assertEqual(np.frombuffer(data[32:], "<f4").tolist(), [0, 1, 2, 3, 4, 5])
        other = files.PointCache(self.path("b.pc2"), 2, 1)
        self.addCleanup(other.discard)
        with self.assertRaisesRegex(module.Problem, "3 vertices after frames of 2"):
            other.add(np.zeros((3, 3)))

    def test_what_the_system_refuses_is_a_problem_with_the_file_in_it(self):
        with self.assertRaisesRegex(module.Problem, "Cannot write .*none/a.pc2: No such file"):
            files.PointCache(self.path("none", "a.pc2"), 2, 1)
        cache = files.PointCache(self.path("a.pc2"), 100000, 1)
        cache._file.close()
        cache._file = open("/dev/full", "wb")
        with self.assertRaisesRegex(module.Problem, "a.pc2: No space left on device") as caught:
            cache.add(np.zeros((100000, 3)))
        self.assertIn("make room", caught.exception.hint)
        cache.discard()
        self.assertEqual(os.listdir(self.folder), [])


class Staging(InFolder):
    def tree(self):
        return sorted(os.path.relpath(os.path.join(inside, name), self.folder)
                      for inside, _, names in os.walk(self.folder) for name in names)

    def read(self, *parts):
        with open(self.path(*parts)) as file:
            return file.read()

    def stage(self, mesh, text, failure=None):
        with files.Staged(self.path("g"), self.path("g.json")) as stage:
            with open(stage.file("meshes", "a.obj"), "w") as file:
                file.write(mesh)
            with open(stage.file("motion.json"), "w") as file:
                file.write(mesh)
            if failure is not None:
                raise failure
            stage.commit(text)

    def test_all_files_appear_or_none(self):
        with self.assertRaisesRegex(module.Problem, "no vertex group"):
            self.stage("new", "new", module.Problem("no vertex group"))
        self.assertEqual(os.listdir(self.folder), [])
        self.stage("old", "old graph")
        whole = ["g.json", "g/meshes/a.obj", "g/motion.json"]
        self.assertEqual(self.tree(), whole)
        for failure in (module.Problem("no vertex group"), OSError(errno.ENOSPC, "No space left on device")):
            with self.assertRaises(module.Problem):
                self.stage("new", "new graph", failure)
            self.assertEqual(self.tree(), whole)
            self.assertEqual((self.read("g", "meshes", "a.obj"), self.read("g.json")), ("old", "old graph"))
        self.stage("new", "new graph")
        self.assertEqual(self.tree(), whole)
        self.assertEqual((self.read("g", "meshes", "a.obj"), self.read("g.json")), ("new", "new graph"))
        self.assertEqual(sorted(os.listdir(self.path("g"))), ["meshes", "motion.json"])

    def test_the_graph_is_the_last_that_changes(self):
        self.stage("old", "old graph")
        moved, replace = [], os.replace

        def watched(source, target):
            moved.append(os.path.basename(target))
            replace(source, target)

        with mock.patch.object(os, "replace", watched):
            self.stage("new", "new graph")
        self.assertEqual((len(moved), moved[-1]), (3, "g.json"))

    def test_errors_name_the_file_that_was_meant(self):
        with self.assertRaisesRegex(module.Problem, "Cannot write .*/g/motion.json: No space") as caught:
            with files.Staged(self.path("g"), self.path("g.json")) as stage:
                raise OSError(errno.ENOSPC, "No space left on device", stage.file("motion.json"))
        self.assertNotIn(".part", str(caught.exception))
        with open(self.path("g"), "w"):
            pass
        with self.assertRaisesRegex(module.Problem, "Cannot write .*/g: "):
            self.stage("new", "new graph")

    def test_a_link_stays_one(self):
        os.mkdir(self.path("else"))
        os.symlink("else/real.json", self.path("g.json"))
        self.stage("mesh", "graph")
        self.assertTrue(os.path.islink(self.path("g.json")))
        self.assertEqual(self.read("else", "real.json"), "graph")


class Axes(unittest.TestCase):
    def test_up_is_told_by_gravity_in_all_its_forms(self):
        down = [0, 0, -9.8]
        for gravity in (down, {"value": down, "unit": "m/s^2"}, {"keys": [[1, down], [3, [0, 0, -5]]]}):
            self.assertEqual(space.up_of(gravity), "Z", gravity)
        for gravity in (None, [0, -9.8, 0], [0, 0, 0], [3, 0, 3], {"from": "t.outValue"},
                        {"value": [0, -980, 0], "unit": "cm/s^2"}, {"keys": []}, "0 0 -9.8"):
            self.assertEqual(space.up_of(gravity), "Y", gravity)

    def test_a_graph_has_its_own_axes_and_the_exported_one_those_of_blender(self):
        def taken(gravity, **given):
            settings = types.SimpleNamespace(graph="b.json", exported="", up_axis="Z", units="SAME")
            vars(settings).update(given)
            space.take_axes(settings, gravity, os.path.abspath)
            return settings.up_axis, settings.units, settings.exported

        self.assertEqual(taken(None, exported="a.json"), ("Y", "GRAPH", ""))
        self.assertEqual(taken([0, 0, -9.8], exported="a.json"), ("Z", "GRAPH", ""))
        self.assertEqual(taken([0, 0, 0], exported="./b.json"), ("Z", "SAME", "./b.json"))
        self.assertEqual(taken(None), ("Y", "SAME", ""))  # units as the user chose them
        self.assertEqual(taken({"value": [0, 0, -1]}, up_axis="Y", units="GRAPH"), ("Z", "GRAPH", ""))


class Sending(unittest.TestCase):
    """A mesh that stands in for a node, with a session of Sinew's."""

    def setUp(self):
        session = part("session")
        self.ob = Mesh()
        self.ob.edit(*TET)
        link = types.SimpleNamespace(enabled=True, kind="MESH", plug="sent", object=self.ob)
        self.scene = types.SimpleNamespace(
            sinew=types.SimpleNamespace(links=[link], up_axis="Z", units="SAME"), objects=Objects(),
            unit_settings=types.SimpleNamespace(scale_length=1.0),
        )
        self.scene.objects.append(self.ob)
        self.ob.sinew = types.SimpleNamespace(body="")
        show(self.scene)
        self.state = session.State("g.json", "")
        self.state.session.load_text(hanging())
        self.state.graph = json.loads(self.state.session.text)

    def sent(self, frame):
        return self.state.session.evaluate(frame, "sent.outMesh")[0]

    def read_motion(self, last):
        for frame in range(1, last + 1):
            self.state.send(self.scene, frame, None)

    def test_an_edited_mesh_is_sent_anew(self):
        self.read_motion(3)
        self.assertEqual(len(self.sent(3).points), 4)
        edits = self.state.edits
        self.read_motion(3)
        self.assertEqual(self.state.edits, edits)  # the same again is nothing new
        self.ob.edit(*PYRAMID)
        self.read_motion(3)
        for frame in (1, 3):
            self.assertEqual((len(self.sent(frame).points), len(self.sent(frame).face_sizes)), (5, 6))
        np.testing.assert_array_equal(self.sent(2).points, PYRAMID[0])
        self.assertEqual(self.state.read, {1, 2, 3})

    def test_the_same_vertices_with_other_faces_are_another_mesh(self):
        points, faces = PYRAMID
        self.ob.edit(points, faces)
        self.read_motion(2)
        self.ob.edit(points, [[0, 3, 1], [1, 3, 2], *faces[2:]])
        self.read_motion(2)
        self.assertEqual(self.sent(2).face_vertices[:6].tolist(), [0, 3, 1, 1, 3, 2])

    def test_vertices_that_come_on_the_way_are_told_and_the_next_reading_mends_it(self):
        self.read_motion(2)
        self.ob.edit(*PYRAMID)
        with self.assertRaisesRegex(module.Problem, 'slab has other .* at frame 3 than at frame 1.*"sent"') as caught:
            self.state.send(self.scene, 3, None)
        self.assertIn("Read Motion", caught.exception.hint)
        self.assertEqual(self.state.missing(self.scene, 3), [1, 2])  # so that no frame is shown by what was sent
        self.read_motion(3)
        self.assertEqual(len(self.sent(3).points), 5)


class Exporting(InFolder):
    """A scene of a bone that moves, one that deforms, and a muscle, as `export` reads it."""

    def setUp(self):
        super().setUp()
        self.export = part("export")
        self.bone = self.object("arm/left", "BONE")
        self.deforming = self.object("arm.left", "BONE", deforms=True)
        group = types.SimpleNamespace(group="top", target=self.bone, mode="fixed", stiffness=1e8)
        self.muscle = self.object("/home/u/x", "MUSCLE", attachments=[group])
        self.muscle.vertex_groups = {"top": types.SimpleNamespace(index=0)}
        for i, v in enumerate(self.muscle.data.vertices.points):
            v.index, v.groups = i, [types.SimpleNamespace(group=0, weight=1.0)]
        self.scene = types.SimpleNamespace(
            name_full="Scene", objects=Objects([self.bone, self.deforming, self.muscle]), frame_start=1, frame_end=2,
            frame_current=1, frame_subframe=0.0, frame_set=lambda frame, subframe=0.0: None, render=types.SimpleNamespace(fps=24, fps_base=1.0),
            unit_settings=types.SimpleNamespace(scale_length=1.0), sinew=types.SimpleNamespace(gravity=(0, 0, -9.8)),
        )
        show(self.scene)

    def object(self, name, role, deforms=False, attachments=()):
        ob = Mesh()
        ob.name = ob.name_full = name
        ob.edit(*TET)
        ob.data.vertices.points = [types.SimpleNamespace() for _ in TET[0]]
        ob.sinew = types.SimpleNamespace(
            role=role, deforms=deforms, attachments=attachments, excitation=0.0, fibres=False, law="NeoHookean",
            tet_size=0.5, youngs_modulus=12000.0, poissons_ratio=0.4, mass_density=1060.0,
        )
        return ob

    def tree(self):
        return sorted(os.path.relpath(os.path.join(inside, name), self.folder)
                      for inside, _, names in os.walk(self.folder) for name in names)

    def write(self):
        return self.export.write(self.scene, os.path.join(self.folder, "g.json"))

    def test_each_object_has_files_of_its_own_in_the_folder_and_the_graph_reads_them(self):
        done = self.write()
        self.assertEqual((done.bones, done.muscles, done.warnings), (2, 1, []))
        self.assertEqual(self.tree(), ["g.json", "g/meshes/_home_u_x.obj", "g/meshes/arm_left.obj",
                                       "g/meshes/arm_left.pc2", "g/meshes/arm_left_2.obj", "g/motion.json",
                                       "g/paint.json"])
        session = sinew.Session(os.path.join(self.folder, "g.json"))
        self.assertEqual(session.nodes["/home/u/x"], "zTissue")
        np.testing.assert_array_equal(session.evaluate(2, "/home/u/xMesh.outMesh")[0].points, TET[0])
        np.testing.assert_array_equal(session.evaluate(2, "arm_leftMesh.outMesh")[0].points, TET[0])

    def test_an_export_that_cannot_be_leaves_all_as_it_was(self):
        def content():
            found = []
            for name in self.tree():
                with open(os.path.join(self.folder, name), "rb") as file:
                    found.append((name, file.read()))
            return found

        self.write()
        before = content()
        for ob in self.scene.objects:
            ob.edit(np.array(TET[0]) + 1.0, TET[1])
        self.muscle.vertex_groups = {}
        with self.assertRaisesRegex(module.Problem, 'no vertex group "top"'):
            self.write()
        self.assertEqual(content(), before)


if __name__ == "__main__":
    unittest.main()
