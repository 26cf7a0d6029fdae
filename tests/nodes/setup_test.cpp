// What zSolver hands to the solver: lengths in metres, contacts, holds, times. Looked at by a node that has zSolver's
// inputs and reads them as it does.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"

#include "engine/registry.h"
#include "nodes/solver_setup.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/contact_rest.h"
#include "solver/terms/hold/hold.h"

using namespace bench;

namespace {

using Look = std::function<void(const engine::Reads&, const nodes::Setup&)>;
const engine::Output<double> done{.name = "out", .doc = "Test: 1."};

/// Reads the node "solver" of a graph as zSolver does and looks at what comes of it.
void look_at(const std::string& nodes, const Look& look) {
    auto registry = std::make_shared<engine::Registry>();
    nodes::register_all(*registry);
    engine::NodeType type;
    type.name = "look";
    type.doc = "Test: reads as zSolver does.";
    type.inputs = registry->find("zSolver")->inputs;
    type.outputs = {engine::describe(done)};
    type.compute = [&look](const engine::Reads& in, engine::Writes& out) {
        look(in, nodes::read_setup(in, nullptr, nodes::contact_of(in)));
        out.set(done, 1.0);
    };
    registry->add(std::move(type));
    const std::string text =
        R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 20}, "nodes": {)" + nodes + "}}";
    engine::Evaluator evaluator({}, 1);
    CHECK(evaluator.pull({engine::read_graph(registry, text, "test.json").graph, {"solver", "out"}, 1}).as<double>() ==
          1);
}

/// A ball of 2 units in a shell, a bone, an attachment of 5 units and a hold; `solver` beside the connections.
std::string scene(const std::string& solver, const std::string& body = "", const std::string& hold = "") {
    return R"("ball": {"type": "polySphere", "inputs": {"radius": 2}}, "flesh": {"type": "zMaterial"},
        "shell": {"type": "polySphere", "inputs": {"radius": 2.1, "subdivisionsAxis": 9}},
        "box": {"type": "polyCube"}, "place": {"type": "transform", "inputs": {"mesh": {"from": "box.outMesh"}, "translate": [9, 0, 0]}},
        "bone": {"type": "zBone", "inputs": {"mesh": {"from": "place.outMesh"}}},
        "body": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}])" +
           body + R"(}},
        "tie": {"type": "zAttachment", "inputs": {"source": {"from": "body.outBody"}, "target": {"from": "bone.outBody"}, "maxDistance": 5}},
        "hold": {"type": "zHold", "inputs": {"tissue": {"from": "body.outBody"}, "weights": [1], "momentPoint": [1, 2, 3])" +
           hold + R"(}},
        "solver": {"type": "look", "inputs": {"bodies": [{"from": "body.outBody"}, {"from": "bone.outBody"}],
            "attachments": [{"from": "tie.outAttachment"}], "forces": [{"from": "hold.outForce"}])" +
           solver + "}}";
}

/// Of the first body.
struct Contact {
    solver::ContactRest rest;
    solver::ContactValues values;
};
Contact contact(const std::string& solver, const std::string& body = "") {
    Contact out;
    look_at(scene(R"(, "collisionDetection": true)" + solver, body),
            [&](const engine::Reads& in, const nodes::Setup& setup) {
                const solver::SceneDescription d = describe_scene(setup);
                const solver::StepInputs values = step_inputs(in, setup, 1);
                for (std::size_t k = 0; k < d.parts.size(); ++k)
                    if (d.parts[k].type == &solver::contact_type && d.parts[k].bodies.front() == 0) {
                        out.rest = static_cast<const solver::ContactRest&>(*d.parts[k].rest);
                        out.values = solver::get_fields<solver::ContactValues>(values.parts[k]);
                    }
            });
    return out;
}

nodes::Body pulled_body(const std::string& nodes, const std::string& node) {
    return Session(nodes).get<nodes::Body>(node, "outBody");
}

bool bounds_a_solid(const nodes::Body& b) {
    return static_cast<const solver::ContactRest&>(*b.contact->rest).is_volume;
}

} // namespace

TEST_CASE("lengths in scene units become metres", "[nodes]") {
    for (const double scale : {1.0, 100.0}) {
        INFO(scale);
        look_at(scene(R"(, "scale": )" + std::to_string(scale)),
                [&](const engine::Reads& in, const nodes::Setup& setup) {
                    const solver::SceneDescription d = describe_scene(setup);
                    REQUIRE(d.attachments.size() == 1);
                    CHECK(d.attachments[0].max_distance == Approx(5 / scale));
                    CHECK(solver::bounding_box(std::get<0>(d.bodies[0])->surface).max.y() == Approx(2 / scale));
                    CHECK(solver::bounding_box(std::get<1>(d.bodies[1])->surface).max.x() == Approx(9.5 / scale));
                    const auto values = solver::get_fields<solver::HoldValues>(step_inputs(in, setup, 1).parts[0]);
                    CHECK(values.about_x == Approx(1 / scale));
                    CHECK(values.about_y == Approx(2 / scale));
                    CHECK(values.about_z == Approx(3 / scale));
                });
    }
}

