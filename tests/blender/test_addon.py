# The add-on in Blender: what is shown, what is sent, what runs again, what is baked, exported and refused.
# SPDX-License-Identifier: GPL-3.0-or-later
import json
import os
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import numpy as np
import scenes
from scenes import Case, coordinates, key


class Arm(Case):
    def test_frames_are_those_of_the_command_line(self):
        graph = os.path.join(scenes.ROOT, "graphs/scenes/arm.json")
        expected = scenes.frames_of_program(graph, 1, 5, self.path("out"))
        self.load("graphs/scenes/arm.json")
        bodies = {name for _, name in expected}
        self.assertEqual(len(bodies), 12)
        shown = {ob.sinew.body for ob in self.scene.objects if ob.sinew.body}
        self.assertEqual(shown, bodies)
        for frame in (1, 2, 3, 4, 5, 2):
            self.scene.frame_set(frame)
            for body in bodies:
                x, y, z = (expected[frame, body] * 0.01).T  # 100 units a metre, y up
                np.testing.assert_array_equal(self.points(body), np.stack([x, -z, y], 1).astype(np.float32), body)
        self.assertEqual(self.simulated(), 5)
        self.assertGreater(np.abs(expected[5, "biceps"] - expected[1, "biceps"]).max(), 0.01)

    def test_graphs_that_include_graphs_are_shown_and_driven(self):
        path = os.path.join(scenes.ROOT, "graphs/learn/25_included_limbs.json")
        expected = scenes.frames_of_program(path, 1, 3, self.path("out"))
        self.load(path)
        for frame in (1, 2, 3):
            self.scene.frame_set(frame)
            x, y, z = (expected[frame, "left_belly"] * 0.01).T
            np.testing.assert_array_equal(self.points("left.belly"), np.stack([x, -z, y], 1).astype(np.float32))
        empty = bpy.data.objects.new("dial", None)
        self.scene.collection.objects.link(empty)
        empty["pull"] = 1.0
        bpy.ops.sinew.link_add(kind="VALUE", plug="left.fibre.excitation", object="dial", path='["pull"]')
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(2)
        self.scene.frame_set(3)
        x, y, z = (expected[3, "left_belly"] * 0.01).T
        self.assertGreater(np.abs(self.points("left.belly") - np.stack([x, -z, y], 1)).max(), 1e-5)

    def test_timing_faces_and_colours_are_those_of_the_graph(self):
        self.load("graphs/scenes/arm.json")
        self.assertEqual((self.scene.frame_start, self.scene.frame_end, self.scene.render.fps), (1, 128, 24))
        biceps = bpy.data.objects["biceps (Sinew)"].data
        with open(os.path.join(scenes.ROOT, "graphs/scenes/arm_ziva/muscles/biceps.obj")) as file:
            faces = [[int(w.split("/")[0]) - 1 for w in line.split()[1:]] for line in file if line.startswith("f ")]
        self.assertEqual([list(p.vertices) for p in biceps.polygons], faces)
        self.assertGreater(biceps.materials[0].diffuse_color[0], 2 * biceps.materials[0].diffuse_color[2])

    def test_frames_on_disk_are_found_by_the_next_session(self):
        from sinew_blender import session

        shutil.copy(os.path.join(scenes.ROOT, "graphs/learn/02_muscle_pulls.json"), self.path("g.json"))
        for simulated in (3, 0):
            self.load(self.path("g.json"), keep=True)
            self.scene.frame_set(1)
            self.scene.frame_set(3)
            self.assertEqual(self.simulated(), simulated)
            session.forget_all()
        self.assertIn("g.sinew-cache", os.listdir(self.folder))

    def test_units_and_axes_are_a_choice(self):
        self.scene.unit_settings.scale_length = 0.01  # Blender in centimetres
        self.load("graphs/scenes/arm.json")
        centimetres = self.points("humerus").copy()
        self.settings.units, self.settings.up_axis = "SAME", "Z"
        self.scene.frame_set(2)
        self.scene.frame_set(1)
        x, y, z = self.points("humerus").T
        np.testing.assert_array_equal(centimetres, np.stack([x, -z, y], 1))


