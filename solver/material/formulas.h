// From a law's name to its formulas: one case a law. What formulas are:
//   energy(s, mu, lambda, Principal&)          density and derivatives by the principal stretches
//   energy(strains, mu, lambda, TensorForm&)   the same by strains, for laws whose facts say so
//   measure(…)                                 the measure of volume whose mean a quadratic tet takes
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/material/compression_resistance.h"
#include "solver/material/corotational.h"
#include "solver/material/law.h"
#include "solver/material/log_neo_hookean.h"
#include "solver/material/measure_by_j.h"
#include "solver/material/neo_hookean.h"
#include "solver/material/stvk.h"

#include <utility>

namespace sinew::solver {

/// Of laws with directions: no part in principal stretches. Their energy is in anisotropic.h.
struct NoStretches : MeasureByJ {
    template <class At, class R, class Form>
    static void energy(const At&, R, R, Form& out) {
        clear(out);
    }
};

template <ElasticLaw law>
using Law = std::integral_constant<ElasticLaw, law>;

// A law that is missing here does not compile.
#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wswitch"
/// Calls visit(formulas, Law<law>).
template <class Visit>
inline void visit_law(LawInUse in_use, Visit&& visit) {
    switch (in_use.law) {
    case ElasticLaw::stvk:
        return visit(StVK{}, Law<ElasticLaw::stvk>{});
    case ElasticLaw::neo_hookean:
        return visit(StableNeoHookean{}, Law<ElasticLaw::neo_hookean>{});
    case ElasticLaw::log_neo_hookean:
        if (in_use.continued) return visit(ContinuedLogNeoHookean{}, Law<ElasticLaw::log_neo_hookean>{});
        return visit(LogNeoHookean{}, Law<ElasticLaw::log_neo_hookean>{});
    case ElasticLaw::corotational:
        return visit(Corotational{}, Law<ElasticLaw::corotational>{});
    case ElasticLaw::anisotropic:
        return visit(NoStretches{}, Law<ElasticLaw::anisotropic>{});
    }
}
#pragma GCC diagnostic pop

/// Energy density and derivatives, with compression resistance where the law takes it. `Form` is Principal with the
/// principal stretches, or TensorForm with the strains; the latter only where has_tensor_form(law).
template <class Form, class At, class R>
inline void evaluate_law(LawInUse law, const At& at, R mu, R lambda, R compression, Form& out) {
    visit_law(law, [&](auto formulas, auto id) {
        if constexpr (requires { formulas.energy(at, mu, lambda, out); }) {
            formulas.energy(at, mu, lambda, out);
            if constexpr (law_facts(id).resists_compression) add_compression_resistance(at, compression, out);
        } else
            static_assert(!has_tensor_form(id), "the table of laws says that this law is written in strains");
    });
}

/// The law's measure of volume.
template <class Form, class At>
inline void evaluate_measure(LawInUse law, const At& at, Form& out) {
    visit_law(law, [&](auto formulas, auto id) {
        if constexpr (requires { formulas.measure(at, out); })
            formulas.measure(at, out);
        else
            static_assert(!has_tensor_form(id), "a law that is written in strains has its measure in them too");
    });
}

} // namespace sinew::solver
