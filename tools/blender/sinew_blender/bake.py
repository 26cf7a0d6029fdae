# Baked shapes: a point cache (PC2) a body, played by Blender's Mesh Cache modifier, without Sinew.
# SPDX-License-Identifier: GPL-3.0-or-later
import os

import bpy

from . import session, shapes
from .files import FileNames, PointCache
from .module import Problem
from .settings import BAKE, baked


def folder_of(scene, state):
    """Where the caches of a scene go; made if need be."""
    wanted = scene.sinew.bake_folder
    folder = session.full_path(wanted, scene) if wanted else os.path.splitext(state.path)[0] + "_baked"
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise Problem(f"Cannot make the folder {folder}: {error.strerror}") from error
    return folder


class Bake:
    """Takes frames in their order; `finish` puts the modifiers on. Raises Problem where files cannot be written."""

    def __init__(self, scene, state, first):
        self.scene, self.state, self.first = scene, state, first
        self.folder = folder_of(scene, state)
        self.names = FileNames(ob.name for ob in shapes.targets(scene).values())
        self.caches = {}

    def add(self, number, frame):
        from_sinew = self.state.space(self.scene)
        found, problems = shapes.pairs(self.scene, self.state, frame)
        if problems:
            raise problems[0]
        for ob, body in found:
            if ob.name not in self.caches:
                path = os.path.join(self.folder, self.names.of(ob.name) + ".pc2")
                self.caches[ob.name] = PointCache(path, len(body.points), self.first)
            self.caches[ob.name].add(shapes.local(body, ob, self.state.world(number, ob), from_sinew))

    def finish(self):
        for cache in self.caches.values():
            cache.finish()
        for name, cache in self.caches.items():
            ob = self.scene.objects[name]
            modifier = baked(ob) or ob.modifiers.new(BAKE, "MESH_CACHE")
            modifier.cache_format = "PC2"
            modifier.filepath = bpy.path.relpath(cache.path) if bpy.data.filepath else cache.path
            modifier.frame_start = self.first
            modifier.interpolation = "LINEAR"
            modifier.show_viewport = modifier.show_render = True
            # Modifiers of the user's own come after the shape. Blender 3.4 moves them by an operator alone.
            for _ in range(list(ob.modifiers).index(modifier)):
                with bpy.context.temp_override(object=ob):
                    bpy.ops.object.modifier_move_up(modifier=modifier.name)

    def discard(self):
        for cache in self.caches.values():
            cache.discard()


def clear(scene):
    """Takes the modifiers off; the files stay. Gives how many there were."""
    found = [ob for ob in shapes.targets(scene).values() if baked(ob)]
    for ob in found:
        ob.modifiers.remove(baked(ob))
    return len(found)
