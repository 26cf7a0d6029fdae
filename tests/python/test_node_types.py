# Node types in Python: used in graphs like any other, pure and found again, told of when they fail.
# SPDX-License-Identifier: GPL-3.0-or-later
import unittest

import numpy as np
import sinew
from scenes import hanging


def lift(runs=None, version="1"):
    @sinew.node_type(
        "lift",
        version=version,
        inputs={
            "mesh": sinew.Wire("mesh", "The mesh to lift."),
            "by": sinew.Input("number", 1.0, "How far, in scene units.", min=0),
            "way": sinew.Input("text", "up", "Where to.", options=("up", "down")),
        },
        outputs={"outMesh": sinew.Output("mesh", "The lifted mesh.")},
    )
    def lift(mesh, by, way):
        """Lifts a mesh."""
        if runs is not None:
            runs.append(by)
        return mesh.with_points(mesh.points + [0, by if way == "up" else -by, 0])

    return lift


def lifted(runs=None, version="1", **inputs):
    text = hanging(
        plate={"type": "zBone", "inputs": {"mesh": {"from": "lifted.outMesh"}}},
        lifted={"type": "lift", "inputs": {"mesh": {"from": "cube.outMesh"}, **inputs}},
    )
    return sinew.Session(text=text, node_types=[lift(runs, version)])


