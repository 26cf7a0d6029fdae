// The promise "never simulate a frame twice": how many steps each action costs, and that the bits do not
// change.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>

using namespace toys;

namespace {

constexpr const char* scene =
    R"("stiff": {"type": "number", "inputs": {"value": {"keys": [[1, 1], [79, 3], [100, 5]], "interp": "linear"}}},
    "sim": {"type": "sim", "inputs": {"target": {"from": "stiff.out"},
                                      "stiffness": {"keys": [[1, 1], [60, 4], [79, 4], [100, 4]], "interp": "linear"}}})";
const Plug plug{"sim", "out"};

struct Scene {
    std::shared_ptr<Counts> counts = std::make_shared<Counts>();
    std::shared_ptr<const Registry> types = registry(counts);
    std::shared_ptr<const Graph> graph;
    Evaluator evaluator;
    explicit Scene(const std::string& nodes = scene, StorePolicy policy = {})
        : graph(toys::graph(types, nodes))
        , evaluator(policy, 2) {}

    /// Steps that a pull takes.
    int steps(const std::shared_ptr<const Graph>& g, double frame) {
        const int before = counts->advances;
        last = number(evaluator, g, plug, frame);
        return counts->advances - before;
    }
    int steps(double frame) { return steps(graph, frame); }
    double last = 0;
};

double from_nothing(const std::shared_ptr<const Graph>& g, double frame) {
    Evaluator fresh;
    return number(fresh, g, plug, frame);
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

} // namespace

TEST_CASE("a cold pull of frame 100 takes 99 steps, then every frame is a look-up") {
    Scene s;
    CHECK(s.steps(100) == 99);
    CHECK(s.counts->initials == 1);
    CHECK(s.steps(100) == 0);
    CHECK(s.steps(40) == 0);
    CHECK(s.steps(99) == 0);
    CHECK(s.steps(1) == 0);
    CHECK(s.counts->publishes == 100);
}

TEST_CASE("pulling frames in order takes one step each") {
    Scene s;
    CHECK(s.steps(1) == 0);
    for (int f = 2; f <= 50; ++f) CHECK(s.steps(f) == 1);
    CHECK(same_bits(s.last, from_nothing(s.graph, 50)));
}

TEST_CASE("a display-only edit and a rename take no step") {
    Scene s;
    s.steps(100);
    const int computes = s.counts->computes;
    const auto painted =
        Edit(s.graph).set_json({"sim", "color"}, "\"blue\"").set_json({"stiff", "show"}, "false").commit().graph;
    CHECK(s.steps(painted, 100) == 0);
    const auto renamed = Edit(s.graph).rename_node("stiff", "pullTo").commit().graph;
    CHECK(s.steps(renamed, 100) == 0);
    const auto laid_out = Edit(s.graph).set_editor_json(R"({"positions": {"sim": [1, 2]}})").commit().graph;
    CHECK(s.steps(laid_out, 100) == 0);
    CHECK(s.counts->computes == computes);
}

TEST_CASE("an edit at frame 80 re-simulates 80 to 100 only, bit-equal to a run from nothing") {
    Scene s;
    s.steps(100);
    const auto edited = Edit(s.graph).set_key({"sim", "stiffness"}, 80, 7).commit().graph;
    CHECK(s.steps(edited, 79) == 0);
    CHECK(same_bits(s.last, from_nothing(s.graph, 79)));
    CHECK(s.steps(edited, 100) == 21);
    CHECK(same_bits(s.last, from_nothing(edited, 100)));
    CHECK_FALSE(same_bits(s.last, from_nothing(s.graph, 100)));
}

TEST_CASE("with every tenth state kept the same edit takes 29 steps") {
    Scene s(scene, {.state_every = 10});
    s.steps(100);
    const auto edited = Edit(s.graph).set_key({"sim", "stiffness"}, 80, 7).commit().graph;
    CHECK(s.steps(edited, 100) == 29);
    CHECK(same_bits(s.last, from_nothing(edited, 100)));
}

TEST_CASE("a key that changes no sampled value takes no step") {
    Scene s;
    s.steps(100);
    const auto flat = Edit(s.graph).set_key({"sim", "stiffness"}, 70, 4).commit().graph;
    CHECK(s.steps(flat, 100) == 0);
}

