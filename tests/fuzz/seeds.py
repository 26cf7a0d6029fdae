# SPDX-License-Identifier: GPL-3.0-or-later
"""What libFuzzer begins with: {target: [bytes]}, small and right, of every form that a reader knows."""
import glob
import json
import os
import re
import struct
import subprocess
import tempfile

import samples

BETWEEN = b"\n%%%%\n"
ENDINGS = {"obj": "obj", "off": "off", "ply": "ply", "stl": "stl", "mesh": "medit", "vtk": "vtk", "msh": "gmsh", "veg": "veg"}
HEADER = len(b"sinew kept 6\n") + 16 + 2 * (16 + 8)
BLOCK = 4096

TINY = {"format": "sinew 1", "timing": {"start": 1, "end": 2}, "nodes": {
    "cube": {"type": "polyCube", "inputs": {}},
    "flesh": {"type": "zMaterial", "inputs": {}},
    "body": {"type": "zTissue", "inputs": {"mesh": {"from": "cube.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]}},
    "tets": {"type": "zTet", "inputs": {}},
    "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "body.outBody"}]}}}}


def numbers(kind, values):
    return struct.pack("<Q", len(values)) + struct.pack(f"<{len(values)}{kind}", *values)


def flat(rows):
    return [x for row in rows for x in row]


def kept_values():
    """As nodes/codecs.cpp writes them; the first byte says which."""
    mesh = numbers("i", [3] * len(samples.FACES)) + numbers("i", flat(samples.FACES))
    triangles = struct.pack("<Q", len(samples.FACES)) + struct.pack("<18i", *flat(samples.FACES))
    points = numbers("d", flat(samples.POINTS))
    tets = struct.pack("<Q", 2) + struct.pack("<8i", *flat(samples.TETS))
    whole = points + tets + numbers("d", []) + b"\1" + numbers("i", []) + numbers("d", []) + b"\0"
    cut = points + tets + numbers("d", [1, 0.5]) + b"\1" + numbers("i", [1]) + numbers("d", [0.1] * 4) + b"\1"
    contact = struct.pack("<Q3i?10d", 1, 0, 1, 2, True, *[0.5] * 10)
    marks = (struct.pack("<Q", 1) + b"".join(struct.pack("<Q", len(t)) + t for t in (b"term", b"what", b"m"))
             + struct.pack("<Qi7d2i", 1, 3, *[0.5] * 7, 0, 1))
    return [b"\0" + points + mesh + triangles, b"\1" + whole, b"\1" + cut, b"\2" + struct.pack("<Q", 1) + mesh + triangles
            + points, b"\3" + bytes(1000), b"\4" + contact, b"\5" + marks, b"\6" + numbers("d", [0, 0.5, 1])]


def sections(payload, before):
    """The sections of a part that is written whole, which begins after so many bytes: (offset, length) of each."""
    at, out = before + 8, []
    for _ in range(2):  # where parts begin, and which blocks follow
        at += 8 + 4 * struct.unpack_from("<Q", payload, at)[0]
    base = at
    while at + 8 <= len(payload):
        length = struct.unpack_from("<Q", payload, at)[0]
        if at + 8 + length > len(payload):
            break
        out.append((at + 8, length))
        at = base + -(-(at + 8 + length - base) // BLOCK) * BLOCK
    return out


def from_a_run(program):
    """Frames, rows and a state that the program keeps of a cube."""
    out = {"frame": [], "rows": [], "state": []}
    with tempfile.TemporaryDirectory() as folder:
        graph = os.path.join(folder, "tiny.json")
        with open(graph, "w", encoding="utf-8") as file:
            json.dump(TINY, file)
        subprocess.run([program, "run", graph, "--cache", folder, "--quiet", "--threads", "1"], check=True,
                       stdout=subprocess.DEVNULL)
        frames = []
        for name in sorted(glob.glob(folder + "/*.frame")):
            with open(name, "rb") as file:
                bytes_of_it = file.read()
            told = struct.unpack_from("<Q", bytes_of_it, HEADER - 16 - 2 * 8)[0]
            frames.append((bytes_of_it[HEADER:HEADER + told], bytes_of_it[HEADER + told:]))
        for told, state in sorted(frames, key=lambda f: len(f[1]), reverse=True)[:1]:
            version = sections(told, 16)[0][0]
            # Zeros where the target puts in what this build and this folder need.
            whole = bytes(16) + told[16:version] + bytes(16) + told[version + 16:]
            out["frame"].append(BETWEEN.join([whole, b"", state]))
            for other_told, other_state in frames:
                if other_told != told:
                    out["frame"].append(BETWEEN.join([whole, bytes(16) + other_told[16:], state, other_state]))
            begin, length = sections(state, 0)[0]
            out["state"].append(state[begin:begin + length])
        for name in glob.glob(folder + "/*.rows"):
            with open(name, "rb") as file:
                out["rows"].append(file.read()[:2000])
    out["rows"].append(b"sinew rows 2\n" + struct.pack("<Q", 2) + bytes(range(64)) + bytes(16))
    return out


def small(tree):
    """Graphs as text without what makes them long."""
    return samples.json.dumps(tree).encode().replace(samples.PLACE.encode(), b"")


def graphs():
    right, broken = samples.graphs(False)
    return [text for text in map(small, right + broken) if len(text) < 6000]


def includes():
    part = b'{"format":"sinew 1","nodes":{"n":{"type":"curve","inputs":{"points":[0,0,0,1,0,0]}},"t":{"type":"transform"}}}'
    top = (b'{"format":"sinew 1","includes":{"a":{"file":"b.json","overrides":{"n.points":[0,0,0,2,0,0],'
           b'"t.translate":{"value":[1,2,3],"unit":"cm"}}},"c":{"file":"./b.json"}},"nodes":{"m":{"type":"muscleCurve"}}}')
    middle = top.replace(b"b.json", b"c.json")
    circle = top.replace(b"b.json", b"a.json")
    return [top + BETWEEN + part, top + BETWEEN + middle + BETWEEN + part, circle, top + BETWEEN + circle + BETWEEN + part]


def data():
    matrix = [1, 0, 0, 2, 0, 1, 0, 3, 0, 0, 1, 4, 0, 0, 0, 1]
    turned = [0, -1, 0, 2, 1, 0, 0, 3, 0, 0, 1, 4, 0, 0, 0, 1]
    motion = {"frames": [{"frame": f, "flexion": f * 0.5, "bones": {"ulna": m}} for f, m in ((1, matrix), (2, turned))]}
    return {
        "motion": [json.dumps(motion).encode()],
        "curve": [b"0 0 0\n1 0 0\n1 1e-3 -2\n2 2 2\n", b"[[0,0,0],[1,0,0],[1,1,0],[2,2,2]]", b"[0,0,0,1,1,1]"],
        "map": [b"[0,0.5,1]", b'{"vertices":[1,2,3]}', b'{"a":[{"vertices":[0,1]}]}', b'{"a":[[0,1],[0.5]],"faces":[2]}'],
        "pc2": [b"POINTCACHE2\0" + struct.pack("<2i2fi6f", 1, 2, 1, 1, 1, *range(6))],
        "mdd": [struct.pack(">2i2f12f", 2, 2, 0, 0.5, *range(12))],
    }


def all_seeds(program):
    out = {"graph": graphs(), "includes": includes(), "kept": kept_values(), **data(), **from_a_run(program)}
    files, beside = samples.meshes()
    for name, content, _ in files:
        ending = name.rsplit(".", 1)[1]
        if ending in ENDINGS:
            out.setdefault(ENDINGS[ending], []).append(content)
    out["tetgen"] = [beside["b.node"] + BETWEEN + beside["a.ele"]]
    document, binary = samples.small_glb()
    out["glb"] = [samples.glb_bytes(json.dumps(document), binary)]
    return out


def words_of(seeds):
    """For libFuzzer's dictionary."""
    found = set()
    for seed in seeds:
        found.update(re.findall(rb"[A-Za-z_$*][A-Za-z_0-9]{1,30}", seed))
    return "".join(f'"{word.decode()}"\n' for word in sorted(found)[:2000])