class Exported(Case):
    def setUp(self):
        super().setUp()
        scenes.muscle_scene()
        self.graph = self.path("pull.json")
        self.settings.keep_frames = False
        self.assertEqual(bpy.ops.sinew.export(filepath=self.graph), {"FINISHED"})
        self.settings.live = True

    def play(self, last=6):
        bpy.ops.sinew.read_motion()
        for frame in range(1, last + 1):
            self.scene.frame_set(frame)

    def test_the_command_line_gives_the_same_frames(self):
        checked = scenes.program("check", self.graph)
        self.assertNotIn("warning", checked)
        self.assertNotIn("error", checked)
        expected = scenes.frames_of_program(self.graph, 1, 6, self.path("out"))
        bpy.ops.sinew.read_motion()
        for frame in range(1, 7):
            self.scene.frame_set(frame)
            np.testing.assert_array_equal(self.points("belly"), expected[frame, "belly"].astype(np.float32), str(frame))
        self.assertGreater(np.abs(expected[6, "belly"] - expected[1, "belly"]).max(), 0.002)
        self.assertEqual(self.simulated(), 6)
        for name in ("lower", "plate_upper"):  # bones are shown by what moves them
            ob = bpy.data.objects[name.replace("_", ".")]
            seen = coordinates(ob.data) @ np.array(ob.matrix_world)[:3, :3].T + np.array(ob.matrix_world)[:3, 3]
            np.testing.assert_allclose(seen, expected[6, name], atol=2e-7)

    def test_another_graph_has_its_own_axes_and_units_again(self):
        self.assertEqual((self.settings.up_axis, self.settings.units), ("Z", "SAME"))
        bpy.ops.sinew.load()  # the exported one: Blender's
        self.assertEqual((self.settings.up_axis, self.settings.units), ("Z", "SAME"))
        self.settings.links.clear()
        self.settings.live = False
        with open(os.path.join(scenes.ROOT, "graphs/learn/02_muscle_pulls.json")) as file:
            text = file.read()
        self.assertNotIn('"gravity"', text)
        with open(self.path("other.json"), "w") as file:
            file.write(text)
        bpy.data.objects.remove(bpy.data.objects["belly (Sinew)"])  # of the same name there, with other faces
        self.settings.graph = self.path("other.json")
        bpy.ops.sinew.load()
        self.assertEqual((self.settings.up_axis, self.settings.units), ("Y", "GRAPH"))

    def test_names_with_slashes_stay_in_the_folder(self):
        bpy.data.objects["belly"].name = "/home/u/belly"
        with self.refused('belly (Sinew) shows "belly", but there is no such body'):
            bpy.ops.sinew.export(filepath=self.path("slash.json"))
        bpy.data.objects.remove(bpy.data.objects["belly (Sinew)"])
        bpy.ops.sinew.export(filepath=self.path("slash.json"))
        self.assertIn("_home_u_belly.obj", os.listdir(self.path("slash", "meshes")))
        self.assertNotIn("error", scenes.program("check", self.path("slash.json")))
        bpy.ops.sinew.bake()
        self.assertIn("_home_u_belly (Sinew).pc2", os.listdir(self.path("slash_baked")))

    def test_an_export_that_fails_leaves_all_as_it_was(self):
        def content():
            return {os.path.join(folder, name): open(os.path.join(folder, name), "rb").read()
                    for folder, _, names in os.walk(self.folder) for name in names if "cache" not in folder}

        before = content()
        bpy.data.objects["belly"].location.z += 1
        bpy.data.objects["belly"].sinew.attachments[0].group = "none"
        with self.refused("belly", '"none"'):
            bpy.ops.sinew.export(filepath=self.graph)
        self.assertEqual(content(), before)

    def test_the_rest_shape_stays_and_a_second_export_is_the_first(self):
        self.play()
        first = {}
        for folder, _, names in os.walk(self.path("pull")):
            for name in names:
                with open(os.path.join(folder, name), "rb") as file:
                    first[name] = file.read()
        self.assertEqual(set(first), {"belly.obj", "lower.obj", "plate_upper.obj", "motion.json", "paint.json"})
        bpy.ops.sinew.export(filepath=self.path("pull.json"), use=False)
        for folder, _, names in os.walk(self.path("pull")):
            for name in names:
                with open(os.path.join(folder, name), "rb") as file:
                    self.assertEqual(file.read(), first[name], name)

    def test_a_changed_key_runs_what_comes_after_it_and_nothing_else(self):
        self.play()
        self.assertEqual(self.simulated(), 6)
        before = self.points("belly").copy()
        pose = bpy.data.objects["rig"].pose.bones["arm"]
        curve = bpy.data.objects["rig"].animation_data.action.fcurves[0]
        point = next(p for p in curve.keyframe_points if p.co[0] == 4)
        was = point.co[1]
        point.co[1] = was + 0.05
        curve.update()
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(3)
        self.assertEqual(self.simulated(), 6)
        self.scene.frame_set(6)
        self.assertEqual(self.simulated(), 9)  # 4, 5, 6
        self.assertFalse(np.array_equal(self.points("belly"), before))
        point.co[1] = was
        curve.update()
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(5)
        self.scene.frame_set(6)
        self.assertEqual(self.simulated(), 9)
        np.testing.assert_array_equal(self.points("belly"), before)
        self.assertEqual(pose.name, "arm")

    def test_a_jump_over_unread_frames_is_refused_and_backwards_costs_nothing(self):
        with self.told("frame 5", "Read Motion"):
            self.scene.frame_set(5)
        self.assertEqual(self.simulated(), 1)
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(5)
        at_5 = self.points("belly").copy()
        self.assertEqual(self.simulated(), 5)
        evaluations = self.state().evaluations
        self.scene.frame_set(2)
        self.scene.frame_set(5)
        self.assertEqual(self.simulated(), 5)
        self.assertEqual(self.state().evaluations, evaluations + 2)
        self.scene.frame_set(5)
        self.assertEqual(self.state().evaluations, evaluations + 2)
        np.testing.assert_array_equal(self.points("belly"), at_5)

    def test_a_changed_pose_is_noticed(self):
        self.play()
        self.assertEqual(self.state().missing(self.scene, 6), [])
        bpy.data.objects["rig"].hide_render = True
        bpy.data.objects["rig"].select_set(True)
        bpy.ops.object.camera_add()
        bpy.context.view_layer.update()
        self.assertEqual(self.state().missing(self.scene, 6), [])
        bpy.data.objects["rig"].location.x = 0.01
        bpy.context.view_layer.update()
        self.assertEqual(self.state().missing(self.scene, 6), [1, 2, 3, 4, 5])
        with self.told("Read Motion"):
            self.scene.frame_set(5)

    def test_patience_ends_and_what_is_finished_stays(self):
        from sinew_blender import module, stepping

        self.scene.frame_end = 300
        bpy.ops.sinew.read_motion()
        before = self.points("belly").copy()
        self.settings.live = False
        self.scene.frame_set(300)
        with self.assertRaisesRegex(module.Problem, "on the way to frame 300"):
            stepping.step(self.scene, bpy.context.evaluated_depsgraph_get(), patience=1e-6)
        reached = self.simulated()
        self.assertLess(reached, 300)
        np.testing.assert_array_equal(self.points("belly"), before)
        stepping.step(self.scene, bpy.context.evaluated_depsgraph_get())
        self.assertEqual(self.simulated(), 300)

    def test_with_a_window_unread_motion_is_read_by_itself(self):
        from sinew_blender import stepping

        with self.told("Read Motion"):
            self.scene.frame_set(4)
        stepping._catch_up(self.scene.name_full)  # what a timer calls as soon as Blender is idle
        self.assertEqual(self.simulated(), 4)
        self.assertEqual(self.scene.frame_current, 4)
        expected = scenes.frames_of_program(self.graph, 4, 4, self.path("out"))
        np.testing.assert_array_equal(self.points("belly"), expected[4, "belly"].astype(np.float32))

    def test_rendering_simulates_each_frame_once_and_shows_it(self):
        scene = self.scene
        bpy.ops.object.camera_add(location=(0.05, -0.5, 0), rotation=(np.pi / 2, 0, 0))
        scene.camera = bpy.context.object
        scene.world = bpy.data.worlds.new("light")
        render = scene.render
        render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
        render.resolution_x = render.resolution_y = 48
        render.filepath = self.path("frame_")
        scene.frame_end = 3
        bpy.data.objects["lower"].hide_render = bpy.data.objects["rig"].hide_render = True
        belly = bpy.data.objects["belly (Sinew)"]
        evaluations = self.state().evaluations
        rendered = {}

        def look(*_):
            rendered[scene.frame_current] = coordinates(belly.data)

        bpy.app.handlers.render_post.append(look)
        bpy.ops.render.render(animation=True)
        bpy.app.handlers.render_post.remove(look)
        self.assertEqual(self.simulated(), 3)
        self.assertEqual(self.state().evaluations - evaluations, 4)  # the fourth: back to frame 1 afterwards
        expected = scenes.frames_of_program(self.graph, 1, 3, self.path("out"))
        self.assertEqual(set(rendered), {1, 2, 3})
        for frame, points in rendered.items():
            np.testing.assert_array_equal(points, expected[frame, "belly"].astype(np.float32))
        live = [scenes.pixels(self.path(f"frame_{n:04}.png")) for n in (1, 2, 3)]
        self.assertGreater(np.abs(live[2] - live[0]).max(), 0.02)
        self.settings.live = False  # the same shapes from point caches give the same pictures
        bpy.ops.sinew.bake()
        render.filepath = self.path("baked_")
        bpy.ops.render.render(animation=True)
        for n in (1, 2, 3):
            np.testing.assert_array_equal(scenes.pixels(self.path(f"baked_{n:04}.png")), live[n - 1])

    def test_baked_shapes_need_no_sinew(self):
        self.play()
        wanted = {}
        for frame in (2, 3, 6, 4):
            self.scene.frame_set(frame)
            wanted[frame] = self.points("belly").copy()
        bpy.ops.sinew.bake()
        self.assertFalse(self.settings.live)
        self.assertEqual(self.simulated(), 6)
        self.assertEqual(os.path.getsize(self.path("pull_baked", "belly (Sinew).pc2")), 32 + 6 * 12 * len(wanted[2]))
        bpy.ops.wm.save_as_mainfile(filepath=self.path("scene.blend"))
        bpy.ops.preferences.addon_disable(module="sinew_blender")
        bpy.ops.wm.open_mainfile(filepath=self.path("scene.blend"))
        ob = bpy.data.objects["belly (Sinew)"]
        for frame, points in wanted.items():
            bpy.context.scene.frame_set(frame)
            shown = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
            np.testing.assert_array_equal(coordinates(shown), points)
        bpy.context.scene.frame_set(2, subframe=0.5)
        shown = ob.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        np.testing.assert_allclose(coordinates(shown), (wanted[2] + wanted[3]) / 2, atol=1e-8)
        bpy.ops.preferences.addon_enable(module="sinew_blender")
        bpy.ops.sinew.clear_bake()
        self.assertEqual(len(ob.modifiers), 0)

    def test_a_saved_scene_goes_on(self):
        self.play(3)
        wanted = self.points("belly").copy()
        bpy.ops.wm.save_as_mainfile(filepath=self.path("scene.blend"))
        bpy.ops.wm.open_mainfile(filepath=self.path("scene.blend"))
        self.scene = bpy.context.scene
        self.assertTrue(self.scene.sinew.live)
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(2)
        self.scene.frame_set(3)
        np.testing.assert_array_equal(self.points("belly"), wanted)

    def test_shapes_follow_objects_that_move_themselves(self):
        self.play()
        at_6 = self.points("belly").copy()
        ob = bpy.data.objects["belly (Sinew)"]
        key(ob, "location", 1, (0, 0, 0))
        key(ob, "location", 6, (0.5, 0, 0))
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(5)
        self.scene.frame_set(6)
        np.testing.assert_allclose(self.points("belly") + [0.5, 0, 0], at_6, atol=1e-7)

    def test_simulate_does_all_frames_and_a_stop_keeps_what_is_finished(self):
        from sinew_blender import session, stepping
        import sinew

        state = stepping.read_motion(self.scene)
        job = session.Job(state, range(1, 1000), "")
        taken = []
        with self.assertRaises(sinew.Cancelled):
            for number, _ in job.results():
                taken.append(number)
                if number == 3:
                    job.cancel()
        self.assertEqual(taken[:3], [1, 2, 3])
        self.assertTrue(state.session.is_ready(3))
        self.assertFalse(state.session.is_ready(999))
        reached = self.simulated()
        self.assertLess(reached, 900)
        bpy.ops.sinew.simulate()
        self.assertEqual(self.simulated(), max(6, reached))


