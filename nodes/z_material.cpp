// zMaterial: one layer of what a tissue or cloth is made of.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "solver/meshing/layer_place.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> envelope{
    .name = "envelope",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Strength of this layer over those below it; times the weights. The first layer of a tissue "
           "covers all of "
           "it and ignores this.",
};
const Input<NumberList> weights{
    .name = "weights",
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Where this layer counts: one number per vertex of the tissue's mesh, one for all, or none for "
           "everywhere. "
           "The first layer of a tissue covers all of it and ignores this.",
};
const Wire<Mesh> mesh{
    .name = "mesh",
    .doc =
        "A closed mesh that says where this layer is, with a sharp border: an inclusion, a tendon, a pad of fat, "
        "modelled where the tissue is at rest, in scene units. Tets that its border passes through are split along it; "
        "where it bends within a tet's width, a tet takes the mean by volume. Parts may overlap, and a shell inside "
        "another one bounds a hollow. Let it reach to the skin or beyond where the layer does. Weights multiply it: "
        "the mesh says where, they how much. Pressure and surface tension "
        "count at the vertices of the tissue's mesh that lie in it or on it. It must not change over time. The first "
        "layer of a tissue covers all of it and ignores this, with a warning.",
    .required = false,
};
const Input<double> youngs_modulus{
    .name = "youngsModulus",
    .def = 12e3,
    .unit = "Pa",
    .limits = {.min = 0, .max = 1e13, .open_min = true},
    .doc = "Stiffness: the stress that a small stretch by 100 % would need.",
    .presets = {{"gelatin", 1},
                {"brain", 500},
                {"liver", 700},
                {"breast", 900},
                {"fat", 3e3},
                {"smoothMuscle", 5e3},
                {"skeletalMuscle", 12e3},
                {"cartilage", 2e4},
                {"rubber", 1e7},
                {"wood", 6e8},
                {"tendon", 1e9},
                {"plastic", 1.5e9},
                {"bone", 1.4e10},
                {"walnutShell", 1.5e10},
                {"steel", 2e11},
                {"diamond", 1e12}},
};
const Input<double> poissons_ratio{
    .name = "poissonsRatio",
    .def = 0.4,
    .unit = "1",
    .limits = {.min = -1, .max = 0.5, .open_min = true, .open_max = true},
    .doc = "How much the tissue thins when it is stretched; towards 0.5 it keeps its volume, best kept below "
           "0.45.",
};
const Input<double> mass_density{
    .name = "massDensity",
    .def = 1060,
    .unit = "kg/m^3",
    .limits = {.min = 0, .max = 1e13, .open_min = true},
    .doc = "Mass per volume.",
};
const Input<double> volume_conservation{
    .name = "volumeConservation",
    .def = 0,
    .unit = "Pa",
    .limits = {.min = 0, .max = 1e20},
    .doc = "Resists changes of volume in both directions, whatever Young's modulus is; useful from a hundred to ten "
           "million times it. Bending stays free: the volume is kept on average over a few tets, not in each.",
};
const Input<double> rest_scale{
    .name = "restScale",
    .def = 1,
    .unit = "1",
    .limits = {.min = 0, .max = 1000, .open_min = true},
    .doc = "Scales the shape in which the tissue is at rest, alike in all directions: 0.8 shrinks it to 80 % of its "
           "lengths, without stress where nothing is in the way. Painted by the layer's weights and mesh, into the "
           "volume. Its mass stays. To change it over time, key zTissue.restScaleEnvelope.",
    .keyable = false,
};
const Input<double> pressure{
    .name = "pressure",
    .def = 0,
    .unit = "Pa",
    .limits = {.min = -1e13, .max = 1e13},
    .doc = "Pushes the deformed surface inwards along its normal, or outwards where it is negative; faces must look "
           "outwards. "
           "Painted by the "
           "layer's weights and mesh on the surface alone. To change it over time, key zTissue.pressureEnvelope.",
    .keyable = false,
};
const Input<double> surface_tension{
    .name = "surfaceTension",
    .def = 0,
    .unit = "N/m",
    .limits = {.min = -1e13, .max = 1e13},
    .doc =
        "Pulls the deformed surface together like the skin of a drop: rounds edges and presses with twice itself over "
        "the radius. Negative spreads it. Painted by the layer's weights and mesh on the surface alone. To change it "
        "over time, "
        "key zTissue.surfaceTensionEnvelope.",
    .keyable = false,
};
const Input<double> tensile_stiffness{
    .name = "tensileStiffness",
    .def = 5e3,
    .unit = "N/m",
    .limits = {.min = 0, .max = 1e12},
    .doc = "Cloth only: the force per width that a stretch by 100 % along warp or weft would need.",
};
const Input<double> shear_stiffness{
    .name = "shearStiffness",
    .def = 500,
    .unit = "N/m",
    .limits = {.min = 0, .max = 1e12},
    .doc = "Cloth only: resists that the angle between warp and weft changes, as force per width and radian for small "
           "angles.",
};
const Input<double> bend_stiffness{
    .name = "bendStiffness",
    .def = 1e-5,
    .unit = "N*m",
    .limits = {.min = 0, .max = 1e12},
    .doc = "Cloth only: resists bending, as moment per width and curvature, so that it means the same on a finer mesh.",
};
const Input<double> cloth_mass_density{
    .name = "clothMassDensity",
    .def = 0.1,
    .unit = "kg/m^2",
    .limits = {.min = 0, .max = 1e13, .open_min = true},
    .doc = "Cloth only: mass per area.",
};
const Output<Material> out_material{.name = "outMaterial",
                                    .doc = "The layer; connect to zTissue.materials or zCloth.materials."};

