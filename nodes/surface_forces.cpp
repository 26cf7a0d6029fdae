// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/surface_forces.h"

#include "engine/text.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/layer_place.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"

#include <algorithm>
#include <cstdio>
#include <string>

namespace sinew::nodes {

using engine::Digest;
using engine::Hasher;

namespace {

bool has_any(const Layers& layers, double Material::*value) {
    return std::any_of(layers.begin(), layers.end(), [&](const Material& m) { return m.*value != 0; });
}

void add(const engine::Reads& in, const solver::TermType& type, double Material::*value, const Mesh& mesh,
         const Layers& layers, double envelope, std::vector<Force>& forces) {
    if (!has_any(layers, value)) return;
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
            made->layers.push_back({layers[k].get().*value, painted_layer(mesh, layers, k)});
        return std::make_shared<Kept>(Kept{std::move(made)});
    });
    Force& f = forces.emplace_back();
    f.type = &type;
    f.rest = kept->rest;
    f.digest = digest;
    f.values = {envelope};
}

/// Pressure goes by the way that faces look, and moves a tissue as a whole where they do not close.
void warn_of_facing(const engine::Reads& in, const Mesh& mesh) {
    struct Facing {
        double open = 0; ///< sum of the faces' area vectors, as a share of their area
        double volume = 0;
    };
    const Digest key = Hasher().add("pressure.facing").add(mesh.topology->digest).add(mesh.points_digest).finish();
    auto facing = in.lease<Facing>(key, [&] {
        auto made = std::make_shared<Facing>();
        solver::Vec3 sum = solver::Vec3::Zero();
        double area = 0;
        for (const solver::Triangle& t : mesh.topology->triangles) {
            const auto corner = [&](std::size_t i) { return (*mesh.points)[static_cast<std::size_t>(t[i])]; };
            const solver::Vec3 across = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
            sum += across;
            area += across.norm();
        }
        made->open = sum.norm() / area;
        made->volume = solver::enclosed_volume(*mesh.points, mesh.topology->triangles);
        return made;
    });
    const std::string name = in.source_name("mesh");
    constexpr double rounding = 1e-6;
    if (facing->open > rounding) {
        const std::string share = engine::rough_text(100 * facing->open, 2);
        in.warn("mesh", "FE245",
                name + " is not closed or has faces twice, so pressure pushes the tissue away as a whole, by " + share +
                    " % of what it presses with",
                "Close the mesh, or remesh it by zIsoMesh.");
    } else if (facing->volume < 0) {
        in.warn("mesh", "FE245",
                "the faces of " + name + " look inwards, so its pressure acts the other way than it says",
                "Turn the faces around, or remesh it by zIsoMesh.");
    }
}

/// A sheet may be open, but its faces have to look to one side for pressure to push it there.
void warn_of_sides(const engine::Reads& in, const Mesh& mesh) {
    struct Sides {
        solver::Flaw turned;
    };
    const Digest key = Hasher().add("pressure.sides").add(mesh.topology->digest).add(mesh.points_digest).finish();
    auto sides = in.lease<Sides>(key, [&] {
        return std::make_shared<Sides>(
            Sides{solver::check_mesh(*mesh.points, mesh.topology->triangles).badly_oriented_edges});
    });
    const solver::Flaw& turned = sides->turned;
    if (!turned) return;
    const auto [a, b] = turned.edges.front();
    const solver::Vec3 at =
        0.5 * ((*mesh.points)[static_cast<std::size_t>(a)] + (*mesh.points)[static_cast<std::size_t>(b)]);
    char place[96];
    std::snprintf(place, sizeof place, "(%g, %g, %g)", at.x(), at.y(), at.z());
    in.warn("mesh", "FE315",
            "the faces of " + in.source_name("mesh") + " look to both sides: they change at " +
                solver::describe(turned, "edge", "edges") + ", near " + place +
                ", so pressure pushes this way and that",
            "Turn faces until neighbours look to the same side.");
}

} // namespace

engine::NumberList painted_layer(const Mesh& mesh, const Layers& layers, std::size_t k) {
    if (k == 0) return {};
    const Material& layer = layers[k];
    if (!layer.place) return layer.weights;
    engine::NumberList out = solver::points_in_layer(*mesh.points, *layer.place);
    if (layer.weights.empty()) return out;
    for (std::size_t v = 0; v < out.size(); ++v) out[v] *= layer.weights[layer.weights.size() == 1 ? 0 : v];
    return out;
}

void add_pressure(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                  std::vector<Force>& forces, bool closed) {
    if (has_any(layers, &Material::pressure)) closed ? warn_of_facing(in, mesh) : warn_of_sides(in, mesh);
    add(in, solver::pressure_type, &Material::pressure, mesh, layers, envelope, forces);
}

void add_surface_tension(const engine::Reads& in, const Mesh& mesh, const Layers& layers, double envelope,
                         std::vector<Force>& forces) {
    add(in, solver::surface_tension_type, &Material::surface_tension, mesh, layers, envelope, forces);
}

} // namespace sinew::nodes
