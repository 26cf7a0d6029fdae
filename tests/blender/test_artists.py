# The add-on as artists use it: objects hidden, deleted, renamed, mirrored, edited and shown twice.
# SPDX-License-Identifier: GPL-3.0-or-later
import json
import os
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import bpy
import numpy as np
import scenes
from scenes import MuscleCase, coordinates, key


class Motion(MuscleCase):
    def test_what_is_switched_off_in_viewports_is_refused_and_what_is_hidden_is_not(self):
        lower, belly = bpy.data.objects["lower"], bpy.data.objects["belly"]
        for ob in (lower, belly):
            ob.hide_viewport = True
            with self.refused(ob.name + " is switched off in viewports", "by the eye"):
                bpy.ops.sinew.export(filepath=self.path("pull.json"))
            ob.hide_viewport = False
        bones = bpy.data.collections.new("bones")
        self.scene.collection.children.link(bones)
        bones.objects.link(lower)
        self.scene.collection.objects.unlink(lower)
        bones.hide_viewport = True
        with self.refused("lower is switched off in viewports"):
            bpy.ops.sinew.export(filepath=self.path("pull.json"))
        bones.hide_viewport = False
        lower.hide_set(True)
        bpy.data.objects["rig"].hide_viewport = True  # its bone is needed all the same
        self.live()
        wanted = scenes.frames_of_program(self.graph, 1, 6, self.path("out"))
        self.scene.frame_set(6)
        np.testing.assert_array_equal(self.points("belly"), wanted[6, "belly"].astype(np.float32))
        self.assertGreater(np.abs(wanted[6, "lower"] - wanted[1, "lower"]).max(), 0.01)
        bpy.context.view_layer.layer_collection.children["bones"].exclude = True
        with self.refused("lower is switched off in viewports"):
            bpy.ops.sinew.read_motion()
        with self.told("lower is switched off in viewports"):
            self.scene.frame_set(3)

    def test_a_deleted_bone_is_told(self):
        self.live()
        bpy.ops.object.select_all(action="DESELECT")
        bpy.data.objects["lower"].select_set(True)
        bpy.ops.object.delete()
        with self.refused("lower is not in this scene"):
            bpy.ops.sinew.read_motion()
        with self.refused("leads to lower, which is not in this scene"):
            bpy.ops.sinew.export(filepath=self.path("again.json"))

    def test_a_frame_between_whole_ones_sends_nothing(self):
        self.live()
        self.scene.frame_set(4)
        wanted = self.points("belly").copy()
        edits = self.state().edits
        for curve in bpy.data.objects["rig"].animation_data.action.fcurves:
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
        bpy.ops.sinew.read_motion()
        self.assertEqual(self.state().edits, edits)
        for frame in (1, 2, 3):
            self.scene.frame_set(frame, subframe=0.9)
        self.scene.frame_set(4)
        np.testing.assert_array_equal(self.points("belly"), wanted)
        self.assertEqual(self.state().edits, edits)
        self.scene.frame_set(2, subframe=0.5)
        bpy.ops.sinew.read_motion()
        self.assertAlmostEqual(self.scene.frame_float, 2.5)

    def test_a_value_that_a_script_sets_counts(self):
        belly = bpy.data.objects["belly"]
        belly.animation_data_clear()
        for value in (0.75, 0.25):
            belly.sinew.excitation = value
            self.export(use=False)
            with open(self.graph) as file:
                self.assertEqual(json.load(file)["nodes"]["bellyFibre"]["inputs"]["excitation"], value)
        self.live()
        self.scene.frame_set(4)
        before = self.points("belly").copy()
        belly.sinew.excitation = 1
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(4)
        self.assertGreater(np.abs(self.points("belly") - before).max(), 1e-4)

    def test_another_unit_scale_is_noticed(self):
        self.settings.keep_frames = False
        self.load("graphs/learn/02_muscle_pulls.json")
        before = self.points("belly").copy()
        self.scene.unit_settings.scale_length = 0.01
        self.scene.frame_set(2)
        self.scene.frame_set(1)
        np.testing.assert_allclose(self.points("belly"), 100 * before, rtol=1e-6)

    def test_a_scene_that_is_not_in_the_window_is_read(self):
        self.live()
        bpy.data.objects["lower"].sinew.deforms = True
        self.export("deforming.json")
        wanted = scenes.frames_of_program(self.graph, 1, 6, self.path("out"))
        from sinew_blender import stepping

        here = self.scene
        bpy.context.window.scene = bpy.data.scenes.new("other")
        stepping.read_motion(here)
        here.frame_set(6)
        lower = self.state().session.evaluate(6)["lower"].points
        np.testing.assert_allclose(lower, wanted[6, "lower"], atol=1e-7)
        np.testing.assert_allclose(self.points("belly"), wanted[6, "belly"], atol=1e-7)