TEST_CASE("a literal in place of a flat curve takes no step") {
    Scene s(R"("sim": {"type": "sim", "inputs": {"stiffness": {"keys": [[1, 3], [50, 3]], "interp": "smooth"}}})");
    s.steps(100);
    CHECK(s.steps(Edit(s.graph).set_json({"sim", "stiffness"}, "3").commit().graph, 100) == 0);
}

TEST_CASE("undo and redo take no step") {
    Scene s;
    s.steps(100);
    const double before = s.last;
    const Edit::Done done = Edit(s.graph).set_key({"sim", "stiffness"}, 80, 7).commit();
    s.steps(done.graph, 100);
    const double after = s.last;
    const Edit::Done undone = done.inverse->commit();
    CHECK(s.steps(undone.graph, 100) == 0);
    CHECK(same_bits(s.last, before));
    CHECK(s.steps(undone.inverse->commit().graph, 100) == 0);
    CHECK(same_bits(s.last, after));
}

TEST_CASE("an edit of the initial state re-simulates everything") {
    Scene s;
    s.steps(100);
    const auto edited = Edit(s.graph).set_json({"sim", "height"}, "3").commit().graph;
    CHECK(s.steps(edited, 100) == 99);
    CHECK(same_bits(s.last, from_nothing(edited, 100)));
}

TEST_CASE("the initial state counts at the start frame only") {
    Scene s(
        R"("h": {"type": "number", "inputs": {"value": {"keys": [[1, 2], [50, 2], [60, 9]], "interp": "linear"}}},
               "sim": {"type": "sim", "inputs": {"height": {"from": "h.out"}}})");
    s.steps(100);
    const auto later = Edit(s.graph).set_key({"h", "value"}, 60, 5).commit().graph;
    CHECK(s.steps(later, 100) == 0);
}

TEST_CASE("after outputs are dropped, states each 7 frames, frame 90 takes 5 steps") {
    Scene s(scene, {.state_every = 7});
    s.steps(100);
    s.evaluator.drop_values();
    CHECK(s.steps(90) == 5);
    CHECK(same_bits(s.last, from_nothing(s.graph, 90)));
}

TEST_CASE("an upstream edit that gives the same content is cut off") {
    Scene s(R"("a": {"type": "number", "inputs": {"value": 6, "times": 1}},
               "sim": {"type": "sim", "inputs": {"target": {"from": "a.out"}}})");
    s.steps(100);
    const auto same = Edit(s.graph).set_json({"a", "value"}, "3").set_json({"a", "times"}, "2").commit().graph;
    CHECK(s.steps(same, 100) == 0);
    CHECK(s.counts->computes == 2);
}

TEST_CASE("sub-steps read their own times, and a change of their number moves the chain") {
    Scene s(
        R"("sim": {"type": "sim", "inputs": {"substeps": 4, "stiffness": {"keys": [[1, 1], [3, 1], [4, 9]], "interp": "linear"}}})");
    s.steps(10);
    // Between 3 and 4 only the sub-steps can tell these two apart: at whole frames the values are the same.
    const auto bent = Edit(s.graph).set_key({"sim", "stiffness"}, 3.75, 1).commit().graph;
    CHECK(s.steps(bent, 3) == 0);
    CHECK(s.steps(bent, 10) == 7);
    CHECK(s.steps(Edit(s.graph).set_json({"sim", "substeps"}, "2").commit().graph, 10) == 9);
}

TEST_CASE("sub-steps can be keyed and are read at the frame that is stepped to") {
    Scene s(R"("sim": {"type": "sim", "inputs": {"substeps": {"keys": [[1, 1], [5, 3]]}}})");
    const auto other = Edit(s.graph).set_key({"sim", "substeps"}, 5, 2).commit().graph;
    s.steps(8);
    CHECK(s.steps(other, 4) == 0);
    CHECK(s.steps(other, 8) == 4);
}

