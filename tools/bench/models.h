// What the benchmarks sweep over, each list in one place: laws, elements, integrators, linear solvers. A new one is one
// line.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/scene.h"
#include "solver/step_inputs.h"

#include <array>
#include <string_view>

namespace sinew::bench {

struct LawName {
    std::string_view word;      ///< of zTissue.material
    std::string_view catalogue; ///< name of the energy in the reference values
    solver::ElasticLaw law;
};
/// The isotropic laws.
inline constexpr std::array laws{LawName{"StVK", "stvk", solver::ElasticLaw::stvk},
                                 LawName{"NeoHookean", "snh", solver::ElasticLaw::neo_hookean},
                                 LawName{"LogNeoHookean", "nh", solver::ElasticLaw::log_neo_hookean},
                                 LawName{"Corotational", "corot", solver::ElasticLaw::corotational}};

/// With the one that needs directions and a ratio too.
inline constexpr std::array all_laws{laws[0], laws[1], laws[2], laws[3],
                                     LawName{"Anisotropic", "tistvk", solver::ElasticLaw::anisotropic}};
static_assert(all_laws.size() == laws.size() + 1);

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
inline constexpr std::array elements{ElementName{"linear", solver::ElementKind::linear},
                                     ElementName{"quadratic", solver::ElementKind::quadratic}};

struct IntegratorName {
    std::string_view word;        ///< of zSolver.integrator
    std::string_view catalogue;   ///< in the tables of one degree of freedom
    std::string_view bar_release; ///< in the runs of the released bar
    solver::Integrator integrator;
    double order; ///< of its global error in the step size
};
inline constexpr std::array integrators{
    IntegratorName{"BackwardEuler", "BE", "BE", solver::Integrator::backward_euler, 1},
    IntegratorName{"BDF2", "BDF2", "BDF2", solver::Integrator::bdf2, 2},
    IntegratorName{"TR-BDF2", "TRBDF2_gamma_2_minus_sqrt2", "TRBDF2_2-sqrt2", solver::Integrator::tr_bdf2, 2}};

struct LinearMethodName {
    std::string_view word; ///< of zSolver.linearSolver
    solver::LinearMethod method;
};
inline constexpr std::array linear_methods{LinearMethodName{"Auto", solver::LinearMethod::automatic},
                                           LinearMethodName{"Direct", solver::LinearMethod::direct},
                                           LinearMethodName{"Iterative", solver::LinearMethod::iterative}};

} // namespace sinew::bench
