// What terms show in pictures: over all terms, and where a scene has none.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/marks_of.h"
#include "tests/support/term_checks.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

struct Run {
    ExampleScene made;
    Workspace workspace;
    State state;
    explicit Run(const TermExample& example)
        : made(example.make(1))
        , workspace(made.scene)
        , state(initial_state(*made.scene, made.inputs(0))) {}
    void step(int k) {
        const std::vector<StepInputs> inputs{made.inputs(k)};
        state = advance(workspace, state, inputs);
    }
    Marks marks(int k) { return marks_of(workspace, state, made.inputs(k)); }
};

bool same(const Marks& a, const Marks& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const MarkGroup& g, const MarkGroup& h) {
        return g.term == h.term && g.what == h.what && g.unit == h.unit &&
               std::equal(g.marks.begin(), g.marks.end(), h.marks.begin(), h.marks.end(),
                          [](const Mark& m, const Mark& n) {
                              return m.part == n.part && m.from == n.from && m.to == n.to && m.value == n.value;
                          });
    });
}

} // namespace

TEST_CASE("terms: marks are finite, a few hundred a part, and there for parts alone") {
    for (const TermExample& example : term_examples()) {
        INFO(example.name);
        Run run(example);
        run.step(1);
        const Marks all = run.marks(1);
        const auto inputs = run.made.inputs(1);
        const bool slides = std::any_of(inputs.attachments.begin(), inputs.attachments.end(),
                                        [](const AttachmentInputs& a) { return a.slides > 0; });
        if (run.made.scene->description().parts.empty() && !slides) {
            // Asked by itself: a term without parts that has some would not be heard.
            TermProbe probe(example);
            Marks own;
            probe.term().marks(probe.before().x, own);
            CHECK(own.empty());
            CHECK(all.empty());
        }
        for (const MarkGroup& group : all) {
            CHECK_FALSE(group.what.empty());
            std::map<int, std::size_t> counts;
            for (const Mark& m : group.marks) {
                ++counts[m.part];
                CHECK((m.from.allFinite() && m.to.allFinite() && std::isfinite(m.value)));
            }
            for (const auto& [part, count] : counts) CHECK(count <= 400);
        }
    }
}

TEST_CASE("terms: asking for marks changes no bit of what follows, and needs no step before") {
    for (const TermExample& example : term_examples()) {
        INFO(example.name);
        Run plain(example), asked(example);
        (void)asked.marks(0);
        for (int k = 1; k <= 3; ++k) {
            plain.step(k);
            asked.step(k);
            (void)asked.marks(k);
            CHECK(asked.state.x == plain.state.x);
            CHECK(asked.state.v == plain.state.v);
            CHECK(asked.state.memories == plain.state.memories);
        }
        // A workspace that has never made a step gives the same marks.
        Workspace fresh(asked.made.scene);
        CHECK(same(marks_of(fresh, asked.state, asked.made.inputs(3)), asked.marks(3)));
        CHECK(fresh.symbolic_analyses() == 0);
    }
}
