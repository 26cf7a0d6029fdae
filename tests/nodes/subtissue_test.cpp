// zSubtissue from end to end: bars of parts in closed form, nesting, fibres, attachments, what comes out, diagnostics.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace bench;

namespace {

/// A box from x0 to x1 of 1 x 1 about the x axis, as the nodes NAMEShape and NAMEMesh (its outMesh).
std::string box(const std::string& name, double x0, double x1, int parts) {
    return "\"" + name + R"(Shape": {"type": "polyCube", "inputs": {"width": )" + number(x1 - x0) +
           R"(, "subdivisionsWidth": )" + std::to_string(parts) + R"(}},
        ")" +
           name + R"(Mesh": {"type": "transform", "inputs": {"mesh": {"from": ")" + name +
           R"(Shape.outMesh"}, "translate": [)" + number(0.5 * (x0 + x1)) + R"(, 0, 0]}},)";
}

std::string flesh(const std::string& name, double modulus, double restScale = 1) {
    return "\"" + name + R"(": {"type": "zMaterial", "inputs": {"poissonsRatio": 0, "youngsModulus": )" +
           number(modulus) + R"(, "restScale": )" + number(restScale) + "}},";
}

/// A bar from -2 to 2 cm of 1 kPa. From .55 on it is `muscle` of 4 kPa, of which what lies beyond 1.3 is `tendon` of
/// 20 kPa where `nested`. Held at -2; at 2 as `end` says. No border falls on the given tets' faces.
std::string bar(const std::string& element, bool nested, const std::string& end, const std::string& muscle = "",
                const std::string& solver_inputs = "") {
    return box("bar", -2, 2, 7) + box("muscle", 0.55, 2, 2) + box("tendon", 1.3, 2, 1) + flesh("soft", 1e3) +
           flesh("firm", 4e3) + flesh("hard", 2e4) + R"(
        "fit": {"type": "zDelaunayTetMesh", "inputs": {"mesh": {"from": "barMesh.outMesh"}}},
        "tets": {"type": "zTet", "inputs": {"tets": {"from": "fit.outTets"}, "element": ")" +
           element + R"("}},
        "tendon": {"type": "zSubtissue", "inputs": {"mesh": {"from": "tendonMesh.outMesh"},
            "materials": [{"from": "hard.outMaterial"}]}},
        "muscle": {"type": "zSubtissue", "inputs": {"mesh": {"from": "muscleMesh.outMesh"},
            "materials": [{"from": "firm.outMaterial"}])" +
           (nested ? R"(, "subtissues": [{"from": "tendon.outBody"}])" : "") + muscle + R"(}},
        "bar": {"type": "zTissue", "inputs": {"mesh": {"from": "barMesh.outMesh"}, "tets": {"from": "tets.outTets"},
            "compressionResistance": 0, "materials": [{"from": "soft.outMaterial"}],
            "subtissues": [{"from": "muscle.outBody"}]}},
        "left": {"type": "weights", "inputs": {"mesh": {"from": "barMesh.outMesh"}, "mode": "ramp", "start": -1.99, "end": -2}},
        "right": {"type": "weights", "inputs": {"mesh": {"from": "barMesh.outMesh"}, "mode": "ramp", "start": 1.99, "end": 2}},
        "pull": {"type": "transform", "inputs": {"translate": {"keys": [[1, [0, 0, 0]], [2, [1, 0, 0]]]}}},
        "still": {"type": "zHold", "inputs": {"tissue": {"from": "bar.outBody"}, "weights": {"from": "left.outWeights"}}},)" +
           end + R"(
        "solver": {"type": "zSolver", "inputs": {"gravity": [0, 0, 0], "integrator": "QuasiStatic",
            "solverToleranceFactor": 1e-4, "maxNewtonIterations": 60,
            "bodies": [{"from": "bar.outBody"}, {"from": "muscle.outBody"})" +
           (nested ? R"(, {"from": "tendon.outBody"})" : "") + solver_inputs + "}}";
}

const std::string moved = R"("moved": {"type": "zHold", "inputs": {"tissue": {"from": "bar.outBody"},
    "weights": {"from": "right.outWeights"}, "matrix": {"from": "pull.outMatrix"}}},)";
const std::string both_held = R"(], "forces": [{"from": "still.outForce"}, {"from": "moved.outForce"}])";

/// Stress over the first section of StVK at nu = 0 along a bar.
double pull_of(double modulus, double stretch) { return 0.5 * modulus * stretch * (stretch * stretch - 1); }

/// The root of a rising function.
template <class F>
double root(const F& f, double low, double high) {
    for (int i = 0; i < 200; ++i) (f(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
}

/// The stretch at which a material pulls so much.
double stretch_of(double modulus, double pull) {
    return root([&](double s) { return pull_of(modulus, s) - pull; }, 0.6, 4);
}

double least_x(const nodes::Mesh& mesh) {
    double x = 1e9;
    for (const solver::Vec3& p : *mesh.points) x = std::min(x, p.x());
    return x;
}

std::vector<std::string> warnings(const Counter& counter) {
    std::vector<std::string> out;
    for (const engine::Diagnostic& d : counter.warnings) out.push_back(d.code + " " + d.node);
    return out;
}

} // namespace

TEST_CASE("a bar of a tissue, its part and a part of that stretches as three bars in a row", "[nodes]") {
    for (const char* element : {"linear", "quadratic"})
        for (const bool nested : {false, true}) {
            INFO(element << (nested ? ", nested" : ""));
            Session s(bar(element, nested, moved, "", both_held));
            const double ends = nested ? 1.3 : 2;
            const auto length = [&](double pull) {
                return 2.55 * stretch_of(1e3, pull) + (ends - 0.55) * stretch_of(4e3, pull) +
                       (2 - ends) * stretch_of(2e4, pull);
            };
            const double pull = root([&](double p) { return length(p) - 5; }, 0, 1e5);
            const auto meshes = s.get<nodes::MeshList>("solver", "outMeshes", 2).meshes;
            const double border = -2 + 2.55 * stretch_of(1e3, pull);
            REQUIRE(meshes.size() == (nested ? 3 : 2));
            CHECK(least_x(meshes[1]) == Approx(border).epsilon(1e-6));
            if (nested) CHECK(least_x(meshes[2]) == Approx(border + 0.75 * stretch_of(4e3, pull)).epsilon(1e-6));
            // And no thinner anywhere: a tet that two parts shared would not be under one stress.
            for (const nodes::Mesh& m : meshes)
                for (const solver::Vec3& p : *m.points) CHECK(std::abs(std::abs(p.y()) - 0.5) < 1e-6);
            const auto report = s.get<nodes::SolveReport>("solver", "outReport", 2);
            CHECK(report.record.converged);
            CHECK(report.tets == s.get<nodes::SolveReport>("solver", "outReport", 1).tets);
            CHECK(warnings(s.counter).empty());
        }
}

TEST_CASE("a part's fibres pull within it alone, in place of the tissue's", "[nodes]") {
    const std::string fibres = R"("own": {"type": "zFiber", "inputs": {"direction": [1, 0, 0], "strength": 1000,
            "contractionLimit": 0.5, "excitation": 1}},
        "others": {"type": "zFiber", "inputs": {"direction": [1, 0, 0], "strength": 3000, "contractionLimit": 0.2,
            "excitation": {"keys": [[1, 0], [3, 0], [4, 1]], "interp": "step"}}},)";
    std::string nodes = fibres + bar("linear", false, R"("moved": {"type": "zHold", "inputs": {
        "tissue": {"from": "bar.outBody"}, "weights": {"from": "right.outWeights"}}},)",
                                     R"(, "fibers": [{"from": "own.outFiber"}])", both_held);
    const std::string soft = R"("materials": [{"from": "soft.outMaterial"}])";
    nodes.insert(nodes.find(soft), R"("fibers": [{"from": "others.outFiber"}], )");
    Session s(nodes);
    for (const bool both : {false, true}) {
        // Force of the muscle at the stretch that the rest leaves it, and of the rest.
        const auto surplus = [&](double x) { // of the pull on the border at x, to the left
            const double left = (x + 2) / 2.55, right = (2 - x) / 1.45;
            return pull_of(1e3, left) + (both ? 3000 * std::max(0.0, left - 0.2) : 0) -
                   (pull_of(4e3, right) + 1000 * std::max(0.0, right - 0.5));
        };
        INFO((both ? "both" : "the part's"));
        const auto meshes = s.get<nodes::MeshList>("solver", "outMeshes", both ? 4 : 2).meshes;
        CHECK(least_x(meshes[1]) == Approx(root(surplus, -1, 1.5)).epsilon(1e-6));
    }
    CHECK(warnings(s.counter).empty());
}

