// polyCube: a box of quads.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/made_mesh.h"
#include "solver/mesh/primitives.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<double> width{
    .name = "width",
    .def = 1,
    .limits = {.min = 0, .max = largest_length, .open_min = true},
    .doc = "Size along x, in scene units.",
};
const Input<double> height{
    .name = "height",
    .def = 1,
    .limits = {.min = 0, .max = largest_length, .open_min = true},
    .doc = "Size along y, in scene units.",
};
const Input<double> depth{
    .name = "depth",
    .def = 1,
    .limits = {.min = 0, .max = largest_length, .open_min = true},
    .doc = "Size along z, in scene units.",
};
const Input<std::int64_t> subdivisions_width{
    .name = "subdivisionsWidth",
    .def = 1,
    .limits = {.min = 1, .max = 4096},
    .doc = "Faces along x.",
    .keyable = false,
};
const Input<std::int64_t> subdivisions_height{
    .name = "subdivisionsHeight",
    .def = 1,
    .limits = {.min = 1, .max = 4096},
    .doc = "Faces along y.",
    .keyable = false,
};
const Input<std::int64_t> subdivisions_depth{
    .name = "subdivisionsDepth",
    .def = 1,
    .limits = {.min = 1, .max = 4096},
    .doc = "Faces along z.",
    .keyable = false,
};
const Output<Mesh> out_mesh{
    .name = "outMesh",
    .doc = "The mesh, centred on the origin, y up, in scene units.",
};

int count(std::int64_t n) { return static_cast<int>(n); }

void compute(const Reads& in, Writes& out) {
    const int w = count(in[subdivisions_width]), h = count(in[subdivisions_height]), d = count(in[subdivisions_depth]);
    const double faces = 2 * (double{1} * w * h + double{1} * h * d + double{1} * w * d);
    out.set(out_mesh, made_mesh(in, subdivisions_width.name, faces,
                                [&] { return solver::make_cube(in[width], in[height], in[depth], w, h, d); }));
}

} // namespace

void add_poly_cube(Registry& registry) {
    NodeType type;
    type.name = "polyCube";
    type.doc = "Makes a box.";
    type.inputs = {describe(width),
                   describe(height),
                   describe(depth),
                   describe(subdivisions_width),
                   describe(subdivisions_height),
                   describe(subdivisions_depth)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
