// The same scene elsewhere and in another unit: what is chosen by size or distance ties all over modelled shapes, and
// rounding must not be what decides.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

using namespace bench;

namespace {

/// A muscle with fibres and a part inside, that hangs with its cap on a plate; `unit` scene units a centimetre, moved
/// by `by` centimetres along each axis.
std::string muscle(double unit, double by) {
    const auto cm = [&](double length) { return number(unit * length); };
    const std::string moved = R"("translate": [)" + cm(by) + ", " + cm(2 * by) + ", " + cm(-3 * by) + "]";
    return R"("round": {"type": "polyCylinder", "inputs": {"radius": )" + cm(3) + R"(, "height": )" + cm(20) +
           R"(, "subdivisionsAxis": 16, "subdivisionsHeight": 10}},
        "skin": {"type": "transform", "inputs": {"mesh": {"from": "round.outMesh"}, )" +
           moved + R"(}},
        "ball": {"type": "polySphere", "inputs": {"radius": )" +
           cm(2) +
           R"(, "subdivisionsAxis": 16, "subdivisionsHeight": 12}},
        "inner": {"type": "transform", "inputs": {"mesh": {"from": "ball.outMesh"}, )" +
           moved + R"(}},
        "slab": {"type": "polyCube", "inputs": {"width": )" +
           cm(10) + R"(, "height": )" + cm(1) + R"(, "depth": )" + cm(10) + R"(}},
        "slabPlace": {"type": "transform", "inputs": {"mesh": {"from": "slab.outMesh"}, "translate": [)" +
           cm(by) + ", " + cm(2 * by + 10.5) + ", " + cm(-3 * by) + R"(]}},
        "plate": {"type": "zBone", "inputs": {"mesh": {"from": "slabPlace.outMesh"}}},
        "upper": {"type": "weights", "inputs": {"mesh": {"from": "skin.outMesh"}, "mode": "ramp", "axis": "y", "start": )" +
           cm(2 * by + 9) + R"(, "end": )" + cm(2 * by + 9.9) + R"(}},
        "lower": {"type": "weights", "inputs": {"mesh": {"from": "skin.outMesh"}, "mode": "ramp", "axis": "y", "start": )" +
           cm(2 * by - 9) + R"(, "end": )" + cm(2 * by - 9.9) + R"(}},
        "ends": {"type": "endPoints", "inputs": {"mesh": {"from": "skin.outMesh"}, "source": {"from": "upper.outWeights"},
            "sink": {"from": "lower.outWeights"}}},
        "fibre": {"type": "zFiber", "inputs": {"endPoints": {"from": "ends.outEndPoints"}, "strength": 6e4,
            "excitation": 0.5}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 2e4}},
        "firm": {"type": "zMaterial", "inputs": {"youngsModulus": 2e5}},
        "part": {"type": "zSubtissue", "inputs": {"mesh": {"from": "inner.outMesh"},
            "materials": [{"from": "firm.outMaterial"}]}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "skin.outMesh"}, "tetSize": )" +
           cm(2.5) + R"(}},
        "belly": {"type": "zTissue", "inputs": {"mesh": {"from": "skin.outMesh"}, "tets": {"from": "tets.outTets"},
            "materials": [{"from": "flesh.outMaterial"}], "fibers": [{"from": "fibre.outFiber"}],
            "subtissues": [{"from": "part.outBody"}]}},
        "tendon": {"type": "zAttachment", "inputs": {"source": {"from": "belly.outBody"}, "target": {"from": "plate.outBody"},
            "weights": {"from": "upper.outWeights"}}},
        "solver": {"type": "zSolver", "inputs": {"scale": )" +
           number(100 * unit) + R"(, "maxNewtonIterations": 60,
            "bodies": [{"from": "plate.outBody"}, {"from": "belly.outBody"}, {"from": "part.outBody"}],
            "attachments": [{"from": "tendon.outAttachment"}]}})";
}

} // namespace

TEST_CASE("a muscle with a part inside moves alike wherever the scene stands and in whatever unit", "[nodes]") {
    const auto frame = [](Session& s, std::size_t body) {
        return *s.get<nodes::MeshList>("solver", "outMeshes", 4).meshes[body].points;
    };
    Session here(muscle(1, 0));
    const solver::Points belly = frame(here, 1), part = frame(here, 2);
    double lowest = 0;
    for (const solver::Vec3& p : belly) lowest = std::min(lowest, p.y());
    REQUIRE(lowest > -9.5); // it hangs from y = 10 to -10, and pulls
    const std::pair<double, double> places[] = {{1, 7}, {1, 0.37}, {0.01, 0}, {0.01, 11.1}, {10, 1 / 3.0}};
    for (const auto& [unit, by] : places) {
        CAPTURE(unit, by);
        Session there(muscle(unit, by));
        for (const std::size_t body : {1, 2}) {
            double farthest = 0;
            const solver::Points now = frame(there, body);
            const solver::Points& then = body == 1 ? belly : part;
            REQUIRE(now.size() == then.size());
            for (std::size_t v = 0; v < now.size(); ++v)
                farthest = std::max(farthest, (now[v] / unit - by * solver::Vec3(1, 2, -3) - then[v]).norm());
            CHECK(farthest < 1e-7); // centimetres; .18 and .0013 where rounding decides
        }
    }
}
