// zTissue: a soft body, from a mesh, its tets, its material layers and its fibres.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/appearance.h"
#include "nodes/carriers.h"
#include "nodes/contact_inputs.h"
#include "nodes/options.h"
#include "nodes/rest_shapes.h"
#include "nodes/subtissues.h"
#include "nodes/surface_forces.h"
#include "nodes/tissue_rest.h"
#include "solver/linear/blas_kernel.h"
#include "solver/terms/elastic/rest_change.h"

#include <algorithm>
#include <cstdio>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<bool> enable{
    .name = "enable",
    .def = true,
    .doc = "Off leaves the tissue and its attachments out of the simulation. Keyed: while it is off the tissue stands "
           "still where it is, in the solver's space, its attachments let go and it touches nothing; when it comes on, "
           "it goes on from there at rest.",
    .looks_ahead = true,
};
const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The tissue's surface as modelled, in scene units; it does not change over time.",
};
const Wire<TetMeshValue> tets{
    .name = "tets",
    .doc = "The tets that carry the tissue, from zTet or a file. Without it: a lattice of the default size.",
    .required = false,
};
const WireList<Material> materials{
    .name = "materials",
    .doc = "Material layers from bottom to top; one at least.",
};
const WireList<Fiber> fibers{.name = "fibers", .doc = "Muscle fibres; their pulls add up."};
std::string doc_of_laws() {
    std::string doc = "The elastic law: ";
    for (const solver::LawFacts& facts : solver::elastic_laws)
        doc += std::string(&facts == solver::elastic_laws ? "" : ", ") + std::string(facts.name) + " (" +
               std::string(facts.doc) + ")";
    return doc + ".";
}
const std::string law_doc = doc_of_laws();
const Input<std::string> law{
    .name = "material",
    .def = std::string(word_of(solver::ElasticLaw::stvk)),
    .doc = law_doc,
    .keyable = false,
    .options = words(options_of<solver::ElasticLaw>),
};
std::string doc_of_resistance() {
    std::string laws;
    for (const solver::LawFacts& facts : solver::elastic_laws)
        if (facts.resists_compression) laws += (laws.empty() ? "" : ", ") + std::string(facts.name);
    return "Extra resistance against being squashed, relative to the stiffness; useful from 1e3 on. Acts in the laws " +
           laws + ".";
}
const std::string resistance_doc = doc_of_resistance();
const Input<double> compression_resistance{
    .name = "compressionResistance",
    .def = 20000,
    .unit = "1",
    .limits = {.min = 0, .max = 1e13},
    .doc = resistance_doc,
};
const Input<double> transverse_anisotropy{
    .name = "transverseAnisotropy",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1e6, .open_min = true},
    .doc = "Anisotropic only: stiffness across the fibre over stiffness along it; 1 is the same in all directions. "
           "Young's modulus is the one along the fibre.",
};
const WireList<RestShapeTarget> rest_shapes{
    .name = "restShapes",
    .doc = "Shapes in which the tissue is at rest instead of its model, each by its weight and paint; from "
           "zRestShape.outRestShape. They act before restScale and muscle growth.",
};
const Input<Vec3> initial_velocity{
    .name = "initialVelocity",
    .unit = "m/s",
    .limits = {.min = -3e8, .max = 3e8},
    .doc = "Velocity of the centre of mass at the start frame; always in metres, whatever the scale. What is held "
           "stays, and QuasiStatic knows no velocities.",
    .keyable = false,
};
const Input<Vec3> initial_angular_velocity{
    .name = "initialAngularVelocity",
    .unit = "rad/s",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Angular velocity about the centre of mass at the start frame, along the axis of rotation.",
    .keyable = false,
};
const Input<double> inertial_damping{
    .name = "inertialDamping",
    .def = 0,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Takes momentum out of the motion of the tissue as a whole: translation, rotation, shear and scaling. Finer "
           "motion, as waves, keeps its own. The share of it that is gone after 1/24 s, however many steps that are: 0 "
           "is none, 1 leaves no momentum from step to step, so that the whole only creeps after the forces.",
};
const Input<double> rest_scale_envelope{
    .name = "restScaleEnvelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "The power to which zMaterial.restScale is taken: 0 is off, 1 all of it, more is more than that, and -1 the "
           "reciprocal.",
};
const Input<double> pressure_envelope{
    .name = "pressureEnvelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "Multiplies zMaterial.pressure; below 0 it pushes the other way.",
};
const Input<double> surface_tension_envelope{
    .name = "surfaceTensionEnvelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "Multiplies zMaterial.surfaceTension; below 0 the surface spreads.",
};
const Wire<Mesh> collision_shape{
    .name = "collisionShape",
    .doc =
        "A mesh that stands in for the tissue's own surface in contacts, modelled where the tissue is at rest, in "
        "scene units; coarser, or closed where the mesh is not. Like the mesh it should not move by itself: one that "
        "does is bound anew at every frame. It rides on the tets: zEmbedder.outCollisionMeshes gives it deformed.",
    .required = false,
};
const Input<std::string> appearance = appearance_input(Matter::muscle);
const Input<Vec3> colour = colour_input({0.68, 0.235, 0.2});
const Output<Body> out_body{
    .name = "outBody",
    .doc = "The tissue, for zSolver.bodies, zAttachment and zEmbedder.",
};

