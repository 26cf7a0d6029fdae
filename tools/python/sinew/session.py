# A graph and what has been computed of it.
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import atexit
import json
import operator
import os
import sys
import warnings
import weakref
from typing import Any, Callable, Dict, Iterator, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _sinew
from .errors import SinewWarning, UsageError
from .node_types import NodeType

Value = Any
"""A number, an array of numbers, a text, or what a graph file would hold as a dict or a list of dicts."""


class Counts(NamedTuple):
    """What has been done since a session began. Look-ups cost nothing and count as reused."""

    simulated: int
    computed: int
    reused: int


class Timing(NamedTuple):
    fps: float
    start: int
    end: int


_cores: "weakref.WeakSet[_sinew.Core]" = weakref.WeakSet()


def _end_evaluations(process: int) -> None:
    """When the program ends: a thread that still evaluates would meet an interpreter that is gone. Only daemon threads
    can; they get Cancelled. A fork has no such threads."""
    if os.getpid() == process:
        for core in list(_cores):
            core.end()


atexit.register(_end_evaluations, os.getpid())


def _split(plug: str) -> Tuple[str, str]:
    if not isinstance(plug, str):
        raise UsageError(f"{plug!r} names no input: write \"node.attribute\", and the frame behind it")
    node, dot, attribute = plug.rpartition(".")
    if not dot or not node or not attribute:
        raise UsageError(f'"{plug}" names no input: write node.attribute')
    return node, attribute


def _text(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name} is a text, not {value!r}")
    return value


def _frame(value: Any) -> float:
    if not isinstance(value, (str, bytes, bytearray)):
        try:
            return float(value)
        except (TypeError, ValueError):
            pass
    raise TypeError(f"a frame is a number, not {value!r}")


def _count(value: Any, name: str, of: str) -> int:
    try:
        out = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is a whole number of {of}, not {value!r}") from None
    if not 0 <= out < 2**63:
        raise UsageError(f"{name} is a whole number of {of} from 0 on, not {value!r}")
    return out


def _folder(value: Any, name: str) -> str:
    if value is None:
        return ""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} is a folder's path or None, not {value!r}")
    return os.fspath(value)


def _callback(value: Any, name: str) -> Any:
    if value is not None and not callable(value):
        raise TypeError(f"{name} is a function or None, not {value!r}")
    return value


def _is_json(value: Value) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, (list, tuple)) and len(value) > 0 and all(isinstance(v, dict) for v in value)
    )


