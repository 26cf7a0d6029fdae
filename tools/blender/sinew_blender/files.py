# Files that are there whole or not at all, their names, and point caches. Knows nothing of Blender.
# SPDX-License-Identifier: GPL-3.0-or-later
import os
import shutil
import struct
import tempfile
from contextlib import contextmanager, suppress

import numpy as np

from .module import Problem


@contextmanager
def told(path):
    """What the system refuses (a full disk, a folder that cannot be written) is a Problem that names the file."""
    try:
        yield
    except OSError as error:
        raise Problem(
            f"Cannot write {path}: {error.strerror or error}", "Choose another folder, or make room and rights there."
        ) from error


def _plain(name):
    """Letters of any script, digits and a few marks: no way leads out of a folder, and no # stands for numbers."""
    return "".join(c if c.isalnum() or c in " -_()" else "_" for c in name)


class FileNames:
    """A file name for each name, no two alike, on disks that tell no large letters from small ones either. Those of
    `names` that can be file names stay as they are, whatever comes before them."""

    def __init__(self, names=()):
        self._given, self._taken = {}, set()
        for name in sorted(names, key=lambda n: n != _plain(n)):
            self.of(name)

    def of(self, name):
        if name not in self._given:
            plain, number = _plain(name), 1
            out = plain
            while out.casefold() in self._taken:
                number += 1
                out = f"{plain}_{number}"
            self._taken.add(out.casefold())
            self._given[name] = out
        return self._given[name]


class PointCache:
    """A PC2 file: a head of 32 bytes, then little-endian x, y, z of 32 bits, frame after frame. Appears under its name
    when it is complete. Raises Problem where it cannot be written."""

    def __init__(self, path, points, first):
        self.path, self.points, self.first, self.samples = path, points, first, 0
        with told(path):
            self._file = open(path + ".part", "wb")
            self._head()

    def _head(self):
        self._file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, self.points, self.first, 1.0, self.samples))

    def add(self, points):
        if points.shape != (self.points, 3):
            raise Problem(f"{self.path}: {len(points)} vertices after frames of {self.points}")
        with told(self.path):
            self._file.write(np.ascontiguousarray(points, "<f4").tobytes())
        self.samples += 1

    def finish(self):
        with told(self.path):
            self._file.seek(0)
            self._head()
            self._file.close()
            os.replace(self.path + ".part", self.path)

    def discard(self):
        """Takes away what is not complete; what has gone wrong has been told then."""
        with suppress(OSError):
            self._file.close()
        with suppress(OSError):
            os.remove(self.path + ".part")


class Staged:
    """Files that appear together when all of them are written: those of `folder`, and last `path`, which names them.
    Until `commit`, and if it never comes, what was there stays as it was."""

    def __init__(self, folder, path):
        self.folder, self.path = folder, os.path.realpath(path)  # a link stays one
        self._text = self.path + ".part"
        with told(folder):
            self._is_new = not os.path.isdir(folder)
            os.makedirs(folder, exist_ok=True)
            self._stage = tempfile.mkdtemp(prefix=".part-", dir=folder)

    def __enter__(self):
        return self

    def __exit__(self, kind, error, _trace):
        shutil.rmtree(self._stage, ignore_errors=True)
        with suppress(OSError):
            os.remove(self._text)
        if kind is not None and self._is_new:
            with suppress(OSError):
                os.rmdir(self.folder)
        if isinstance(error, OSError):
            named = str(error.filename or self.folder).replace(self._stage, self.folder)
            with told(named):
                raise error

    def file(self, *parts):
        """Where to write a file of the folder."""
        out = os.path.join(self._stage, *parts)
        os.makedirs(os.path.dirname(out), exist_ok=True)
        return out

    def commit(self, text):
        """text: of `path`."""
        with open(self._text, "w", encoding="utf-8") as file:
            file.write(text)
        for inside, _, names in os.walk(self._stage):
            there = os.path.normpath(os.path.join(self.folder, os.path.relpath(inside, self._stage)))
            os.makedirs(there, exist_ok=True)
            for name in names:
                os.replace(os.path.join(inside, name), os.path.join(there, name))
        os.replace(self._text, self.path)
