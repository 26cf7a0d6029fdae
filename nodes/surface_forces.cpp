// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/surface_forces.h"

#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"

#include <algorithm>

namespace sinew::nodes {

using engine::Digest;
using engine::Hasher;

namespace {

/// The first layer covers all of the tissue, so its own weights say nothing.
const engine::NumberList& weights_of(const Layers& layers, std::size_t k) {
    static const engine::NumberList everywhere;
    return k == 0 ? everywhere : layers[k].get().weights;
}

void add(const engine::Reads& in, const solver::TermType& type, double Material::*value, const Layers& layers,
         double envelope, std::vector<Force>& forces) {
    if (std::all_of(layers.begin(), layers.end(), [&](const Material& m) { return m.*value == 0; })) return;
    Hasher h;
    h.add("surface layers").add(static_cast<std::uint64_t>(layers.size()));
    for (std::size_t k = 0; k < layers.size(); ++k) h.add(layers[k].get().*value).add_doubles(weights_of(layers, k));
    const Digest digest = h.finish();
    struct Kept { // one for all frames
        std::shared_ptr<const solver::SurfaceLayers> rest;
    };
    auto kept = in.lease<Kept>(digest, [&] {
        auto made = std::make_shared<solver::SurfaceLayers>();
        for (std::size_t k = 0; k < layers.size(); ++k)
            made->layers.push_back({layers[k].get().*value, weights_of(layers, k)});
        return std::make_shared<Kept>(Kept{std::move(made)});
    });
    Force& f = forces.emplace_back();
    f.type = &type;
    f.rest = kept->rest;
    f.digest = digest;
    f.values = {envelope};
}

} // namespace

void add_pressure(const engine::Reads& in, const Layers& layers, double envelope, std::vector<Force>& forces) {
    add(in, solver::pressure_type, &Material::pressure, layers, envelope, forces);
}

void add_surface_tension(const engine::Reads& in, const Layers& layers, double envelope, std::vector<Force>& forces) {
    add(in, solver::surface_tension_type, &Material::surface_tension, layers, envelope, forces);
}

} // namespace sinew::nodes
