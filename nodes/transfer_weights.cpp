// transferWeights: a painted map on a mesh that has changed.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "nodes/options.h"
#include "solver/mesh/map_transfer.h"

#include <algorithm>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> old_mesh{
    .name = "oldMesh",
    .doc = "The mesh that the map was painted on. It must lie where the new one lies.",
};
const Input<NumberList> old_weights{
    .name = "weights",
    .limits = within_reach,
    .doc = "The map: one number per vertex of oldMesh, or one for all.",
    .required = true,
};
const Wire<Mesh> new_mesh{
    .name = "newMesh",
    .doc = "The mesh that needs the map, for example the same model with other triangles, or its iso mesh.",
};
NumberList transfer_clamped(const solver::MapTransfer& places, const NumberList& map) {
    NumberList out = solver::transfer_map(places, map);
    for (double& w : out) w = std::clamp(w, 0.0, 1.0);
    return out;
}
constexpr Option<NumberList (*)(const solver::MapTransfer&, const NumberList&)> modes[] = {
    {"linear", transfer_clamped}, {"endPoints", solver::transfer_ends}};
const Input<std::string> mode{
    .name = "mode",
    .def = "linear",
    .doc = "linear takes the value at the closest point of oldMesh. endPoints keeps the ends of fibres "
           "sharp: 0.9 and "
           "more become 1, 0.1 and less 0, all else 0.5, and no end is lost on a coarser mesh.",
    .options = words(modes),
};
const Output<NumberList> out_weights{
    .name = "outWeights",
    .doc = "One number per vertex of newMesh, kept between 0 and 1.",
    .unit = "1",
};

void compute(const Reads& in, Writes& out) {
    const Mesh &from = in[old_mesh], &to = in[new_mesh];
    const NumberList& map = in[old_weights];
    if (map.empty())
        in.fail(old_weights.name, "FE204",
                "no numbers for a mesh of " + std::to_string(from.points->size()) + " vertices",
                "Give one number per vertex of oldMesh.");
    check_map(in, old_weights.name, map, from.points->size(), "the weights", "vertex",
              in.source_name(old_weights.name));
    out.set(out_weights, guarded(in, new_mesh.name, [&]() -> NumberList {
                const solver::MapTransfer places =
                    solver::find_places(*from.points, from.topology->triangles, *to.points, to.topology->triangles);
                return meaning(modes, in[mode])(places, per_vertex(map, from.points->size()));
            }));
}

} // namespace

void add_transfer_weights(Registry& registry) {
    NodeType type;
    type.name = "transferWeights";
    type.numerics = 2; // weights are kept between 0 and 1
    type.doc = "Carries a painted map over to another mesh in the same place, by the closest point.";
    type.inputs = {describe(old_mesh), describe(old_weights), describe(new_mesh), describe(mode)};
    type.outputs = {describe(out_weights)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
