# What the panel's buttons do.
# SPDX-License-Identifier: GPL-3.0-or-later
import os

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from . import bake, export, links, presence, session, shapes, space, stepping
from .settings import baked
from .module import Problem


def _has_graph(context):
    return bool(context.scene.sinew.graph)


def guarded(run):
    """An operator's function: what goes wrong in the scene or graph is reported and kept for the panel."""

    def inner(self, context, *more):
        try:
            return run(self, context, *more)
        except Exception as error:
            if not stepping.expected(error):
                raise
            return _failed(self, context, error)

    return inner


def _failed(operator, context, error):
    found = session.note(context.scene, error)
    for message in found:
        operator.report({"ERROR"}, str(message))
    return {"CANCELLED"}


def _warn(operator, state):
    for message in state.messages:
        operator.report({"WARNING"}, str(message))


class SINEW_OT_load(bpy.types.Operator):
    """Loads the graph, takes its frames over, and makes meshes that show its bodies"""

    bl_idname = "sinew.load"
    bl_label = "Load Graph"
    bl_options = {"REGISTER", "UNDO"}

    take_timing: BoolProperty(name="Frames of the graph", description="Sets the scene's frames and rate", default=True)

    @classmethod
    def poll(cls, context):
        return _has_graph(context)

    @guarded
    def execute(self, context):
        scene = context.scene
        state = session.ensure(scene)
        space.take_axes(scene.sinew, state.solver().get("gravity"), lambda path: session.full_path(path, scene))
        state = session.ensure(scene)
        if self.take_timing:
            timing = state.session.timing
            scene.frame_start, scene.frame_end = timing.start, timing.end
            scene.render.fps = max(1, round(timing.fps))
            scene.render.fps_base = scene.render.fps / timing.fps
            if not scene.frame_start <= scene.frame_current <= scene.frame_end:
                scene.frame_set(scene.frame_start)
        made = _show(context, state)
        _warn(self, state)
        self.report({"INFO"}, f"{len(state.graph['nodes'])} nodes, {made} meshes made")
        return {"FINISHED"}


def _show(context, state):
    """Meshes for all bodies, in the shape of the first frame. Gives how many were made."""
    scene = context.scene
    here = scene.frame_current
    stepping.read_motion(scene, last=state.first)
    frame = state.session.evaluate(state.first, scene.sinew.plug)
    if not frame.names:
        raise Problem(f'"{frame.plug}" gives no meshes', "Show an output that does, as solver.outMeshes.")
    made = shapes.make(scene, state, frame)
    shapes.write(scene, state, state.first, frame)
    state.shown = (state.first, state.edits) if here == state.first else None
    session.clear_errors(scene)
    return len(made)


class SINEW_OT_make_shapes(bpy.types.Operator):
    """Makes meshes for bodies that no mesh shows"""

    bl_idname = "sinew.make_shapes"
    bl_label = "Make Shapes"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return _has_graph(context)

    @guarded
    def execute(self, context):
        made = _show(context, session.ensure(context.scene))
        self.report({"INFO"}, f"{made} meshes made")
        return {"FINISHED"}


class SINEW_OT_read_motion(bpy.types.Operator):
    """Goes through the frames and sends what drives the graph; only what has changed simulates again"""

    bl_idname = "sinew.read_motion"
    bl_label = "Read Motion"

    @classmethod
    def poll(cls, context):
        return _has_graph(context) and len(context.scene.sinew.links) > 0

    @guarded
    def execute(self, context):
        scene = context.scene
        state = session.ensure(scene)
        before = state.edits
        stepping.read_motion(scene)
        self.report({"INFO"}, f"{state.edits - before} values of frames are new")
        return {"FINISHED"}


