# The Python module: what is sent and what comes out, what runs again, errors, threads, Ctrl-C.
# SPDX-License-Identifier: GPL-3.0-or-later
import gc
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
import weakref

import numpy as np
import sinew
from scenes import hanging, lifted


class Frames(unittest.TestCase):
    def test_bodies_come_by_name_and_place(self):
        frame = sinew.Session(text=hanging()).evaluate(1)
        self.assertEqual(frame.names, ["hung", "plate"])
        self.assertEqual(list(frame), ["hung", "plate"])
        self.assertEqual(frame["plate"].name, "plate")
        self.assertEqual(frame[-1].name, "plate")
        self.assertEqual(frame["plate"].points.shape, (8, 3))
        self.assertEqual(frame["plate"].triangles.shape, (12, 3))
        self.assertEqual(frame["plate"].face_sizes.tolist(), [4] * 6)
        self.assertEqual(frame["plate"].face_vertices.size, 24)
        self.assertEqual(frame.plug, "solver.outMeshes")
        self.assertIn("hung", frame)
        self.assertNotIn("ball", frame)
        with self.assertRaisesRegex(KeyError, "there is no mesh 'ball'; meshes: hung or plate"):
            frame["ball"]
        with self.assertRaises(IndexError):
            frame[2]

    def test_a_bone_is_where_its_matrix_puts_it(self):
        session = sinew.Session(text=hanging())
        session.set_input("plate.matrix", 2, lifted(0.25))
        for number, y in ((1, 0), (2, 0.25)):
            points = session.evaluate(number)["plate"].points
            np.testing.assert_array_equal(np.unique(points[:, 1]), [y - 0.5, y + 0.5])

    def test_arrays_show_what_sinew_holds_and_cannot_be_written(self):
        frame = sinew.Session(text=hanging()).evaluate(2)
        first, second = frame["hung"], frame["hung"]
        for name in ("points", "triangles", "face_sizes", "face_vertices"):
            a, b = getattr(first, name), getattr(second, name)
            self.assertEqual(a.ctypes.data, b.ctypes.data, name)
            self.assertFalse(a.flags.owndata, name)
            self.assertTrue(a.flags.c_contiguous, name)
            with self.assertRaises(ValueError):
                a[0] = 0
            with self.assertRaises(ValueError):
                a.setflags(write=True)

    def test_arrays_outlive_everything(self):
        session = sinew.Session(text=hanging())
        mesh = session.evaluate(3)["hung"]
        part = mesh.points[::2, 1]
        wanted = part.copy()
        faces = mesh.triangles
        wanted_faces = faces.copy()
        session["ball.radius"] = 1.5
        del session, mesh
        gc.collect()
        others = [sinew.Session(text=hanging()).evaluate(3) for _ in range(3)]
        np.testing.assert_array_equal(part, wanted)
        np.testing.assert_array_equal(faces, wanted_faces)
        self.assertEqual(len(others), 3)

    def test_values_are_numbers_arrays_and_texts(self):
        session = sinew.Session(
            text=hanging(
                turn={"type": "transform", "inputs": {"translate": [1, 2, 3]}},
                paint={"type": "weights", "inputs": {"mesh": {"from": "cube.outMesh"}, "value": 0.25}},
            )
        )
        matrix = session.evaluate(1, "turn.outMatrix").value
        np.testing.assert_array_equal(matrix, [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])
        self.assertFalse(matrix.flags.owndata)
        np.testing.assert_array_equal(session.evaluate(1, "paint.outWeights").value, [0.25] * 8)
        self.assertIsNone(session.evaluate(1, "flesh.outMaterial").value)
        self.assertEqual(session.evaluate(1, "cube.outMesh").value[0].points.shape, (8, 3))

    def test_the_report_is_that_of_the_frame(self):
        report = sinew.Session(text=hanging()).evaluate(3).report
        self.assertEqual(report["frame"], 3)
        self.assertTrue(report["converged"])
        self.assertEqual(report["size"]["bodies"], 2)
        self.assertEqual(report["where"]["min_J"]["tissue"], "hung")
        self.assertEqual(sinew.Session(text=hanging()).evaluate(1, "cube.outMesh").report, {})


