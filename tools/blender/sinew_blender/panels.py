# The sidebar.
# SPDX-License-Identifier: GPL-3.0-or-later
import textwrap

import bpy

from . import module, session
from .space import decimal


class _Panel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Sinew"


def _lines(layout, text, icon, width):
    letters = (width / (bpy.context.preferences.system.ui_scale or 1) - 60) / 7  # no window, no scale
    for i, line in enumerate(textwrap.wrap(text, max(12, int(letters)))):
        layout.label(text=line, icon=icon if i == 0 else "BLANK1")


def show_messages(layout, scene, width):
    """What went wrong, with its place and what would be right."""
    for message in session.messages(scene)[:8]:
        box = layout.box()
        head = " ".join(part for part in (message.code, message.place) if part)
        icon = "ERROR" if message.severity == "error" else "INFO"
        _lines(box, f"{head}: {message.text}" if head else message.text, icon, width)
        if message.hint:
            _lines(box, message.hint, "BLANK1", width)


class SINEW_PT_graph(_Panel, bpy.types.Panel):
    bl_label = "Graph"

    def draw(self, context):
        layout, scene = self.layout, context.scene
        settings = scene.sinew
        try:
            module.sinew()
        except module.Problem as problem:
            _lines(layout, f"{problem} {problem.hint}", "ERROR", context.region.width)
            return
        layout.prop(settings, "graph", text="")
        layout.operator("sinew.load")
        show_messages(layout, scene, context.region.width)
        layout.prop(settings, "up_axis")
        layout.prop(settings, "units")
        _lines(layout, units_in_words(scene), "BLANK1", context.region.width)
        layout.prop(settings, "plug")
        layout.prop(settings, "keep_frames")
        layout.prop(settings, "live", toggle=True)
        layout.prop(settings, "patience")
        if settings.live and not scene.render.use_lock_interface:
            layout.prop(scene.render, "use_lock_interface")
        layout.operator("sinew.simulate")
        layout.prop(settings, "bake_folder")
        row = layout.row(align=True)
        row.operator("sinew.bake")
        row.operator("sinew.clear_bake")


def units_in_words(scene):
    """How long a unit of the graph is in Blender."""
    state = session.peek(scene)
    if scene.sinew.units == "SAME":
        return "A unit of the graph is a unit of Blender"
    if state is None or state.loaded is None:
        return "Lengths by zSolver.scale and the scene's unit scale"
    try:
        metre = 1 / decimal(scene.unit_settings.scale_length)
        return f"{state.units_per_metre:g} units of the graph = 1 m = {metre:g} units of Blender"
    except module.Problem as problem:
        return str(problem)


class SINEW_PT_links(_Panel, bpy.types.Panel):
    bl_label = "Driven by Blender"

    def draw(self, context):
        layout, settings = self.layout, context.scene.sinew
        layout.operator("sinew.link_by_name")
        layout.operator("sinew.read_motion")
        for i, link in enumerate(settings.links):
            box = layout.box()
            row = box.row(align=True)
            row.prop(link, "enabled", text="")
            row.prop(link, "kind", text="")
            row.prop(link, "plug", text="")
            box.prop(link, "object", text="")
            if link.kind == "MATRIX":
                if link.object is not None and link.object.type == "ARMATURE":
                    box.prop_search(link, "bone", link.object.pose, "bones")
                box.prop(link, "rest")
            elif link.kind == "VALUE":
                box.prop(link, "path")
            box.operator("sinew.link_remove").index = i
        layout.operator("sinew.link_add")


class SINEW_PT_object(_Panel, bpy.types.Panel):
    bl_label = "Object"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context):
        layout, ob = self.layout, context.object
        s = ob.sinew
        layout.prop(s, "body")
        layout.prop(s, "role")
        if s.role == "BONE":
            layout.prop(s, "deforms")
        if s.role != "MUSCLE":
            return
        for name in ("tet_size", "law", "youngs_modulus", "poissons_ratio", "mass_density", "fibres"):
            layout.prop(s, name)
        if s.fibres:
            layout.prop_search(s, "origin", ob, "vertex_groups")
            layout.prop_search(s, "insertion", ob, "vertex_groups")
            for name in ("strength", "contraction_limit", "excitation"):
                layout.prop(s, name)
        for i, a in enumerate(s.attachments):
            box = layout.box()
            box.prop_search(a, "group", ob, "vertex_groups")
            box.prop(a, "target")
            box.prop(a, "mode")
            box.prop(a, "stiffness")
            box.operator("sinew.attachment_remove").index = i
        layout.operator("sinew.attachment_add")


class SINEW_PT_export(_Panel, bpy.types.Panel):
    bl_label = "Export"

    def draw(self, context):
        layout = self.layout
        layout.prop(context.scene.sinew, "gravity")
        layout.operator("sinew.export")
        layout.operator("sinew.make_shapes")


_classes = (SINEW_PT_graph, SINEW_PT_links, SINEW_PT_object, SINEW_PT_export)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
