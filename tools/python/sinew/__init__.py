"""Sinew: soft tissue that moves by the laws of physics.

    import sinew

    session = sinew.Session("arm.json")
    for frame in session.run():
        points = frame["biceps"].points  # (n, 3), shown without a copy
"""
# SPDX-License-Identifier: GPL-3.0-or-later
from ._sinew import Diagnostic, Event, Frame, Mesh
from ._sinew import version as __version__
from .errors import Cancelled, Error, GraphError, SinewWarning, SolveError, UsageError
from .node_types import Input, NodeType, Output, Wire, WireList, node_type
from .session import Counts, Session, Timing

__all__ = [
    "Cancelled",
    "Counts",
    "Diagnostic",
    "Error",
    "Event",
    "Frame",
    "GraphError",
    "Input",
    "Mesh",
    "NodeType",
    "Output",
    "Session",
    "SinewWarning",
    "SolveError",
    "Timing",
    "UsageError",
    "Wire",
    "WireList",
    "__version__",
    "node_type",
]