/// A mesh that says nothing: on the layer that covers everything, or away from the tissue.
void warn_of_places(const Reads& in, const TissueParts& parts, const std::vector<std::size_t>& empty) {
    if (parts.materials.front().get().place)
        in.warn(materials.name, "FE243",
                in.source_name(materials.name, 0) +
                    " has a mesh, but it is the first layer, which covers all of the tissue",
                "Put a layer below it, for what lies outside of the mesh.");
    for (const std::size_t k : empty)
        in.warn(materials.name, "FE244",
                "the mesh of " + in.source_name(materials.name, k) +
                    " holds no part of the tissue, so the layer is nowhere",
                "Model it where the tissue is at rest, in the same units.");
}

void warn_of_vertices_outside(const Reads& in, const TissueParts& parts, const MadeTissue& made) {
    if (made.outside == 0) return;
    char farthest[32];
    std::snprintf(farthest, sizeof farthest, "%.2g", made.farthest);
    std::string why,
        cure = "Connect tets that reach around the whole mesh, for example from a zTet that reads the same mesh.";
    if (made.without_face > 0) why = "; " + std::to_string(made.without_face) + " of them belong to no face";
    if (made.at_open_edges > 0)
        why += "; " + std::to_string(made.at_open_edges) +
               " of them are at open edges, where faces stick out or leave a hole and enclose nothing to fill";
    if (made.without_face == made.outside)
        cure = "Nothing shows them; remove vertices without faces where the mesh is modelled.";
    else if (made.without_face + made.at_open_edges == made.outside)
        cure = "Remove faces that stick out and close holes where the mesh is modelled, or remesh it by zIsoMesh.";
    in.warn(parts.tets ? tets.name : mesh.name, "FE246",
            std::to_string(made.outside) + " of " + std::to_string(parts.mesh->points->size()) +
                " vertices of the mesh lie outside of the tets, up to " + farthest +
                " widths of a tet; what they do is drawn out from the nearest tet" + why,
            cure);
}

void check_law(const Reads& in, const TissueParts& parts) {
    const bool some_part = std::any_of(parts.subtissues.begin(), parts.subtissues.end(),
                                       [](const auto& part) { return !part->fibers.empty(); });
    if (needs_direction(parts.law) && parts.fibers.empty() && !some_part)
        in.fail(law.name, "FE225", "the law " + in[law] + " has no fibre to take its direction from",
                "Connect a zFiber to fibers; with strength 0 it gives a direction and no pull.");
}

/// The solver would name the tissue alone.
void check_rest(const Reads& in, const solver::TissueInputs& values) {
    guarded(in, rest_scale_envelope.name, [&] { solver::check_rest_scale(values); });
    guarded(in, fibers.name, [&] { solver::check_growth(values); });
}

std::shared_ptr<const CollisionSurface> collision_surface(const Reads& in, const BodyRest& rest) {
    const Mesh* shape = in.find(collision_shape);
    if (!shape) return nullptr;
    const std::string whose = in.source_name(collision_shape.name);
    struct Kept {
        PlacedPoints placed;
        std::shared_ptr<const CollisionSurface> surface;
    };
    const Digest key = Hasher()
                           .add("zTissue.collision")
                           .add(rest.digest)
                           .add(shape->topology->digest)
                           .add(shape->points_digest)
                           .finish();
    auto kept = in.lease<Kept>(key, [&] {
        return guarded(in, collision_shape.name, [&] {
            const auto& tissue = *std::get<std::shared_ptr<const solver::TissueRest>>(rest.data);
            solver::check_usable(shape->surface());
            PlacedPoints placed = place(tissue, *shape, whose);
            auto surface = std::make_shared<const CollisionSurface>(CollisionSurface{*shape, placed.carriers});
            return std::make_shared<Kept>(Kept{std::move(placed), std::move(surface)});
        });
    });
    warn_of_far_vertices(in, collision_shape.name, kept->placed, whose);
    return kept->surface;
}

