// The list of all targets.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/targets/targets.h"

#include <algorithm>

namespace sinew::fuzz {

namespace {

using Bytes = std::string_view;

constexpr Target targets[] = {
    {"graph", read_graph_text},
    {"includes", read_included_graphs},
    {"obj", [](Bytes b) { read_surface_as(b, "a.obj"); }},
    {"off", [](Bytes b) { read_surface_as(b, "a.off"); }},
    {"ply", [](Bytes b) { read_surface_as(b, "a.ply"); }},
    {"stl", [](Bytes b) { read_surface_as(b, "a.stl"); }},
    {"glb", read_glb_file},
    {"medit", [](Bytes b) { read_tets_as(b, "a.mesh"); }},
    {"vtk", [](Bytes b) { read_tets_as(b, "a.vtk"); }},
    {"gmsh", [](Bytes b) { read_tets_as(b, "a.msh"); }},
    {"veg", [](Bytes b) { read_tets_as(b, "a.veg"); }},
    {"tetgen", read_tetgen_files},
    {"pc2", [](Bytes b) { read_point_cache_as(b, "a.pc2"); }},
    {"mdd", [](Bytes b) { read_point_cache_as(b, "a.mdd"); }},
    {"motion", read_motion},
    {"curve", read_curve_file},
    {"map", read_painted_map},
    {"kept", read_kept_value},
    {"frame", read_kept_frame},
    {"rows", read_kept_rows},
    {"state", read_saved_state},
};

} // namespace

std::span<const Target> all_targets() { return targets; }

const Target* find_target(std::string_view name) {
    const auto at =
        std::find_if(std::begin(targets), std::end(targets), [&](const Target& t) { return t.name == name; });
    return at == std::end(targets) ? nullptr : at;
}

std::vector<std::string_view> files_in(std::string_view bytes) {
    constexpr std::string_view between = "\n%%%%\n";
    std::vector<std::string_view> out;
    while (true) {
        const std::size_t end = bytes.find(between);
        out.push_back(bytes.substr(0, end));
        if (end == bytes.npos) return out;
        bytes.remove_prefix(end + between.size());
    }
}

} // namespace sinew::fuzz
