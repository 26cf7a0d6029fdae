// Inputs that count only while a switch is on (Input::when), and what values hold aside for it (WireList::aside_when):
// where it is off they enter no frame's key and cannot be read.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

using namespace toys;

namespace {

struct Tagged {
    double value = 0, tag = 0;
};

} // namespace

template <>
struct sinew::engine::ValueTraits<Tagged> {
    static constexpr std::string_view name = "tagged";
    static void hash(Hasher& h, const Tagged& t) { h.add(t.value); }
    static void hash_aside(Hasher& h, const Tagged& t) { h.add(t.tag); }
    static std::size_t bytes(const Tagged&) { return 0; }
};

namespace {

const Input<double> value{.name = "value", .def = 1, .doc = "What is read always."},
    tag{.name = "tag", .def = 1, .doc = "What is read where it is on."};
const Output<Tagged> out_tagged{.name = "out", .doc = "Both."};
const Input<bool> on{.name = "on", .def = false, .doc = "The switch."},
    nosy{.name = "nosy", .def = false, .doc = "Reads what is off."};
const Input<double> gain{.name = "gain", .def = 1, .doc = "Counts while it is on.", .when = "on"};
const WireList<Tagged> terms{.name = "terms", .doc = "What is added up.", .aside_when = "on"};
const Output<double> out_sum{.name = "out", .doc = "The sum."};

std::shared_ptr<Registry> types(std::shared_ptr<Counts> counts) {
    auto r = std::make_shared<Registry>();
    NodeType tagged;
    tagged.name = "tagged", tagged.doc = "Test.";
    tagged.inputs = {describe(value), describe(tag)}, tagged.outputs = {describe(out_tagged)};
    tagged.compute = [](const Reads& in, Writes& out) { out.set(out_tagged, Tagged{in[value], in[tag]}); };
    r->add(tagged);
    SimulationType<ToyState> t;
    t.base = {.name = "adder", .doc = "Test."};
    t.base.inputs = {describe(on), describe(nosy), describe(gain), describe(terms)};
    t.base.outputs = {describe(out_sum)};
    t.initial = [](const Reads&) { return ToyState(); };
    t.advance = [counts](const ToyState& before, std::span<const SubstepReads> times) {
        const Reads& in = times.back().end;
        ++counts->advances;
        ToyState s = before;
        for (const Tagged& t : in[terms]) s.x += t.value + (in[on] ? in[gain] * t.tag : 0);
        if (in[nosy]) s.x += in[gain];
        return s;
    };
    t.publish = [](const ToyState& s, const Reads&, Writes& w) { w.set(out_sum, s.x); };
    t.save = [](const ToyState&) { return std::vector<std::byte>(); };
    t.load = [](std::span<const std::byte>) { return ToyState(); };
    r->add(t);
    return r;
}

struct Scene {
    std::shared_ptr<Counts> counts = std::make_shared<Counts>();
    std::shared_ptr<const Graph> graph;
    Evaluator evaluator{{}, 1};
    explicit Scene(const std::string& adder)
        : graph(toys::graph(types(counts), R"("a": {"type": "tagged", "inputs": {"value": 2, "tag": 3}},
            "b": {"type": "tagged"}, "switch": {"type": "tagged"},
            "sim": {"type": "adder", "inputs": {"terms": [{"from": "a.out"}, {"from": "b.out"}])" +
                                               adder + "}}")) {}
    /// Steps that frame 10 takes with another value, and what it then is.
    std::pair<int, double> with(const std::string& node, const std::string& attribute, const std::string& json) {
        const int before = counts->advances;
        const double x =
            number(evaluator, Edit(graph).set_json({node, attribute}, json).commit().graph, {"sim", "out"}, 10);
        return {counts->advances - before, x};
    }
};

using Took = std::pair<int, double>;

} // namespace

TEST_CASE("what is switched off steps no frame again, what is on does, and keys do from where they switch") {
    Scene off("");
    CHECK(off.with("sim", "gain", "1") == Took{9, 27}); // nine steps of 2 + 1
    CHECK(off.with("sim", "gain", "5") == Took{0, 27});
    CHECK(off.with("a", "tag", "8") == Took{0, 27});
    CHECK(off.with("a", "value", "3") == Took{9, 36});
    CHECK(off.with("sim", "on", "true") == Took{9, 27 + 9 * 4});

    Scene always(R"(, "on": true)");
    CHECK(always.with("sim", "gain", "1") == Took{9, 27 + 9 * 4});
    CHECK(always.with("sim", "gain", "2") == Took{9, 27 + 9 * 8});
    CHECK(always.with("b", "tag", "2") == Took{9, 27 + 9 * 5});

    Scene keyed(R"(, "on": {"keys": [[1, false], [7, true], [9, false]]})"); // at frames 7 and 8
    CHECK(keyed.with("sim", "gain", "1") == Took{9, 27 + 2 * 4});
    CHECK(keyed.with("sim", "gain", "2") == Took{4, 27 + 2 * 8});
    CHECK(keyed.with("a", "tag", "4") == Took{4, 27 + 2 * 5});
    CHECK(keyed.with("sim", "gain", R"({"keys": [[1, 1], [9, 7]], "interp": "step"})") == Took{0, 27 + 2 * 4});
}

TEST_CASE("what is switched off cannot be read, and a switch must be one") {
    Scene s(R"(, "nosy": true)");
    CHECK_THROWS_AS(number(s.evaluator, s.graph, {"sim", "out"}, 2), std::logic_error);
    const auto refused = [](std::string_view name) {
        NodeType t;
        t.name = "odd", t.doc = "Test.";
        const Input<double> some{.name = "some", .def = 1, .doc = "Some.", .when = name};
        t.inputs = {describe(on), describe(value), describe(some)}, t.outputs = {describe(out_sum)};
        t.compute = [](const Reads&, Writes& w) { w.set(out_sum, 1.0); };
        Registry r;
        r.add(t);
    };
    CHECK_NOTHROW(refused("on"));
    CHECK_NOTHROW(refused(""));
    for (const char* name : {"value", "some", "nothing"}) CHECK_THROWS_AS(refused(name), std::logic_error);
    const WireList<double> plain{.name = "plain", .doc = "Numbers.", .aside_when = "on"};
    CHECK_THROWS_AS(describe(plain), std::logic_error);
}
