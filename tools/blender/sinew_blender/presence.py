# What Blender evaluates: only such objects move, and have the values that they are animated to.
# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from .module import Problem


def view_layer(scene):
    """The one that is seen, or the first of a scene that is in no window."""
    return bpy.context.view_layer if bpy.context.scene == scene else scene.view_layers[0]


def depsgraph(scene):
    """Of a scene, as it is now, whichever is in the window."""
    if bpy.context.scene == scene:
        return bpy.context.evaluated_depsgraph_get()
    layer = scene.view_layers[0]
    layer.update()
    return layer.depsgraph


def tag(objects):
    """Has Blender look at properties that a script has set, which it does not notice by itself."""
    for ob in objects:
        ob.update_tag()


def _shown(layer):
    if layer.exclude or layer.collection.hide_viewport:
        return
    yield from layer.collection.objects
    for child in layer.children:
        yield from _shown(child)


def _needed_by(ob):
    """Objects that are evaluated because this one is."""
    yield ob.parent
    bones = ob.pose.bones if ob.pose is not None else ()
    for constraint in (c for one in (ob, *bones) for c in one.constraints):
        yield getattr(constraint, "target", None)
        yield getattr(constraint, "pole_target", None)
    for modifier in ob.modifiers:
        yield getattr(modifier, "object", None)
    for curve in ob.animation_data.drivers if ob.animation_data is not None else ():
        for variable in curve.driver.variables:
            yield from (target.id for target in variable.targets if isinstance(target.id, bpy.types.Object))


def _evaluated(scene):
    """The names of objects that are evaluated themselves, and of those that these need."""
    own = {ob.name: ob for ob in _shown(view_layer(scene).layer_collection) if not ob.hide_viewport}
    found, todo = dict(own), list(own.values())
    while todo:
        for other in _needed_by(todo.pop()):
            if other is not None and other.name not in found:
                found[other.name] = other
                todo.append(other)
    return set(own), set(found)


def check(scene, whole, placed):
    """Raises Problem for an object that is not in the scene, or that Blender does not evaluate.

    whole: objects whose meshes or properties are read. placed: those of which only matters where they are, which is
    right, too, where another one needs them."""
    own, found = _evaluated(scene)
    for objects, names in ((whole, own), (placed, found)):
        for ob in objects:
            if ob.name in names:
                continue
            if ob.name not in scene.objects:
                raise Problem(f"{ob.name} is not in this scene: it may have been deleted", "Choose another object.")
            raise Problem(
                f"{ob.name} is switched off in viewports, so Blender does not move it",
                "Hide it by the eye instead of the monitor, and include its collection.",
            )
