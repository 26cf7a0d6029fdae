// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/rest_shapes.h"

#include "nodes/adapters.h"
#include "solver/mesh/harmonic.h"
#include "solver/terms/elastic/rest_shape.h"

#include <algorithm>

namespace sinew::nodes {

namespace {

using engine::Digest;
using engine::Reads;

/// A painted map in the volume, per tet.
std::vector<double> paint_of_tets(const solver::TissueRest& t, const engine::NumberList& map) {
    const double first = map.empty() ? 1.0 : map.front();
    if (std::all_of(map.begin(), map.end(), [&](double w) { return w == first; }))
        return std::vector<double>(t.tets.tets.size(), first);
    const solver::PaintedSurface surface{t.surface, t.triangles, t.embedding};
    return solver::tet_means(
        t.tets, solver::harmonic_extensions(t.tets, surface, {map}, std::vector<char>(t.surface.size(), 1)).front());
}

} // namespace

void add_rest_shapes(const Reads& in, std::string_view attribute,
                     const std::vector<std::reference_wrapper<const RestShapeTarget>>& targets, const BodyRest& rest,
                     std::vector<Force>& forces) {
    refuse_twice(in, attribute, targets.size(), "count");
    for (std::size_t k = 0; k < targets.size(); ++k) {
        const RestShapeTarget& t = targets[k];
        const std::string name = in.source_name(attribute, k);
        const std::size_t has = t.target.points->size(), wants = rest.mesh.points->size();
        if (has != wants)
            in.fail(attribute, "FE285",
                    "the target of " + name + " has " + std::to_string(has) + " vertices, the tissue's mesh " +
                        std::to_string(wants),
                    "Sculpt a copy of the tissue's mesh, with its vertices in the same order.");
        if (t.target.topology->digest != rest.mesh.topology->digest)
            in.fail(attribute, "FE285", "the target of " + name + " has other faces than the tissue's mesh",
                    "Sculpt a copy of the tissue's mesh, with its vertices in the same order.");
        check_map(in, attribute, t.weights, wants, "weights of " + name, "vertex",
                  in.source_behind(attribute, k, "weights"));
        const Digest digest = engine::Hasher()
                                  .add("zRestShape")
                                  .add(solver::rest_shape_type.numerics)
                                  .add(rest.digest)
                                  .add(t.target.points_digest)
                                  .add_doubles(t.weights)
                                  .finish();
        struct Kept { // one for all frames
            std::shared_ptr<const solver::RestShape> rest;
        };
        auto kept = in.lease<Kept>(digest, [&] {
            return guarded(in, attribute, [&] {
                const auto& tissue = *std::get<std::shared_ptr<const solver::TissueRest>>(rest.data);
                const solver::Points tets = solver::carried_to_target(
                    tissue.tets, {tissue.surface, tissue.triangles, tissue.embedding}, *t.target.points);
                try {
                    return std::make_shared<Kept>(Kept{std::make_shared<const solver::RestShape>(
                        solver::make_rest_shape(tissue.tets, tets, paint_of_tets(tissue, t.weights)))});
                } catch (solver::Error& e) {
                    throw solver::Error(e.code, name + ": " + e.what(), e.hint);
                }
            });
        });
        Force& f = forces.emplace_back();
        f.type = &solver::rest_shape_type;
        f.rest = kept->rest;
        f.digest = digest;
        f.values = {t.weight};
    }
}

} // namespace sinew::nodes

namespace sinew::engine {

void ValueTraits<nodes::RestShapeTarget>::hash(Hasher& h, const nodes::RestShapeTarget& v) {
    h.add(v.target.topology->digest).add(v.target.points_digest).add_doubles(v.weights).add(v.weight);
}

std::size_t ValueTraits<nodes::RestShapeTarget>::bytes(const nodes::RestShapeTarget& v) {
    return ValueTraits<nodes::Mesh>::bytes(v.target) + v.weights.size() * sizeof(double);
}

} // namespace sinew::engine