class Feeding(Case):
    def hanging(self, **more):
        nodes = {
            "cube": {"type": "polyCube", "inputs": {"width": 6, "depth": 6}},
            "plate": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}},
            "ball": {"type": "polySphere", "inputs": {"radius": 2}},
            "flesh": {"type": "zMaterial"},
            "hung": {
                "type": "zTissue",
                "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]},
            },
            "tie": {
                "type": "zAttachment",
                "inputs": {"source": {"from": "hung.outBody"}, "target": {"from": "plate.outBody"}},
            },
            "solver": {
                "type": "zSolver",
                "inputs": {
                    "bodies": [{"from": "hung.outBody"}, {"from": "plate.outBody"}],
                    "attachments": [{"from": "tie.outAttachment"}],
                },
            },
        }
        nodes.update(more)
        with open(self.path("hanging.json"), "w") as file:
            json.dump({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 4}, "nodes": nodes}, file)
        self.settings.keep_frames = False
        self.settings.graph = self.path("hanging.json")

    def test_motion_goes_through_axes_and_units(self):
        self.hanging()
        empty = bpy.data.objects.new("plate", None)
        self.scene.collection.objects.link(empty)
        key(empty, "location", 1, (0, 0, 0))
        key(empty, "location", 4, (0.03, 0, 0.06))
        bpy.ops.sinew.link_by_name(rest="BIND")
        self.assertEqual([link.plug for link in self.settings.links], ["plate.matrix"])
        bpy.ops.sinew.load()
        bpy.ops.sinew.simulate()
        plate = self.state().session.evaluate(4)["plate"].points
        # Blender's z is the graph's y, a metre has 100 units: 3 along x, 6 up.
        np.testing.assert_allclose(plate.mean(axis=0), [3, 6, 0], atol=1e-5)
        self.assertNotIn("plate", [ob.sinew.body for ob in self.scene.objects])

    def test_a_bone_of_an_armature_moves_from_its_rest_pose(self):
        self.hanging()
        scenes.muscle_scene(4)
        rig = bpy.data.objects["rig"]
        rig.pose.bones["arm"].name = "plate"
        bpy.ops.sinew.link_by_name(rest="BIND")
        self.assertEqual([(link.plug, link.bone) for link in self.settings.links], [("plate.matrix", "plate")])
        bpy.ops.sinew.load()
        bpy.ops.sinew.read_motion()
        plate = self.state().session.evaluate(4)["plate"].points
        self.scene.frame_set(4)
        bone = rig.pose.bones["plate"]
        turned = np.array(bone.matrix) @ np.linalg.inv(np.array(bone.bone.matrix_local))
        cube = np.array([[x, y, z] for x in (-3, 3) for y in (-0.5, 0.5) for z in (-3, 3)]) * 0.01
        there = cube[:, [0, 2, 1]] * [1, -1, 1] @ turned[:3, :3].T + turned[:3, 3]
        back = there[:, [0, 2, 1]] * [100, 100, -100]
        np.testing.assert_allclose(sorted(plate.tolist()), sorted(back.tolist()), atol=1e-4)

    def test_a_mesh_with_its_modifiers_stands_in_for_a_node(self):
        self.hanging()
        self.settings.units = "SAME"
        plate = scenes.box("slab", (6, 1, 6), (0, 0, 0))
        plate.shape_key_add(name="Basis")
        wide = plate.shape_key_add(name="wide")
        for point in wide.data:
            point.co.x *= 1.5
        key(wide, "value", 1, 0)
        key(wide, "value", 3, 1)
        bpy.ops.sinew.link_add(kind="MESH", plug="cube", object="slab")
        bpy.ops.sinew.load()
        self.settings.up_axis = "Z"  # a graph that writes no gravity has y up
        bpy.ops.sinew.simulate()
        session = self.state().session
        for frame, width in ((1, 6), (2, 7.5), (3, 9), (4, 9)):
            self.assertAlmostEqual(np.ptp(session.evaluate(frame)["plate"].points[:, 0]), width, places=5)
        self.assertEqual(session.evaluate(1)["plate"].face_sizes.tolist(), [4] * 6)
        wider = np.ptp(session.evaluate(4)["hung"].points[:, 0])
        self.assertGreater(wider, np.ptp(session.evaluate(1)["hung"].points[:, 0]) + 0.2)

    def test_an_edited_mesh_is_sent_with_its_new_faces(self):
        self.hanging()
        scenes.box("slab", (0.06, 0.06, 0.01), (0, 0, 0))
        bpy.ops.sinew.link_add(kind="MESH", plug="cube", object="slab")
        bpy.ops.sinew.load()
        bpy.ops.sinew.simulate()
        self.assertEqual(len(self.state().session.evaluate(4)["plate"].face_sizes), 6)
        other = scenes.tube("other", 0.03, 0.01, 6, 1)
        bpy.data.objects["slab"].data = other.data
        bpy.ops.sinew.read_motion()
        bpy.ops.sinew.simulate()
        for frame in (1, 4):
            plate = self.state().session.evaluate(frame)["plate"]
            self.assertEqual((len(plate.points), len(plate.face_sizes)), (12, 8))

    def test_units_are_those_of_the_solver_that_is_shown(self):
        from sinew_blender import session

        second = {
            "later": {
                "type": "zSolver",
                "inputs": {"bodies": [{"from": "skin.outBody"}], "scale": 10},
            },
            "skinMesh": {"type": "pickMesh", "inputs": {"meshes": {"from": "solver.outMeshes"}, "body": "plate"}},
            "skin": {"type": "zBone", "inputs": {"mesh": {"from": "skinMesh.outMesh"}}},
        }
        self.hanging(**second)
        for plug, units in (("", 10), ("solver.outMeshes", 100), ("skinMesh.outMesh", 100)):
            self.settings.plug = plug
            self.assertEqual(session.ensure(self.scene).units_per_metre, units, plug)

    def test_frames_before_the_first_show_the_model(self):
        scenes.muscle_scene(3)
        self.settings.keep_frames = False
        bpy.ops.sinew.export(filepath=self.path("g.json"))
        self.settings.live = True
        at_1 = self.points("belly").copy()
        self.scene.frame_start = -2
        bpy.ops.sinew.simulate()
        self.assertEqual(self.simulated(), 3)
        self.scene.frame_set(3)
        self.assertFalse(np.array_equal(self.points("belly"), at_1))
        self.scene.frame_set(-1)
        np.testing.assert_array_equal(self.points("belly"), at_1)

    def test_a_property_drives_a_number(self):
        self.hanging()
        empty = bpy.data.objects.new("dial", None)
        self.scene.collection.objects.link(empty)
        empty["softness"] = 1.0
        empty.keyframe_insert('["softness"]', frame=1)
        empty["softness"] = 0.25
        empty.keyframe_insert('["softness"]', frame=2)
        bpy.ops.sinew.link_add(kind="VALUE", plug="tie.envelope", object="dial", path='["softness"]')
        bpy.ops.sinew.load()
        bpy.ops.sinew.simulate()
        sent = json.loads(self.state().session.text)["nodes"]["tie"]["inputs"]["envelope"]["keys"]
        self.assertEqual(dict((k[0], k[1]) for k in sent)[2], 0.25)

    def test_a_deforming_bone_is_exported_as_it_deforms(self):
        scenes.muscle_scene(4)
        upper = bpy.data.objects["plate.upper"]
        upper.sinew.deforms = True
        upper.shape_key_add(name="Basis")
        lifted = upper.shape_key_add(name="lifted")
        for point in lifted.data:
            point.co.z += 0.01
        key(lifted, "value", 1, 0)
        key(lifted, "value", 4, 1)
        self.settings.keep_frames = False
        graph = self.path("deforming.json")
        bpy.ops.sinew.export(filepath=graph)
        self.settings.live = True
        self.assertNotIn("warning", scenes.program("check", graph))
        expected = scenes.frames_of_program(graph, 1, 4, self.path("out"))
        bpy.ops.sinew.read_motion()
        for frame in range(1, 5):
            self.scene.frame_set(frame)
            np.testing.assert_array_equal(self.points("belly"), expected[frame, "belly"].astype(np.float32), str(frame))
        lift = expected[4, "plate_upper"][:, 2] - expected[1, "plate_upper"][:, 2]
        np.testing.assert_allclose(lift, 0.01, atol=1e-7)