class Session:
    """A graph, what has been computed of it, and what the host sends.

    May be used from several threads: edits come one after the other, evaluations run side by side, and each sees the
    graph as it was when it began. The interpreter's lock is free while anything is computed.

    graph: path of a graph file; or give `text`, whose messages name `file_name` and whose relative paths start at its
        folder.
    threads: 0 takes all of the machine.
    memory: bytes for results that are kept; 0 takes a quarter of the machine's.
    cache: folder in which frames are kept for later processes; None keeps none.
    root: the only folder in which files are opened and written that graphs and the host name, wherever "..", absolute
        paths and links lead; None: anywhere.
    on_event: called with an Event from worker threads, one at a time; True cancels the evaluations that run. What it
        raises does, too, and comes out of evaluate. In it, of this session only cancel() and counts may be used.
    on_warning: called with a Diagnostic; without it evaluate gives a SinewWarning.
    node_types: types of the host's own, beside Sinew's.
    """

    def __init__(
        self,
        graph: Union[str, "os.PathLike[str]", None] = None,
        *,
        text: Optional[str] = None,
        file_name: str = "graph.json",
        threads: int = 0,
        memory: int = 0,
        cache: Union[str, "os.PathLike[str]", None] = None,
        cache_size: int = 0,
        root: Union[str, "os.PathLike[str]", None] = None,
        on_event: Optional[Callable[[_sinew.Event], Optional[bool]]] = None,
        on_warning: Optional[Callable[[_sinew.Diagnostic], None]] = None,
        node_types: Sequence[NodeType] = (),
    ) -> None:
        threads = _count(threads, "threads", "threads")
        if threads >= 2**31:
            raise UsageError(f"threads is a number of threads, not {threads}")
        if isinstance(node_types, NodeType):
            raise TypeError("node_types is a list of node types, not one of them")
        self._core = _sinew.Core(
            threads,
            _count(memory, "memory", "bytes"),
            _folder(cache, "cache"),
            _count(cache_size, "cache_size", "bytes"),
            _folder(root, "root"),
            _callback(on_event, "on_event"),
            _callback(on_warning, "on_warning"),
            list(node_types),
        )
        _cores.add(self._core)
        if graph is not None and text is not None:
            raise UsageError("give a graph's path or its text, not both")
        if graph is not None:
            self.load(graph)
        if text is not None:
            self.load_text(text, file_name)

    def load(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Another graph in place of this one; what has been computed is found again where it fits."""
        self._core.load_file(os.fspath(path))
        self._warn()

    def load_text(self, text: str, file_name: str = "graph.json") -> None:
        """The same of a text."""
        self._core.load_text(_text(text, "the graph's text"), _text(file_name, "file_name"))
        self._warn()

    @property
    def text(self) -> str:
        """The graph as a file would hold it, with all that was set."""
        return self._core.graph_text()

    @property
    def timing(self) -> Timing:
        return Timing(*self._core.timing())

    @property
    def nodes(self) -> Dict[str, str]:
        """The type of each node, in the order of the file."""
        return dict(self._core.nodes())

    def set(self, plug: str, value: Value) -> None:
        """Sets "node.attribute" at all frames alike."""
        node, attribute = _split(plug)
        if _is_json(value):
            self._core.set_json(node, attribute, json.dumps(value))
        else:
            self._core.set([(node, attribute, value)])

    __setitem__ = set

    def get(self, plug: str) -> Value:
        """What the input "node.attribute" is, set or by default: a number, text or array in SI units; keys, connections
        and the like as a graph file holds them; None for a connection that is not there."""
        return self._core.get(*_split(plug))

    __getitem__ = get

    def set_input(self, plug: str, frame: float, value: Value) -> None:
        """Sets "node.attribute" from `frame` on; the frames before keep what they have, so simulations go on from
        there. Sub-steps between two frames interpolate. The same values sent again find the same frames."""
        self.set_inputs(frame, {plug: value})

    def set_inputs(self, frame: float, values: Mapping[str, Value]) -> None:
        """The same of several: all of them or none."""
        if not isinstance(values, Mapping):
            raise TypeError(f'values is a dict of values by "node.attribute", not {values!r}')
        for plug, value in values.items():
            if _is_json(value):
                raise UsageError(f'{plug}: at a frame a value is a number, an array of numbers or a text as "30 kPa"')
        inputs = [(*_split(plug), value) for plug, value in values.items()]
        self._core.set_at(_frame(frame), inputs)

    def set_mesh(
        self,
        node: str,
        frame: float,
        points: Any,
        face_vertices: Any = None,
        face_sizes: Any = None,
    ) -> None:
        """Sends a mesh to a hostMesh node, from `frame` on; the first one holds for the frames before, too.

        points: (n, 3). face_vertices: corners, face after face, wanted once; left out, the faces stay. Without
        face_sizes they are triangles, and an array of shape (m, k) holds faces of k corners."""
        if face_vertices is None and face_sizes is not None:
            raise UsageError("face_sizes says nothing without face_vertices")
        corners = np.zeros(0, np.int32) if face_vertices is None else np.asarray(face_vertices)
        if corners.ndim > 2:
            raise UsageError("face_vertices has one axis, or two: faces and their corners")
        if len(points) == 0:
            raise UsageError("the mesh has no points")
        sizes = np.zeros(0, np.int32) if face_sizes is None else np.asarray(face_sizes)
        if corners.ndim == 2 and face_sizes is None and corners.shape[1] != 3:
            sizes = np.full(corners.shape[0], corners.shape[1])
        self._core.set_mesh(
            _text(node, "node"),
            _frame(frame),
            points,
            _whole(corners, "face_vertices"),
            _whole(sizes, "face_sizes"),
        )

    def evaluate(self, frame: float, plug: str = "") -> _sinew.Frame:
        """What "node.output" is at a frame; without a plug outMeshes of the solver that no other one reads. Only what
        is not there yet runs. Ctrl-C ends it with KeyboardInterrupt and leaves the finished frames."""
        try:
            return self._core.evaluate(_frame(frame), _text(plug, "plug"))
        finally:
            self._warn()

    def run(self, first: Optional[int] = None, last: Optional[int] = None, plug: str = "") -> Iterator[_sinew.Frame]:
        """Frame after frame; without bounds those of the graph's timing."""
        timing = self.timing
        for frame in range(timing.start if first is None else first, (timing.end if last is None else last) + 1):
            yield self.evaluate(frame, plug)

    def is_ready(self, frame: float, plug: str = "") -> bool:
        """Whether evaluate would be a look-up."""
        return self._core.is_ready(_frame(frame), _text(plug, "plug"))

    def explain(self, frame: float, plug: str = "") -> str:
        """Why it would run, in words."""
        return self._core.explain(_frame(frame), _text(plug, "plug"))

    def cancel(self) -> None:
        """Ends the evaluations that are running now, in whatever threads; finished frames stay."""
        self._core.cancel()

    @property
    def counts(self) -> Counts:
        return Counts(*self._core.counts())

    def _warn(self) -> None:
        for warning in self._core.take_warnings():
            warnings.warn(str(warning), SinewWarning, stacklevel=_level_of_caller())


def _level_of_caller() -> int:
    """For warnings: how far above the function that asks the code is that called the session."""
    level = 1
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename == __file__:
        frame = frame.f_back
        level += 1
    return level


def _whole(array: "np.ndarray[Any, Any]", name: str) -> "np.ndarray[Any, Any]":
    out: "np.ndarray[Any, Any]" = array.astype(np.int32, copy=False)
    if not np.array_equal(out, array):
        raise UsageError(f"{name} holds what is no vertex number")
    return np.ascontiguousarray(out).ravel()