class Meshes(MuscleCase):
    def widening(self, ob):
        """A shape key that makes it half as wide again."""
        ob.shape_key_add(name="Basis")
        wide = ob.shape_key_add(name="wide")
        for point in wide.data:
            point.co.x *= 1.5
        return wide

    def test_modifiers_that_deform_count_and_those_that_add_vertices_are_refused(self):
        belly = bpy.data.objects["belly"]
        self.widening(belly).value = 1
        smooth = belly.modifiers.new("smooth", "SUBSURF")
        smooth.levels = 2
        self.export()
        self.assertAlmostEqual(np.ptp(self.exported("belly")[0][:, 0]), 1.5 * 0.04, places=6)
        shown = bpy.data.objects["belly (Sinew)"]
        self.assertEqual([(m.type, m.levels) for m in shown.modifiers], [("SUBSURF", 2)])
        self.assertTrue(smooth.show_viewport)
        self.assertIsNone(shown.data.shape_keys)
        np.testing.assert_allclose(self.points("belly"), self.exported("belly")[0], atol=1e-8)
        belly.modifiers.new("mirror", "MIRROR")
        with self.refused("Modifiers of belly give it other vertices", "Apply them"):
            bpy.ops.sinew.export(filepath=self.path("mirrored.json"))

    def test_a_bone_that_changes_its_shape_without_deforms_is_told(self):
        from sinew_blender import export

        upper = bpy.data.objects["plate.upper"]
        wide = self.widening(upper)
        self.assertEqual(export.write(self.scene, self.path("still.json")).warnings, [])
        key(wide, "value", 1, 0)
        key(wide, "value", 6, 1)
        done = export.write(self.scene, self.path("moving.json"))
        self.assertEqual(done.warnings, ["plate.upper changes its shape, but Deforms is off: its first one is kept"])

    def test_faces_of_what_an_object_mirrors_look_outwards(self):
        for name in ("belly", "plate.upper", "lower"):
            bpy.data.objects[name].scale.x *= -1
        bpy.data.objects["lower"].sinew.deforms = True
        bpy.context.view_layer.update()
        before = self.volume_seen("belly")
        self.export()
        for mesh, sign in (("belly", 1), ("plate_upper", 1), ("lower", 1)):
            self.assertGreater(sign * self.volume(mesh), 0, mesh)
        self.assertNotIn("FE321", scenes.program("check", self.graph))
        self.assertLess(before, 0)
        shown = bpy.data.objects["belly (Sinew)"]
        self.assertEqual([list(p.vertices) for p in shown.data.polygons], self.exported("belly")[1])
        self.settings.live = True
        bpy.ops.sinew.read_motion()
        self.scene.frame_set(6)
        wanted = scenes.frames_of_program(self.graph, 6, 6, self.path("out"))
        np.testing.assert_array_equal(self.points("belly"), wanted[6, "belly"].astype(np.float32))
        faces = self.state().session.evaluate(6)["lower"]
        ends = np.cumsum(faces.face_sizes)
        self.assertEqual([faces.face_vertices[e - n : e].tolist() for n, e in zip(faces.face_sizes, ends)],
                         self.exported("lower")[1])

    def volume_seen(self, name):
        """With the faces as the object's mesh has them, where they are seen."""
        ob = bpy.data.objects[name]
        points = coordinates(ob.data).astype(np.float64) @ np.array(ob.matrix_world)[:3, :3].T
        return sum(np.dot(points[f[0]], np.cross(points[f[i]], points[f[i + 1]]))
                   for f in (list(p.vertices) for p in ob.data.polygons) for i in range(1, len(f) - 1)) / 6

    def test_what_is_being_edited_is_exported(self):
        belly = bpy.data.objects["belly"]
        bpy.context.view_layer.objects.active = belly
        bpy.ops.object.select_all(action="DESELECT")
        belly.select_set(True)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.resize(value=(2, 2, 1))
        self.export(use=False)
        self.assertAlmostEqual(np.ptp(self.exported("belly")[0][:, 0]), 0.08, places=6)
        self.assertEqual(belly.mode, "EDIT")

    def test_fibres_without_ends_and_paths_without_endings(self):
        belly = bpy.data.objects["belly"]
        belly.sinew.origin = ""
        with self.refused("fibres of belly have no Origin"):
            bpy.ops.sinew.export(filepath=self.path("pull.json"))
        belly.sinew.origin = "top"
        self.assertEqual(bpy.ops.sinew.export(filepath=self.path("ending"), use=False), {"FINISHED"})
        self.assertTrue(os.path.isfile(self.path("ending.json")))
        with self.refused("beside the .blend file, which has not been saved"):
            bpy.ops.sinew.export(filepath="//beside.json")
        bpy.ops.wm.save_as_mainfile(filepath=self.path("scene.blend"))
        bpy.ops.sinew.export(filepath="//beside.json", use=False)
        self.assertTrue(os.path.isfile(self.path("beside.json")))


