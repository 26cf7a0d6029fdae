// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/painted_volume.h"

#include "nodes/adapters.h"
#include "solver/error.h"
#include "solver/mesh/fibre_field.h"
#include "solver/mesh/harmonic.h"
#include "solver/meshing/finer_tets.h"

#include <algorithm>
#include <optional>

namespace sinew::nodes {

using engine::NumberList;

namespace {

bool is_constant(const NumberList& map) {
    return std::all_of(map.begin(), map.end(), [&](double w) { return w == map.front(); });
}

/// Surface maps in the volume: extended harmonically, then the mean of each tet. One factorisation serves
/// all; constant maps need none and stay exact.
std::vector<std::vector<double>> per_tet(const PaintedIn& t, const std::vector<const NumberList*>& maps) {
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

/// Directions between painted ends, on smaller tets than the simulation's: where fibres leave an end that covers much
/// of a muscle's side, they turn within a tet.
class FibreField {
  public:
    FibreField(const PaintedIn& t, const solver::MeshingControl& control)
        : tets_(t.tets)
        , surface_(t.surface)
        , triangles_(t.triangles)
        , finer_(solver::finer_tets(t.tets, t.surface, t.triangles, control))
        , locator_(finer_.mesh)
        , embedding_(solver::embed(locator_, t.surface)) {}

    /// Their means in the simulation's tets.
    solver::Points between(const NumberList& end_points) const {
        std::vector<char> painted;
        NumberList ends;
        for (const double e : end_points) {
            painted.push_back(is_source(e) || is_sink(e));
            ends.push_back(is_source(e) ? 0.0 : is_sink(e) ? 1.0 : e);
        }
        const solver::Points gradients =
            solver::fibre_gradients(finer_.mesh, {surface_, triangles_, embedding_, &locator_}, ends, painted);
        return solver::fibre_directions(tets_, solver::means_over_parts(finer_, gradients, tets_.tets.size()));
    }

  private:
    const solver::TetMesh& tets_;
    const solver::Points& surface_;
    const std::vector<solver::Triangle>& triangles_;
    solver::FinerTets finer_;
    solver::TetLocator locator_;
    solver::Embedding embedding_;
};

/// The tets that a part holds something of, with the part's share as their coverage: fibres run along its own border.
struct PartTets {
    solver::TetMesh mesh;
    std::vector<int> tet; ///< of the tissue, for each
};

PartTets tets_of_part(const solver::TetMesh& whole, const std::vector<double>& shares) {
    PartTets out;
    std::vector<int> number(whole.vertices.size(), -1);
    for (std::size_t t = 0; t < shares.size(); ++t) {
        if (shares[t] < least_part_share) continue;
        solver::Tet tet = whole.tets[t];
        for (int& v : tet) {
            int& n = number[static_cast<std::size_t>(v)];
            if (n < 0) {
                n = static_cast<int>(out.mesh.vertices.size());
                out.mesh.vertices.push_back(whole.vertices[static_cast<std::size_t>(v)]);
            }
            v = n;
        }
        out.mesh.tets.push_back(tet);
        out.mesh.coverage.push_back(shares[t] * (whole.coverage.empty() ? 1 : whole.coverage[t]));
        out.tet.push_back(static_cast<int>(t));
    }
    return out;
}

} // namespace

bool is_source(double end_point) { return end_point <= 0.1; }
bool is_sink(double end_point) { return end_point >= 0.9; }

Painted painted_in(const PaintedIn& t, const Layers& materials, const Fibers& fibers, const std::vector<int>& parent,
                   std::size_t count, const solver::MeshingControl& control) {
    const NumberList everywhere;
    std::vector<const NumberList*> maps;
    for (const Material& m : materials) maps.push_back(maps.empty() ? &everywhere : &m.weights);
    for (const Fiber& f : fibers) maps.push_back(&f.weights);
    Painted out;
    out.layers = per_tet(t, maps);
    std::optional<FibreField> field; // one for all
    for (std::size_t i = 0; i < fibers.size(); ++i) {
        const Fiber& fiber = fibers[i];
        if (fiber.directions.empty() && !field) field.emplace(t, control);
        out.fibers.push_back({fiber.directions.empty() ? field->between(fiber.end_points)
                                                       : given_directions(parent, count, fiber.directions),
                              std::move(out.layers[materials.size() + i])});
    }
    out.layers.resize(materials.size());
    return out;
}

Painted painted_in_part(const solver::TissueRest& t, const Subtissue& part, const std::vector<double>& shares,
                        const std::vector<int>& parent, std::size_t count, const solver::MeshingControl& control) {
    const PartTets own = tets_of_part(t.tets, shares);
    const solver::Embedding embedding = solver::embed(own.mesh, *part.mesh.points);
    std::vector<int> own_parent;
    for (const int tet : own.tet) own_parent.push_back(parent[static_cast<std::size_t>(tet)]);
    Painted found = painted_in({own.mesh, *part.mesh.points, part.mesh.topology->triangles, embedding},
                               references(part.materials), references(part.fibers), own_parent, count, control);
    const auto everywhere = [&](const auto& of_own, auto blank) {
        std::vector<decltype(blank)> out(t.tets.tets.size(), blank);
        for (std::size_t i = 0; i < own.tet.size(); ++i) out[static_cast<std::size_t>(own.tet[i])] = of_own[i];
        return out;
    };
    Painted out;
    for (const auto& weights : found.layers) out.layers.push_back(everywhere(weights, 0.0));
    for (const solver::FiberRest& f : found.fibers)
        out.fibers.push_back({everywhere(f.directions, solver::Vec3(0, 0, 0)), everywhere(f.weights, 0.0)});
    return out;
}

} // namespace sinew::nodes
