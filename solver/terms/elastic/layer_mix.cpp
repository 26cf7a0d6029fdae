// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/layer_mix.h"

#include "solver/error.h"
#include "solver/terms/elastic/rest_change.h"

#include <algorithm>
#include <string>

namespace sinew::solver {

bool same_material(const TissueInputs& a, const TissueInputs& b) {
    const auto same_layers = [](const std::vector<MaterialValues>& m, const std::vector<MaterialValues>& n) {
        return std::equal(m.begin(), m.end(), n.begin(), n.end(), same_fields<MaterialValues>);
    };
    const auto same_part = [&](const SubtissueInputs& p, const SubtissueInputs& q) {
        return same_layers(p.layers, q.layers);
    };
    return same_fields(a, b) && same_layers(a.layers, b.layers) &&
           std::equal(a.subtissues.begin(), a.subtissues.end(), b.subtissues.begin(), b.subtissues.end(), same_part);
}

MaterialValues mix_layers(const std::vector<MaterialValues>& layers, const std::vector<std::vector<double>>& weights,
                          std::size_t tet) {
    MaterialValues m = layers.front();
    for (std::size_t k = 1; k < layers.size(); ++k) {
        const double a = std::clamp(layers[k].envelope * weights[k][tet], 0.0, 1.0);
        for (const auto& f : MaterialValues::fields()) m.*f.at = a * layers[k].*f.at + (1 - a) * m.*f.at;
    }
    return m;
}

double own_share(const TissueRest& rest, std::size_t tet) {
    double share = 1;
    for (const SubtissueRest& part : rest.subtissues) share -= part.shares[tet];
    return std::max(0.0, share);
}

MaterialValues mix_layers(const TissueRest& rest, const TissueInputs& in, std::size_t tet) {
    MaterialValues m = mix_layers(in.layers, rest.layer_weights, tet);
    const double own = own_share(rest, tet);
    if (own == 1) return m;
    for (const auto& f : MaterialValues::fields()) m.*f.at *= own;
    for (std::size_t i = 0; i < rest.subtissues.size(); ++i) {
        const double share = rest.subtissues[i].shares[tet];
        if (share == 0) continue;
        const MaterialValues part = mix_layers(in.subtissues[i].layers, rest.subtissues[i].layer_weights, tet);
        for (const auto& f : MaterialValues::fields()) m.*f.at += share * part.*f.at;
    }
    return m;
}

void check_values(const TissueInputs& in, const RestShapes& shapes, int body) {
    const auto refuse = [&](const std::string& what) {
        Error e("FE304", what + " is not a finite number", "check the attribute and what it is connected to");
        e.body = body;
        throw e;
    };
    if (const auto* f = not_finite(in)) refuse(std::string("the ") + f->name + " of a tissue");
    for (const MaterialValues& m : in.layers)
        if (const auto* f = not_finite(m)) refuse(std::string("the ") + f->name + " of a tissue's material");
    for (const SubtissueInputs& part : in.subtissues) {
        if (const auto* f = not_finite(part)) refuse(std::string("the ") + f->name + " of a subtissue");
        for (const MaterialValues& m : part.layers)
            if (const auto* f = not_finite(m)) refuse(std::string("the ") + f->name + " of a subtissue's material");
    }
    for (const FiberValues& values : in.fibers)
        if (const auto* f = not_finite(values)) refuse(std::string("the ") + f->name + " of a tissue's fibre");
    try {
        check_rest_scale(in);
        check_growth(in);
        check_rest_shapes(shapes);
    } catch (Error& e) {
        e.body = body;
        throw;
    }
    if (!std::all_of(in.forces.begin(), in.forces.end(), [](const Vec3& f) { return f.allFinite(); }))
        refuse("a load on a tissue");
}

} // namespace sinew::solver