TEST_CASE("stages within sub-steps are read where the scheme has them, at their own times") {
    const auto stages = [](const std::string& inputs, double frame) {
        Scene s(R"("sim": {"type": "sim", "inputs": {)" + inputs + "}}");
        s.steps(frame);
        return s.counts->stages;
    };
    CHECK(stages("", 4).empty());
    CHECK(stages(R"("scheme": "staged")", 3) == std::vector{1.25, 1.5, 2.25, 2.5});
    CHECK(stages(R"("scheme": "staged", "substeps": 2)", 2) == std::vector{1.125, 1.25, 1.625, 1.75});
    // The scheme counts at the end of a sub-step, also where it comes and goes within a frame.
    CHECK(stages(R"("scheme": {"keys": [[1, "plain"], [3, "staged"], [4, "plain"]]})", 6) == std::vector{2.25, 2.5});
    CHECK(stages(R"("substeps": 2, "scheme": {"keys": [[1, "plain"], [2.5, "staged"], [3, "plain"]]})", 4) ==
          std::vector{2.125, 2.25});
}

TEST_CASE("a value that only stages see re-simulates the frames that have them, and no frame of another scheme") {
    const std::string curve = R"({"keys": [[1, 1], [19, 1], [20, 1], [100, 2]], "interp": "linear"})";
    const std::string nodes[] = {R"("sim": {"type": "sim", "inputs": {"scheme": "SCHEME", "stiffness": )" + curve +
                                     "}}",
                                 R"("stiff": {"type": "number", "inputs": {"value": )" + curve + R"(}},
           "sim": {"type": "sim", "inputs": {"scheme": "SCHEME", "target": {"from": "stiff.out"}}})"};
    for (const bool wired : {false, true})
        for (const bool staged : {false, true}) {
            std::string text = nodes[wired];
            text.replace(text.find("SCHEME"), 6, staged ? "staged" : "plain");
            Scene s(text);
            s.steps(30);
            const Plug keyed = wired ? Plug{"stiff", "value"} : Plug{"sim", "stiffness"};
            INFO("wired " << wired << ", staged " << staged);
            // At 19.25 and nowhere at the end of a sub-step.
            const auto seen =
                Edit(s.graph).set_key(keyed, 19.1, 1).set_key(keyed, 19.25, 3).set_key(keyed, 19.4, 1).commit().graph;
            CHECK(s.steps(seen, 19) == 0);
            CHECK(s.steps(seen, 30) == (staged ? 11 : 0));
            CHECK(same_bits(s.last, from_nothing(seen, 30)));
            CHECK(same_bits(s.last, from_nothing(s.graph, 30)) == !staged);
            // Between stages and ends nobody looks.
            const auto unseen =
                Edit(s.graph).set_key(keyed, 19.6, 1).set_key(keyed, 19.75, 3).set_key(keyed, 19.9, 1).commit().graph;
            CHECK(s.steps(unseen, 30) == 0);
        }
}

TEST_CASE("another scheme from a frame on leaves the frames before it alone") {
    Scene s(R"("sim": {"type": "sim", "inputs": {"scheme": {"keys": [[1, "plain"], [50, "staged"]]},
                        "stiffness": {"keys": [[1, 1], [100, 9]], "interp": "linear"}}})");
    s.steps(60);
    const auto later =
        Edit(s.graph).set_json({"sim", "scheme"}, R"({"keys": [[1, "plain"], [55, "staged"]]})").commit().graph;
    CHECK(s.steps(later, 49) == 0);
    CHECK(s.steps(later, 60) == 11); // from 50 on
    CHECK(same_bits(s.last, from_nothing(later, 60)));
    CHECK(s.steps(s.graph, 60) == 0);
}

TEST_CASE("behind another simulation, which has whole frames only, no stages are read") {
    Scene s(R"("first": {"type": "sim", "inputs": {"scheme": "staged"}},
               "double": {"type": "relay", "inputs": {"in": {"from": "first.out"}}},
               "sim": {"type": "sim", "inputs": {"scheme": "staged", "target": {"from": "double.out"}}})");
    CHECK(s.steps(4) == 6);
    CHECK(s.counts->stages == std::vector{1.25, 1.5, 2.25, 2.5, 3.25, 3.5}); // those of the first one
    CHECK(same_bits(s.last, from_nothing(s.graph, 4)));
}

