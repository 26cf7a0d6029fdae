// polyPlane: a flat sheet of quads that faces up.
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
    .doc = "Size along z, in scene units.",
};
const Input<std::int64_t> subdivisions_width{
    .name = "subdivisionsWidth",
    .def = 10,
    .limits = {.min = 1, .max = 4096},
    .doc = "Faces along x.",
    .keyable = false,
};
const Input<std::int64_t> subdivisions_height{
    .name = "subdivisionsHeight",
    .def = 10,
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
    const int w = count(in[subdivisions_width]), h = count(in[subdivisions_height]);
    out.set(out_mesh, made_mesh(in, subdivisions_width.name, double{1} * w * h,
                                [&] { return solver::make_plane(in[width], in[height], w, h); }));
}

} // namespace

void add_poly_plane(Registry& registry) {
    NodeType type;
    type.name = "polyPlane";
    type.doc = "Makes a flat sheet in the xz plane that faces up.";
    type.inputs = {describe(width), describe(height), describe(subdivisions_width), describe(subdivisions_height)};
    type.outputs = {describe(out_mesh)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