TEST_CASE("a part holds on to a bone by attachments of its own", "[nodes]") {
    const std::string tie = box("wall", 2, 3, 1) + R"(
        "wallMove": {"type": "transform", "inputs": {"translate": {"keys": [[1, [0, 0, 0]], [2, [1, 0, 0]]]}}},
        "wall": {"type": "zBone", "inputs": {"mesh": {"from": "wallMesh.outMesh"}, "matrix": {"from": "wallMove.outMatrix"}}},
        "grip": {"type": "weights", "inputs": {"mesh": {"from": "muscleMesh.outMesh"}, "mode": "ramp", "start": 1.99, "end": 2, "on": "faces"}},
        "glue": {"type": "zAttachment", "inputs": {"source": {"from": "muscle.outBody"}, "target": {"from": "wall.outBody"},
            "weights": {"from": "grip.outWeights"}, "weightsOn": "faces", "stiffness": 1e6}},)";
    for (const char* element : {"linear", "quadratic"}) {
        INFO(element);
        Session s(bar(element, false, tie, "",
                      R"(, {"from": "wall.outBody"}], "forces": [{"from": "still.outForce"}],
                       "attachments": [{"from": "glue.outAttachment"}])"));
        // 1e6 N/m^3: a pull of 1e4 Pa a centimetre.
        const auto length = [&](double pull) {
            return 2.55 * stretch_of(1e3, pull) + 1.45 * stretch_of(4e3, pull) + pull / 1e4;
        };
        const double pull = root([&](double p) { return length(p) - 5; }, 0, 1e5);
        const auto meshes = s.get<nodes::MeshList>("solver", "outMeshes", 2).meshes;
        CHECK(least_x(meshes[1]) == Approx(-2 + 2.55 * stretch_of(1e3, pull)).epsilon(1e-6));
        CHECK(warnings(s.counter).empty());
    }
}