TEST_CASE("what decides on stage times cannot be connected, and stage times that make no sense are a bug") {
    const auto types = registry();
    CHECK(codes_of([&] {
              toys::graph(types, R"("words": {"type": "sum", "inputs": {"terms": [{"from": "n.out"}]}},
                                    "n": {"type": "number"},
                                    "sim": {"type": "sim", "inputs": {"scheme": {"from": "words.text"}}})");
          }) == "DG029");
    const auto refused = [](const std::function<void(SimulationType<ToyState>&)>& change) {
        static const Input<std::string> scheme{.name = "scheme", .def = "a", .doc = "How."};
        static const Output<double> out{.name = "out", .doc = "The number."};
        SimulationType<ToyState> t;
        t.base = {.name = "odd", .doc = "Odd.", .inputs = {describe(scheme)}, .outputs = {describe(out)}};
        t.initial = [](const Reads&) { return ToyState(); };
        t.advance = [](const ToyState& s, std::span<const SubstepReads>) { return s; };
        t.publish = [](const ToyState& s, const Reads&, Writes& w) { w.set(out, s.x); };
        t.stages_input = scheme.name;
        t.stages = [](const Value&) { return std::vector<double>{0.5}; };
        change(t);
        auto r = std::make_shared<Registry>();
        r->add(t);
        const auto g = toys::graph(r, R"("odd": {"type": "odd"})");
        Evaluator e;
        number(e, g, {"odd", "out"}, 2);
    };
    CHECK_NOTHROW(refused([](auto&) {}));
    CHECK_THROWS_AS(refused([](auto& t) { t.stages = {}; }), std::logic_error);
    CHECK_THROWS_AS(refused([](auto& t) { t.stages_input = {}; }), std::logic_error);
    CHECK_THROWS_AS(refused([](auto& t) { t.stages_input = "nothing"; }), std::logic_error);
    for (const std::vector<double>& wrong : {std::vector{0.0}, {1.0}, {0.5, 0.5}, {0.7, 0.2}, {std::nan("")}})
        CHECK_THROWS_AS(refused([&](auto& t) { t.stages = [wrong](const Value&) { return wrong; }; }),
                        std::logic_error);
}

TEST_CASE("frames before the start give the start state") {
    Scene s(R"("sim": {"type": "sim", "inputs": {"startFrame": 10, "stiffness": 2}})");
    CHECK(s.steps(-5) == 0);
    CHECK(s.last == 2);
    CHECK(s.steps(10) == 0);
    CHECK(s.counts->publishes == 1);
    CHECK(s.steps(12) == 2);
}

TEST_CASE("a fraction of a frame on a simulation is refused with its name") {
    Scene s;
    CHECK(codes_of([&] { s.steps(3.5); }) == "DG103");
    CHECK(s.counts->advances == 0);
}

TEST_CASE("a simulation can feed another one") {
    Scene s(R"("first": {"type": "sim", "inputs": {"stiffness": {"keys": [[1, 1], [20, 1], [30, 5]]}}},
               "double": {"type": "sum", "inputs": {"terms": [{"from": "first.out"}, {"from": "first.out"}]}},
               "sim": {"type": "sim", "inputs": {"target": {"from": "double.out"}}})");
    CHECK(s.steps(30) == 58);
    CHECK(s.counts->computes == 30);
    CHECK(same_bits(s.last, from_nothing(s.graph, 30)));
    const auto edited = Edit(s.graph).set_key({"first", "stiffness"}, 25, 1).commit().graph;
    CHECK(s.steps(edited, 30) == 20); // both from frame 21 on
    CHECK(same_bits(s.last, from_nothing(edited, 30)));
}

TEST_CASE("two graphs that share a beginning share its frames") {
    Scene s;
    s.steps(50);
    const auto copy = read_graph(s.types, write_graph(*s.graph), "elsewhere.json").graph;
    CHECK(s.steps(copy, 60) == 10);
}

TEST_CASE("after the state budget is spent, old states are thinned, the newest stays and results do not change") {
    Scene s(scene, {.state_bytes = 2500});
    for (int f = 1; f <= 100; ++f) s.steps(f);
    CHECK(s.counts->advances == 99);
    s.evaluator.drop_values();
    CHECK(s.steps(100) == 0);
    s.evaluator.drop_values();
    const int back = s.steps(50);
    CHECK(back > 0);
    CHECK(back < 49);
    CHECK(same_bits(s.last, from_nothing(s.graph, 50)));
}

TEST_CASE("a node that reads the initial state while stepping is a bug, not a graph error") {
    Scene s(R"("sim": {"type": "sim", "inputs": {"nosy": true}})");
    CHECK_THROWS_AS(s.steps(2), std::logic_error);
}