class Shown(MuscleCase):
    def test_a_shape_that_is_moved_is_written_anew_at_once(self):
        self.live()
        self.scene.frame_set(6)
        shown, wanted = bpy.data.objects["belly (Sinew)"], self.points("belly").copy()
        shown.location = (1, 0, 0)
        self.scene.frame_set(6)
        np.testing.assert_allclose(self.points("belly") + [1, 0, 0], wanted, atol=1e-7)
        shown.location = (0, 0, 0)
        shown.data.vertices[0].co.x += 1
        self.settings.live = False
        self.settings.live = True
        self.scene.frame_set(6)
        np.testing.assert_array_equal(self.points("belly"), wanted)

    def test_a_render_finds_shapes_that_move_without_a_link(self):
        self.load("graphs/learn/02_muscle_pulls.json")
        shown = bpy.data.objects["belly (Sinew)"]
        self.scene.frame_set(2)
        self.scene.frame_set(3)
        wanted = self.points("belly").copy()
        key(shown, "location", 1, (0, 0, 0))
        key(shown, "location", 3, (0.4, 0, 0))
        self.scene.frame_set(1)
        self.scene.frame_end = 3
        bpy.ops.object.camera_add()
        self.scene.camera = bpy.context.object
        render = self.scene.render
        render.engine, self.scene.cycles.samples, self.scene.cycles.use_denoising = "CYCLES", 1, False
        render.resolution_x = render.resolution_y = 8
        render.filepath = self.path("frame_")
        rendered = {}

        def look(*_):
            rendered[self.scene.frame_current] = coordinates(shown.data)

        bpy.app.handlers.render_post.append(look)
        bpy.ops.render.render(animation=True)
        bpy.app.handlers.render_post.remove(look)
        np.testing.assert_allclose(rendered[3] + [0.4, 0, 0], wanted, atol=1e-6)

    def test_two_objects_that_show_one_body_and_shape_keys_are_told(self):
        self.live()
        shown = bpy.data.objects["belly (Sinew)"]
        copy = shown.copy()
        copy.data = shown.data.copy()
        self.scene.collection.objects.link(copy)
        with self.told('both show "belly"', "Clear"):
            self.scene.frame_set(2)
        bpy.data.objects.remove(copy)
        shown.shape_key_add(name="Basis")
        with self.told("belly (Sinew) has shape keys"):
            self.scene.frame_set(3)
        shown.shape_key_clear()
        self.scene.frame_set(4)
        wanted = scenes.frames_of_program(self.graph, 4, 4, self.path("out"))
        np.testing.assert_array_equal(self.points("belly"), wanted[4, "belly"].astype(np.float32))

    def test_one_that_shows_nothing_that_is_there_stops_no_other(self):
        self.load("graphs/learn/02_muscle_pulls.json")
        bpy.data.objects["plate (Sinew)"].sinew.body = "nobody"
        before = self.points("belly").copy()
        with self.told('plate (Sinew) shows "nobody"', "Delete it"):
            self.scene.frame_set(8)
        self.assertGreater(np.abs(self.points("belly") - before).max(), 1e-4)

    def test_what_is_scaled_to_nothing_is_told(self):
        self.live()
        bpy.data.objects["belly (Sinew)"].scale = (0, 1, 1)
        with self.told("belly (Sinew) is scaled to nothing"):
            self.scene.frame_set(2)
        bpy.data.objects["belly (Sinew)"].scale = (1, 1, 1)
        lower = bpy.data.objects["lower"]
        lower.parent = None
        key(lower, "scale", 1, (0, 0, 0))
        key(lower, "scale", 6, (1, 1, 1))
        with self.refused("lower is scaled to nothing"):
            bpy.ops.sinew.export(filepath=self.path("flat.json"))

    def test_each_scene_has_shapes_of_its_own(self):
        self.load("graphs/learn/02_muscle_pulls.json")
        first = self.scene
        other = bpy.data.scenes.new("other")
        bpy.context.window.scene = other
        other.sinew.keep_frames = False
        other.sinew.graph = os.path.join(scenes.ROOT, "graphs/learn/02_muscle_pulls.json")
        self.assertEqual(bpy.ops.sinew.load(), {"FINISHED"})
        mine = {ob.name for ob in first.objects if ob.sinew.body}
        self.assertEqual(mine & {ob.name for ob in other.objects}, set())
        self.assertEqual(len([ob for ob in other.objects if ob.sinew.body]), len(mine))

    def test_a_shape_called_like_what_drives_it_outdates_nothing(self):
        self.load("graphs/learn/02_muscle_pulls.json")
        empty = bpy.data.objects.new("plate", None)
        self.scene.collection.objects.link(empty)
        bpy.ops.sinew.link_by_name()
        bpy.ops.sinew.simulate()
        bpy.context.view_layer.update()
        self.assertEqual(self.state().missing(self.scene, 5), [])
        empty.location.x = 0.1
        bpy.context.view_layer.update()
        self.assertEqual(self.state().missing(self.scene, 5), [1, 2, 3, 4])

    def test_a_part_that_is_saved_anew_is_read(self):
        os.makedirs(self.path("learn"))
        for name in ("25_included_limbs.json", "parts"):
            source = os.path.join(scenes.ROOT, "graphs/learn", name)
            (shutil.copytree if os.path.isdir(source) else shutil.copy)(source, self.path("learn", name))
        self.settings.graph = self.path("learn", "25_included_limbs.json")
        bpy.ops.sinew.load()
        self.settings.live = True
        self.scene.frame_set(3)
        before = self.points("left.belly").copy()
        part = self.path("learn", "parts", "limb.json")
        with open(part) as file:
            text = file.read()
        self.assertEqual(text.count('"20 kPa"'), 1)
        with open(part, "w") as file:
            file.write(text.replace('"20 kPa"', '"200 kPa"'))
        os.utime(part, (1, 1))
        self.scene.frame_set(2)
        self.scene.frame_set(3)
        self.assertGreater(np.abs(self.points("left.belly") - before).max(), 1e-6)

    def test_undo_takes_back_one_step(self):
        bpy.ops.ed.undo_push()
        bpy.ops.sinew.export("EXEC_DEFAULT", True, filepath=self.path("pull.json"))
        bpy.ops.mesh.primitive_cube_add("EXEC_DEFAULT", True)
        bpy.ops.ed.undo()
        scene = bpy.context.scene
        self.assertIn("belly (Sinew)", scene.objects)
        self.assertNotIn("Cube", scene.objects)
        self.assertEqual(len(scene.sinew.links), 3)

    def test_a_modifier_of_the_users_own_is_left_alone(self):
        self.live()
        shown = bpy.data.objects["belly (Sinew)"]
        shown.modifiers.new("Sinew", "SUBSURF")
        bpy.ops.sinew.bake()
        self.assertEqual([m.type for m in shown.modifiers], ["MESH_CACHE", "SUBSURF"])
        bpy.ops.sinew.clear_bake()
        self.assertEqual([m.type for m in shown.modifiers], ["SUBSURF"])

    def test_materials_of_the_object_are_kept(self):
        belly = bpy.data.objects["belly"]
        belly.data.materials.append(None)
        belly.material_slots[0].link = "OBJECT"
        belly.material_slots[0].material = bpy.data.materials.new("flesh")
        self.export()
        self.assertEqual(bpy.data.objects["belly (Sinew)"].material_slots[0].material.name, "flesh")


if __name__ == "__main__":
    scenes.install()
    scenes.run_class(sys.modules[__name__])
