// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/layer_mix.h"

#include "solver/error.h"
#include "solver/terms/elastic/rest_change.h"

#include <algorithm>
#include <string>

namespace sinew::solver {

bool same_material(const TissueInputs& a, const TissueInputs& b) {
    return same_fields(a, b) &&
           std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(), same_fields<MaterialValues>);
}

MaterialValues mix_layers(const TissueRest& rest, const TissueInputs& in, std::size_t tet) {
    MaterialValues m = in.layers.front();
    for (std::size_t k = 1; k < in.layers.size(); ++k) {
        const double a = std::clamp(in.layers[k].envelope * rest.layer_weights[k][tet], 0.0, 1.0);
        for (const auto& f : MaterialValues::fields()) m.*f.at = a * in.layers[k].*f.at + (1 - a) * m.*f.at;
    }
    return m;
}

void check_values(const TissueInputs& in, int body) {
    const auto refuse = [&](const std::string& what) {
        Error e("FE304", what + " is not a finite number", "check the attribute and what it is connected to");
        e.body = body;
        throw e;
    };
    if (const auto* f = not_finite(in)) refuse(std::string("the ") + f->name + " of a tissue");
    for (const MaterialValues& m : in.layers)
        if (const auto* f = not_finite(m)) refuse(std::string("the ") + f->name + " of a tissue's material");
    for (const FiberValues& values : in.fibers)
        if (const auto* f = not_finite(values)) refuse(std::string("the ") + f->name + " of a tissue's fibre");
    try {
        check_rest_scale(in);
        check_growth(in);
    } catch (Error& e) {
        e.body = body;
        throw;
    }
    if (!std::all_of(in.forces.begin(), in.forces.end(), [](const Vec3& f) { return f.allFinite(); }))
        refuse("a load on a tissue");
}

} // namespace sinew::solver
