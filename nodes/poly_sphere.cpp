// polySphere: a sphere of quads with triangle fans at the poles.
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
const Input<std::int64_t> subdivisions_axis{
    .name = "subdivisionsAxis",
    .def = 20,
    .limits = {.min = 3, .max = 4096},
    .doc = "Faces around the axis.",
    .keyable = false,
};
const Input<std::int64_t> subdivisions_height{
    .name = "subdivisionsHeight",
    .def = 20,
    .limits = {.min = 2, .max = 4096},
    .doc = "Rows of faces from pole to pole.",
    .keyable = false,
};
const Output<Mesh> out_mesh{
    .name = "outMesh",
    .doc = "The mesh, centred on the origin, y up, in scene units.",
};

int count(std::int64_t n) { return static_cast<int>(n); }

void compute(const Reads& in, Writes& out) {
    const int around = count(in[subdivisions_axis]), rows = count(in[subdivisions_height]);
    out.set(out_mesh, made_mesh(in, subdivisions_axis.name, double{1} * around * rows,
                                [&] { return solver::make_sphere(in[radius], around, rows); }));
}

} // namespace

void add_poly_sphere(Registry& registry) {
    NodeType type;
    type.name = "polySphere";
    type.doc = "Makes a sphere; 20 by 20 gives 382 vertices and 400 faces.";
    type.inputs = {describe(radius), describe(subdivisions_axis), describe(subdivisions_height)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
