// Puts a tissue's rest data together from the solver's meshing, embedding and extension functions.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/tissue_rest.h"

#include "nodes/painted_volume.h"
#include "nodes/part_shares.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/layer_border.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace sinew::nodes {

namespace {

/// Counts what of the vertices no face has, or stands at an edge of one face alone.
void note_why(const std::vector<int>& outside, const std::vector<solver::Triangle>& triangles, MadeTissue& made) {
    std::map<std::pair<int, int>, int> faces_at; // by edge
    std::set<int> used, open;
    for (const solver::Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const int a = t[i], b = t[(i + 1) % 3];
            used.insert(a);
            ++faces_at[std::minmax(a, b)];
        }
    for (const auto& [edge, count] : faces_at)
        if (count == 1) open.insert(edge.first), open.insert(edge.second);
    for (const int v : outside) {
        made.without_face += used.contains(v) ? 0 : 1;
        made.at_open_edges += open.contains(v) ? 1 : 0;
    }
}

/// A vertex this near to its tet, in widths of the tet, lies on it: files and fitted tets round.
constexpr double touching = 1e-3;

/// All meshes that bound something within a tissue: its layers', then each part's own and its layers'.
std::vector<const solver::Solid*> places_in(const TissueParts& parts, const std::vector<NestedPart>& nested) {
    std::vector<const solver::Solid*> out;
    for (std::size_t k = 1; k < parts.materials.size(); ++k)
        if (const auto& place = parts.materials[k].get().place) out.push_back(place.get());
    for (const NestedPart& n : nested) {
        out.push_back(n.part->place.get());
        for (std::size_t k = 1; k < n.part->materials.size(); ++k)
            if (const auto& place = n.part->materials[k].place) out.push_back(place.get());
    }
    return out;
}

/// The tets, fitted to those borders.
solver::FittedTets fitted(const std::vector<const solver::Solid*>& places, const solver::TissueRest& t,
                          solver::TetMesh tets, const solver::MeshingControl& quiet) {
    if (!places.empty()) return solver::fit_to_borders(tets, places, t.surface, t.triangles, quiet);
    solver::FittedTets out{std::move(tets), {}, {}, {}};
    out.parent.resize(out.mesh.tets.size());
    std::iota(out.parent.begin(), out.parent.end(), 0);
    return out;
}

/// [place][tet]: what of each tet lies in a mesh.
std::vector<std::vector<double>> border_shares(const std::vector<const solver::Solid*>& places,
                                               const solver::FittedTets& fit, const solver::TissueRest& t,
                                               const solver::MeshingControl& quiet) {
    std::vector<std::vector<double>> out;
    for (const solver::Solid* place : places)
        out.push_back(solver::fitted_shares(fit, out.size(), *place, t.surface, t.triangles, quiet));
    return out;
}

/// Layers with a mesh count where it is, times what is painted. Returns those whose mesh holds nothing of the tissue.
/// \param next of the layers' shares; moved on
std::vector<std::size_t> bound_layers(const Layers& materials, std::vector<std::vector<double>>::const_iterator& next,
                                      std::vector<std::vector<double>>& layer_weights) {
    std::vector<std::size_t> empty;
    for (std::size_t k = 1; k < materials.size(); ++k) {
        const Material& layer = materials[k];
        if (!layer.place) continue;
        const std::vector<double>& inside = *next++;
        if (std::all_of(inside.begin(), inside.end(), [](double s) { return s == 0; })) empty.push_back(k);
        for (std::size_t tet = 0; tet < inside.size(); ++tet) layer_weights[k][tet] *= inside[tet];
    }
    return empty;
}

/// The anisotropic law's direction in each tet: that of the first fibre of whatever has most of it.
void set_stiff_directions(solver::TissueRest& t, const std::vector<std::size_t>& first_fibers) {
    t.stiff_directions.assign(t.tets.tets.size(), solver::Vec3(0, 0, 0));
    for (std::size_t tet = 0; tet < t.stiff_directions.size(); ++tet) {
        double most = 1;
        for (const solver::SubtissueRest& part : t.subtissues) most -= part.shares[tet];
        std::size_t whose = 0; // the tissue's own, then the parts'
        for (std::size_t i = 0; i < t.subtissues.size(); ++i)
            if (t.subtissues[i].shares[tet] > most) most = t.subtissues[i].shares[tet], whose = i + 1;
        if (first_fibers[whose] < first_fibers[whose + 1])
            t.stiff_directions[tet] = t.fibers[first_fibers[whose]].directions[tet];
    }
}

/// Adds the parts to a tissue whose own layers and fibres are there.
void add_parts(const std::vector<NestedPart>& nested, std::vector<std::vector<double>>::const_iterator next,
               const solver::FittedTets& fit, std::size_t given_tets, const solver::MeshingControl& quiet,
               solver::TissueRest& t, FoundParts& found) {
    const std::vector<double> volumes = solid_volumes(t.tets);
    std::vector<std::vector<double>> inside;
    auto place = next;
    for (const NestedPart& n : nested) {
        inside.push_back(*place++);
        for (std::size_t k = 1; k < n.part->materials.size(); ++k) place += n.part->materials[k].place != nullptr;
        found.inside.push_back(sum_of(inside.back(), volumes) /
                               std::abs(solver::enclosed_volume(n.part->place->points, n.part->place->triangles)));
        // What flat sides of tets lose of a small part lies inside all the same.
        const solver::Points& points = *n.part->mesh.points;
        const auto is_inside = [&](const solver::Vec3& p) { return fit.tissue->winding_number(p) > 0.5; };
        if (fit.tissue && found.inside.back() > 0 && std::all_of(points.begin(), points.end(), is_inside))
            found.inside.back() = 1;
    }
    const std::vector<std::vector<double>> own = exclusive_shares(nested, inside, volumes, found);
    for (std::size_t i = 0; i < nested.size(); ++i) {
        ++next;
        solver::SubtissueRest& rest = t.subtissues.emplace_back();
        if (std::all_of(own[i].begin(), own[i].end(), [](double s) { return s < least_part_share; })) {
            // Nothing of it, which is refused where the part lies outside; or so little that paint within it has no
            // place.
            rest.layer_weights.assign(nested[i].part->materials.size(), std::vector<double>(own[i].size(), 0.0));
            for (std::size_t f = 0; f < nested[i].part->fibers.size(); ++f)
                t.fibers.push_back(
                    {solver::Points(own[i].size(), solver::Vec3(0, 0, 0)), std::vector<double>(own[i].size(), 0.0)});
        } else {
            Painted painted = painted_in_part(t, *nested[i].part, own[i], fit.parent, given_tets, quiet);
            rest.layer_weights = std::move(painted.layers);
            for (solver::FiberRest& f : painted.fibers) t.fibers.push_back(std::move(f));
        }
        bound_layers(references(nested[i].part->materials), next, rest.layer_weights);
        rest.shares = own[i];
    }
}

/// Weights of fibres times the share of what they belong to.
void weigh_fibers(solver::TissueRest& t, const std::vector<std::size_t>& first_fibers) {
    for (std::size_t whose = 0; whose + 1 < first_fibers.size(); ++whose)
        for (std::size_t f = first_fibers[whose]; f < first_fibers[whose + 1]; ++f)
            for (std::size_t tet = 0; tet < t.tets.tets.size(); ++tet) {
                double share = 1;
                if (whose > 0)
                    share = t.subtissues[whose - 1].shares[tet];
                else
                    for (const solver::SubtissueRest& part : t.subtissues) share -= part.shares[tet];
                t.fibers[f].weights[tet] *= std::max(0.0, share);
            }
}

/// A part as a body of its own on the tissue's tets.
BodyRest::Part part_on(const solver::TissueRest& tissue, const Subtissue& part, const engine::Digest& whole) {
    auto t = std::make_shared<solver::TissueRest>();
    t->tets = tissue.tets;
    t->element = tissue.element;
    t->law = tissue.law;
    t->surface = *part.mesh.points;
    t->triangles = part.mesh.topology->triangles;
    t->embedding = solver::embed(t->tets, t->surface);
    auto rest = std::make_shared<BodyRest>();
    rest->data = std::shared_ptr<const solver::TissueRest>(std::move(t));
    rest->mesh = part.mesh;
    rest->digest = engine::Hasher().add("part").add(whole).add(part.digest).finish();
    return {part.digest, std::move(rest)};
}

} // namespace

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
    for (const auto& part : parts.subtissues) h.add(part->digest);
    return h.finish();
}

