// endPoints: where a muscle's fibres begin and end, from two painted maps.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"

#include <algorithm>
#include <utility>

namespace sinew::nodes {

using namespace engine;

namespace {

const Wire<Mesh> mesh{.name = "mesh", .doc = "The muscle's mesh."};
const Input<NumberList> source{
    .name = "source",
    .limits = within_reach,
    .doc = "Painted map of the end where the fibres begin: above 0.5 belongs to it.",
    .required = true,
};
const Input<NumberList> sink{
    .name = "sink",
    .limits = within_reach,
    .doc = "Painted map of the end where the fibres end: above 0.5 belongs to it; not on a "
           "vertex of the source.",
    .required = true,
};
const Output<NumberList> out_end_points{
    .name = "outEndPoints",
    .doc = "Per vertex 0 at the source, 1 at the sink, 0.5 elsewhere; connect to "
           "zFiber.endPoints.",
};

void compute(const Reads& in, Writes& out) {
    const std::size_t count = in[mesh].points->size();
    check_map(in, source.name, in[source], count, "the source map", "vertex", in.source_name(source.name));
    check_map(in, sink.name, in[sink], count, "the sink map", "vertex", in.source_name(sink.name));
    const NumberList begin = per_vertex(in[source], count), end = per_vertex(in[sink], count);
    const auto is_painted = [](double w) { return w > 0.5; };
    for (const auto& [input, map] : {std::pair(source.name, &begin), std::pair(sink.name, &end)})
        if (count > 0 && std::none_of(map->begin(), map->end(), is_painted))
            in.warn(input, "FE335",
                    "no number of " + (in.source_name(input).empty() ? std::string(input) : in.source_name(input)) +
                        " is above 0.5, so the fibres have no " + std::string(input),
                    "Paint the end of the muscle there.");
    NumberList ends(count, 0.5);
    for (std::size_t v = 0; v < count; ++v) {
        if (begin[v] > 0.5 && end[v] > 0.5)
            in.fail(sink.name, "DG110", "vertex " + std::to_string(v) + " belongs to both source and sink",
                    "Keep the two ends apart.");
        if (begin[v] > 0.5) ends[v] = 0;
        if (end[v] > 0.5) ends[v] = 1;
    }
    out.set(out_end_points, std::move(ends));
}

} // namespace

void add_end_points(Registry& registry) {
    NodeType type;
    type.name = "endPoints";
    type.doc = "Marks both ends of a muscle's fibres from two painted maps.";
    type.inputs = {describe(mesh), describe(source), describe(sink)};
    type.outputs = {describe(out_end_points)};
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