class Sending(unittest.TestCase):
    def test_only_what_changed_runs_again(self):
        session = sinew.Session(text=hanging())
        for number in range(1, 6):
            session.set_inputs(number, {"plate.matrix": lifted(0.1 * number)})
            session.evaluate(number)
            self.assertEqual(session.counts.simulated, number)
        fifth = session.evaluate(5)["hung"].points.tobytes()
        session.set_input("plate.matrix", 4, lifted(0.9))
        self.assertFalse(session.is_ready(5))
        self.assertIn("plate", session.explain(5))
        self.assertNotEqual(session.evaluate(5)["hung"].points.tobytes(), fifth)
        self.assertEqual(session.counts.simulated, 7)
        session.set_input("plate.matrix", 4, lifted(0.1 * 4))
        self.assertTrue(session.is_ready(5))
        self.assertEqual(session.evaluate(5)["hung"].points.tobytes(), fifth)
        self.assertEqual(session.counts.simulated, 7)

    def test_run_goes_over_the_timing(self):
        session = sinew.Session(text=hanging())
        self.assertEqual([frame.number for frame in session.run()], [1, 2, 3, 4, 5, 6])
        self.assertEqual([frame.number for frame in session.run(5, 7)], [5, 6, 7])
        self.assertEqual(session.counts.simulated, 7)
        self.assertEqual(session.timing, sinew.Timing(24, 1, 6))

    def test_meshes_are_sent_in_the_shapes_that_hosts_have(self):
        session = sinew.Session(text=hanging())
        square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
        session.set_mesh("sent", 1, square, [[0, 1, 2, 3]])
        mesh = session.evaluate(1, "sent.outMesh")[0]
        self.assertEqual(mesh.face_sizes.tolist(), [4])
        np.testing.assert_array_equal(mesh.points, square)
        session.set_mesh("sent", 3, square + 2)
        np.testing.assert_array_equal(session.evaluate(2, "sent.outMesh")[0].points, square)
        np.testing.assert_array_equal(session.evaluate(2.5, "sent.outMesh")[0].points, square + 1)
        session.set_mesh("sent", 1, square[:3], [0, 1, 2])
        self.assertEqual(session.evaluate(9, "sent.outMesh")[0].triangles.tolist(), [[0, 1, 2]])
        session.set_mesh("sent", 1, np.asfortranarray(square), np.array([0, 1, 2, 0, 2, 3], np.int64))
        self.assertEqual(session.evaluate(1, "sent.outMesh")[0].triangles.shape, (2, 3))
        for wrong in (lambda: session.set_mesh("sent", 1, square[:, :2]), lambda: session.set_mesh("sent", 1, [1, 2])):
            self.assertRaises(ValueError, wrong)
        with self.assertRaises(sinew.UsageError):
            session.set_mesh("sent", 1, square, [0, 1, 1.5])
        with self.assertRaises(sinew.UsageError):
            session.set_mesh("ball", 1, square)

    def test_values_are_taken_as_python_has_them(self):
        session = sinew.Session(text=hanging())
        session.set("flesh.youngsModulus", {"value": 30, "unit": "kPa"})
        session["solver.enable"] = True
        session["solver.substeps"] = np.int64(2)
        session["solver.gravity"] = (0, -5, 0)
        session["hung.material"] = "NeoHookean"
        session["solver.attachments"] = [{"from": "tie.outAttachment"}]
        for part in ('"youngsModulus": 30000', '"substeps": 2', '"gravity": [0, -5, 0]', "NeoHookean"):
            self.assertIn(part, session.text)
        self.assertEqual(session.nodes["solver"], "zSolver")
        self.assertRaises(TypeError, session.set, "flesh.youngsModulus", None)
        self.assertRaises(TypeError, session.set, "flesh.youngsModulus", object())
        self.assertRaises(sinew.UsageError, session.set, "youngsModulus", 1)
        self.assertRaises(sinew.UsageError, session.set_input, 2, "flesh.youngsModulus", 1)  # the frame comes second
        session.set_input("flesh.youngsModulus", 2, "30 kPa")
        with self.assertRaisesRegex(sinew.GraphError, 'write "30 kPa"'):
            session.set_input("flesh.youngsModulus", 2, "30 kpa")
        self.assertRaises(sinew.UsageError, session.set, "solver.gravity", [1, 2])

    def test_a_cache_is_found_by_the_next_session(self):
        with tempfile.TemporaryDirectory() as folder:
            first = sinew.Session(text=hanging(), cache=folder)
            wanted = first.evaluate(4)["hung"].points.tobytes()
            del first
            second = sinew.Session(text=hanging(), cache=folder)
            self.assertEqual(second.evaluate(4)["hung"].points.tobytes(), wanted)
            self.assertEqual(second.counts.simulated, 0)


