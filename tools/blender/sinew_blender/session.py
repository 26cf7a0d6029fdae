# The session of a scene: a graph, what Blender has sent to it, and what went wrong.
# SPDX-License-Identifier: GPL-3.0-or-later
import json
import os
import queue
import re
import threading

import bpy
import numpy as np

from . import links, presence, shapes, space
from .module import Problem, sinew

_states = {}  # by the scene's name
_errors = {}  # the same: what went wrong last


class Message:
    """A diagnostic of Sinew or a problem in Blender, as the panel and reports show it."""

    def __init__(self, severity, text, hint="", code="", place=""):
        self.severity, self.text, self.hint, self.code, self.place = severity, text, hint, code, place

    @staticmethod
    def of(d):
        plug = ".".join(part for part in (d.node, d.attribute) if part)
        where = os.path.basename(d.file) + (f":{d.line}:{d.column}" if d.line > 0 else "") if d.file else ""
        frame = "" if d.frame is None else f"frame {d.frame:g}"
        return Message(d.severity, d.message, d.hint, d.code, ", ".join(p for p in (plug, where, frame) if p))

    def __str__(self):
        head = " ".join(part for part in (self.code, self.place) if part)
        return (f"{head}: " if head else "") + self.text + (f" ({self.hint})" if self.hint else "")