std::vector<NestedPart> nested_parts(const std::vector<std::shared_ptr<const Subtissue>>& direct) {
    std::vector<NestedPart> out;
    for (std::size_t i = 0; i < direct.size(); ++i) out.push_back({direct[i].get(), -1, i});
    for (std::size_t k = 0; k < out.size(); ++k)
        for (const auto& inner : out[k].part->parts) out.push_back({inner.get(), static_cast<int>(k), out[k].top});
    return out;
}

MadeTissue make_tissue_rest(const TissueParts& parts, const solver::MeshingControl& control) {
    solver::check_usable(parts.mesh->surface());
    auto t = std::make_shared<solver::TissueRest>();
    t->triangles = parts.mesh->topology->triangles;
    t->surface = *parts.mesh->points;
    solver::TetMesh tets = parts.tets ? *parts.tets->mesh : solver::make_lattice(t->surface, t->triangles, {}, control);
    const std::size_t given_tets = tets.tets.size();
    const solver::MeshingControl quiet{control.stop, {}}; // meshing has reported all of its way
    const std::vector<NestedPart> nested = nested_parts(parts.subtissues);
    const std::vector<const solver::Solid*> places = places_in(parts, nested);
    solver::FittedTets fit = fitted(places, *t, std::move(tets), quiet);
    t->tets = fit.mesh;
    t->embedding = solver::embed(t->tets, t->surface);
    t->law = parts.law;
    if (parts.tets) t->element = parts.tets->element;
    Painted painted = painted_in({t->tets, t->surface, t->triangles, t->embedding}, parts.materials, parts.fibers,
                                 fit.parent, given_tets, quiet);
    t->layer_weights = std::move(painted.layers), t->fibers = std::move(painted.fibers);
    const std::vector<std::vector<double>> shares = border_shares(places, fit, *t, quiet);
    auto next = shares.begin();
    MadeTissue made;
    made.empty_places = bound_layers(parts.materials, next, t->layer_weights);
    std::vector<std::size_t> first_fibers{0, t->fibers.size()};
    if (!nested.empty()) {
        add_parts(nested, next, fit, given_tets, quiet, *t, made.parts);
        for (const NestedPart& n : nested) first_fibers.push_back(first_fibers.back() + n.part->fibers.size());
        weigh_fibers(*t, first_fibers);
    }
    if (needs_direction(t->law)) set_stiff_directions(*t, first_fibers);
    std::vector<int> outside;
    const std::vector<double> widths = solver::widths_outside(t->tets, t->embedding);
    for (std::size_t v = 0; v < widths.size(); ++v)
        if (widths[v] > touching)
            outside.push_back(static_cast<int>(v)), made.farthest = std::max(made.farthest, widths[v]);
    made.outside = outside.size();
    if (!outside.empty()) note_why(outside, t->triangles, made);
    auto rest = std::make_shared<BodyRest>();
    rest->mesh = *parts.mesh;
    rest->digest = static_digest(parts);
    for (const NestedPart& n : nested) rest->parts.push_back(part_on(*t, *n.part, rest->digest));
    rest->data = std::shared_ptr<const solver::TissueRest>(std::move(t));
    made.rest = std::move(rest);
    return made;
}

} // namespace sinew::nodes