class Wrong(unittest.TestCase):
    def test_all_that_is_wrong_comes_with_its_place(self):
        text = '{"format": "sinew 1", "nodes": {\n "a": {"type": "polyCube",\n  "inputs": {"widht": 1, "depth": -1}}}}'
        with self.assertRaises(sinew.GraphError) as caught:
            sinew.Session(text=text, file_name="wrong.json")
        found = caught.exception.diagnostics
        self.assertEqual([d.code for d in found], ["DG011", "DG013"])
        self.assertEqual((found[0].file, found[0].line, found[0].column), ("wrong.json", 3, 14))
        self.assertEqual((found[1].node, found[1].attribute), ("a", "depth"))
        self.assertEqual(found[0].severity, "error")
        self.assertIn("width", found[0].hint)
        self.assertIn("DG011", str(caught.exception))
        self.assertIsInstance(caught.exception, sinew.Error)

    def test_wrong_calls_are_another_error(self):
        for call in (
            lambda: sinew.Session().evaluate(1),
            lambda: sinew.Session(text=hanging()).evaluate(1, "solver"),
            lambda: sinew.Session("a.json", text=hanging()),
        ):
            self.assertRaises(sinew.UsageError, call)
        self.assertRaises(sinew.GraphError, sinew.Session, "/there/is/none.json")
        self.assertRaises(sinew.GraphError, sinew.Session(text=hanging()).evaluate, 1, "sent.outMesh")

    def test_warnings_are_warnings(self):
        text = '{"format": "sinew 1", "nodes": {"a": {"type": "polyCubes"}}}'
        with self.assertWarns(sinew.SinewWarning) as caught:
            sinew.Session(text=text)
        self.assertIn("DG010", str(caught.warning))
        self.assertEqual(caught.filename, __file__)
        told = []
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sinew.Session(text=text, on_warning=told.append)
        self.assertEqual([d.code for d in told], ["DG010"])

    def test_what_on_warning_raises_while_a_graph_loads_comes_out(self):
        def refuse(warning):
            raise ZeroDivisionError(warning.code)

        text = '{"format": "sinew 1", "nodes": {"a": {"type": "polyCubes"}}}'
        self.assertRaisesRegex(ZeroDivisionError, "DG010", lambda: sinew.Session(text=text, on_warning=refuse))

    def test_names_and_frames_that_are_not_there_are_wrong_calls(self):
        session = sinew.Session(text=hanging())
        for call in (
            lambda: session.set("nope.matrix", lifted(1)),
            lambda: session.set_input("plate.nope", 1, 1),
            lambda: session.set_mesh("nope", 1, np.eye(3)),
            lambda: session.evaluate(1, "hung.nope"),
            lambda: session.evaluate(float("nan")),
            lambda: session.is_ready(float("nan")),
        ):
            self.assertRaises(sinew.UsageError, call)

    def test_objects_made_by_new_alone_are_refused(self):
        self.assertRaises(TypeError, lambda: sinew.Frame.__new__(sinew.Frame).meshes)
        self.assertRaises(TypeError, lambda: sinew.Mesh.__new__(sinew.Mesh).points)
        self.assertRaises(TypeError, lambda: sinew.Event.__new__(sinew.Event).node)
        self.assertRaises(TypeError, lambda: sinew.Diagnostic.__new__(sinew.Diagnostic).code)

    def test_meshes_are_checked(self):
        self.assertRaises(ValueError, sinew.Mesh, [[0, 0, 0]], [0, 0])
        self.assertRaises(ValueError, sinew.Mesh, [[0, 0]], [0, 0, 0])
        self.assertRaises(ValueError, sinew.Mesh, [[0, 0, 0]], [0.5, 0, 0])
        self.assertRaises(sinew.Error, sinew.Mesh, [[0, 0, 0]], [0, 1, 2])
        self.assertRaises(sinew.Error, sinew.Mesh, [[0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [0, 1, 2])
        mesh = sinew.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [0, 1, 2])
        self.assertEqual(mesh.with_points(mesh.points + 1).points.sum(), mesh.points.sum() + 9)
        self.assertRaises(ValueError, mesh.with_points, mesh.points[:2])

    def test_numbers_of_corners_stay_what_they_are(self):
        square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        for wrong in (np.array([0, 1, 2]) + 2**32, np.array([0, 1, 2 + 2**63], np.uint64)):
            self.assertRaisesRegex(ValueError, "a corner is no vertex number", sinew.Mesh, square, wrong)
        self.assertRaises(ValueError, sinew.Mesh, square, [0, 1, 2], [2**32 + 3])
        quads = sinew.Mesh(square, np.array([[0, 1, 2, 3]] * 3))
        self.assertEqual(quads.face_sizes.tolist(), [4, 4, 4])
        self.assertEqual(sinew.Mesh(square, [[0, 1, 2], [0, 2, 3]]).face_sizes.tolist(), [3, 3])
        self.assertRaises(ValueError, sinew.Mesh, square, np.zeros((1, 1, 3), int))
        self.assertRaisesRegex(TypeError, "corners are whole numbers", sinew.Mesh, square, [[0, 1, 2], [0, 1, 2, 3]])

    def test_what_is_no_number_does_not_become_one(self):
        session = sinew.Session(text=hanging())
        masked = np.ma.masked_array(np.eye(4), np.eye(4) > 0)
        for wrong in (1j, np.eye(4) * 1j, masked, ["1"] * 16, np.array(["2020-01-01"] * 16, "datetime64[D]"), [1, None]):
            self.assertRaisesRegex(TypeError, "a value is a number", session.set_input, "plate.matrix", 1, wrong)
        for wrong in (np.eye(3) * 1j, [["0", "1", "2"]], "abc", [[0, 0, 0], [1, 2]]):
            self.assertRaisesRegex(TypeError, "points are an array", sinew.Mesh, wrong, [0, 1, 2])
        with self.assertRaisesRegex(sinew.UsageError, "a text as \"30 kPa\""):
            session.set_input("flesh.youngsModulus", 2, {"value": 30, "unit": "kPa"})

        class Stops:
            def __array__(self, *_, **__):
                raise KeyboardInterrupt

        self.assertRaises(KeyboardInterrupt, session.set_input, "plate.matrix", 1, Stops())

    def test_frames_may_be_sent_in_any_order(self):
        def motion(order):
            session = sinew.Session(text=hanging())
            for frame in order:
                session.set_input("plate.matrix", frame, lifted(frame / 8))
            return [session.evaluate(f)["plate"].points[:, 1].max() for f in range(1, 7)]

        wanted = [0.5 + h / 8 for h in (1, 1, 3, 3, 5, 5)]
        for order in ((1, 3, 5), (1, 5, 3), (5, 1, 3), (5, 3, 1)):
            self.assertEqual(motion(order), wanted, order)

    def test_meshes_are_found_by_name_or_place_alone(self):
        frame = sinew.Session(text=hanging()).evaluate(1)
        for wrong in (1.5, None, slice(0, 1)):
            self.assertRaisesRegex(TypeError, "by the name of its body or by its place", lambda: frame[wrong])
        self.assertEqual(frame[np.int64(1)].name, "plate")


class Going(unittest.TestCase):
    def test_events_tell_what_runs_and_what_is_reused(self):
        steps, kinds = [], set()

        def watch(event):
            kinds.add(event.kind)
            if event.kind == "stepped":
                steps.append((event.node, event.frame))

        session = sinew.Session(text=hanging(), on_event=watch)
        session.evaluate(3)
        self.assertEqual(steps, [("solver", 1), ("solver", 2), ("solver", 3)])
        session.evaluate(3)
        self.assertEqual(len(steps), 3)
        self.assertLessEqual({"stepped", "computed", "reused"}, kinds)

    def test_a_callback_cancels_and_finished_frames_stay(self):
        session = sinew.Session(text=hanging(), on_event=lambda e: e.kind == "stepped" and e.frame == 3)
        self.assertRaises(sinew.Cancelled, session.evaluate, 6)
        self.assertEqual(session.counts.simulated, 3)
        self.assertEqual([session.is_ready(n) for n in (1, 2, 3, 4)], [True, True, True, False])

    def test_what_a_callback_raises_comes_out(self):
        def watch(event):
            if event.kind == "stepped" and event.frame == 2:
                raise ZeroDivisionError("of the host")

        session = sinew.Session(text=hanging(), on_event=watch)
        self.assertRaisesRegex(ZeroDivisionError, "of the host", session.evaluate, 6)
        self.assertEqual(session.counts.simulated, 2)
        session.evaluate(6)
        self.assertEqual(session.counts.simulated, 6)

    def test_only_true_cancels(self):
        for answer in (False, np.bool_(False), None):
            sinew.Session(text=hanging(), on_event=lambda e: answer).evaluate(2)
        for answer in (7, "go on", []):
            session = sinew.Session(text=hanging(), on_event=lambda e: answer)
            self.assertRaisesRegex(TypeError, "on_event gave back a value of type " + type(answer).__name__,
                                   session.evaluate, 2)
        session = sinew.Session(text=hanging(), on_event=lambda e: np.bool_(True))
        self.assertRaises(sinew.Cancelled, session.evaluate, 2)

    def test_ctrl_c_ends_it_and_finished_frames_stay(self):
        pressed = []

        def watch(event):
            if event.kind == "stepped" and event.frame == 3 and not pressed:
                pressed.append(True)
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.3)  # the main thread sees it meanwhile

        session = sinew.Session(text=hanging(), on_event=watch)
        with self.assertRaises(KeyboardInterrupt):
            session.evaluate(6)
        self.assertEqual(session.counts.simulated, 3)
        self.assertTrue(session.is_ready(3))
        session.evaluate(6)
        self.assertEqual(session.counts.simulated, 6)

    def test_a_session_refuses_its_own_callbacks(self):
        told = []

        def watch(event):
            if event.kind == "stepped" and event.frame == 2:
                for call in (
                    lambda: session.evaluate(3),
                    lambda: session.is_ready(1),
                    lambda: session.set_input("plate.matrix", 3, lifted(1)),
                ):
                    try:
                        call()
                    except sinew.UsageError as error:
                        told.append(error.diagnostics[0].code)

        session = sinew.Session(text=hanging(), on_event=watch)
        session.evaluate(3)
        self.assertEqual(told, ["DG140"] * 3)
        naive = sinew.Session(text=hanging(), on_event=lambda event: naive.evaluate(1) and None)
        self.assertRaisesRegex(sinew.UsageError, "its own callback", naive.evaluate, 2)

    def test_what_ends_the_program_comes_out_of_compute_as_it_is(self):
        outputs = {"out": sinew.Output("number", "A number.")}
        for raised in (SystemExit(3), KeyboardInterrupt()):
            def compute():
                raise raised

            ends = sinew.NodeType("ends", "1", "Ends the program.", {}, outputs, compute)
            session = sinew.Session(text=hanging(e={"type": "ends"}), node_types=[ends])
            with self.assertRaises(type(raised)) as caught:
                session.evaluate(1, "e.out")
            self.assertIs(caught.exception, raised)
            self.assertEqual(session.evaluate(2).number, 2)  # once

    def test_another_thread_may_cancel(self):
        reached = threading.Event()
        session = sinew.Session(text=hanging(), on_event=lambda e: e.kind == "stepped" and e.frame == 3 and
                                (reached.set(), time.sleep(0.2)) and False)
        canceller = threading.Thread(target=lambda: (reached.wait(), session.cancel()))
        canceller.start()
        self.assertRaises(sinew.Cancelled, session.evaluate, 6)
        canceller.join()
        self.assertEqual(session.counts.simulated, 3)

    def test_python_goes_on_while_something_is_computed(self):
        session = sinew.Session(text=hanging(), threads=1)
        worker = threading.Thread(target=session.evaluate, args=(40,))
        ticks = 0
        worker.start()
        while worker.is_alive():
            ticks += 1
            time.sleep(0.001)
        self.assertEqual(session.counts.simulated, 40)
        self.assertGreater(ticks, 10)

    def test_sessions_in_threads_give_the_bits_of_one_alone(self):
        def run():
            session = sinew.Session(text=hanging(), threads=1)
            for number in range(1, 5):
                session.set_input("plate.matrix", number, lifted(0.2 * number))
                frame = session.evaluate(number)
            return frame["hung"].points.tobytes()

        alone, found = run(), []
        threads = [threading.Thread(target=lambda: found.append(run())) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [alone] * 3)

    def test_threads_may_share_a_session(self):
        session = sinew.Session(text=hanging())
        found = []

        def run():
            for number in range(1, 7):
                found.append((number, session.evaluate(number)["hung"].points.tobytes()))

        threads = [threading.Thread(target=run) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 18)
        self.assertEqual(len(set(found)), 6)
        self.assertEqual(session.counts.simulated, 6)


