// Bodies that are switched off for some frames while they touch.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include <algorithm>
#include <cmath>

using namespace bench;

namespace {

/// A cube of 4 cm that stands on a floor, with more attributes of the two.
std::string standing(const std::string& cube, const std::string& floor) {
    return R"("shape": {"type": "polyCube", "inputs": {"width": 4, "height": 4, "depth": 4, "subdivisionsWidth": 2, "subdivisionsHeight": 2, "subdivisionsDepth": 2}},
        "place": {"type": "transform", "inputs": {"mesh": {"from": "shape.outMesh"}, "translate": [0, 2, 0]}},
        "flesh": {"type": "zMaterial", "inputs": {"youngsModulus": 1e5, "poissonsRatio": 0.3}},
        "tets": {"type": "zTet", "inputs": {"mesh": {"from": "place.outMesh"}, "tetSize": 2}},
        "cube": {"type": "zTissue", "inputs": {"mesh": {"from": "place.outMesh"}, "tets": {"from": "tets.outTets"}, "materials": [{"from": "flesh.outMaterial"}])" +
           cube + R"(}},
        "slab": {"type": "polyCube", "inputs": {"width": 30, "height": 20, "depth": 30}},
        "below": {"type": "transform", "inputs": {"translate": [0, -10, 0]}},
        "floor": {"type": "zBone", "inputs": {"mesh": {"from": "slab.outMesh"}, "matrix": {"from": "below.outMatrix"})" +
           floor + R"(}},
        "solver": {"type": "zSolver", "inputs": {"maxNewtonIterations": 40, "collisionDetection": true, "bodies": [{"from": "floor.outBody"}, {"from": "cube.outBody"}]}})";
}

double lowest(Session& s, double frame) {
    const solver::Points points = *s.get<nodes::MeshList>("solver", "outMeshes", frame).meshes[1].points;
    double low = points.front().y();
    for (const solver::Vec3& p : points) low = std::min(low, p.y());
    return low;
}

} // namespace

TEST_CASE("what rests on something comes back to it when it has been switched off and on", "[nodes]") {
    const std::string off = R"({"keys": [[1, true], [8, false], [9, true]]})";
    Session never(standing("", ""));
    const double rest = lowest(never, 40);
    // rho g h / k with the default stiffness, in centimetres.
    CHECK(rest == Approx(-100 * 1060 * 9.8 * 0.04 / 1e6).epsilon(0.02));
    for (const auto& [cube, floor] : {std::pair{R"(, "enable": )" + off, std::string()},
                                      {std::string(), R"(, "enable": )" + off},
                                      {R"(, "collisions": )" + off, std::string()}}) {
        INFO(cube << floor);
        Session s(standing(cube, floor));
        CHECK(lowest(s, 40) == Approx(rest).epsilon(0.02));
    }
}

TEST_CASE("the energy of contact goes with it, whatever was simulated before", "[nodes]") {
    const std::string off = R"({"keys": [[1, true], [20, false]]})";
    for (const std::string& cube : {R"(, "collisions": )" + off, R"(, "enable": )" + off}) {
        INFO(cube);
        const auto energy = [&](bool goes_on) {
            Session s(standing(cube, ""));
            const auto report = [&](double frame) { return s.get<nodes::SolveReport>("solver", "outReport", frame); };
            CHECK(value_of(report(19).record.measured, "contact", "force_N") > 0);
            (void)report(21);
            if (!goes_on) s.evaluator.drop_scratch();
            return report(22).record.energy;
        };
        CHECK(energy(true) == energy(false));
    }
}