class State:
    """What Sinew holds of a scene.

    path: of the graph file. files: that and what it includes. first: where the simulation begins. sent: by frame what was
    sent, as bytes. forms: by node of the meshes that were sent how many vertices and which faces they have. read: the
    frames whose motion is what was sent, since poses last changed. worlds: by frame and object's name where an object was
    that shows a body and moves itself."""

    def __init__(self, path, cache):
        self.path, self.cache = path, cache
        self.messages = []
        self.loaded, self.files = None, [path]
        self.last_stepped = None
        self.stopping = False
        self.job = None  # what an operator is working at
        self.evaluations = 0
        self.session = sinew().Session(
            cache=cache or None, on_event=self._on_event, on_warning=lambda d: self.messages.append(Message.of(d))
        )
        self._forget()

    def _forget(self):
        self.graph = {"nodes": {}}
        self.sent, self.rests, self.forms, self.read, self.worlds = {}, {}, {}, set(), {}
        self.edits, self.shown, self.mapped = 0, None, {}

    def _on_event(self, event):
        if event.kind == "stepped":
            self.last_stepped = event.frame
        return self.stopping

    def wanted(self, scene):
        """Changes with all that a load hangs on."""
        settings = scene.sinew
        scale = scene.unit_settings.scale_length
        stamps = tuple(_stamp(file) for file in self.files)
        return stamps, links.signature(scene), settings.up_axis, settings.units, scale, settings.plug

    def load(self, scene):
        self.loaded, self.files = None, [self.path]
        self.messages = []
        self._forget()
        self.session.load(self.path)
        self.graph = parsed(self.session.text)
        self.graph.setdefault("nodes", {})
        self.files = included(self.path, self.graph)
        wanted = self.wanted(scene)
        links.check(scene, self.session.nodes)
        self._replace_meshes(scene)
        depsgraph = presence.depsgraph(scene)
        for link in links.enabled(scene):
            if link.kind == "MATRIX":
                self.session.set(link.plug, np.eye(4))
            elif link.kind == "VALUE":
                self.session.set(link.plug, links.value_of(link, depsgraph))
        self.loaded = wanted

    @property
    def plug(self):
        return self.loaded[-1] if self.loaded else ""

    def _replace_meshes(self, scene):
        """Nodes that Blender's meshes stand in for become hostMesh nodes."""
        names = [k.plug for k in links.enabled(scene) if k.kind == "MESH"]
        types = self.session.nodes
        others = [name for name in names if types[name] != "hostMesh"]
        for name in others:
            if name not in self.graph["nodes"]:
                raise Problem(f'"{name}" is not in the graph\'s own file', "Let the file that it is in have a hostMesh node there.")
        if others:
            for name in others:
                self.graph["nodes"][name] = {"type": "hostMesh"}
            self.session.load_text(json.dumps(self.graph, indent=1), self.path)

    # Of the graph

    def solver(self):
        """The inputs of the solver that is shown, as they stand in the file; {} where there is none."""
        nodes = self.graph["nodes"]
        solvers = [name for name, kind in self.session.nodes.items() if kind == "zSolver"]
        if self.plug:
            above = [name for name in upstream(nodes, self.plug.rpartition(".")[0]) if name in solvers]
        else:
            read = {other for name in solvers for other in upstream(nodes, name)[1:]}
            above = [name for name in solvers if name not in read]
        if above and above[0] not in nodes:
            raise Problem(
                f'The solver "{above[0]}" is not in the graph\'s own file, so its units and its start are not known here',
                "Write the solver into the graph itself.",
            )
        return nodes[above[0]].get("inputs", {}) if above else {}

    @property
    def units_per_metre(self):
        scale = self.solver().get("scale", 100.0)
        if isinstance(scale, dict):
            scale = scale.get("value", 100.0)
        if not isinstance(scale, (int, float)):
            raise Problem("zSolver.scale is keyed or connected", 'Set Units to "As they are".')
        return float(scale)

    @property
    def first(self):
        start = self.solver().get("startFrame")
        return int(start) if isinstance(start, (int, float)) else self.session.timing.start

    def space(self, scene):
        return space.blender_from_sinew(scene, self.units_per_metre if scene.sinew.units == "GRAPH" else 1.0)

    # Of what is sent

    def missing(self, scene, frame):
        """The frames before this one whose motion has not been read as it is now."""
        if not links.enabled(scene):
            return []
        return [f for f in range(self.first, frame) if f not in self.read]

    def outdate(self):
        """Poses have changed: what was read may not be what they are now."""
        self.read.clear()
        self.shown = None

    def send(self, scene, frame, depsgraph):
        """Reads all links as they are in `depsgraph` and sends what differs from what was sent for this frame. Before
        the simulation begins nothing moves."""
        if frame < self.first:
            return
        links.check_presence(scene)
        to_sinew = space.inverse(self.space(scene))
        values, meshes = {}, {}
        for link in links.enabled(scene):
            if link.kind == "MATRIX":
                if frame == self.first:
                    self.rests[link.plug] = links.rest_of(link, depsgraph)
                if link.plug not in self.rests:
                    raise Problem(f"The motion has not been read from frame {self.first} on", "Use Read Motion.")
                now = links.world_of(link, depsgraph)
                values[link.plug] = space.motion(now, self.rests[link.plug], self.space(scene), link.object.name)
            elif link.kind == "VALUE":
                values[link.plug] = links.value_of(link, depsgraph)
            else:
                meshes[link.plug] = (link, links.single(space.moved(to_sinew, links.world_points(link.object, depsgraph))))
        before = self.sent.setdefault(frame, {})
        changed = {plug: v for plug, v in values.items() if before.get(plug) != v.tobytes()}
        if changed:
            self.session.set_inputs(frame, changed)
        for node, (link, points) in meshes.items():
            self._send_faces(node, link.object, frame, points, depsgraph)
            if before.get(node) == points.tobytes():
                continue
            self.session.set_mesh(node, frame, points)
            before[node] = points.tobytes()
            self.edits += 1
        before.update({plug: v.tobytes() for plug, v in changed.items()})
        self.edits += len(changed)
        for ob in shapes.targets(scene).values():
            if shapes.moves(ob):
                self.worlds[frame, ob.name] = space.array(ob.evaluated_get(depsgraph).matrix_world)
        self.read.add(frame)

    def world(self, frame, ob):
        """Where an object that shows a body is at a frame."""
        found = self.worlds.get((frame, ob.name))
        return space.array(ob.matrix_world) if found is None else found

    def _send_faces(self, node, ob, frame, points, depsgraph):
        """Once, and again when the mesh has been edited: what was sent of the one before then holds no longer."""
        evaluated = ob.evaluated_get(depsgraph)
        sizes, corners = links.outward(*links.faces(evaluated.data), space.array(evaluated.matrix_world))
        form = (len(points), sizes.tobytes(), corners.tobytes())
        if self.forms.get(node) == form:
            return
        if node in self.forms and frame != self.first:
            self.outdate()
            raise Problem(
                f'{ob.name} has other vertices or faces at frame {frame} than at frame {self.first}, which "{node}" '
                "cannot take",
                "If it was edited, use Read Motion. If its modifiers add or remove some from frame to frame, switch "
                "these off.",
            )
        self.session.set_mesh(node, self.first, points, corners, sizes)
        self.session.set(node + ".restPoints", points.ravel())
        for sent in self.sent.values():
            sent.pop(node, None)
        self.read.clear()
        self.mapped = {}
        self.forms[node] = form

    # Of frames

    def evaluate(self, frame, plug, seconds=0.0):
        """One frame; after so many seconds (0: never) Problem is raised and what is finished stays."""
        self.evaluations += 1
        if seconds <= 0 or self.session.is_ready(frame, plug):
            return self.session.evaluate(frame, plug)
        job = Job(self, [frame], plug)
        job.thread.join(seconds)
        if job.running:
            job.cancel()
        try:
            return next(job.results())[1]
        except sinew().Cancelled as error:
            reached = "" if self.last_stepped is None else f" at frame {self.last_stepped:g}"
            raise Problem(
                f"Stopped after {seconds:g} s{reached}, on the way to frame {frame}",
                "Use Simulate, or give it more Patience; it goes on from there.",
            ) from error