TEST_CASE("a sub-step takes its share of a frame", "[nodes]") {
    look_at(scene(R"(, "framesPerSecond": 25, "gravity": [1, 2, 3], "massDamping": 0.5, "stiffnessDamping": 0.25,
        "solverToleranceFactor": 7, "maxNewtonIterations": 9, "stepHalvings": 4)"),
            [](const engine::Reads& in, const nodes::Setup& setup) {
                const solver::StepInputs s = step_inputs(in, setup, 5);
                CHECK(s.step_size == Approx(1.0 / 125).epsilon(1e-15));
                CHECK(s.gravity == solver::Vec3(1, 2, 3));
                CHECK((s.mass_damping == 0.5 && s.stiffness_damping == 0.25 && s.tolerance_factor == 7));
                CHECK((s.max_newton_iterations == 9 && s.max_halvings == 4));
            });
}

TEST_CASE("what bodies and solver say of contact arrives, its lengths in metres", "[nodes][contact]") {
    const std::string body = R"(, "contactStiffness": 2e5, "contactFriction": 0.25, "contactSliding": false,
        "selfCollisions": true, "collisionSets": "3 -1", "collisionShape": {"from": "shell.outMesh"})";
    for (const double scale : {1.0, 100.0}) {
        INFO(scale);
        const Contact c =
            contact(R"(, "maxContactLength": 0.02, "contactDamping": 30, "scale": )" + std::to_string(scale), body);
        CHECK(c.values.longest == Approx(0.02));
        CHECK((c.values.damping == 30 && c.values.stiffness == 2e5 && c.values.friction == 0.25));
        CHECK((c.values.slides == 0 && c.values.collides == 1 && c.values.collides_with_itself == 1));
        CHECK(c.rest.sets == std::vector{3, -1});
        CHECK(c.rest.is_volume);
        CHECK(c.rest.spacing == 0);
        REQUIRE(c.rest.shape);
        CHECK(solver::bounding_box(c.rest.shape->surface).max.y() == Approx(2.1 / scale));
    }
    CHECK(contact(R"(, "collisionPointSpacing": 0.5)").rest.spacing == 0);
    CHECK(contact(R"(, "collisionPointSpacing": 0.5, "collisionSubdivision": true)").rest.spacing == 0.5);
    CHECK_FALSE(contact("").rest.shape);
}

TEST_CASE("surfaces bound a solid where they are closed and not inside out, unless they shall not",
          "[nodes][contact]") {
    const auto bone = [](const std::string& transform, const std::string& more = "") {
        return R"("box": {"type": "polyCube"}, "place": {"type": "transform", "inputs": {"mesh": {"from": "box.outMesh"}, )" +
               transform + R"(}}, "bone": {"type": "zBone", "inputs": {"mesh": {"from": "place.outMesh"})" + more +
               "}}";
    };
    CHECK(bounds_a_solid(pulled_body(bone(R"("scale": [1, 2, 3])"), "bone")));
    CHECK_FALSE(bounds_a_solid(pulled_body(bone(R"("scale": [-1, 2, 3])"), "bone"))); // mirrored, so inside out
    CHECK_FALSE(bounds_a_solid(pulled_body(bone(R"("scale": [1, 2, 3])", R"(, "collisionVolume": "off")"), "bone")));
    std::string text;
    CHECK(codes(bone(R"("scale": [-1, 2, 3])", R"(, "collisionVolume": "on")"), "bone", "outBody", &text) ==
          Codes{"FE254"});
    CHECK(text.find("inside out") != std::string::npos);
}

TEST_CASE("a collision surface of other points is another contact", "[nodes][contact]") {
    const auto with = [](const std::string& radius) {
        return R"("ball": {"type": "polySphere", "inputs": {"radius": 2}}, "flesh": {"type": "zMaterial"},
            "shell": {"type": "polySphere", "inputs": {"radius": )" +
               radius + R"(}},
            "body": {"type": "zTissue", "inputs": {"mesh": {"from": "ball.outMesh"}, "materials": [{"from": "flesh.outMaterial"}], "collisionShape": {"from": "shell.outMesh"}}})";
    };
    const nodes::Body one = pulled_body(with("2.1"), "body"), same = pulled_body(with("2.1"), "body"),
                      other = pulled_body(with("2.05"), "body");
    CHECK(one.contact->digest == same.contact->digest);
    CHECK(one.contact->digest != other.contact->digest);
    CHECK(engine::Value::of(one).aside_digest() != engine::Value::of(other).aside_digest());
}

TEST_CASE("holds of faces and of vertices are not the same, whatever is painted", "[nodes]") {
    const auto hold = [](const std::string& on) {
        return Session(scene("", "", R"(, "weightsOn": ")" + on + "\"")).get<nodes::Force>("hold", "outForce");
    };
    CHECK(hold("vertices").digest == hold("vertices").digest);
    CHECK(hold("vertices").digest != hold("faces").digest);
}

TEST_CASE("a hold's matrix may stretch by rounding and no more", "[nodes]") {
    const auto codes_of = [](const std::string& stretch) {
        return codes(scene("", "", R"(, "matrix": [)" + stretch + ",0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]"), "hold",
                     "outForce");
    };
    CHECK(codes_of("1.000004").empty());
    CHECK(codes_of("1.00001") == Codes{"FE250"});
    CHECK(codes_of("1.01") == Codes{"FE250"});
}
