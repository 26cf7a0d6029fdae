// zCloth: a sheet that bends more easily than it stretches, from a mesh and its material layers.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "engine/text.h"
#include "nodes/adapters.h"
#include "nodes/appearance.h"
#include "nodes/contact_inputs.h"
#include "nodes/limits.h"
#include "nodes/options.h"
#include "nodes/surface_forces.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/terms/cloth/check_cloth.h"
#include "solver/terms/cloth/sheet.h"

namespace sinew::nodes {

using namespace engine;

namespace {

/// Raised when the same parts give rest data with other bits.
constexpr int cloth_numerics = 1;

const Input<bool> enable{
    .name = "enable",
    .def = true,
    .doc = "Off leaves the cloth and its attachments out of the simulation. Keyed: while it is off the cloth stands "
           "still where it is, in the solver's space, its attachments let go and it touches nothing; when it comes on, "
           "it goes on from there at rest.",
    .looks_ahead = true,
};
const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "The sheet as modelled, in scene units, open or closed; its own vertices are simulated. It does not change "
           "over time. No edge may have more than two faces.",
};
const WireList<Material> materials{
    .name = "materials",
    .doc = "Material layers from bottom to top; one at least. Read are tensileStiffness, shearStiffness, "
           "bendStiffness, clothMassDensity, restScale, pressure, surfaceTension, envelope, weights and mesh.",
};
const Input<std::string> material{
    .name = "material",
    .def = "BaraffWitkin",
    .doc = "The law: stretch along warp and weft and shear between them, each linear, and bending about the edges. "
           "There is one.",
    .keyable = false,
    .affects = Affects::nothing,
    .options = {"BaraffWitkin"},
};
const Input<std::string> bend_rest_angle{
    .name = "bendRestAngle",
    .def = std::string(word_of(solver::BendRestAngle::mesh)),
    .doc = "At which angle between its faces the cloth does not want to bend: mesh, that of the mesh as modelled; or "
           "flat, none.",
    .keyable = false,
    .options = words(options_of<solver::BendRestAngle>),
};
const Input<Vec3> warp_direction{
    .name = "warpDirection",
    .def = {1, 0, 0},
    .unit = "1",
    .limits = within_reach,
    .doc = "Which way the warp runs: this direction of the modelled space, laid onto each face; the weft is square to "
           "it. A face that is square to it takes the next axis. Any length above 0.",
    .keyable = false,
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
    .doc = "Takes momentum out of the motion of the cloth as a whole: translation, rotation, shear and scaling. Finer "
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
    .doc = "Multiplies zMaterial.pressure, which pushes against the side that faces look to; below 0 it pushes the "
           "other way.",
};
const Input<double> surface_tension_envelope{
    .name = "surfaceTensionEnvelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = -1e6, .max = 1e6},
    .doc = "Multiplies zMaterial.surfaceTension; below 0 the cloth spreads.",
};
const Input<std::string> appearance = appearance_input(Matter::fascia);
const Input<Vec3> colour = colour_input({0.36, 0.5, 0.7});
const Output<Body> out_body{
    .name = "outBody",
    .doc = "The cloth, for zSolver.bodies and zAttachment.",
};

solver::Vec3 vector(const Reads& in, const Input<Vec3>& v) { return {in[v][0], in[v][1], in[v][2]}; }

std::shared_ptr<const BodyRest> make_rest(const Reads& in, const Mesh& modelled, const Layers& layers,
                                          const Digest& digest) {
    auto cloth = std::make_shared<solver::ClothRest>();
    solver::check_usable(modelled.surface());
    cloth->triangles = modelled.topology->triangles;
    cloth->surface = *modelled.points;
    cloth->warp = solver::warp_directions(cloth->surface, cloth->triangles, vector(in, warp_direction));
    cloth->bend_rest = meaning(options_of<solver::BendRestAngle>, in[bend_rest_angle]);
    for (std::size_t k = 0; k < layers.size(); ++k)
        cloth->layer_weights.push_back(per_vertex(painted_layer(modelled, layers, k), cloth->surface.size()));
    solver::check_cloth(*cloth, -1);
    auto rest = std::make_shared<BodyRest>();
    rest->data = std::shared_ptr<const solver::ClothRest>(std::move(cloth));
    rest->mesh = modelled;
    rest->digest = digest;
    return rest;
}

Digest static_digest(const Reads& in, const Mesh& modelled, const Layers& layers) {
    Hasher h;
    h.add("cloth").add(cloth_numerics).add(modelled.topology->digest).add(modelled.points_digest);
    h.add(in[bend_rest_angle]);
    for (const double c : in[warp_direction]) h.add(c);
    h.add(static_cast<std::uint64_t>(layers.size()));
    // The first layer covers everything, so what is painted on it and its mesh change nothing.
    for (std::size_t k = 1; k < layers.size(); ++k)
        h.add_doubles(layers[k].get().weights).add(layers[k].get().place_digest);
    return h.finish();
}

/// Tension T adds T times the area, which a shear of g radians lowers by T g^2 / 2 a square metre, while shearStiffness
/// asks for as much times itself; and k (s - 1)^2 + T s^2 of a stretch s both ways has no minimum where T is below -k.
void warn_of_tension(const Reads& in, const Layers& layers) {
    for (std::size_t k = 0; k < layers.size(); ++k) {
        const double tension = layers[k].get().surface_tension * in[surface_tension_envelope];
        const solver::ClothMaterial& m = layers[k].get().cloth;
        if (tension <= m.shear_stiffness && tension > -m.tensile_stiffness) continue;
        const bool folds = tension > 0;
        in.warn(materials.name, "FE316",
                "a surfaceTension of " + number_text(tension) + " N/m is more than " +
                    in.source_name(materials.name, k) + " bears: its " +
                    (folds ? "shearStiffness" : "tensileStiffness") + " is " +
                    number_text(folds ? m.shear_stiffness : m.tensile_stiffness) + " N/m, so the cloth " +
                    (folds ? "shears until no area is left where nothing stretches it" : "spreads without end"),
                folds ? "Keep surfaceTension below shearStiffness, or let restScale shrink the cloth."
                      : "Keep surfaceTension above minus tensileStiffness, or let restScale spread the cloth.");
    }
}

void compute(const Reads& in, Writes& out) {
    const Mesh& modelled = in[mesh];
    const auto given = in[materials];
    Layers layers;
    for (std::size_t k = 0; k < given.size(); ++k) layers.emplace_back(given[k]);
    if (layers.empty())
        in.fail(materials.name, "FE206", "a cloth without material has neither stiffness nor mass",
                "Connect a zMaterial's outMaterial to materials.");
    for (std::size_t k = 0; k < layers.size(); ++k)
        check_map(in, materials.name, layers[k].get().weights, modelled.points->size(),
                  "weights of " + in.source_name(materials.name, k), "vertex",
                  in.source_behind(materials.name, k, "weights"));
    if (vector(in, warp_direction).isZero(0))
        in.fail(warp_direction.name, "FE304", "warpDirection is zero, so the cloth has no warp",
                "Give it a length above 0; only where it points counts.");
    struct Kept {
        std::shared_ptr<const BodyRest> rest;
    };
    const Digest digest = static_digest(in, modelled, layers);
    auto kept = in.lease<Kept>(digest, [&] {
        return guarded(in, mesh.name,
                       [&] { return std::make_shared<Kept>(Kept{make_rest(in, modelled, layers, digest)}); });
    });
    solver::ClothInputs values;
    values.rest_scale_envelope = in[rest_scale_envelope];
    values.inertial_damping = in[inertial_damping];
    for (const Material& m : layers) values.layers.push_back(m.cloth);
    values.layers.front().envelope = 1; // the first layer covers everything
    guarded(in, materials.name, [&] { solver::check_cloth_values(values, -1); }, {{"FE247", rest_scale_envelope.name}});
    std::vector<Force> forces;
    add_pressure(in, modelled, layers, in[pressure_envelope], forces, false);
    add_surface_tension(in, modelled, layers, in[surface_tension_envelope], forces);
    warn_of_tension(in, layers);
    const solver::InitialMotion start{vector(in, initial_velocity), vector(in, initial_angular_velocity)};
    out.set(out_body, Body{kept->rest, in[enable], std::move(values), start, nullptr, std::move(forces),
                           read_contact(in, Collider::cloth, modelled, nullptr), nullptr, in.is_ever_on(enable)});
}

} // namespace

void add_z_cloth(Registry& registry) {
    NodeType type;
    type.name = "zCloth";
    type.numerics = cloth_numerics;
    type.doc =
        "A cloth or fascia: a sheet without thickness whose own vertices are simulated. It stretches, shears and "
        "bends.";
    type.inputs = {describe(enable),
                   describe(mesh),
                   describe(materials),
                   describe(material),
                   describe(bend_rest_angle),
                   describe(warp_direction),
                   describe(initial_velocity),
                   describe(initial_angular_velocity),
                   describe(inertial_damping),
                   describe(rest_scale_envelope),
                   describe(pressure_envelope),
                   describe(surface_tension_envelope),
                   describe(appearance),
                   describe(colour)};
    for (AttributeInfo& a : contact_attributes(Collider::cloth)) type.inputs.push_back(std::move(a));
    type.outputs = {describe(out_body)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