class NodeTypes(unittest.TestCase):
    def test_a_python_type_works_in_a_graph(self):
        session = lifted(by=2)
        self.assertEqual(session.evaluate(1)["plate"].points[:, 1].min(), 1.5)
        session["lifted.way"] = "down"
        self.assertEqual(session.evaluate(1)["plate"].points[:, 1].max(), -1.5)
        with self.assertRaises(sinew.GraphError) as caught:
            session["lifted.by"] = -1
        self.assertEqual([(d.code, d.node, d.attribute) for d in caught.exception.diagnostics],
                         [("DG013", "lifted", "by")])

    def test_it_runs_once_for_the_same_inputs(self):
        runs = []
        session = lifted(runs)
        for number in range(1, 5):
            session.evaluate(number)
        self.assertEqual(runs, [1.0])
        session.set_input("lifted.by", 4, 1.5)
        session.evaluate(5)
        self.assertEqual(runs, [1.0, 1.5])
        self.assertEqual(session.counts.simulated, 4 + 2)
        session.set_input("lifted.by", 4, 1.0)
        session.evaluate(4)
        self.assertEqual(runs, [1.0, 1.5])

    def test_all_kinds_of_values_go_in_and_out(self):
        seen = {}

        def compute(frame, **given):
            seen.update(given, frame=frame)
            meshes = given["meshes"]
            return {
                "bool": not given["switch"], "integer": given["whole"] + 1, "number": frame / 2, "text": "out",
                "vector": given["vector"] * 2, "matrix": given["matrix"] @ given["matrix"],
                "numbers": np.arange(4), "mesh": meshes[0], "meshes": meshes,
            }

        kinds = ("bool", "integer", "number", "text", "vector", "matrix", "numbers", "mesh", "meshes")
        every = sinew.NodeType(
            "every", "1", "Takes and gives all kinds.",
            {
                "switch": sinew.Input("bool", True, "A switch."),
                "whole": sinew.Input("integer", 3, "A whole number.", min=0, max=9),
                "angle": sinew.Input("number", 0.5, "An angle.", unit="deg"),
                "word": sinew.Input("text", "free", "A text."),
                "vector": sinew.Input("vector", (1, 2, 3), "A vector."),
                "matrix": sinew.Input("matrix", 2 * np.eye(4), "A matrix."),
                "list": sinew.Input("numbers", [], "Numbers."),
                "wire": sinew.Wire("mesh", "A mesh.", required=False),
                "meshes": sinew.WireList("mesh", "Meshes."),
            },
            {kind: sinew.Output(kind, f"A {kind}.") for kind in kinds}, compute, uses_time=True,
        )
        text = hanging(every={"type": "every", "inputs": {"meshes": [{"from": "cube.outMesh"}, {"from": "ball.outMesh"}],
                                                          "list": [4, 5]}})
        session = sinew.Session(text=text, node_types=[every])
        out = {kind: session.evaluate(3, "every." + kind).value for kind in kinds}
        self.assertEqual((out["bool"], out["integer"], out["number"], out["text"]), (False, 4, 1.5, "out"))
        np.testing.assert_array_equal(out["vector"], [2, 4, 6])
        np.testing.assert_array_equal(out["matrix"], 4 * np.eye(4))
        np.testing.assert_array_equal(out["numbers"], [0, 1, 2, 3])
        self.assertEqual([len(m.points) for m in out["meshes"]], [8, len(session.evaluate(1, "ball.outMesh")[0].points)])
        self.assertEqual(len(out["mesh"][0].points), 8)
        self.assertEqual((seen["frame"], seen["word"], seen["wire"], seen["angle"]), (3.0, "free", None, 0.5))
        np.testing.assert_array_equal(seen["list"], [4, 5])
        self.assertFalse(seen["vector"].flags.writeable)

    def test_what_it_raises_is_a_failure_of_its_node(self):
        def failing(compute):
            broken = sinew.NodeType("broken", "1", "Fails.", {}, {"out": sinew.Output("number", "A number.")}, compute)
            session = sinew.Session(text=hanging(b={"type": "broken"}), node_types=[broken])
            with self.assertRaises(sinew.GraphError) as caught:
                session.evaluate(1, "b.out")
            (found,) = caught.exception.diagnostics
            self.assertEqual((found.code, found.node), ("DG127", "b"))
            return found.message

        message = failing(lambda: 1 / 0)
        self.assertIn("ZeroDivisionError: division by zero", message)
        self.assertIn("test_node_types.py, line", message)
        self.assertIn("another kind", failing(lambda: "text"))
        self.assertIn("None in place of a number", failing(lambda: None))
        self.assertIn("no output 'other'", failing(lambda: {"out": 1.0, "other": 2}))
        self.assertIn("nothing is given", failing(lambda: {}))

    def test_it_may_cancel(self):
        def give_up():
            raise sinew.Cancelled("not now", [])

        broken = sinew.NodeType("broken", "1", "Gives up.", {}, {"out": sinew.Output("number", "A number.")}, give_up)
        session = sinew.Session(text=hanging(b={"type": "broken"}), node_types=[broken])
        self.assertRaises(sinew.Cancelled, session.evaluate, 1, "b.out")
        self.assertEqual(session.evaluate(2).number, 2)

    def test_none_for_a_mesh_is_told(self):
        for kind, given, told in (("mesh", None, "None in place of a sinew.Mesh"),
                                  ("meshes", [None], "a list in place of a list of sinew.Mesh")):
            broken = sinew.NodeType("broken", "1", "Fails.", {}, {"out": sinew.Output(kind, "A mesh.")}, lambda: given)
            session = sinew.Session(text=hanging(b={"type": "broken"}), node_types=[broken])
            with self.assertRaises(sinew.GraphError) as caught:
                session.evaluate(1, "b.out")
            self.assertIn(told, caught.exception.diagnostics[0].message)

    def test_descriptions_that_cannot_be_are_refused(self):
        good = dict(name="n", version="1", doc="A node.", inputs={}, compute=lambda: 1.0,
                    outputs={"out": sinew.Output("number", "A number.")})
        sinew.Session(node_types=[sinew.NodeType(**good)])
        for wrong in (
            dict(version=""), dict(name="zBone"), dict(doc=""), dict(outputs={}),
            dict(outputs={"out": sinew.Output("nmber", "A number.")}),
            dict(inputs={"a": sinew.Input("mesh", None, "A mesh.")}),
            dict(inputs={"a": sinew.Input("number", "x", "A number.")}),
            dict(inputs={"a": sinew.Input("number", 5, "A number.", max=3)}),
            dict(inputs={"a": sinew.Input("number", 5, "A number.", unit="parsnips")}),
            dict(inputs={"a": sinew.Input("text", "c", "A text.", options=("a", "b"))}),
            dict(version=1), dict(doc=None), dict(inputs={1: sinew.Input("number", 5, "A number.")}),
            dict(inputs={"a": sinew.Input("number", 5, "A number.", unit=None)}),
            dict(inputs={"a": sinew.Input("text", "c", "A text.", options="ab")}),
            dict(inputs={"a": sinew.Input("number", 5, "A number.", min="a")}),
            dict(inputs={"a": sinew.Input("number", 5, "A number.", keyable="yes")}),
            dict(inputs={"a": sinew.Input("vector", [1, 2], "Too few.")}),
            dict(inputs={"a": sinew.Input("vector", "abc", "No numbers.")}),
            dict(inputs={"a": sinew.Output("number", "An output.")}),
            dict(inputs={"frame": sinew.Input("number", 7, "A number.")}, uses_time=True),
        ):
            with self.assertRaises(sinew.UsageError, msg=wrong) as caught:
                sinew.Session(node_types=[sinew.NodeType(**{**good, **wrong})])
            self.assertEqual([d.code for d in caught.exception.diagnostics], ["DG128"], wrong)
        self.assertRaisesRegex(sinew.UsageError, "a part of its declaration is of another kind",
                               lambda: sinew.Session(node_types=[3]))

    def test_functions_that_cannot_be_called_so_are_refused_at_once(self):
        def made(compute, uses_time=False):
            return sinew.Session(node_types=[sinew.NodeType(
                "n", "1", "A node.", {"x": sinew.Input("number", 1.0, "A number.")},
                {"out": sinew.Output("number", "A number.")}, compute, uses_time)])

        for compute, words in (
            (lambda: 1.0, "does not take x"), (lambda y: 1.0, "does not take x"), (lambda x, /: 1.0, "does not take x"),
            (lambda *args: 1.0, "does not take x"), (lambda x, y: 1.0, "wants y, which it is not given"),
            (lambda x, frame: 1.0, "wants frame"), (3, "is no function"),
        ):
            with self.assertRaisesRegex(sinew.UsageError, "node type n: compute " + words) as caught:
                made(compute)
            self.assertEqual([d.code for d in caught.exception.diagnostics], ["DG128"])
        self.assertRaisesRegex(sinew.UsageError, "does not take frame", made, lambda x: 1.0, True)
        for compute in (lambda x: x, lambda **given: 1.0, lambda x, y=2: 1.0, dict, max):
            made(compute)
        made(lambda frame, x: x, True)

    def test_numbers_are_told_from_what_is_none(self):
        for given in ("abc", {1.0, 2.0, 3.0}, [1, [2, 3]], [1, 2, None], [1j, 2, 3]):
            broken = sinew.NodeType("broken", "1", "Fails.", {}, {"out": sinew.Output("vector", "Three.")}, lambda: given)
            session = sinew.Session(text=hanging(b={"type": "broken"}), node_types=[broken])
            with self.assertRaises(sinew.GraphError) as caught:
                session.evaluate(1, "b.out")
            self.assertIn("is of another kind: a " + type(given).__name__, caught.exception.diagnostics[0].message)


if __name__ == "__main__":
    unittest.main()
