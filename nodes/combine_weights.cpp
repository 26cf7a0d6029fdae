// combineWeights: several painted maps of one mesh made one, turned over and smoothed.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/options.h"
#include "nodes/painted_maps.h"

#include <algorithm>
#include <cmath>

namespace sinew::nodes {

using namespace engine;

namespace {

enum class Rule { multiply, min, max };
constexpr Option<Rule> rules[] = {{"multiply", Rule::multiply}, {"min", Rule::min}, {"max", Rule::max}};

const WireList<NumberList> maps{
    .name = "weights",
    .doc = "The maps, all of one mesh: as many numbers each, or one number for all.",
    .min_count = 1,
};
const Input<std::string> mode{
    .name = "mode",
    .def = "multiply",
    .doc = "multiply or min: where all of them are painted; max: where any of them is.",
    .options = words(rules),
};
const Input<bool> invert{
    .name = "invert",
    .def = false,
    .doc = "Takes 1 minus the combined weight.",
    .keyable = false,
};
const Input<std::int64_t> smooth{
    .name = "smooth",
    .def = 0,
    .limits = {.min = 0, .max = 1000},
    .doc = "How often each weight goes half of the way to the mean of its neighbours, last of all; needs mesh.",
    .keyable = false,
};
const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "smooth: the mesh that the maps paint.",
    .required = false,
};
const Input<std::string> on{
    .name = "on",
    .def = "vertices",
    .doc = "smooth: what the maps count, vertices, which are neighbours along edges, or faces, across them.",
    .options = words(options_of<solver::PaintedOn>),
};
const Output<NumberList> out_weights{
    .name = "outWeights",
    .doc = "One number per vertex or face, 0 to 1.",
    .unit = "1",
};

double combined(Rule rule, double a, double b) {
    if (rule == Rule::multiply) return a * b;
    return rule == Rule::min ? std::min(a, b) : std::max(a, b);
}

NumberList combined(const Reads& in) {
    const auto all = in[maps];
    std::size_t count = 1;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const NumberList& map = all[i];
        const std::string name = in.source_name(maps.name, i);
        if (map.empty()) in.fail(maps.name, "FE204", name + " gives no numbers", "Give one for all, or one each.");
        if (map.size() > 1 && count > 1 && map.size() != count)
            in.fail(maps.name, "FE204",
                    name + " gives " + std::to_string(map.size()) + " numbers, the maps before it " +
                        std::to_string(count),
                    "Paint one mesh in all of them, and vertices or faces.");
        count = std::max(count, map.size());
        if (!std::all_of(map.begin(), map.end(), [](double w) { return std::isfinite(w); }))
            in.fail(maps.name, "FE202", name + " gives a number that is not finite", "Repair the map.");
    }
    NumberList out = per_vertex(all.front(), count);
    const Rule rule = meaning(rules, in[mode]);
    for (std::size_t i = 1; i < all.size(); ++i) {
        const NumberList map = per_vertex(all[i], count);
        for (std::size_t v = 0; v < count; ++v) out[v] = combined(rule, out[v], map[v]);
    }
    for (double& w : out) w = std::clamp(in[invert] ? 1 - w : w, 0.0, 1.0);
    return out;
}

NumberList smoothed(const Reads& in, NumberList map) {
    const Mesh* m = in.find(mesh);
    if (!m) in.fail(mesh.name, "DG110", "smooth needs the mesh that is painted", "Connect mesh.");
    const bool by_faces = meaning(options_of<solver::PaintedOn>, in[on]) == solver::PaintedOn::faces;
    const std::size_t count = by_faces ? m->topology->face_sizes.size() : m->points->size();
    check_map(in, maps.name, map, count, "the combined map", by_faces ? "face" : "vertex");
    if (map.size() == 1) return map; // the same everywhere
    return smooth_map(std::move(map), by_faces ? face_neighbours(*m->topology) : vertex_neighbours(*m->topology, count),
                      static_cast<int>(in[smooth]));
}

void compute(const Reads& in, Writes& out) {
    NumberList map = combined(in);
    out.set(out_weights, in[smooth] > 0 ? smoothed(in, std::move(map)) : map);
}

} // namespace

void add_combine_weights(Registry& registry) {
    NodeType type;
    type.name = "combineWeights";
    type.doc = "Makes one painted map of several: where all are, where any is, where none is; and smooths it.";
    type.inputs = {describe(maps), describe(mode), describe(invert), describe(smooth), describe(mesh), describe(on)};
    type.outputs = {describe(out_weights)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
