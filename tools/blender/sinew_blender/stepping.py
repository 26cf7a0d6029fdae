# What happens when the frame changes: values are read and sent, the frame is simulated, shapes are written.
# SPDX-License-Identifier: GPL-3.0-or-later
import sys
from contextlib import contextmanager

import bpy
from bpy.app.handlers import persistent

from . import links, presence, session, shapes
from .module import Problem

_busy = set()  # names of scenes whose frames this add-on changes itself
_rendering = set()


@contextmanager
def alone(scene):
    """While frames are changed by this add-on itself, its handlers stand aside."""
    _busy.add(scene.name_full)
    try:
        yield
    finally:
        _busy.discard(scene.name_full)


def step(scene, depsgraph, patience=0.0):
    """Shows the scene's current frame.

    depsgraph: what drives the graph is read from it; None goes by what has been read before, and so do frames between
    whole ones. Raises Problem or an error of Sinew."""
    state = session.ensure(scene)
    if scene.frame_subframe:
        depsgraph = None
    frame = scene.frame_current
    if state.job is not None and state.job.running and not state.session.is_ready(frame, scene.sinew.plug):
        return
    gap = state.missing(scene, frame if depsgraph is not None else frame + 1)
    if gap:
        if depsgraph is not None:
            links.check_presence(scene)  # which reading would tell
        raise Problem(
            f"The motion up to frame {frame} has not been read as it is now, from frame {gap[0]} on", "Use Read Motion."
        )
    if depsgraph is not None:
        state.send(scene, frame, depsgraph)
    shown = (frame, state.edits, shapes.places(scene, state, frame))
    if state.shown == shown:
        return
    result = state.evaluate(frame, scene.sinew.plug, patience)
    shapes.write(scene, state, frame, result)
    state.shown = shown
    session.clear_errors(scene)


def read_motion(scene, last=None):
    """Goes through the frames once and sends what drives the graph; only what differs counts as new. Afterwards the
    scene is where it was."""
    state = session.ensure(scene)
    last = max(scene.frame_end, scene.frame_current) if last is None else last
    here, between = scene.frame_current, scene.frame_subframe
    with alone(scene):
        try:
            presence.tag(link.object for link in links.enabled(scene) if link.kind == "VALUE")
            for frame in range(min(state.first, scene.frame_start), last + 1):
                scene.frame_set(frame)
                state.send(scene, frame, presence.depsgraph(scene))
        finally:
            scene.frame_set(here, subframe=between)
    return state


def is_driven(scene):
    """Whether something of the scene matters at other frames than the one that is shown."""
    return bool(links.enabled(scene)) or any(shapes.moves(ob) for ob in shapes.targets(scene).values())


def _tell(scene, error):
    for message in session.note(scene, error):
        print(f"Sinew: {message}", file=sys.stderr)


def expected(error):
    """Whether it is for the user: a problem in the scene or the graph, not an error in the add-on."""
    return isinstance(error, Problem) or any(c.__module__.startswith("sinew.") for c in type(error).__mro__)


def _catch_up(name):
    """Reads the motion and shows the frame, outside of Blender's handlers."""
    scene = bpy.data.scenes.get(name)
    if scene is None or _rendering or not scene.sinew.live:
        return
    try:
        read_motion(scene)
        step(scene, presence.depsgraph(scene), scene.sinew.patience)
    except Exception as error:
        if not expected(error):
            raise
        _tell(scene, error)


def live_changed(scene):
    """What is shown may be from before."""
    state = session.peek(scene)
    if state is not None:
        state.shown = None
    if scene.sinew.live and not bpy.app.background:
        bpy.app.timers.register(lambda name=scene.name_full: _catch_up(name), first_interval=0)


@persistent
def on_frame_change(scene, depsgraph=None):
    if not scene.sinew.live or scene.name_full in _busy:
        return
    try:
        if scene.name_full in _rendering:  # Blender's graph of dependencies then lacks what is not rendered
            step(scene, None)
            return
        state = session.ensure(scene)
        if not bpy.app.background and state.missing(scene, scene.frame_current):
            bpy.app.timers.register(lambda: _catch_up(scene.name_full), first_interval=0)
            return
        patience = 0 if bpy.app.background else scene.sinew.patience
        step(scene, depsgraph or presence.depsgraph(scene), patience)
    except Exception as error:
        if not expected(error):
            raise
        _tell(scene, error)


@persistent
def on_update(scene, depsgraph):
    """A changed pose or action: what was read of the motion is no longer true."""
    state = session.peek(scene)
    if state is None or scene.name_full in _busy or not state.read:
        return
    moving, dials = links.owners(scene)
    for update in depsgraph.updates:
        name = links.kind_and_name(update.id)
        moved = update.is_updated_transform or update.is_updated_geometry  # not: renamed, hidden, selected
        if isinstance(update.id, bpy.types.Action) or name in dials or (moved and name in moving):
            state.outdate()
            return


@persistent
def on_reload(*_):
    session.forget_all()


@persistent
def on_undo(scene, *_):
    state = session.peek(scene)
    if state is not None:
        state.outdate()
        state.mapped = {}


@persistent
def on_render(scene, *_):
    """Reads the motion before the first frame. With a window rendering has a thread of its own, in which frames must
    not be changed: then what was read before counts."""
    if scene.sinew.live and bpy.app.background:
        try:
            if is_driven(scene):
                read_motion(scene)
        except Exception as error:
            if not expected(error):
                raise
            _tell(scene, error)
    _rendering.add(scene.name_full)


@persistent
def on_rendered(scene, *_):
    _rendering.discard(scene.name_full)


_handlers = (
    ("frame_change_post", on_frame_change),
    ("depsgraph_update_post", on_update),
    ("load_pre", on_reload),
    ("undo_post", on_undo),
    ("redo_post", on_undo),
    ("render_init", on_render),
    ("render_complete", on_rendered),
    ("render_cancel", on_rendered),
)


def register():
    for name, handler in _handlers:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    for name, handler in _handlers:
        getattr(bpy.app.handlers, name).remove(handler)
    session.forget_all()
