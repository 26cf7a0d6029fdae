# SPDX-License-Identifier: GPL-3.0-or-later
"""What fuzzing has grown and the tree keeps: corpus/TARGET.pack, of each input its length (8 bytes, the lowest first) and
its bytes. found_test.cpp reads the same."""
import os
import struct

import samples

FOLDER = os.path.join(samples.HERE, "corpus")


def of(target):
    """[bytes], none if nothing is kept."""
    try:
        with open(os.path.join(FOLDER, target + ".pack"), "rb") as file:
            pack = file.read()
    except FileNotFoundError:
        return []
    out, at = [], 0
    while at < len(pack):
        (length,) = struct.unpack_from("<Q", pack, at)
        out.append(pack[at + 8 : at + 8 + length])
        at += 8 + length
    return out


def write(target, inputs):
    os.makedirs(FOLDER, exist_ok=True)
    path = os.path.join(FOLDER, target + ".pack")
    with open(path + ".tmp", "wb") as file:
        for one in inputs:
            file.write(struct.pack("<Q", len(one)) + one)
    os.replace(path + ".tmp", path)
