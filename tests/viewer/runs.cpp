// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/viewer/runs.h"

#include "engine/format/graph_file.h"
#include "nodes/register_all.h"

#include <cmath>

namespace sinew::test {

std::string muscle_graph_text() {
    return R"({
  "format": "sinew 1",
  "timing": { "fps": 24, "start": 1, "end": 4 },
  "nodes": {
    "blockMesh": { "type": "polyCube", "inputs": { "width": 4, "height": 8, "depth": 4, "subdivisionsWidth": 2, "subdivisionsHeight": 4, "subdivisionsDepth": 2 } },
    "top": { "type": "weights", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "mode": "ramp", "axis": "y", "start": 3, "end": 4 } },
    "bottom": { "type": "weights", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "mode": "ramp", "axis": "y", "start": -3, "end": -4 } },
    "ends": { "type": "endPoints", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "source": { "from": "bottom.outWeights" }, "sink": { "from": "top.outWeights" } } },
    "fibre": { "type": "zFiber", "inputs": { "endPoints": { "from": "ends.outEndPoints" }, "excitation": { "keys": [[1, 0], [3, 1]] } } },
    "flesh": { "type": "zMaterial", "inputs": { "youngsModulus": { "value": 20, "unit": "kPa" } } },
    "block": { "type": "zTissue", "inputs": { "mesh": { "from": "blockMesh.outMesh" }, "materials": [ { "from": "flesh.outMaterial" } ], "fibers": [ { "from": "fibre.outFiber" } ] } },
    "plateMesh": { "type": "polyCube", "inputs": { "width": 6, "height": 1, "depth": 6 } },
    "lowerMove": { "type": "transform", "inputs": { "translate": [0, -4.5, 0] } },
    "lower": { "type": "zBone", "inputs": { "mesh": { "from": "plateMesh.outMesh" }, "matrix": { "from": "lowerMove.outMatrix" } } },
    "upperMove": { "type": "transform", "inputs": { "translate": { "keys": [[1, [0, 4.5, 0]], [4, [0.5, 4.7, 0]]] }, "rotate": { "keys": [[1, [0, 0, 0]], [4, [0, 20, 0]]] } } },
    "upper": { "type": "zBone", "inputs": { "mesh": { "from": "plateMesh.outMesh" }, "matrix": { "from": "upperMove.outMatrix" } } },
    "off": { "type": "zAttachment", "inputs": { "source": { "from": "block.outBody" }, "target": { "from": "lower.outBody" }, "attachmentMode": "none" } },
    "holdTop": { "type": "zAttachment", "inputs": { "source": { "from": "block.outBody" }, "target": { "from": "upper.outBody" }, "weights": { "from": "top.outWeights" } } },
    "holdBottom": { "type": "zAttachment", "inputs": { "source": { "from": "block.outBody" }, "target": { "from": "lower.outBody" }, "weights": { "from": "bottom.outWeights" } } },
    "solver": { "type": "zSolver", "inputs": {
      "bodies": [ { "from": "lower.outBody" }, { "from": "upper.outBody" }, { "from": "block.outBody" } ],
      "attachments": [ { "from": "off.outAttachment" }, { "from": "holdTop.outAttachment" }, { "from": "holdBottom.outAttachment" } ] } }
  }
})";
}

std::shared_ptr<const engine::Graph> muscle_graph() {
    return engine::read_graph(nodes::make_registry(), muscle_graph_text(), "muscle.json").graph;
}

viewer::ViewScene made_scene(std::size_t vertices, std::size_t frames) {
    viewer::ViewScene scene;
    scene.title = "made";
    viewer::ViewBody ball;
    ball.name = "ball", ball.kind = render::BodyKind::tissue;
    ball.look = render::look_of(ball.kind, {}, 0);
    for (std::size_t v = 0; v < vertices; ++v) {
        const double a = 2.399963 * static_cast<double>(v),
                     z = 1 - 2 * (static_cast<double>(v) + 0.5) / static_cast<double>(vertices);
        const double r = std::sqrt(1 - z * z);
        for (const double c : {r * std::cos(a), r * std::sin(a), z}) ball.rest.push_back(static_cast<float>(10 * c));
    }
    for (std::size_t v = 0; v + 2 < vertices; ++v)
        ball.triangles.push_back({static_cast<int>(v), static_cast<int>(v + 1), static_cast<int>(v + 2)});
    viewer::DeformingMotion moving;
    for (std::size_t f = 0; f < frames; ++f) {
        scene.frames.push_back({.frame = static_cast<int>(f) + 1});
        const float t = 0.05f * static_cast<float>(f);
        viewer::Coordinates now = ball.rest;
        for (std::size_t i = 0; i < now.size(); i += 3) {
            now[i] *= 1 + 0.2f * std::sin(t + now[i + 1]);
            now[i + 1] += 3 * t;
        }
        moving.points.push_back(std::move(now));
    }
    ball.motion = std::move(moving);
    scene.bodies.push_back(std::move(ball));
    return scene;
}

std::string cube_obj(double x, int extra) {
    std::string out = "# sinew: bone, z up, 10 units a metre\n";
    for (const int i : {0, 1, 3, 2, 4, 5, 7, 6})
        out +=
            "v " + std::to_string(x + (i & 1)) + " " + std::to_string(i >> 1 & 1) + " " + std::to_string(i >> 2) + "\n";
    for (int i = 0; i < extra; ++i) out += "v 0 0 0\n";
    return out + "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

} // namespace sinew::test
