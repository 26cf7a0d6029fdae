// zEmbedder: extra meshes that ride on a simulated tissue.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/carriers.h"

#include <optional>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Solved> solved{.name = "solved", .doc = "zSolver.outSolved."};
const Wire<Body> body{
    .name = "body",
    .doc = "The tissue that carries the meshes; one of the solver's bodies.",
};
const WireList<Mesh> meshes{
    .name = "meshes",
    .doc = "Meshes at rest beside the tissue as modelled, in scene units. None: the tissue's own mesh. A mesh with "
           "vertices "
           "more than a tet's width outside of the tissue's tets is warned of; one that is there wholly is refused.",
};
const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Blends from the meshes as given (0) to the carried ones (1).",
};
const Output<MeshList> out_meshes{
    .name = "outMeshes",
    .doc = "The carried meshes at this frame, in the order of `meshes`.",
    .entries_of = "meshes",
};

const Output<MeshList> out_collision_meshes{
    .name = "outCollisionMeshes",
    .doc = "The tissue's collision surface at this frame: its collisionShape, carried. No mesh where it has none.",
};

std::size_t find(const Reads& in, const Solved& s) {
    const int found = find_body(s.bodies, id_of(in[body]));
    if (found >= 0) return static_cast<std::size_t>(found);
    in.fail(body.name, found == body_ambiguous ? "FE213" : "FE209",
            in.source_name(body.name) + (found == body_ambiguous ? " cannot be told from another body of the solver"
                                                                 : " is not simulated by that solver"),
            "Connect a tissue that is among zSolver.bodies and enabled there.");
}

/// \param whose  whose mesh it is; none for the tissue's own, which is not checked here
solver::Points carried_by(const Reads& in, const BodyRest& rest, const solver::TissueRest& tissue, const Mesh& mesh,
                          const std::optional<std::string>& whose, const solver::Points& corners,
                          const solver::Points& midpoints) {
    struct Kept {
        PlacedPoints placed;
    };
    const Digest key =
        Hasher().add("zEmbedder").add(rest.digest).add(mesh.points_digest).add(whose.has_value()).finish();
    auto kept = in.lease<Kept>(key, [&] {
        return guarded(in, meshes.name, [&] {
            return std::make_shared<Kept>(
                Kept{whose ? place(tissue, mesh, *whose) : PlacedPoints{find_carriers(tissue, *mesh.points)}});
        });
    });
    if (whose) warn_of_far_vertices(in, meshes.name, kept->placed, *whose);
    return carried(kept->placed.carriers, corners, midpoints);
}

Mesh blended(const Mesh& from, solver::Points to, double share) {
    if (share < 1)
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = (1 - share) * (*from.points)[i] + share * to[i];
    return from.with_points(std::move(to));
}

void compute(const Reads& in, Writes& out) {
    const Solved& s = in[solved];
    const std::size_t at = find(in, s);
    const BodyRest& rest = *s.rests[at];
    const auto* tissue = std::get_if<std::shared_ptr<const solver::TissueRest>>(&rest.data);
    if (!tissue)
        in.fail(body.name, "FE218",
                in.source_name(body.name) +
                    (in[body].is_cloth() ? " is a cloth and carries no meshes" : " is a bone and carries no meshes"),
                in[body].is_cloth() ? "A cloth's own mesh is in zSolver.outMeshes; tie further ones to it as cloth."
                                    : "Move the meshes of a bone by a transform.");
    MeshList list;
    const auto carry = [&](const Mesh& m, const std::optional<std::string>& whose) {
        solver::Points to = carried_by(in, rest, **tissue, m, whose, s.positions[at], s.midpoints[at]);
        list.meshes.push_back(blended(m, std::move(to), in[envelope]));
    };
    const auto given = in[meshes];
    for (std::size_t i = 0; i < given.size(); ++i) carry(given[i], in.source_name(meshes.name, i));
    if (given.empty()) carry(rest.mesh, std::nullopt);
    out.set(out_meshes, std::move(list));
    // From the body as connected here, not from the solver's: its frames are the same with and without.
    MeshList collision;
    if (const auto& shape = in[body].collision)
        collision.meshes.push_back(
            blended(shape->mesh, carried(shape->carriers, s.positions[at], s.midpoints[at]), in[envelope]));
    out.set(out_collision_meshes, std::move(collision));
}

} // namespace

void add_z_embedder(Registry& registry) {
    NodeType type;
    type.name = "zEmbedder";
    type.doc = "Carries extra meshes, for example a fine skin, and the tissue's collision surface along with a "
               "simulated tissue.";
    type.inputs = {describe(solved), describe(body), describe(meshes), describe(envelope)};
    type.outputs = {describe(out_meshes), describe(out_collision_meshes)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
