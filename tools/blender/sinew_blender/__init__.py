"""Sinew in Blender: soft tissue that follows the bones of a scene, by the laws of physics."""
# SPDX-License-Identifier: GPL-3.0-or-later
bl_info = {
    "name": "Sinew",
    "description": "Muscles, fat and skin over animated bones, simulated by Sinew",
    "author": "Sinew",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Sinew",
    "category": "Physics",
}

from . import operators, panels, settings, stepping  # noqa: E402  (Blender reads bl_info from the top of the file)

_parts = (settings, operators, panels, stepping)


def register():
    for part in _parts:
        part.register()


def unregister():
    for part in reversed(_parts):
        part.unregister()