class Calls(unittest.TestCase):
    def test_arguments_of_another_kind_are_told_in_words(self):
        session = sinew.Session(text=hanging())
        for words, call in (
            ("a frame is a number, not '2'", lambda: session.set_inputs("2", {"plate.matrix": np.eye(4)})),
            ("a frame is a number, not 'x'", lambda: session.evaluate("x")),
            ("a frame is a number, not None", lambda: session.is_ready(None)),
            ("a frame is a number, not 'x'", lambda: session.explain("x")),
            ("a frame is a number, not 'x'", lambda: session.set_mesh("sent", "x", np.eye(3), [0, 1, 2])),
            ("node is a text, not 3", lambda: session.set_mesh(3, 1, np.eye(3), [0, 1, 2])),
            ("plug is a text, not 3", lambda: session.evaluate(1, 3)),
            ("values is a dict .* not \\[1\\]", lambda: session.set_inputs(1, [1])),
            ("the graph's text is a text, not 3", lambda: session.load_text(3)),
            ("cache_size is a whole number of bytes, not '1GB'", lambda: sinew.Session(cache_size="1GB")),
            ("threads is a whole number of threads, not 2.5", lambda: sinew.Session(threads=2.5)),
            ("cache is a folder's path or None, not 3", lambda: sinew.Session(cache=3)),
            ("root is a folder's path or None, not 3", lambda: sinew.Session(root=3)),
            ("on_event is a function or None, not 3", lambda: sinew.Session(on_event=3)),
            ("on_warning is a function or None, not 3", lambda: sinew.Session(on_warning=3)),
        ):
            self.assertRaisesRegex(TypeError, "^" + words + "$", call)
        for words, given in (("memory is a whole number of bytes from 0 on, not -1", {"memory": -1}),
                             ("threads is a whole number of threads from 0 on, not -1", {"threads": -1}),
                             ("threads is a number of threads, not 1099511627776", {"threads": 2**40})):
            self.assertRaisesRegex(sinew.UsageError, "^" + words + "$", sinew.Session, **given)
        for frame in (np.int64(2), np.float32(2), np.array(2.0)):
            self.assertFalse(session.is_ready(frame))

    def test_inputs_are_read_as_they_are_set(self):
        session = sinew.Session(text=hanging())
        np.testing.assert_array_equal(session["plate.matrix"], np.eye(4))  # by default
        session["plate.matrix"] = 2 * np.eye(4)
        np.testing.assert_array_equal(session["plate.matrix"], 2 * np.eye(4))
        session["flesh.youngsModulus"] = "30 kPa"
        self.assertEqual(session["flesh.youngsModulus"], 30000)
        self.assertEqual(session["tie.attachmentMode"], "fixed")
        self.assertEqual(session["hung.mesh"], {"from": "ball.outMesh"})
        self.assertEqual(session["solver.bodies"], [{"from": "hung.outBody"}, {"from": "plate.outBody"}])
        self.assertIsNone(session["hung.fibers"])
        session["flesh.massDensity"] = {"keys": [[1, 1000], [3, 1100]]}
        self.assertEqual(session.get("flesh.massDensity")["keys"], [[1, 1000], [3, 1100]])
        for plug, words in (("plat.matrix", 'did you mean "plate"'), ("plate.matrx", 'did you mean "matrix"'),
                            ("solver.outMeshes", "is an output.*\n.*evaluate"), ("plate", "write node.attribute"),
                            (0, "names no input")):
            self.assertRaisesRegex(sinew.UsageError, words, lambda: session[plug])


