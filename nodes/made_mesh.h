// What the nodes that make meshes from numbers have in common: a size that can be had, and errors at the right input.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/adapters.h"
#include "solver/mesh/coordinates.h"

#include <cstdio>

namespace sinew::nodes {

/// Of what they make; so no vertex is farther out than meshes may be.
inline constexpr double largest_length = solver::largest_coordinate;

/// More faces than this are refused before any work: they would take gigabytes.
inline constexpr double most_faces = 1e7;

/// Fails with FE232 at `attribute` if there would be more than most_faces; else makes the mesh.
template <class Make>
Mesh made_mesh(const engine::Reads& in, std::string_view attribute, double faces, Make&& make) {
    if (faces > most_faces) {
        char text[80];
        std::snprintf(text, sizeof text, "the mesh would have %.3g faces; %.0e are possible", faces, most_faces);
        in.fail(attribute, "FE232", text, "Choose fewer subdivisions.");
    }
    return guarded(in, attribute, [&] { return Mesh::from(make()); });
}

} // namespace sinew::nodes
