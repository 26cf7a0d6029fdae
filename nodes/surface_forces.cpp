// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/surface_forces.h"

#include "solver/meshing/layer_place.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"

#include <algorithm>

namespace sinew::nodes {

using engine::Digest;
using engine::Hasher;

namespace {

/// The first layer covers all of the tissue, so its own weights and mesh say nothing.
engine::NumberList weights_of(const Mesh& mesh, const Layers& layers, std::size_t k) {
    if (k == 0) return {};
    const Material& layer = layers[k];
    if (!layer.place) return layer.weights;
    engine::NumberList out = solver::points_in_layer(*mesh.points, *layer.place);
    if (layer.weights.empty()) return out;
    for (std::size_t v = 0; v < out.size(); ++v) out[v] *= layer.weights[layer.weights.size() == 1 ? 0 : v];
    return out;
}

void add(const engine::Reads& in, const solver::TermType& type, double Material::*value, const Mesh& mesh,
         const Layers& layers, double envelope, std::vector<Force>& forces) {
    if (std::all_of(layers.begin(), layers.end(), [&](const Material& m) { return m.*value == 0; })) return;
    Hasher h;
    h.add("surface layers").add(static_cast<std::uint64_t>(layers.size()));
    for (std::size_t k = 0; k < layers.size(); ++k) {
        const Material& layer = layers[k];
        h.add(layer.*value);
        if (k == 0) continue;
        h.add_doubles(layer.weights).add(layer.place_digest);
        if (layer.place) h.add(mesh.points_digest);
    }
    const Digest digest = h.finish();
    struct Kept { // one for all frames
        std::shared_ptr<const solver::SurfaceLayers> rest;
    };
    auto kept = in.lease<Kept>(digest, [&] {
        auto made = std::make_shared<solver::SurfaceLayers>();
        for (std::size_t k = 0; k < layers.size(); ++k)
            made->layers.push_back({layers[k].get().*value, weights_of(mesh, layers, k)});
        return std::make_shared<Kept>(Kept{std::move(made)});
    });
    Force& f = forces.emplace_back();
    f.type = &type;
    f.rest = kept->rest;
    f.digest = digest;
    f.values = {envelope};
}

} // namespace

void add_pressure(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                  std::vector<Force>& forces) {
    add(in, solver::pressure_type, &Material::pressure, mesh, layers, envelope, forces);
}

void add_surface_tension(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                         std::vector<Force>& forces) {
    add(in, solver::surface_tension_type, &Material::surface_tension, mesh, layers, envelope, forces);
}

} // namespace sinew::nodes
