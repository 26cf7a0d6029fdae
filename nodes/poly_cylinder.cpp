// polyCylinder: a closed cylinder along y.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/made_mesh.h"
#include "solver/mesh/primitives.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> radius{
    .name = "radius",
    .def = 1,
    .limits = {.min = 0, .max = largest_length, .open_min = true},
    .doc = "Radius, in scene units.",
};
const Input<double> height{
    .name = "height",
    .def = 2,
    .limits = {.min = 0, .max = largest_length, .open_min = true},
    .doc = "Size along y, in scene units.",
};
const Input<std::int64_t> subdivisions_axis{
    .name = "subdivisionsAxis",
    .def = 20,
    .limits = {.min = 3, .max = 4096},
    .doc = "Faces around the axis.",
    .keyable = false,
};
const Input<std::int64_t> subdivisions_height{
    .name = "subdivisionsHeight",
    .def = 1,
    .limits = {.min = 1, .max = 4096},
    .doc = "Rows of faces along y.",
    .keyable = false,
};
const Input<std::int64_t> subdivisions_caps{
    .name = "subdivisionsCaps",
    .def = 1,
    .limits = {.min = 0, .max = 4096},
    .doc = "Rings of faces on each end; 0 leaves one polygon.",
    .keyable = false,
};
const Output<Mesh> out_mesh{
    .name = "outMesh",
    .doc = "The mesh, centred on the origin, y up, in scene units.",
};

int count(std::int64_t n) { return static_cast<int>(n); }

void compute(const Reads& in, Writes& out) {
    const int around = count(in[subdivisions_axis]), rows = count(in[subdivisions_height]),
              caps = count(in[subdivisions_caps]);
    out.set(out_mesh, made_mesh(in, subdivisions_axis.name, double{1} * around * (rows + 2.0 * caps),
                                [&] { return solver::make_cylinder(in[radius], in[height], around, rows, caps); }));
}

} // namespace

void add_poly_cylinder(Registry& registry) {
    NodeType type;
    type.name = "polyCylinder";
    type.doc = "Makes a closed cylinder along y.";
    type.inputs = {describe(radius), describe(height), describe(subdivisions_axis), describe(subdivisions_height),
                   describe(subdivisions_caps)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