class Working:
    """An operator that simulates frames: at once when called from a script, beside the interface from a button; Esc
    stops it, and what is finished stays."""

    def begin(self, context, state):
        """Gives (first, last) of the frames that are wanted."""

    def take(self, context, number, frame):
        """One finished frame."""

    def end(self, context):
        """All of them are finished."""

    def stopped(self, context):
        """They are not."""

    @classmethod
    def poll(cls, context):
        state = session.peek(context.scene)
        return _has_graph(context) and not (state is not None and state.job is not None and state.job.running)

    def _start(self, context):
        scene = self.scene = context.scene  # another one may be in the window when it ends
        self.state = session.ensure(scene)
        self.first, self.last = self.begin(context, self.state)
        self.state.job = session.Job(self.state, range(self.first, self.last + 1), scene.sinew.plug)

    def _finish(self, context):
        scene = self.scene
        session.clear_errors(scene)
        self.end(context)
        if scene.sinew.live:
            self.state.shown = None
            stepping.step(scene, presence.depsgraph(scene))
        _warn(self, self.state)
        return {"FINISHED"}

    def execute(self, context):
        try:
            self._start(context)
            for number, frame in self.state.job.results():
                self.take(context, number, frame)
            return self._finish(context)
        except Exception as error:
            self.stopped(context)
            if not stepping.expected(error):
                raise
            return _failed(self, context, error)

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self._start(context)
        except Exception as error:
            self.stopped(context)
            if not stepping.expected(error):
                raise
            return _failed(self, context, error)
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.1, window=context.window)
        manager.progress_begin(self.first, self.last + 1)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        job = self.state.job
        try:
            if event.type == "ESC":
                job.cancel()
                self.stopped(context)
                self._leave(context)
                self.report({"WARNING"}, f"Stopped at frame {self._reached()}; finished frames are kept")
                return {"CANCELLED"}
            if event.type != "TIMER":
                return {"PASS_THROUGH"}
            ended = not job.running
            for number, frame in job.take():
                self.take(context, number, frame)
            context.window_manager.progress_update(self._reached())
            context.workspace.status_text_set(f"Sinew: frame {self._reached()} of {self.last}; Esc stops")
            if ended:
                job.take()  # raises what ended it
                self._leave(context)
                return self._finish(context)
            return {"RUNNING_MODAL"}
        except Exception as error:
            job.cancel()
            self.stopped(context)
            self._leave(context)
            if not stepping.expected(error):
                raise
            return _failed(self, context, error)

    def _reached(self):
        stepped = self.state.last_stepped
        return self.first if stepped is None else int(stepped)

    def _leave(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)


class SINEW_OT_simulate(Working, bpy.types.Operator):
    """Simulates all frames of the scene; afterwards they are only looked up"""

    bl_idname = "sinew.simulate"
    bl_label = "Simulate"

    def begin(self, context, state):
        scene = context.scene
        if links.enabled(scene):
            stepping.read_motion(scene)
        return min(state.first, scene.frame_start), scene.frame_end

    def end(self, context):
        counts = self.state.session.counts
        self.report({"INFO"}, f"Frames {self.first} to {self.last} are there; {counts.simulated} simulated so far")


class SINEW_OT_bake(Working, bpy.types.Operator):
    """Writes the shapes of all frames into point caches, which Blender plays without Sinew"""

    bl_idname = "sinew.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}

    writer = None

    def begin(self, context, state):
        scene = context.scene
        shown = list(shapes.targets(scene).values())
        if not shown:
            raise Problem("No mesh shows a body", "Load the graph or use Make Shapes.")
        if stepping.is_driven(scene):
            stepping.read_motion(scene)
        self.writer = bake.Bake(scene, state, scene.frame_start)
        return scene.frame_start, scene.frame_end

    def take(self, context, number, frame):
        self.writer.add(number, frame)

    def end(self, context):
        self.scene.sinew.live = False
        self.writer.finish()
        self.report({"INFO"}, f"{len(self.writer.caches)} point caches in {self.writer.folder}")

    def stopped(self, context):
        if self.writer is not None:
            self.writer.discard()


class SINEW_OT_clear_bake(bpy.types.Operator):
    """Takes the modifiers off that play baked shapes; the files stay"""

    bl_idname = "sinew.clear_bake"
    bl_label = "Clear Bake"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return any(baked(ob) for ob in shapes.targets(context.scene).values())

    def execute(self, context):
        self.report({"INFO"}, f"{bake.clear(context.scene)} modifiers removed")
        return {"FINISHED"}


class SINEW_OT_link_add(bpy.types.Operator):
    """Lets something in Blender drive an input of the graph"""

    bl_idname = "sinew.link_add"
    bl_label = "Add Link"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(items=[("MATRIX", "Motion", ""), ("MESH", "Mesh", ""), ("VALUE", "Number", "")])
    plug: StringProperty()
    object: StringProperty()
    bone: StringProperty()
    path: StringProperty()
    rest: EnumProperty(items=[("START", "At start", ""), ("BIND", "Rest pose", "")])

    def execute(self, context):
        ob = bpy.data.objects.get(self.object) if self.object else context.active_object
        if self.object and ob is None:
            self.report({"ERROR"}, f'There is no object "{self.object}"')
            return {"CANCELLED"}
        link = context.scene.sinew.links.add()
        link.kind, link.plug, link.object, link.bone = self.kind, self.plug, ob, self.bone
        link.path, link.rest = self.path, self.rest
        return {"FINISHED"}


