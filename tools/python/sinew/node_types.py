# Node types in Python: declarations of what a node takes and gives, and the function that computes it.
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import inspect
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, Optional, Sequence


@dataclass(frozen=True)
class Input:
    """A value that a graph file can write, key or connect.

    kind: bool, integer, number, text, vector, matrix (4 by 4) or numbers. unit: "Pa", "m", "deg" …; "" for none.
    options: of a text, the words that it can be."""

    kind: str
    default: Any
    doc: str
    unit: str = ""
    min: Optional[float] = None
    max: Optional[float] = None
    keyable: bool = True
    options: Sequence[str] = ()
    form: str = field(default="input", init=False)


@dataclass(frozen=True)
class Wire:
    """A value that only a connection can bring: mesh, meshes, or any kind of Input. Not connected: None."""

    kind: str
    doc: str
    required: bool = True
    form: str = field(default="wire", init=False)


@dataclass(frozen=True)
class WireList:
    """A list of connections, in their order."""

    kind: str
    doc: str
    form: str = field(default="list", init=False)


@dataclass(frozen=True)
class Output:
    """What the node gives, of any kind."""

    kind: str
    doc: str


@dataclass(frozen=True)
class NodeType:
    """A node type whose results are computed by a Python function.

    compute: called with a value for each input, by name, and with `frame` if uses_time, so it takes all of them and
        wants no others; gives a dict with a value for each output, or the value itself where there is one. It must be
        a pure function of what it is given: results are found again by the type's name, its version and the inputs.
        Called from worker threads.
    version: another text whenever the function gives other results."""

    name: str
    version: str
    doc: str
    inputs: Dict[str, Any]
    outputs: Dict[str, Output]
    compute: Callable[..., Any]
    uses_time: bool = False


def node_type(
    name: str,
    *,
    version: str,
    inputs: Dict[str, Any],
    outputs: Dict[str, Output],
    doc: str = "",
    uses_time: bool = False,
) -> Callable[[Callable[..., Any]], NodeType]:
    """Makes a NodeType of the function below it; its docstring is the type's doc."""

    def make(compute: Callable[..., Any]) -> NodeType:
        text = doc or (compute.__doc__ or "").strip()
        return NodeType(name, version, text, inputs, outputs, compute, uses_time)

    return make


def _signature_fault(compute: Callable[..., Any], names: Sequence[str]) -> Optional[str]:
    """Why a function cannot be called with these names; None if it can, or where Python does not know."""
    try:
        parameters = inspect.signature(compute).parameters.values()
    except (TypeError, ValueError):
        return None if callable(compute) else "compute is no function"
    named = {p.name: p for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    left = [name for name in names if name not in named]
    if left and not any(p.kind is p.VAR_KEYWORD for p in parameters):
        return f"compute does not take {', '.join(left)}"
    wanted = [p.name for p in parameters if p.default is p.empty and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)]
    others = [name for name in wanted if name not in named or name not in names]
    if others:
        return f"compute wants {', '.join(others)}, which it is not given"
    return None
