# What is kept in the .blend: of a scene the graph and what drives it, of an object what it is in an exported graph.
# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    PointerProperty,
    StringProperty,
)

BAKE = "Sinew"  # name of the modifier that plays baked shapes


def baked(ob):
    """The modifier that plays an object's baked shape; None if it has none."""
    return next((m for m in ob.modifiers if m.type == "MESH_CACHE" and m.name.split(".")[0] == BAKE), None)


def _live_changed(scene_settings, _context):
    """Baked shapes stand aside while live ones are written, and these are shown at once."""
    from . import stepping  # which reads the settings

    scene = scene_settings.id_data
    for ob in scene.objects:
        modifier = baked(ob)
        if modifier is not None:
            modifier.show_viewport = modifier.show_render = not scene_settings.live
    stepping.live_changed(scene)


def _is_mesh(_self, ob):
    return ob.type == "MESH"


class SinewLink(bpy.types.PropertyGroup):
    """Something in Blender that drives an input of the graph."""

    kind: EnumProperty(
        name="Sends",
        items=[
            ("MATRIX", "Motion", "The motion of an object or of a bone of an armature, to a matrix"),
            ("MESH", "Mesh", "The mesh with its modifiers, at each frame, in place of a node that gives a mesh"),
            ("VALUE", "Number", "A property of an object, to a number or vector"),
        ],
    )
    plug: StringProperty(name="To", description="node.attribute of the graph; for a mesh the node's name")
    object: PointerProperty(name="Object", type=bpy.types.Object)
    bone: StringProperty(name="Bone", description="Bone of the armature; empty: the object itself")
    path: StringProperty(name="Property", description='Data path from the object, as "sinew.excitation" or ["strain"]')
    rest: EnumProperty(
        name="Modelled",
        description="Where the object is while the mesh is as modelled",
        items=[
            ("START", "At start", "As posed at the first frame of the simulation"),
            ("BIND", "Rest pose", "In the armature's rest pose; of an object: without any transformation"),
        ],
    )
    enabled: BoolProperty(name="On", default=True)


class SinewScene(bpy.types.PropertyGroup):
    graph: StringProperty(name="Graph", subtype="FILE_PATH", description="Graph file of Sinew (JSON)")
    plug: StringProperty(
        name="Show", description="node.output whose meshes are shown; empty: outMeshes of the solver no other one reads"
    )
    live: BoolProperty(
        name="Live",
        description="Simulate and write shapes whenever the frame changes",
        update=_live_changed,
    )
    patience: FloatProperty(
        name="Patience",
        description="Seconds after which a frame change stops simulating; what is finished stays. 0: none. "
        "Without a window there is no limit",
        default=5,
        min=0,
        soft_max=60,
    )
    up_axis: EnumProperty(
        name="Up",
        items=[
            ("Y", "Y of the graph", "The graph's y is Blender's z"),
            ("Z", "Z of the graph", "The graph has Blender's axes"),
        ],
    )
    units: EnumProperty(
        name="Units",
        items=[
            ("GRAPH", "Metres", "By zSolver.scale and Blender's unit scale, so that a metre is a metre"),
            ("SAME", "As they are", "A unit of the graph is a unit of Blender"),
        ],
    )
    exported: StringProperty(
        description="The graph that was exported from the scene, in Blender's own axes and units", options={"HIDDEN"}
    )
    keep_frames: BoolProperty(
        name="Keep frames on disk",
        description="Beside the graph, for the next time that Blender is started",
        default=True,
    )
    bake_folder: StringProperty(
        name="Bake to", subtype="DIR_PATH", description="Folder of point caches; empty: beside the graph"
    )
    links: CollectionProperty(type=SinewLink)
    gravity: FloatVectorProperty(
        name="Gravity", description="Of exported graphs, in m/s², whatever the units", size=3, default=(0, 0, -9.8)
    )


class SinewAttachment(bpy.types.PropertyGroup):
    """What a muscle holds on to."""

    group: StringProperty(name="Vertex group", description="Where it is attached, and how strongly; empty: all of it")
    target: PointerProperty(name="To", type=bpy.types.Object, poll=_is_mesh)
    mode: EnumProperty(
        name="Mode", items=[("fixed", "Fixed", "It stays where it is"), ("sliding", "Sliding", "It slides along")]
    )
    stiffness: FloatProperty(name="Stiffness", description="N/m³", default=1e8, min=0)


class SinewObject(bpy.types.PropertyGroup):
    body: StringProperty(name="Shows", description="The body of the graph whose shape this mesh takes")
    role: EnumProperty(
        name="Role",
        description="What it is in an exported graph",
        items=[
            ("NONE", "None", "Not a part of it"),
            ("BONE", "Bone", "Moves as animated; muscles are attached to it"),
            ("MUSCLE", "Muscle", "Soft tissue"),
        ],
    )
    deforms: BoolProperty(
        name="Deforms",
        description="The bone's vertices move by modifiers or shape keys, not only the object",
    )
    tet_size: FloatProperty(name="Tet size", description="In Blender's units; 0: by the size of the mesh", min=0)
    law: EnumProperty(
        name="Law",
        items=[(word, word, "") for word in ("LogNeoHookean", "NeoHookean", "StVK", "Corotational")],
    )
    youngs_modulus: FloatProperty(name="Young's modulus", description="Pa", default=12000, min=1e-3)
    poissons_ratio: FloatProperty(name="Poisson's ratio", default=0.4, min=-0.95, max=0.495)
    mass_density: FloatProperty(name="Density", description="kg/m³", default=1060, min=1e-3)
    attachments: CollectionProperty(type=SinewAttachment)
    fibres: BoolProperty(name="Fibres", description="It contracts")
    origin: StringProperty(name="Origin", description="Vertex group in which the fibres begin")
    insertion: StringProperty(name="Insertion", description="Vertex group in which they end")
    strength: FloatProperty(name="Strength", description="Pa", default=12000, min=0)
    contraction_limit: FloatProperty(name="Contraction limit", default=0, min=0, max=1)
    excitation: FloatProperty(
        name="Excitation",
        description="0 relaxed to 1 fully excited; animate it",
        min=0,
        max=1,
        options={"ANIMATABLE"},
    )


_classes = (SinewLink, SinewScene, SinewAttachment, SinewObject)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)
    bpy.types.Scene.sinew = PointerProperty(type=SinewScene)
    bpy.types.Object.sinew = PointerProperty(type=SinewObject)


def unregister():
    del bpy.types.Object.sinew
    del bpy.types.Scene.sinew
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
