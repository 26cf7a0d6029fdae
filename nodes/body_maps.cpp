// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/body_maps.h"

#include "nodes/adapters.h"
#include "nodes/options.h"

namespace sinew::nodes {

using namespace engine;

NumberList painted_map(const Reads& in, const Input<NumberList>& map, const Input<std::string>& on, const Body& body,
                       const std::string& name) {
    const MeshTopology& topology = *body.rest->mesh.topology;
    const bool by_faces = meaning(options_of<solver::PaintedOn>, in[on]) == solver::PaintedOn::faces;
    const std::size_t vertices = body.rest->mesh.points->size(), faces = topology.face_sizes.size(),
                      count = by_faces ? faces : vertices;
    const NumberList& given = in[map];
    if (given.size() > 1 && given.size() != count && given.size() == (by_faces ? vertices : faces))
        in.fail(map.name, "FE204",
                std::string(map.name) + " for " + name + ": " + std::to_string(given.size()) +
                    " numbers, as many as the mesh has " + (by_faces ? "vertices" : "faces") + ", for its " +
                    std::to_string(count) + (by_faces ? " faces" : " vertices"),
                "Set " + std::string(on.name) + " to " + (by_faces ? "vertices" : "faces") + ".");
    check_map(in, map.name, given, count, std::string(map.name) + " for " + name, by_faces ? "face" : "vertex",
              in.source_name(map.name));
    const NumberList each = per_vertex(given, count);
    return by_faces ? per_triangle(topology, each) : each;
}

} // namespace sinew::nodes