class Job:
    """Frames one after the other, in a thread of their own, so that Blender stays awake."""

    def __init__(self, state, frames, plug):
        self.state, self.frames, self.plug = state, list(frames), plug
        self._queue, self._error = queue.SimpleQueue(), None
        state.stopping = False
        self.thread = threading.Thread(target=self._work, daemon=True)
        self.thread.start()

    def _work(self):
        try:
            for frame in self.frames:
                self._queue.put((frame, self.state.session.evaluate(frame, self.plug)))
        except BaseException as error:  # it is raised again where results are taken
            self._error = error

    @property
    def running(self):
        return self.thread.is_alive()

    def take(self):
        """What is finished since it was asked last: (frame, its meshes). Raises what ended the work."""
        ended = not self.running
        out = []
        while not self._queue.empty():
            out.append(self._queue.get())
        if ended and not out and self._error is not None:
            raise self._error
        return out

    def results(self):
        """All of it, as it is finished."""
        while self.running or not self._queue.empty() or self._error is not None:
            found = self.take()
            yield from found
            if not found and self.running:
                self.thread.join(0.02)

    def cancel(self):
        """Stops at the next Newton iteration."""
        self.state.stopping = True
        try:
            while self.running:
                self.state.session.cancel()
                self.thread.join(0.05)
        finally:
            self.state.stopping = False


def parsed(text):
    """A graph file, which may have comments."""
    plain = re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*|/\*.*?\*/', lambda m: m.group(1) or "", text, flags=re.S)
    return json.loads(plain)


def upstream(nodes, name):
    """A node and all that it reads, nearest first. nodes: those of a graph file."""
    found, begin = [name], 0
    while begin < len(found):
        inputs = nodes.get(found[begin], {}).get("inputs", {})
        begin += 1
        for value in inputs.values():
            for one in value if isinstance(value, list) else [value]:
                if isinstance(one, dict) and "from" in one:
                    other = one["from"].rpartition(".")[0]
                    if other not in found:
                        found.append(other)
    return found


def included(path, graph):
    """The file of a graph and all that it includes, as far as they can be read; each once."""
    out, todo = [], [(path, graph)]
    while todo:
        path, graph = todo.pop()
        if path in out:
            continue
        out.append(path)
        for entry in (graph.get("includes") or {}).values():
            file = entry.get("file") if isinstance(entry, dict) else None
            if not isinstance(file, str):
                continue
            other = os.path.normpath(os.path.join(os.path.dirname(path), file))
            try:
                with open(other, encoding="utf-8-sig") as text:
                    todo.append((other, parsed(text.read())))
            except (OSError, ValueError):
                out.append(other)
    return out


def _stamp(path):
    try:
        found = os.stat(path)
        return found.st_mtime_ns, found.st_size
    except OSError:
        return None


def full_path(path, scene=None):
    """Of a path as Blender keeps it: // is the folder of the .blend file, that of a linked scene if it is one. Raises
    Problem where there is no such file yet."""
    library = getattr(scene, "library", None)
    if path.startswith("//") and library is None and not bpy.data.filepath:
        raise Problem(f'"{path}" is beside the .blend file, which has not been saved', "Save it, or name a folder.")
    return os.path.abspath(bpy.path.abspath(path, library=library))


def peek(scene):
    """The state of a scene as it is; None if there is none."""
    return _states.get(scene.name_full)


def ensure(scene):
    """The state of a scene with its graph loaded: again, if the file or what is linked has changed."""
    settings = scene.sinew
    if not settings.graph:
        raise Problem("No graph has been chosen", "Choose a graph file in the sidebar.")
    path = full_path(settings.graph, scene)
    cache = os.path.splitext(path)[0] + ".sinew-cache" if settings.keep_frames else ""
    state = peek(scene)
    if state is None or (state.path, state.cache) != (path, cache):
        state = _states[scene.name_full] = State(path, cache)
    if state.loaded != state.wanted(scene):
        state.load(scene)
    return state


def forget_all():
    _states.clear()
    _errors.clear()


def messages_of(error):
    """What a failure says, a message for each problem."""
    found = [Message.of(d) for d in getattr(error, "diagnostics", ())]
    return found or [Message("error", str(error), getattr(error, "hint", ""))]


def note(scene, error):
    """Keeps what went wrong for the panel, and gives it."""
    _errors[scene.name_full] = messages_of(error)
    return _errors[scene.name_full]


def clear_errors(scene):
    _errors.pop(scene.name_full, None)


def messages(scene):
    """What there is to tell: errors of the last evaluation, then warnings."""
    state = peek(scene)
    return _errors.get(scene.name_full, []) + (state.messages if state is not None else [])