TEST_CASE("a part is not attached to what it is a part of", "[nodes]") {
    for (const auto& [source, target] : {std::pair("muscle", "bar"), {"bar", "muscle"}, {"tendon", "bar"}}) {
        INFO(source << " to " << target);
        const std::string tie = std::string(R"("glue": {"type": "zAttachment", "inputs": {"source": {"from": ")") +
                                source + R"(.outBody"}, "target": {"from": ")" + target + R"(.outBody"}}},)";
        std::string text;
        CHECK(codes(bar("linear", true, moved + tie, "",
                        both_held + R"(, "attachments": [{"from": "glue.outAttachment"}])"),
                    "solver", "outMeshes", &text) == Codes{"FE219"});
        const std::string part = source == std::string("bar") ? target : source;
        CHECK_THAT(text, Catch::Contains("glue: " + part + " is a part of bar, and goes along with it"));
    }
}

TEST_CASE("a part of restScale scales by its own envelope", "[nodes]") {
    // A part that is all of the tissue: nothing of the tissue's own is left, and it comes to rest without stress.
    for (const double exponent : {1.0, -1.0, 2.0}) {
        Session s(box("bar", -2, 2, 4) + flesh("soft", 1e3, 1.5) + flesh("firm", 1e3, 0.8) +
                  R"("tets": {"type": "zTet", "inputs": {"mesh": {"from": "barMesh.outMesh"}, "tetSize": 0.7}},
            "muscle": {"type": "zSubtissue", "inputs": {"mesh": {"from": "barMesh.outMesh"},
                "materials": [{"from": "firm.outMaterial"}], "restScaleEnvelope": )" +
                  number(exponent) + R"(}},
            "bar": {"type": "zTissue", "inputs": {"mesh": {"from": "barMesh.outMesh"}, "tets": {"from": "tets.outTets"},
                "materials": [{"from": "soft.outMaterial"}], "subtissues": [{"from": "muscle.outBody"}]}},
            "solver": {"type": "zSolver", "inputs": {"gravity": [0, 0, 0], "framesPerSecond": 0.1,
                "solverToleranceFactor": 0.001, "maxNewtonIterations": 50,
                "bodies": [{"from": "bar.outBody"}]}})");
        const solver::Points now = *s.get<nodes::MeshList>("solver", "outMeshes", 4).meshes[0].points;
        INFO(exponent);
        CHECK((now.front() - now.back()).norm() == Approx(std::pow(0.8, exponent) * std::sqrt(17.0)).epsilon(1e-7));
        CHECK(s.get<nodes::SolveReport>("solver", "outReport", 4).record.energy < 1e-12);
        CHECK(warnings(s.counter).empty());
    }
}

TEST_CASE("what a part's values change meshes nothing anew", "[nodes]") {
    Session s(
        R"("own": {"type": "zFiber", "inputs": {"direction": [1, 0, 0], "excitation": {"keys": [[1, 0], [4, 1]]}}},)" +
        bar("linear", false, moved, R"(, "fibers": [{"from": "own.outFiber"}])", both_held));
    s.get<nodes::MeshList>("solver", "outMeshes", 4);
    CHECK(s.counter.computes["fit"] == 1);
    CHECK(s.counter.steps["solver"] == 4); // the start frame and three more
    const auto rest_of = [&](double frame) { return s.get<nodes::Body>("bar", "outBody", frame).rest.get(); };
    CHECK(rest_of(1) == rest_of(4));
    const auto before = s.get<nodes::Body>("bar", "outBody", 1), after = s.get<nodes::Body>("bar", "outBody", 4);
    CHECK(nodes::id_of(before).rest == nodes::id_of(after).rest);
    CHECK(nodes::id_of(before).value != nodes::id_of(after).value);
}

TEST_CASE("an extra mesh rides on a part as on its tissue", "[nodes]") {
    Session s(R"("skinShape": {"type": "polyCube", "inputs": {"width": 0.2, "height": 0.2, "depth": 0.2}},
        "skin": {"type": "transform", "inputs": {"mesh": {"from": "skinShape.outMesh"}, "translate": [1, 0, 0]}},
        "onPart": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "muscle.outBody"}, "meshes": [{"from": "skin.outMesh"}]}},
        "onWhole": {"type": "zEmbedder", "inputs": {"solved": {"from": "solver.outSolved"}, "body": {"from": "bar.outBody"}, "meshes": [{"from": "skin.outMesh"}]}},)" +
              bar("quadratic", false, moved, "", both_held));
    const auto part = s.get<nodes::MeshList>("onPart", "outMeshes", 2),
               whole = s.get<nodes::MeshList>("onWhole", "outMeshes", 2);
    CHECK(largest_difference(*part.meshes[0].points, *whole.meshes[0].points) == 0);
    CHECK(least_x(part.meshes[0]) > 0.9 + 0.5);
}

