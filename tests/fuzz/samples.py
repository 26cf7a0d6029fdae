# SPDX-License-Identifier: GPL-3.0-or-later
"""Good inputs to begin with: graphs of the repository, small meshes of every format that is read, GLBs."""
import glob
import json
import os
import re
import struct
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.dirname(os.path.dirname(HERE))
PLACE = "@SOURCE@"  # stands for the folder of the repository until a file is written

POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4)]
TETS = [(0, 1, 2, 3), (1, 2, 3, 4)]


def lines(rows, first=0):
    return "".join(" ".join(str(x + first) for x in row) + "\n" for row in rows)


def with_places(tree, folder):
    """The tree with texts that name files beside the graph made independent of where it lies."""
    if isinstance(tree, dict):
        return {k: with_places(v, folder) for k, v in tree.items()}
    if isinstance(tree, list):
        return [with_places(v, folder) for v in tree]
    if isinstance(tree, str) and tree and os.path.isfile(os.path.join(folder, tree)):
        return PLACE + "/" + os.path.relpath(os.path.join(folder, tree), SOURCE)
    return tree


def graph_in(name):
    """The graph in a file, which may have comments; texts that hold // stay."""
    with open(name, encoding="utf-8") as file:
        text = re.sub(r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/', lambda m: m[0] if m[0][0] == '"' else "", file.read(), flags=re.S)
    return with_places(json.loads(text), os.path.dirname(name))


def graphs(kept_alone):
    """Those that are right and quick to check, and the broken ones, where they are JSON. `kept_alone`: those of the folder
    samples, which stay as they are whatever becomes of the others."""
    right, broken = [], []
    names = sorted(glob.glob(HERE + "/samples/*.json"))
    if not kept_alone:
        names = sorted(glob.glob(SOURCE + "/graphs/learn/*.json")) + [SOURCE + "/graphs/scenes/arm.json"]
    for name in names:
        right.append(graph_in(name))
    if kept_alone:
        return right, right
    for name in sorted(glob.glob(SOURCE + "/graphs/broken/*.json")):
        try:
            broken.append(graph_in(name))
        except ValueError:
            pass
    return right, broken


def ply(order=None):
    head = (f"ply\nformat {'ascii' if not order else 'binary_little_endian' if order == '<' else 'binary_big_endian'} 1.0\n"
            f"comment x\nelement vertex {len(POINTS)}\nproperty double x\nproperty float y\nproperty float z\n"
            f"element face {len(FACES)}\nproperty list uchar int vertex_indices\nend_header\n").encode()
    if not order:
        return head + lines(POINTS).encode() + lines((3, *f) for f in FACES).encode()
    return (head + b"".join(struct.pack(order + "dff", *p) for p in POINTS)
            + b"".join(struct.pack(order + "Biii", 3, *f) for f in FACES))


def stl(is_binary):
    corners = [[POINTS[v] for v in f] for f in FACES]
    if is_binary:
        return b"x" * 80 + struct.pack("<I", len(FACES)) + b"".join(
            struct.pack("<12fH", 0, 0, 0, *[x for p in c for x in p], 0) for c in corners)
    return ("solid a\n" + "".join("facet normal 0 0 1\nouter loop\n" + "".join("vertex " + lines([p]) for p in c)
                                  + "endloop\nendfacet\n" for c in corners) + "endsolid a\n").encode()


def msh(version, order=None):
    if version == "1":
        return ("$NOD\n5\n" + lines((7 + i, *p) for i, p in enumerate(POINTS)) + "$ENDNOD\n$ELM\n2\n"
                + lines((i + 2, 4, 0, 0, 4, *[v + 7 for v in t]) for i, t in enumerate(TETS)) + "$ENDELM\n").encode()
    if not order:
        head = f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n$Nodes\n"
        if version == "2.2":
            return (head + "5\n" + lines((7 + i, *p) for i, p in enumerate(POINTS)) + "$EndNodes\n$Elements\n3\n"
                    + "1 2 2 0 0 7 8 9\n" + lines((i + 2, 4, 1, 0, *[v + 7 for v in t]) for i, t in enumerate(TETS))
                    + "$EndElements\n").encode()
        return (head + "1 5 7 11\n3 1 0 5\n" + lines((7 + i,) for i in range(5)) + lines(POINTS)
                + "$EndNodes\n$Elements\n1 2 2 3\n3 1 4 2\n"
                + lines((i + 2, *[v + 7 for v in t]) for i, t in enumerate(TETS)) + "$EndElements\n").encode()
    out = f"$MeshFormat\n{version} 1 8\n".encode() + struct.pack(order + "i", 1) + b"\n$EndMeshFormat\n$Nodes\n"
    if version == "2.2":
        out += b"5\n" + b"".join(struct.pack(order + "iddd", 7 + i, *p) for i, p in enumerate(POINTS))
        return (out + b"\n$EndNodes\n$Elements\n2\n" + struct.pack(order + "3i", 4, 2, 0)
                + b"".join(struct.pack(order + "5i", i + 2, *[v + 7 for v in t]) for i, t in enumerate(TETS))
                + b"\n$EndElements\n")
    out += struct.pack(order + "4Q3iQ5Q", 1, 5, 7, 11, 3, 1, 0, 5, 7, 8, 9, 10, 11)
    out += b"".join(struct.pack(order + "ddd", *p) for p in POINTS)
    return (out + b"\n$EndNodes\n$Elements\n" + struct.pack(order + "4Q3iQ", 1, 2, 2, 3, 3, 1, 4, 2)
            + b"".join(struct.pack(order + "5Q", i + 2, *[v + 7 for v in t]) for i, t in enumerate(TETS))
            + b"\n$EndElements\n")


def vtk(has_offsets):
    cells = ("CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n" + lines(TETS) if has_offsets
             else "CELLS 2 10\n" + lines((4, *t) for t in TETS))
    return ("# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n" + lines(POINTS) + cells
            + "CELL_TYPES 2\n10\n10\nCELL_DATA 2\nSCALARS coverage double 1\nLOOKUP_TABLE default\n1\n0.5\n").encode()


def meshes():
    """(file name, bytes, True if it is text); of TetGen's two files the one that is spoiled, `other` stays beside it."""
    node = ("5 3 0 0\n" + lines((i + 1, *p) for i, p in enumerate(POINTS))).encode()
    ele = ("2 4 0\n" + lines((i + 1, *[v + 1 for v in t]) for i, t in enumerate(TETS))).encode()
    obj = ("# x\nvn 0 0 1\nvt 0 0\n" + "".join("v " + lines([p]) for p in POINTS) + "g part\n"
           + "".join("f " + lines([f], 1) for f in FACES) + "f 1/1/1 2//1 -1/-1 \\\n -2\n")
    medit = ("MeshVersionFormatted 2\nDimension 3\nVertices 5\n" + lines((*p, 0) for p in POINTS) + "Triangles 1\n1 2 3 0\n"
             + "Tetrahedra 2\n" + lines((*[v + 1 for v in t], 0) for t in TETS) + "End\n")
    veg = ("# c\n*VERTICES\n5 3 0 0\n" + lines((i + 1, *p) for i, p in enumerate(POINTS)) + "*ELEMENTS\nTET\n2 4 0\n"
           + lines((i + 1, *[v + 1 for v in t]) for i, t in enumerate(TETS))
           + "*MATERIAL a\nENU, 1, 2, 0.3\n*REGION\nallElements, a\n")
    off = f"OFF\n# x\n5 {len(FACES)} 0\n" + lines(POINTS) + lines((3, *f) for f in FACES)
    return [
        ("a.obj", obj.encode(), True), ("a.off", off.encode(), True),
        ("a.ply", ply(), True), ("b.ply", ply("<"), False), ("c.ply", ply(">"), False),
        ("a.stl", stl(False), True), ("b.stl", stl(True), False),
        ("a.mesh", medit.encode(), True), ("a.vtk", vtk(False), True), ("b.vtk", vtk(True), True),
        ("a.msh", msh("1"), True), ("b.msh", msh("2.2"), True), ("c.msh", msh("4.1"), True),
        ("d.msh", msh("2.2", "<"), False), ("e.msh", msh("2.2", ">"), False), ("f.msh", msh("4.1", "<"), False),
        ("g.msh", msh("4.1", ">"), False), ("a.veg", veg.encode(), True),
        ("a.node", node, True), ("b.ele", ele, True),
    ], {"a.ele": ele, "b.node": node}


def glb_bytes(document, binary):
    text = document if isinstance(document, bytes) else document.encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def parts_of_glb(data):
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def small_glb():
    positions = b"".join(struct.pack("<3f", *p) for p in POINTS)
    indices = b"".join(struct.pack("<3H", *f) for f in FACES)
    times = struct.pack("<2f", 0, 1)
    moved = struct.pack("<6f", 0, 0, 0, 0, 1, 0)
    views, binary = [], b""
    for piece in (positions, indices, times, moved):
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(piece)})
        binary += piece
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "part", "mesh": 0, "children": [1], "translation": [0, 1, 0], "scale": [1, 1, 1]},
                  {"name": "inner", "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(POINTS), "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * len(FACES), "type": "SCALAR"},
                      {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR"},
                      {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"},
                      {"componentType": 5126, "count": 5, "type": "VEC3",
                       "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
                                  "values": {"bufferView": 3}}}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                        "samplers": [{"input": 2, "output": 3, "interpolation": "LINEAR"}]}],
        "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}
    return document, binary


def glbs(program, folder, kept_alone):
    """(document, binary): one by hand and, unless `kept_alone`, two that the program writes."""
    out = [small_glb()]
    if kept_alone:
        return out
    for name in ("01_hanging_ball", "04_moving_bone"):
        to = os.path.join(folder, name)
        subprocess.run([program, "run", f"{SOURCE}/graphs/learn/{name}.json", "--frames", "1-3", "--out", to, "--format",
                        "glb", "--quiet", "--no-cache", "--threads", "1"], check=True, stdout=subprocess.DEVNULL)
        with open(f"{to}/{name}.glb", "rb") as file:
            out.append(parts_of_glb(file.read()))
    return out
