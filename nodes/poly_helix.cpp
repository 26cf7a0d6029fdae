// polyHelix: a closed tube wound about y.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/made_mesh.h"
#include "solver/mesh/primitives.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> coils{
    .name = "coils",
    .def = 3,
    .limits = {.min = 0, .max = 1e9, .open_min = true},
    .doc = "Number of turns.",
};
const Input<double> height{
    .name = "height",
    .def = 2,
    .limits = {.min = 0, .max = largest_length},
    .doc = "Rise of the tube's centre line along y, in scene units.",
};
const Input<double> width{
    .name = "width",
    .def = 2,
    .limits = {.min = 0, .max = largest_length, .open_min = true},
    .doc = "Diameter of the centre line, in scene units.",
};
const Input<double> radius{
    .name = "radius",
    .def = 0.25,
    .limits = {.min = 0, .max = largest_length, .open_min = true},
    .doc = "Radius of the tube, in scene units. Turns cross each other from about half of height / coils on.",
};
const Input<std::int64_t> subdivisions_axis{
    .name = "subdivisionsAxis",
    .def = 8,
    .limits = {.min = 3, .max = 4096},
    .doc = "Faces around the tube.",
    .keyable = false,
};
const Input<std::int64_t> subdivisions_coil{
    .name = "subdivisionsCoil",
    .def = 50,
    .limits = {.min = 1, .max = 4096},
    .doc = "Rows of faces along one turn.",
    .keyable = false,
};
const Output<Mesh> out_mesh{
    .name = "outMesh",
    .doc = "The mesh, centred on the origin, y up, in scene units.",
};

int count(std::int64_t n) { return static_cast<int>(n); }

void compute(const Reads& in, Writes& out) {
    const int around = count(in[subdivisions_axis]), rows = count(in[subdivisions_coil]);
    if (!(in[radius] < in[width] / 2))
        in.fail(radius.name, "FE222", "the tube must be thinner than the helix is wide",
                "Choose a radius below half of width.");
    if (in[coils] * rows > 1e6)
        in.fail(coils.name, "FE222", "the helix would have over a million rows of faces",
                "Choose fewer coils, or fewer subdivisions of each.");
    out.set(out_mesh, made_mesh(in, subdivisions_axis.name, in[coils] * rows * around, [&] {
                return solver::make_helix(in[width] / 2, in[radius], in[height], in[coils], around, rows);
            }));
}

} // namespace

void add_poly_helix(Registry& registry) {
    NodeType type;
    type.name = "polyHelix";
    type.doc = "Makes a closed tube that winds about y.";
    type.inputs = {describe(coils),
                   describe(height),
                   describe(width),
                   describe(radius),
                   describe(subdivisions_axis),
                   describe(subdivisions_coil)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