class SINEW_OT_link_remove(bpy.types.Operator):
    """Removes the link"""

    bl_idname = "sinew.link_remove"
    bl_label = "Remove Link"
    bl_options = {"REGISTER", "UNDO"}

    index: IntProperty()

    @classmethod
    def poll(cls, context):
        return len(context.scene.sinew.links) > 0

    def execute(self, context):
        context.scene.sinew.links.remove(self.index)
        return {"FINISHED"}


class SINEW_OT_link_by_name(bpy.types.Operator):
    """Links zBone nodes with armature bones or objects of the same name, and hostMesh nodes with meshes"""

    bl_idname = "sinew.link_by_name"
    bl_label = "Link by Name"
    bl_options = {"REGISTER", "UNDO"}

    rest: EnumProperty(
        name="Modelled", items=[("START", "At start", ""), ("BIND", "Rest pose", "")], options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return _has_graph(context)

    @guarded
    def execute(self, context):
        scene = context.scene
        nodes = session.ensure(scene).session.nodes
        there = {link.plug for link in scene.sinew.links}
        added = 0
        for kind, plug, ob, bone in _by_name(scene, nodes):
            if plug in there:
                continue
            link = scene.sinew.links.add()
            link.kind, link.plug, link.object, link.bone, link.rest = kind, plug, ob, bone, self.rest
            added += 1
        self.report({"INFO"} if added else {"WARNING"}, f"{added} links added")
        return {"FINISHED"}


def _by_name(scene, nodes):
    objects = [ob for ob in scene.objects if not ob.sinew.body]
    bones = {b.name: (ob, b.name) for ob in objects if ob.type == "ARMATURE" for b in ob.pose.bones}
    named = {shapes.node_name(ob): (ob, "") for ob in objects if ob.type != "ARMATURE"}
    for node, kind in nodes.items():
        if kind == "zBone" and (node in named or node in bones):
            yield ("MATRIX", node + ".matrix", *(named.get(node) or bones[node]))
        elif kind == "hostMesh" and node in named and named[node][0].type == "MESH":
            yield ("MESH", node, named[node][0], "")


class SINEW_OT_attachment_add(bpy.types.Operator):
    """Lets the muscle hold on to something"""

    bl_idname = "sinew.attachment_add"
    bl_label = "Add Attachment"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.sinew.role == "MUSCLE"

    def execute(self, context):
        context.object.sinew.attachments.add()
        return {"FINISHED"}


class SINEW_OT_attachment_remove(bpy.types.Operator):
    """Removes the attachment"""

    bl_idname = "sinew.attachment_remove"
    bl_label = "Remove Attachment"
    bl_options = {"REGISTER", "UNDO"}

    index: IntProperty()

    @classmethod
    def poll(cls, context):
        return context.object is not None and len(context.object.sinew.attachments) > 0

    def execute(self, context):
        context.object.sinew.attachments.remove(self.index)
        return {"FINISHED"}


class SINEW_OT_export(bpy.types.Operator, ExportHelper):
    """Writes a graph of the scene's bones and muscles, with meshes and motion beside it"""

    bl_idname = "sinew.export"
    bl_label = "Export Graph"
    bl_options = {"REGISTER", "UNDO"}
    filename_ext = ".json"

    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    use: BoolProperty(name="Use it here", description="Load it and let this scene drive it", default=True)

    @classmethod
    def poll(cls, context):
        return any(ob.sinew.role != "NONE" for ob in context.scene.objects)

    @guarded
    def execute(self, context):
        scene = context.scene
        path = bpy.path.ensure_ext(session.full_path(self.filepath), ".json")
        done = export.write(scene, path)
        self.report({"INFO"}, f"{done.bones} bones and {done.muscles} muscles in {os.path.basename(path)}")
        for warning in done.warnings:
            self.report({"WARNING"}, warning)
        if self.use:
            export.connect(scene, path)
            _warn(self, session.ensure(scene))
            _show(context, session.ensure(scene))
        return {"FINISHED"}


_classes = (
    SINEW_OT_load,
    SINEW_OT_make_shapes,
    SINEW_OT_read_motion,
    SINEW_OT_simulate,
    SINEW_OT_bake,
    SINEW_OT_clear_bake,
    SINEW_OT_link_add,
    SINEW_OT_link_remove,
    SINEW_OT_link_by_name,
    SINEW_OT_attachment_add,
    SINEW_OT_attachment_remove,
    SINEW_OT_export,
)


def register():
    for cls in _classes:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(_classes):
        bpy.utils.unregister_class(cls)
