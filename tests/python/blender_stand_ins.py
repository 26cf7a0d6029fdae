# What stands in for Blender where modules of the add-on are tested without it.
# SPDX-License-Identifier: GPL-3.0-or-later
import importlib
import os
import sys
import tempfile
import types
import unittest

import numpy as np

ADDON = os.path.join(os.environ["SINEW_SOURCE_DIR"], "tools/blender/sinew_blender")


def part(name):
    """A module of the add-on. The package's own __init__ registers panels, so it is left out; `bpy` is empty but for
    the paths, as tests here never come to Blender."""
    if "sinew_blender" not in sys.modules:
        package = sys.modules["sinew_blender"] = types.ModuleType("sinew_blender")
        package.__path__ = [ADDON]
        blender = sys.modules["bpy"] = types.ModuleType("bpy")
        blender.path = types.SimpleNamespace(abspath=lambda path: path)
        blender.context = types.SimpleNamespace(evaluated_depsgraph_get=lambda: None)
        blender.app = sys.modules["bpy.app"] = types.ModuleType("bpy.app")
        blender.app.handlers = sys.modules["bpy.app.handlers"] = types.ModuleType("bpy.app.handlers")
        blender.app.handlers.persistent = lambda handler: handler
    return importlib.import_module("sinew_blender." + name)


def show(scene):
    """Puts a scene into the window, with all its objects seen."""
    layer = types.SimpleNamespace(exclude=False, children=[],
                                  collection=types.SimpleNamespace(hide_viewport=False, objects=scene.objects))
    context = sys.modules["bpy"].context
    context.scene, context.view_layer = scene, types.SimpleNamespace(layer_collection=layer)


class InFolder(unittest.TestCase):
    """Tests that have a folder each."""

    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.folder = made.name

    def path(self, *parts):
        return os.path.join(self.folder, *parts)


class Array:
    def __init__(self, **columns):
        self.columns = columns

    def __len__(self):
        return len(next(iter(self.columns.values())))

    def __iter__(self):
        return iter(self.points)

    def foreach_get(self, name, into):
        into[:] = np.ravel(self.columns[name])


class Objects(list):
    def __contains__(self, name):
        return any(ob.name == name for ob in self)


class Mesh:
    """An object of Blender with a mesh, as `links` reads it: triangles."""

    type, name, name_full, bone, mode = "MESH", "slab", "slab", "", "OBJECT"
    matrix_world = np.eye(4)
    hide_viewport, parent, pose, animation_data, constraints, modifiers = False, None, None, None, (), ()

    def update_tag(self):
        pass

    def edit(self, points, triangles):
        self.data = types.SimpleNamespace(
            vertices=Array(co=points), loops=Array(vertex_index=np.ravel(triangles)),
            polygons=Array(loop_total=[3] * len(triangles)),
        )

    def evaluated_get(self, _depsgraph):
        return self

    def to_mesh(self):
        return self.data

    def to_mesh_clear(self):
        pass


TET = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
PYRAMID = (
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1]],
    [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
)
