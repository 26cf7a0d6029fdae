// The checks of tests/support/term_checks.h over all terms.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/all_terms.h"
#include "tests/support/term_checks.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

namespace sinew::test {

std::vector<TermExample> term_examples() {
    std::vector<TermExample> out;
    using Examples = std::vector<TermExample> (*)();
    constexpr Examples of_terms[] = {
        elastic_examples,         attachment_examples, sliding_examples, field_examples, pressure_examples,
        surface_tension_examples, hold_examples,       contact_examples, cloth_examples,
    };
    for (const Examples make : of_terms) {
        const std::vector<TermExample> examples = make();
        out.insert(out.end(), examples.begin(), examples.end());
    }
    return out;
}

} // namespace sinew::test

namespace {

void for_each_example(const std::function<void(const TermExample&)>& check) {
    for (const TermExample& example : term_examples()) DYNAMIC_SECTION(example.name) {
            check(example);
        }
}

} // namespace

TEST_CASE("every term has an example") {
    const std::vector<TermExample> examples = term_examples();
    for (const TermType* type : all_terms()) {
        INFO(type->name);
        CHECK(std::any_of(examples.begin(), examples.end(), [&](const TermExample& e) { return e.type == type; }));
    }
}

/// Whether the term pulls on a held vertex: what it does to it is in the hold's reaction.
static bool pulls_on_what_is_held(const TermExample& example) {
    TermProbe probe(example);
    const Eigen::VectorXd gradient = probe.gradient(poses(probe).front().x);
    const std::vector<int>& unknown = probe.numbering().unknown;
    for (std::size_t v = 0; v < unknown.size(); ++v)
        if (unknown[v] < 0 && gradient.segment<3>(static_cast<Eigen::Index>(3 * v)).norm() > 0) return true;
    return false;
}

TEST_CASE("every term that has forces has an example in which it pulls on what is held") {
    const std::vector<TermExample> examples = term_examples();
    for (const TermType* type : all_terms()) {
        INFO(type->name);
        const auto is_of_it = [&](const TermExample& e) { return e.type == type; };
        if (std::none_of(examples.begin(), examples.end(), [&](const TermExample& e) { return is_of_it(e) && e.acts; }))
            continue;
        CHECK(std::any_of(examples.begin(), examples.end(),
                          [&](const TermExample& e) { return is_of_it(e) && pulls_on_what_is_held(e); }));
    }
}

TEST_CASE("terms: the gradient is that of the energy") { for_each_example(check_gradient); }
TEST_CASE("terms: the Hessian is the derivative of the gradient") { for_each_example(check_hessian); }
TEST_CASE("terms: a projected Hessian is positive semi-definite") { for_each_example(check_projection); }
TEST_CASE("terms: inner forces and their torques cancel") { for_each_example(check_sums); }
TEST_CASE("terms: forces turn and shift with the scene") { for_each_example(check_turns); }
TEST_CASE("terms: 1 and 2 threads give the same bits") { for_each_example(check_threads); }
TEST_CASE("terms: a saved and loaded state goes on with the same bits") { for_each_example(check_saving); }
TEST_CASE("terms: a steady step allocates nothing") { for_each_example(check_allocations); }
TEST_CASE("terms: a value that is not finite is named") { for_each_example(check_values); }

TEST_CASE("terms: one that the scene does not use is not there") {
    const Points corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const Scene of_bone({.bodies = {bone(corners, {{0, 1, 2}})}, .attachments = {}, .parts = {}});
    const Scene of_tissue(
        {.bodies = {tissue(box_mesh({1, 1, 1}, 1, 1, 1), ElasticLaw::stvk)}, .attachments = {}, .parts = {}});
    for (const TermType* type : all_terms()) {
        INFO(type->name);
        CHECK(type->make(of_bone) == nullptr);
        CHECK((type->make(of_tissue) != nullptr) == (type->name == "elastic"));
    }
}
