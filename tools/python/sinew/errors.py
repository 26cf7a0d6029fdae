# What Sinew raises. Each error has all that is wrong, not only the first of it.
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from typing import TYPE_CHECKING, List, Sequence

if TYPE_CHECKING:
    from ._sinew import Diagnostic


class Error(Exception):
    """Something went wrong; `diagnostics` says what, where, and what would be right."""

    diagnostics: List[Diagnostic]

    def __init__(self, text: str = "", diagnostics: Sequence[Diagnostic] = ()) -> None:
        super().__init__(text)
        self.diagnostics = list(diagnostics)


class GraphError(Error):
    """The graph is wrong, or a mesh or value in it."""


class UsageError(Error):
    """The call is wrong: a name, a count of numbers, a session without a graph."""


class SolveError(Error):
    """The graph is right, but a simulation could not go on. The frames before are kept."""


class Cancelled(Error):
    """The host asked for it. Finished frames are kept."""


class SinewWarning(UserWarning):
    """What is doubtful and did not stop anything."""


def _diagnostic(*plain: object) -> Diagnostic:
    """What is in a pickle, made a diagnostic again: compiled functions cannot be named in one."""
    from . import _sinew

    made: Diagnostic = _sinew._diagnostic(plain)
    return made