EXIT = """
import sys, threading, time
import sinew
from scenes import hanging

started = threading.Event()

@sinew.node_type("slow", version="1", inputs={}, outputs={"out": sinew.Output("number", "A number.")}, uses_time=True)
def slow(frame):
    "Takes its time."
    started.set()
    time.sleep(0.01)
    return frame

session = sinew.Session(text=hanging(slow={"type": "slow"}), node_types=[slow], on_event=lambda e: started.set() and None)
plug = sys.argv[1]

def work():
    for number in range(1, 100000):
        session.evaluate(number, plug)

threading.Thread(target=work, daemon=True).start()
started.wait()
print("end")
"""


SOFT = {"type": "zMaterial", "inputs": {"youngsModulus": -3000}}


class OtherProcesses(unittest.TestCase):
    def test_errors_come_whole_out_of_them(self):
        for made, kind in ((lambda: sinew.Session(text=hanging(flesh=SOFT)), sinew.GraphError),
                           (lambda: sinew.Session(text=hanging()).evaluate(1, "none.out"), sinew.UsageError)):
            with self.assertRaises(kind) as caught:
                made()
            error = caught.exception
            back = pickle.loads(pickle.dumps(error))
            self.assertEqual((type(back), str(back)), (kind, str(error)))
            self.assertEqual([str(d) for d in back.diagnostics], [str(d) for d in error.diagnostics])
            for one, other in zip(back.diagnostics, error.diagnostics):
                for field in ("severity", "code", "node", "attribute", "file", "pointer", "line", "column", "frame",
                              "message", "hint"):
                    self.assertEqual(getattr(one, field), getattr(other, field), field)
            self.assertTrue(error.diagnostics)


class Ending(unittest.TestCase):
    def test_the_program_ends_while_a_daemon_thread_evaluates(self):
        for plug in ("slow.out", "solver.outMeshes"):
            made = subprocess.run([sys.executable, "-B", "-c", EXIT, plug], capture_output=True, text=True, timeout=120)
            self.assertEqual((made.returncode, made.stdout), (0, "end\n"), made.stderr)

    def test_a_session_that_its_callbacks_name_is_collected(self):
        def named_by(name):
            box = {}

            def watch(*args):
                return box["session"] and None

            given = watch
            if name == "node_types":
                output = {"out": sinew.Output("number", "A number.")}
                given = [sinew.NodeType("own", "1", "A node.", {}, output, watch)]
            session = box["session"] = sinew.Session(text=hanging(), **{name: given})
            session.evaluate(1)
            return weakref.ref(session), weakref.ref(session._core)

        for name in ("on_event", "on_warning", "node_types"):
            session, core = named_by(name)
            gc.collect()
            self.assertEqual((session(), core()), (None, None), name)


if __name__ == "__main__":
    unittest.main()
