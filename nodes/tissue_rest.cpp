// Puts a tissue's rest data together from the solver's meshing, embedding and extension functions.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/tissue_rest.h"

#include "nodes/adapters.h"
#include "solver/mesh/harmonic.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/layer_border.h"

#include <algorithm>
#include <numeric>

namespace sinew::nodes {

using engine::NumberList;

namespace {

bool is_constant(const NumberList& map) {
    return std::all_of(map.begin(), map.end(), [&](double w) { return w == map.front(); });
}

/// A vertex this near to its tet, in widths of the tet, lies on it: files and fitted tets round.
constexpr double touching = 1e-3;

/// Surface maps in the volume: extended harmonically, then the mean of each tet. One factorisation serves
/// all; constant maps need none and stay exact.
std::vector<std::vector<double>> per_tet(const solver::TissueRest& t, const std::vector<const NumberList*>& maps) {
    std::vector<NumberList> varying;
    for (const NumberList* map : maps)
        if (!is_constant(*map)) varying.push_back(*map);
    std::vector<std::vector<double>> fields;
    if (!varying.empty())
        fields = solver::harmonic_extensions(t.tets, {t.surface, t.triangles, t.embedding}, varying,
                                             std::vector<char>(t.surface.size(), 1));
    std::vector<std::vector<double>> out;
    auto next = fields.begin();
    for (const NumberList* map : maps)
        out.push_back(is_constant(*map) ? std::vector<double>(t.tets.tets.size(), map->empty() ? 1.0 : map->front())
                                        : solver::tet_means(t.tets, *next++));
    return out;
}

/// Unit vectors from given ones; zero where those are. Throws solver::Error FE227 where there are too few or many.
/// \param parent tets that directions are given for, of which the tissue's are parts; `count` of them
solver::Points given_directions(const std::vector<int>& parent, std::size_t count, const NumberList& given) {
    const std::size_t vectors = given.size() / 3;
    if (vectors != 1 && vectors != count)
        throw solver::Error("FE227",
                            std::to_string(vectors) + " fibre directions for " + std::to_string(count) + " tets",
                            "Give 3 numbers for each tet, in the order of the tets, or 3 for all.");
    solver::Points out(parent.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double* d = given.data() + (vectors == 1 ? 0 : 3 * static_cast<std::size_t>(parent[i]));
        out[i] = solver::Vec3(d[0], d[1], d[2]).stableNormalized();
    }
    return out;
}

/// The tets, fitted to the borders of layers that have a mesh.
solver::FittedTets fitted(const TissueParts& parts, const solver::TissueRest& t, solver::TetMesh tets,
                          const solver::MeshingControl& quiet) {
    std::vector<const solver::Solid*> places;
    for (std::size_t k = 1; k < parts.materials.size(); ++k)
        if (const auto& place = parts.materials[k].get().place) places.push_back(place.get());
    if (!places.empty()) return solver::fit_to_borders(tets, places, t.surface, t.triangles, quiet);
    solver::FittedTets out{std::move(tets), {}, {}, {}};
    out.parent.resize(out.mesh.tets.size());
    std::iota(out.parent.begin(), out.parent.end(), 0);
    return out;
}

/// [place][tet]: what of each tet lies in a layer's mesh.
std::vector<std::vector<double>> border_shares(const TissueParts& parts, const solver::FittedTets& fit,
                                               const solver::TissueRest& t, const solver::MeshingControl& quiet) {
    std::vector<std::vector<double>> out;
    for (std::size_t k = 1; k < parts.materials.size(); ++k)
        if (const auto& place = parts.materials[k].get().place)
            out.push_back(solver::fitted_shares(fit, out.size(), *place, t.surface, t.triangles, quiet));
    return out;
}

/// Layers with a mesh count where it is, times what is painted. Returns those whose mesh holds nothing of the tissue.
std::vector<std::size_t> bound_layers(const TissueParts& parts, const std::vector<std::vector<double>>& shares,
                                      solver::TissueRest& t) {
    std::vector<std::size_t> empty;
    std::size_t place = 0;
    for (std::size_t k = 1; k < parts.materials.size(); ++k) {
        if (!parts.materials[k].get().place) continue;
        const std::vector<double>& inside = shares[place++];
        if (std::all_of(inside.begin(), inside.end(), [](double s) { return s == 0; })) empty.push_back(k);
        for (std::size_t tet = 0; tet < inside.size(); ++tet) t.layer_weights[k][tet] *= inside[tet];
    }
    return empty;
}

solver::Points directions(const solver::TissueRest& t, const std::vector<int>& parent, std::size_t count,
                          const Fiber& fiber) {
    if (!fiber.directions.empty()) return given_directions(parent, count, fiber.directions);
    std::vector<char> painted;
    NumberList ends;
    for (const double e : fiber.end_points) {
        painted.push_back(is_source(e) || is_sink(e));
        ends.push_back(is_source(e) ? 0.0 : is_sink(e) ? 1.0 : e);
    }
    return solver::fibre_directions(t.tets, {t.surface, t.triangles, t.embedding}, ends, painted);
}

} // namespace

bool is_source(double end_point) { return end_point <= 0.1; }
bool is_sink(double end_point) { return end_point >= 0.9; }

engine::Digest static_digest(const TissueParts& parts) {
    engine::Hasher h;
    h.add("tissue").add(tissue_numerics).add(parts.mesh->topology->digest).add(parts.mesh->points_digest);
    h.add(parts.tets ? parts.tets->digest : engine::Digest{}).add(static_cast<int>(parts.law));
    h.add(static_cast<std::uint64_t>(parts.materials.size()));
    // The first layer covers everything, so what is painted on it and its mesh change nothing.
    for (std::size_t i = 1; i < parts.materials.size(); ++i)
        h.add_doubles(parts.materials[i].get().weights).add(parts.materials[i].get().place_digest);
    h.add(static_cast<std::uint64_t>(parts.fibers.size()));
    for (const Fiber& f : parts.fibers)
        h.add_doubles(f.weights)
            .add(f.directions.empty())
            .add_doubles(f.directions.empty() ? f.end_points : f.directions);
    return h.finish();
}

MadeTissue make_tissue_rest(const TissueParts& parts, const solver::MeshingControl& control) {
    solver::check_usable(parts.mesh->surface());
    auto t = std::make_shared<solver::TissueRest>();
    t->triangles = parts.mesh->topology->triangles;
    t->surface = *parts.mesh->points;
    solver::TetMesh tets = parts.tets ? *parts.tets->mesh : solver::make_lattice(t->surface, t->triangles, {}, control);
    const std::size_t given_tets = tets.tets.size();
    const solver::MeshingControl quiet{control.stop, {}}; // meshing has reported all of its way
    solver::FittedTets fit = fitted(parts, *t, std::move(tets), quiet);
    t->tets = fit.mesh;
    t->embedding = solver::embed(t->tets, t->surface);
    t->law = parts.law;
    if (parts.tets) t->element = parts.tets->element;
    const NumberList everywhere;
    std::vector<const NumberList*> maps;
    for (const Material& m : parts.materials) maps.push_back(maps.empty() ? &everywhere : &m.weights);
    for (const Fiber& f : parts.fibers) maps.push_back(&f.weights);
    t->layer_weights = per_tet(*t, maps);
    for (std::size_t i = 0; i < parts.fibers.size(); ++i)
        t->fibers.push_back({directions(*t, fit.parent, given_tets, parts.fibers[i]),
                             std::move(t->layer_weights[parts.materials.size() + i])});
    t->layer_weights.resize(parts.materials.size());
    std::vector<std::size_t> empty = bound_layers(parts, border_shares(parts, fit, *t, quiet), *t);
    if (needs_direction(t->law)) t->stiff_directions = t->fibers.front().directions;
    MadeTissue made;
    made.empty_places = std::move(empty);
    for (const double widths : solver::widths_outside(t->tets, t->embedding))
        if (widths > touching) ++made.outside, made.farthest = std::max(made.farthest, widths);
    auto rest = std::make_shared<BodyRest>();
    rest->data = std::shared_ptr<const solver::TissueRest>(std::move(t));
    rest->mesh = *parts.mesh;
    rest->digest = static_digest(parts);
    made.rest = std::move(rest);
    return made;
}

} // namespace sinew::nodes
