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


def _collections(layer):
    """Those that are neither excluded nor switched off in viewports."""
    if layer.exclude or layer.collection.hide_viewport:
        return
    yield layer.collection
    for child in layer.children:
        yield from _collections(child)


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


def _with_what_they_need(objects):
    """The objects that are evaluated where these are."""
    found = set(objects)
    todo = list(found)
    while todo:
        for other in _needed_by(todo.pop()):
            if other is not None and other not in found:
                found.add(other)
                todo.append(other)
    return found


def check(scene, whole, placed):
    """Raises Problem for an object that is not in the scene, or that Blender does not evaluate.

    whole: objects whose meshes or properties are read. placed: those of which only matters where they are, which is
    right, too, where another one needs them."""
    # Asked at each frame, of scenes with thousands of objects: only the few in question are looked at one by one.
    members = set()
    for collection in _collections(view_layer(scene).layer_collection):
        members.update(collection.objects)
    missing = [ob for ob in (*whole, *placed) if ob.hide_viewport or ob not in members]
    if missing and not any(ob in whole for ob in missing):
        found = _with_what_they_need(ob for ob in members if not ob.hide_viewport)
        missing = [ob for ob in missing if ob not in found]
    for ob in missing:
        if ob.name not in scene.objects:
            raise Problem(f"{ob.name} is not in this scene: it may have been deleted", "Choose another object.")
        raise Problem(
            f"{ob.name} is switched off in viewports, so Blender does not move it",
            "Hide it by the eye instead of the monitor, and include its collection.",
        )
