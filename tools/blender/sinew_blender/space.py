# Where Sinew's space lies in Blender's: axes, units, matrices.
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np

from .module import Problem

# Sinew's x, y, z in Blender's axes: y up is turned about x, so that it stands on Blender's floor.
_turns = {
    "Y": np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]),
    "Z": np.eye(4),
}


def decimal(value):
    """The shortest decimal that Blender's 32 bit number stands for: 0.01, not 0.00999999977."""
    return float(str(np.float32(value)))


def array(matrix):
    """A mathutils.Matrix as 4 by 4 numbers of 64 bits."""
    return np.array(matrix, dtype=np.float64)


def inverse(matrix, name=""):
    """The inverse of an affine matrix, its last row exactly 0 0 0 1. Raises Problem, with the name of whose it is, where
    there is none."""
    out = np.eye(4)
    try:
        out[:3, :3] = np.linalg.inv(matrix[:3, :3])
    except np.linalg.LinAlgError as error:
        raise Problem(f"{name} is scaled to nothing along an axis", "Give it a size along all three.") from error
    out[:3, 3] = -(out[:3, :3] @ matrix[:3, 3])
    return out


def moved(matrix, points):
    """Points (n, 3) moved by an affine matrix."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def up_of(gravity):
    """The axis of a graph that is up, "Y" or "Z", by zSolver.gravity as a graph file has it: written, with a unit, or
    keyed (by its first key). "Y" where it is not written, as its default is, or connected."""
    if isinstance(gravity, dict):
        keys = gravity.get("keys")
        gravity = keys[0][1] if keys else gravity.get("value")
    if not isinstance(gravity, list) or len(gravity) != 3:
        return "Y"
    x, y, z = (abs(g) for g in gravity)
    return "Z" if z > max(x, y) else "Y"


def take_axes(settings, gravity, full_path):
    """Sets axes and units for the graph that is loaded: its own, but for the one that was exported from the scene,
    which has Blender's. Units that the user chose stay.

    settings: of the scene. full_path: gives the whole of a path."""
    if settings.exported:
        if full_path(settings.exported) == full_path(settings.graph):
            return
        settings.units, settings.exported = "GRAPH", ""
    settings.up_axis = up_of(gravity)


def blender_from_sinew(scene, units_per_metre):
    """The matrix that takes Sinew's scene space to Blender's world.

    units_per_metre: zSolver.scale of the graph. Blender's unit has `unit_settings.scale_length` metres."""
    settings = scene.sinew
    out = _turns[settings.up_axis].copy()
    if settings.units == "GRAPH":
        out[:3, :3] *= 1 / (units_per_metre * decimal(scene.unit_settings.scale_length))
    return out


def motion(now, rest, space, name=""):
    """What moves a mesh of Sinew's space from where it was at `rest` to where it is `now`, both matrices of Blender's
    world: exactly the identity where they are the same. name: of what moves."""
    if np.array_equal(now, rest):
        return np.eye(4)
    out = inverse(space) @ now @ inverse(rest, name) @ space
    out[3] = (0, 0, 0, 1)
    return out