void compute(const Reads& in, Writes& out) {
    const TissueParts parts{&in[mesh],     in.find(tets), meaning(options_of<solver::ElasticLaw>, in[law]),
                            in[materials], in[fibers],    read_subtissues(in)};
    check_layers(in, materials.name, parts.materials, *parts.mesh);
    check_fibers(in, fibers.name, parts.fibers, *parts.mesh);
    check_law(in, parts);
    // Meshing and extension read static inputs alone; a keyed excitation must not redo them.
    auto kept = in.lease<MadeTissue>(static_digest(parts), [&] {
        in.progress(0, "meshing");
        return guarded(in, mesh.name,
                       [&] { return std::make_shared<MadeTissue>(make_tissue_rest(parts, meshing_control(in))); },
                       {{"FE227", fibers.name}});
    });
    warn_of_places(in, parts, kept->empty_places);
    warn_of_vertices_outside(in, parts, *kept);
    const std::vector<NestedPart> nested = nested_parts(parts.subtissues);
    warn_of_parts(in, nested, kept->parts);
    const std::shared_ptr<const CollisionSurface> collision = collision_surface(in, *kept->rest);
    solver::TissueInputs values;
    values.compression_resistance = in[compression_resistance];
    values.transverse_anisotropy = in[transverse_anisotropy];
    values.inertial_damping = in[inertial_damping];
    for (const Material& m : parts.materials) values.layers.push_back(m.values);
    values.layers.front().envelope = 1; // the first layer covers everything
    for (const Fiber& f : parts.fibers) values.fibers.push_back(f.values);
    for (const NestedPart& n : nested) {
        values.subtissues.push_back(part_inputs(*n.part));
        for (const Fiber& f : n.part->fibers) values.fibers.push_back(f.values);
    }
    values.rest_scale_envelope = in[rest_scale_envelope];
    check_rest(in, values);
    std::vector<Force> forces;
    add_rest_shapes(in, rest_shapes.name, in[rest_shapes], *kept->rest, forces);
    add_pressure(in, *parts.mesh, parts.materials, in[pressure_envelope], forces);
    add_surface_tension(in, *parts.mesh, parts.materials, in[surface_tension_envelope], forces);
    const auto vector = [&](const Input<Vec3>& v) { return solver::Vec3(in[v][0], in[v][1], in[v][2]); };
    const solver::InitialMotion start{vector(initial_velocity), vector(initial_angular_velocity)};
    Body body{kept->rest,
              in[enable],
              std::move(values),
              start,
              collision,
              std::move(forces),
              read_contact(in, Collider::tissue, *parts.mesh, collision.get()),
              nullptr,
              in.is_ever_on(enable)};
    std::vector<std::reference_wrapper<const Fiber>> all(parts.fibers); // in the order of values.fibers
    for (const NestedPart& n : nested) all.insert(all.end(), n.part->fibers.begin(), n.part->fibers.end());
    body.lines = lines_of(all);
    out.set(out_body, std::move(body));
}

} // namespace

void add_z_tissue(Registry& registry) {
    NodeType type;
    type.name = "zTissue";
    type.numerics = tissue_numerics;
    type.machine = solver::machine_numerics();
    type.doc = "A soft body: muscle, fat, an organ. Its mesh rides on tets that are simulated.";
    type.inputs = {describe(enable),
                   describe(mesh),
                   describe(tets),
                   describe(materials),
                   describe(fibers),
                   describe(subtissues),
                   describe(law),
                   describe(compression_resistance),
                   describe(transverse_anisotropy),
                   describe(initial_velocity),
                   describe(initial_angular_velocity),
                   describe(inertial_damping),
                   describe(rest_scale_envelope),
                   describe(rest_shapes),
                   describe(pressure_envelope),
                   describe(surface_tension_envelope),
                   describe(collision_shape),
                   describe(appearance),
                   describe(colour)};
    for (AttributeInfo& a : contact_attributes(Collider::tissue)) type.inputs.push_back(std::move(a));
    type.outputs = {describe(out_body)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
