# Graphs that the tests of the Python module share.
# SPDX-License-Identifier: GPL-3.0-or-later
import json

import numpy as np


def hanging(**more):
    """A ball that hangs on a plate, whose matrix is the host's, beside a bone whose mesh is sent."""
    nodes = {
        "cube": {"type": "polyCube", "inputs": {"width": 6, "depth": 6}},
        "plate": {"type": "zBone", "inputs": {"mesh": {"from": "cube.outMesh"}}},
        "sent": {"type": "hostMesh"},
        "ball": {"type": "polySphere", "inputs": {"radius": 2}},
        "flesh": {"type": "zMaterial"},
        "hung": {
            "type": "zTissue",
            "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}]},
        },
        "tie": {
            "type": "zAttachment",
            "inputs": {"source": {"from": "hung.outBody"}, "target": {"from": "plate.outBody"}},
        },
        "solver": {
            "type": "zSolver",
            "inputs": {
                "bodies": [{"from": "hung.outBody"}, {"from": "plate.outBody"}],
                "attachments": [{"from": "tie.outAttachment"}],
            },
        },
    }
    nodes.update(more)
    return json.dumps({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 6}, "nodes": nodes})


def lifted(y):
    matrix = np.eye(4)
    matrix[1, 3] = y
    return matrix
