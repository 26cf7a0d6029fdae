// The elastic laws: what each is called and what it needs, in one table. A new law is a line here, its formulas in a
// header of its own, and a case in formulas.h that names them.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string_view>

namespace sinew::solver {

enum class ElasticLaw { stvk, neo_hookean, log_neo_hookean, corotational, anisotropic };

/// What a law's energy is written in.
enum class LawForm {
    stretches,   ///< the principal stretches (principal.h)
    strains,     ///< these, and strains and det F (tensor_form.h), which needs no singular values
    directional, ///< F and a direction of each tet (anisotropic.h)
};

struct LawFacts {
    ElasticLaw law;
    std::string_view name; ///< in graphs, reports and tables
    LawForm form;
    bool resists_compression;   ///< takes TissueInputs::compression_resistance
    std::string_view reference; ///< its name in the tables of reference values
    std::string_view doc;       ///< a clause for users
};

/// In the order of the enum.
inline constexpr LawFacts elastic_laws[] = {
    {ElasticLaw::stvk, "StVK", LawForm::strains, true, "stvk", "stiff under large stretch"},
    {ElasticLaw::neo_hookean, "NeoHookean", LawForm::strains, true, "snh", "keeps its volume better"},
    {ElasticLaw::log_neo_hookean, "LogNeoHookean", LawForm::strains, false, "nh",
     "the form of engineering codes, to compare with; it cannot recover a tet that starts inverted"},
    {ElasticLaw::corotational, "Corotational", LawForm::stretches, false, "corot",
     "linear, stable under large rotation"},
    {ElasticLaw::anisotropic, "Anisotropic", LawForm::directional, false, "tistvk",
     "StVK that is softer or stiffer across the first fibre than along it"},
};
static_assert(
    [] {
        std::size_t i = 0;
        for (const LawFacts& facts : elastic_laws)
            if (facts.law != static_cast<ElasticLaw>(i++)) return false;
        return true;
    }(),
    "the lines of the table stand in the order of the enum");

constexpr const LawFacts& law_facts(ElasticLaw law) { return elastic_laws[static_cast<std::size_t>(law)]; }

/// A law as it is evaluated. `continued`: beyond where it is defined, for laws that know no tets inside out.
struct LawInUse {
    ElasticLaw law;
    bool continued = false;
    constexpr LawInUse(ElasticLaw l, bool beyond = false)
        : law(l)
        , continued(beyond) {}
    constexpr operator ElasticLaw() const { return law; }
};

/// Whether each tet needs a direction (TissueRest::stiff_directions).
constexpr bool needs_direction(ElasticLaw law) { return law_facts(law).form == LawForm::directional; }
/// Whether nothing but projection needs singular values.
constexpr bool has_tensor_form(ElasticLaw law) { return law_facts(law).form == LawForm::strains; }

} // namespace sinew::solver
