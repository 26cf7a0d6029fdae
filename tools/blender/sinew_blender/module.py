# Finds Sinew's own Python module: the one that lies in the add-on, or one that this Python knows.
# SPDX-License-Identifier: GPL-3.0-or-later
import importlib
import os
import sys

_inside = os.path.join(os.path.dirname(os.path.abspath(__file__)), "lib")


class Problem(Exception):
    """What a user can put right in Blender; `hint` says how."""

    def __init__(self, text, hint=""):
        super().__init__(text)
        self.hint = hint


def sinew():
    """The module. Raises Problem where this Python cannot load it."""
    if os.path.isdir(_inside) and _inside not in sys.path:
        sys.path.insert(0, _inside)
    try:
        return importlib.import_module("sinew")
    except ImportError as error:
        tag = f"Python {sys.version_info.major}.{sys.version_info.minor} ({sys.executable})"
        raise Problem(
            f"Blender's {tag} cannot load Sinew: {error}",
            "Build the add-on's zip for the Python that this Blender runs; Debian's Blender runs Debian's.",
        ) from error
