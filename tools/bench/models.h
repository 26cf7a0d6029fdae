// What the benchmarks sweep over, each list in one place: laws, elements, integrators, linear solvers. A new one is one
// line.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/options.h"
#include "solver/scene.h"
#include "solver/step_inputs.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace sinew::bench {

struct LawName {
    std::string_view word;      ///< of zTissue.material
    std::string_view catalogue; ///< name of the energy in the reference values
    solver::ElasticLaw law;
};
constexpr LawName name_of(const solver::LawFacts& facts) { return {facts.name, facts.reference, facts.law}; }

/// All laws, in the order of the solver's table.
inline constexpr auto all_laws = [] {
    std::array<LawName, std::size(solver::elastic_laws)> out{};
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = name_of(solver::elastic_laws[i]);
    return out;
}();

/// Those that need no directions and have reference values.
constexpr bool is_catalogued(const solver::LawFacts& facts) {
    return facts.form != solver::LawForm::directional && !facts.reference.empty();
}
inline constexpr auto laws = [] {
    std::array<LawName, std::ranges::count_if(solver::elastic_laws, is_catalogued)> out{};
    std::size_t n = 0;
    for (const solver::LawFacts& facts : solver::elastic_laws)
        if (is_catalogued(facts)) out[n++] = name_of(facts);
    return out;
}();

/// The entry whose energy the reference values call `catalogue`; nullptr if the engine has no such law.
constexpr const LawName* find_law(std::string_view catalogue) {
    for (const LawName& l : laws)
        if (l.catalogue == catalogue) return &l;
    return nullptr;
}

struct ElementName {
    std::string_view word;
    solver::ElementKind kind;
};
inline constexpr std::array elements{
    ElementName{nodes::word_of(solver::ElementKind::linear), solver::ElementKind::linear},
    ElementName{nodes::word_of(solver::ElementKind::quadratic), solver::ElementKind::quadratic}};

struct IntegratorName {
    std::string_view word;        ///< of zSolver.integrator
    std::string_view catalogue;   ///< in the tables of one degree of freedom
    std::string_view bar_release; ///< in the runs of the released bar
    solver::Integrator integrator;
    double order; ///< of its global error in the step size
};
inline constexpr std::array integrators{
    IntegratorName{nodes::word_of(solver::Integrator::backward_euler), "BE", "BE", solver::Integrator::backward_euler,
                   1},
    IntegratorName{nodes::word_of(solver::Integrator::bdf2), "BDF2", "BDF2", solver::Integrator::bdf2, 2},
    IntegratorName{nodes::word_of(solver::Integrator::tr_bdf2), "TRBDF2_gamma_2_minus_sqrt2", "TRBDF2_2-sqrt2",
                   solver::Integrator::tr_bdf2, 2}};

/// With the one that has no time.
inline constexpr std::array all_integrators{
    integrators[0], integrators[1], integrators[2],
    IntegratorName{nodes::word_of(solver::Integrator::quasi_static), "", "", solver::Integrator::quasi_static, 0}};
static_assert(all_integrators.size() == integrators.size() + 1);

struct LinearMethodName {
    std::string_view word; ///< of zSolver.solver
    solver::LinearMethod method;
};
inline constexpr std::array linear_methods{
    LinearMethodName{nodes::word_of(solver::LinearMethod::automatic), solver::LinearMethod::automatic},
    LinearMethodName{nodes::word_of(solver::LinearMethod::direct), solver::LinearMethod::direct},
    LinearMethodName{nodes::word_of(solver::LinearMethod::iterative), solver::LinearMethod::iterative}};

} // namespace sinew::bench