TEST_CASE("parts that cannot be are refused, and doubtful ones named", "[nodes]") {
    const std::string right = bar("linear", false, moved, "", both_held);
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string out = right;
        REQUIRE(out.find(from) != std::string::npos);
        out.replace(out.find(from), from.size(), to);
        return out;
    };
    std::string text;
    CHECK(codes(with(R"("subtissues": [{"from": "muscle.outBody"}])", R"("subtissues": [{"from": "bar2.outBody"}])") +
                    R"(, "bar2": {"type": "zTissue", "inputs": {"mesh": {"from": "muscleMesh.outMesh"},
                    "materials": [{"from": "soft.outMaterial"}]}})",
                "solver", "outMeshes", &text) == Codes{"FE228"});
    CHECK_THAT(text, Catch::Contains("bar2 has tets of its own"));
    CHECK(codes(with(R"("bodies": [{"from": "bar.outBody"}, )", R"("bodies": [)"), "solver", "outMeshes", &text) ==
          Codes{"FE228"});
    CHECK_THAT(text, Catch::Contains("muscle is a part of none of this solver's bodies"));
    CHECK(codes(with(R"("zHold", "inputs": {"tissue": {"from": "bar.outBody"}, "weights": {"from": "left)",
                     R"("zHold", "inputs": {"tissue": {"from": "muscle.outBody"}, "weights": {"from": "left)"),
                "still", "outForce", &text) == Codes{"FE228"});
    CHECK(codes(with(R"("subtissues": [{"from": "muscle.outBody"}])",
                     R"("subtissues": [{"from": "muscle.outBody"}, {"from": "muscle.outBody"}])"),
                "bar", "outBody") == Codes{"FE213"});
    CHECK(codes(box("far", 12, 14, 1) + with(R"("mesh": {"from": "muscleMesh.outMesh"},
            "materials")",
                                             R"("mesh": {"from": "farMesh.outMesh"},
            "materials")"),
                "bar", "outBody", &text) == Codes{"FE229"});
    CHECK_THAT(text, Catch::Contains("nothing of muscle lies inside"));

    std::string twice = with(R"("bodies": [{"from": "bar.outBody"}, )",
                             R"("bodies": [{"from": "bar.outBody"}, {"from": "other.outBody"}, )");
    twice += R"(, "other": {"type": "zTissue", "inputs": {"mesh": {"from": "barMesh.outMesh"},
        "materials": [{"from": "firm.outMaterial"}], "subtissues": [{"from": "muscle.outBody"}]}})";
    CHECK(codes(twice, "solver", "outMeshes", &text) == Codes{"FE228"});
    CHECK_THAT(text, Catch::Contains("muscle is a part of both bar and other"));

    // In a part, and beside it in what that is a part of: said once, before the overlap that follows from it.
    const std::string within = with(R"("materials": [{"from": "firm.outMaterial"}]}})",
                                    R"("materials": [{"from": "firm.outMaterial"}],
                                    "subtissues": [{"from": "tendon.outBody"}]}})");
    std::string beside = within;
    const std::string only = R"("subtissues": [{"from": "muscle.outBody"}])";
    beside.replace(beside.find(only), only.size(),
                   R"("subtissues": [{"from": "muscle.outBody"}, {"from": "tendon.outBody"}])");
    Session listed(beside);
    CHECK(codes([&] { listed.pull("solver", "outMeshes", 1); }, &text) == Codes{"FE228"});
    CHECK(listed.counter.warnings.empty());
    CHECK_THAT(text, Catch::Contains("bar.subtissues: tendon is connected here, but is a part of muscle already"));
    CHECK_THAT(text, Catch::Contains("Remove it here: what is a part of muscle is within this one, too."));

    // In two parts beside each other, or another one just like it.
    const auto in_other = [&](const std::string& part) {
        std::string out = within;
        out.replace(out.find(only), only.size(),
                    R"("subtissues": [{"from": "muscle.outBody"}, {"from": "belly.outBody"}])");
        return box("belly", 0.6, 1.9, 1) + R"("belly": {"type": "zSubtissue", "inputs": {
            "mesh": {"from": "bellyMesh.outMesh"}, "materials": [{"from": "firm.outMaterial"}],
            "subtissues": [{"from": ")" +
               part + R"(.outBody"}]}}, "twin": {"type": "zSubtissue", "inputs": {
            "mesh": {"from": "tendonMesh.outMesh"}, "materials": [{"from": "hard.outMaterial"}]}},)" +
               out;
    };
    CHECK(codes(in_other("tendon"), "bar", "outBody", &text) == Codes{"FE228"});
    CHECK_THAT(text, Catch::Contains("tendon is a part of both muscle and belly"));
    CHECK(codes(in_other("twin"), "bar", "outBody", &text) == Codes{"FE213"});
    CHECK_THAT(text, Catch::Contains("tendon and twin, a part of belly, are alike in mesh and paint"));

    // What lies outside within a part is called by its name.
    Session out_within(box("far", 1.3, 2.8, 1) + [&] {
        std::string nodes = within;
        const std::string own = R"("tendonMesh.outMesh")";
        return nodes.replace(nodes.find(own), own.size(), R"("farMesh.outMesh")");
    }());
    out_within.get<nodes::Body>("bar", "outBody");
    REQUIRE_FALSE(out_within.counter.warnings.empty());
    CHECK_THAT(out_within.counter.warnings[0].message, Catch::Contains("% of tendon lie outside"));

    // Half of it sticks out.
    Session out(box("far", 1, 3, 1) + with(R"("mesh": {"from": "muscleMesh.outMesh"},
            "materials")",
                                           R"("mesh": {"from": "farMesh.outMesh"},
            "materials")"));
    out.get<nodes::Body>("bar", "outBody");
    REQUIRE(warnings(out.counter) == std::vector<std::string>{"FE229 bar"});
    CHECK_THAT(out.counter.warnings[0].message, Catch::Contains("50 % of muscle lie outside"));

    // Two parts beside each other that share .7 of 1.45 and of .7 cm: each loses half of that.
    Session overlap(with(R"("subtissues": [{"from": "muscle.outBody"}])",
                         R"("subtissues": [{"from": "muscle.outBody"}, {"from": "tendon.outBody"}])"));
    overlap.get<nodes::Body>("bar", "outBody");
    REQUIRE(warnings(overlap.counter) == std::vector<std::string>{"FE249 bar", "FE249 bar"});
    CHECK_THAT(overlap.counter.warnings[0].message, Catch::Contains("24 % of muscle"));
    CHECK_THAT(overlap.counter.warnings[1].message, Catch::Contains("50 % of tendon"));
}