/// Prepared once for all frames.
void set_place(const Reads& in, Material& m) {
    const Mesh* shape = in.find(mesh);
    if (!shape) return;
    struct Kept {
        std::shared_ptr<const solver::Solid> place;
    };
    m.place_digest = Hasher().add("zMaterial.mesh").add(shape->topology->digest).add(shape->points_digest).finish();
    auto kept = in.lease<Kept>(m.place_digest, [&] {
        return guarded(in, mesh.name, [&] {
            return std::make_shared<Kept>(Kept{std::make_shared<const solver::Solid>(
                solver::make_layer_place(*shape->points, shape->topology->triangles, meshing_control(in)))});
        });
    });
    m.place = kept->place;
}

void compute(const Reads& in, Writes& out) {
    Material m;
    m.values = {in[youngs_modulus], in[poissons_ratio],      in[mass_density],
                in[envelope],       in[volume_conservation], in[rest_scale]};
    m.cloth = {in[tensile_stiffness],  in[shear_stiffness], in[bend_stiffness],
               in[cloth_mass_density], in[envelope],        in[rest_scale]};
    m.weights = in[weights];
    set_place(in, m);
    m.pressure = in[pressure];
    m.surface_tension = in[surface_tension];
    out.set(out_material, std::move(m));
}

} // namespace

void add_z_material(Registry& registry) {
    NodeType type;
    type.name = "zMaterial";
    type.doc =
        "A material layer of a tissue or cloth; several are laid over each other, the first at the bottom. A cloth "
        "does not read youngsModulus, poissonsRatio, massDensity and volumeConservation, a tissue none of those "
        "that are of cloth only.";
    type.inputs = {describe(envelope),
                   describe(weights),
                   describe(mesh),
                   describe(youngs_modulus),
                   describe(poissons_ratio),
                   describe(mass_density),
                   describe(volume_conservation),
                   describe(rest_scale),
                   describe(pressure),
                   describe(surface_tension),
                   describe(tensile_stiffness),
                   describe(shear_stiffness),
                   describe(bend_stiffness),
                   describe(cloth_mass_density)};
    type.outputs = {describe(out_material)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
