// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/cloth/cloth_mix.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {

void mix_layers(const ClothRest& rest, const ClothInputs& in, std::vector<ClothMaterial>& out) {
    out.assign(rest.surface.size(), in.layers.front());
    for (std::size_t k = 1; k < in.layers.size(); ++k)
        for (std::size_t v = 0; v < out.size(); ++v) {
            const double a = std::clamp(in.layers[k].envelope * rest.layer_weights[k][v], 0.0, 1.0);
            for (const auto& f : ClothMaterial::fields())
                out[v].*f.at = a * in.layers[k].*f.at + (1 - a) * out[v].*f.at;
        }
}

void cloth_masses(const ClothRest& rest, const std::vector<ClothMaterial>& materials, std::vector<double>& out) {
    out.assign(rest.surface.size(), 0.0);
    for (const auto& [a, b, c] : rest.triangles) {
        const auto place = [&](int v) -> const Vec3& { return rest.surface[at(v)]; };
        const double area = 0.5 * (place(b) - place(a)).cross(place(c) - place(a)).norm();
        const double density =
            (materials[at(a)].mass_density + materials[at(b)].mass_density + materials[at(c)].mass_density) / 3;
        for (const int v : {a, b, c}) out[at(v)] += density * area / 3;
    }
}

} // namespace sinew::solver