class Sidebar(Case):
    def drawn(self, name):
        panel = type("Panel", (), {"layout": scenes.Layout()})()
        kind = getattr(bpy.types, name)
        area = type("Context", (), {"scene": self.scene, "object": bpy.context.object})()
        area.region = type("Region", (), {"width": 600})()
        vars(kind)["draw"](panel, area)
        return panel.layout.drawn

    def test_panels_show_what_there_is(self):
        scenes.muscle_scene()
        bpy.context.view_layer.objects.active = bpy.data.objects["belly"]
        bpy.ops.sinew.attachment_add()
        bpy.ops.sinew.attachment_remove(index=2)
        self.assertEqual(len(bpy.data.objects["belly"].sinew.attachments), 2)
        for word in ("youngs_modulus", "excitation", "origin", "sinew.attachment_add"):
            self.assertIn(word, self.drawn("SINEW_PT_object"))
        self.settings.keep_frames = False
        bpy.ops.sinew.export(filepath=self.path("g.json"))
        self.settings.live = True
        self.assertIn("use_lock_interface", self.drawn("SINEW_PT_graph"))
        self.assertIn("path", self.drawn("SINEW_PT_links"))
        self.assertIn("sinew.export", self.drawn("SINEW_PT_export"))
        bpy.ops.sinew.link_remove(index=0)
        self.assertEqual([link.plug for link in self.settings.links], ["lower.matrix", "bellyFibre.excitation"])

    def test_errors_are_drawn_with_their_place(self):
        self.settings.graph = os.path.join(scenes.ROOT, "graphs/broken/cloth_of_negative_stiffness.json")
        self.settings.keep_frames = False
        self.assertRaises(RuntimeError, bpy.ops.sinew.load)
        words = " ".join(self.drawn("SINEW_PT_graph"))
        self.assertIn("DG013 cotton.shearStiffness,", words)
        self.assertIn("json:6:68", words)

    def test_units_are_said(self):
        self.load("graphs/scenes/arm.json")
        self.assertIn("100 units of the graph", " ".join(self.drawn("SINEW_PT_graph")))
        self.settings.units = "SAME"
        self.assertIn("unit of Blender", " ".join(self.drawn("SINEW_PT_graph")))


class Wrong(Case):
    def test_a_broken_graph_is_told_with_its_place(self):
        self.settings.graph = os.path.join(scenes.ROOT, "graphs/broken/cloth_of_negative_stiffness.json")
        self.settings.keep_frames = False
        with self.refused("DG013", "cotton.shearStiffness", "cloth_of_negative_stiffness.json:6:68", "outside"):
            bpy.ops.sinew.load()
        from sinew_blender import session

        (message,) = session.messages(self.scene)
        self.assertEqual((message.code, message.severity), ("DG013", "error"))
        self.settings.live = True
        with self.told("DG013"):
            self.scene.frame_set(2)

    def test_a_repaired_graph_is_taken_at_the_next_frame(self):
        from sinew_blender import session

        with open(os.path.join(scenes.ROOT, "graphs/learn/02_muscle_pulls.json")) as file:
            text = file.read()

        def save(content):
            with open(self.path("g.json"), "w") as file:
                file.write(content)

        save(text)
        self.settings.keep_frames = False
        self.settings.graph = self.path("g.json")
        bpy.ops.sinew.load()
        self.settings.live = True
        save(text.replace('"poissonsRatio": 0.45', '"poissonsRatio": 0.655'))
        with self.told("flesh.poissonsRatio"):
            self.scene.frame_set(2)
        self.assertEqual(self.simulated(), 1)
        save(text)
        self.scene.frame_set(3)
        self.assertEqual(self.simulated(), 3)
        self.assertEqual(session.messages(self.scene), [])

    def test_without_a_graph_buttons_are_off(self):
        for operator in (bpy.ops.sinew.load, bpy.ops.sinew.simulate, bpy.ops.sinew.bake, bpy.ops.sinew.read_motion):
            self.assertFalse(operator.poll())
        self.assertFalse(bpy.ops.sinew.export.poll())
        self.settings.graph = self.path("none.json")
        with self.refused("none.json"):
            bpy.ops.sinew.load()

    def test_links_that_lead_nowhere_are_told(self):
        self.settings.graph = os.path.join(scenes.ROOT, "graphs/learn/02_muscle_pulls.json")
        self.settings.keep_frames = False
        scenes.box("slab", (1, 1, 1), (0, 0, 0))
        for plug, words in (
            ("plat.matrix", ["slab", 'no node "plat"']),
            ("plate.matrx", ["matrx"]),
        ):
            self.settings.links.clear()
            bpy.ops.sinew.link_add(kind="MATRIX", plug=plug, object="slab")
            with self.refused(*words):
                bpy.ops.sinew.load()
        self.settings.links.clear()
        bpy.ops.sinew.link_add(kind="VALUE", plug="fibre.excitation", object="slab", path="nothing")
        with self.refused("slab", '"nothing"', "fibre.excitation"):
            bpy.ops.sinew.load()

    def test_a_mesh_of_other_faces_is_not_written(self):
        slab = scenes.box("slab", (1, 1, 1), (0, 0, 0))
        slab.sinew.body = "belly"
        before = coordinates(slab.data).copy()
        self.settings.graph = os.path.join(scenes.ROOT, "graphs/learn/02_muscle_pulls.json")
        self.settings.keep_frames = False
        with self.refused("slab", "belly", "8 vertices"):
            bpy.ops.sinew.load()
        np.testing.assert_array_equal(coordinates(slab.data), before)

    def test_exports_say_what_is_missing(self):
        scenes.muscle_scene()
        belly = bpy.data.objects["belly"]
        belly.sinew.attachments[0].group = "tp"
        with self.refused("belly", '"tp"'):
            bpy.ops.sinew.export(filepath=self.path("g.json"))
        belly.sinew.attachments[0].group = "top"
        belly.sinew.attachments[0].target = None
        with self.refused("Attachment 1", "belly", "nothing"):
            bpy.ops.sinew.export(filepath=self.path("g.json"))
        self.assertFalse(os.path.exists(self.path("g.json")))

    def test_a_simulation_that_fails_is_told(self):
        from sinew_blender import session

        with open(os.path.join(scenes.ROOT, "graphs/learn/02_muscle_pulls.json")) as file:
            graph = session.parsed(file.read())
        graph["nodes"]["tendon"]["inputs"]["attachmentMode"] = "none"
        graph["nodes"]["solver"]["inputs"]["integrator"] = "QuasiStatic"
        with open(self.path("g.json"), "w") as file:
            json.dump(graph, file)
        self.settings.graph = self.path("g.json")
        self.settings.keep_frames = False
        with self.refused("FE303", "belly"):
            bpy.ops.sinew.load()


if __name__ == "__main__":
    scenes.install()
    scenes.run_class(sys.modules[__name__])
