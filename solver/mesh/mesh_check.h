// What is wrong with a triangle mesh: counts and the first places of each kind of flaw.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

#include <array>
#include <string>
#include <vector>

namespace sinew::solver {

/// How often a flaw occurs, and where first. Places are vertices, triangles, or edges by their two vertices,
/// in rising order.
struct Flaw {
    static constexpr std::size_t most_places = 5;
    std::size_t count = 0;
    std::vector<int> first;                ///< vertices or triangles
    std::vector<std::array<int, 2>> edges; ///< edges, or pairs of triangles
    bool is_whole = true;                  ///< false: there may be more, only so much was looked at
    explicit operator bool() const { return count > 0; }
    void add(int place);
    void add(int a, int b);
};

struct MeshCheck {
    Flaw open_edges;            ///< edges with one triangle
    Flaw non_manifold_edges;    ///< edges with more than two
    Flaw badly_oriented_edges;  ///< two triangles that run the same way along their edge
    Flaw non_manifold_vertices; ///< vertices whose triangles are not one fan (or one half fan at a border)
    Flaw degenerate_triangles;  ///< two corners at one vertex or place, or area below rounding
    Flaw duplicate_triangles;   ///< with the corners of an earlier triangle, in any order
    Flaw coinciding_vertices;   ///< at the place of an earlier vertex
    Flaw unused_vertices;       ///< of no triangle
    Flaw inside_out_parts;      ///< parts of a closed mesh with negative volume, outside of all others: their first
                                ///< triangles. Parts within others may be cavities
    Flaw flat_tets;             ///< of a tet mesh; only flat_tets() looks for them
    Flaw crossing_triangles;    ///< pairs that cross or overlap; only inspect_mesh looks for them
    /// Closed once vertices at one place are one, of repeated triangles one is left, and triangles are turned alike:
    /// what the makers of tets and iso meshes go by. Only inspect_mesh finds out.
    bool encloses = false;
    std::size_t components = 0; ///< of triangles joined over edges
    double volume = 0;          ///< enclosed volume, negative if the mesh is inside out; meaningless if open

    /// Every edge has exactly two triangles, which run along it in opposite directions.
    bool is_closed() const { return !open_edges && !non_manifold_edges && !badly_oriented_edges; }
    /// Every edge has at most two triangles and every vertex one fan.
    bool is_manifold() const { return !non_manifold_edges && !non_manifold_vertices; }
};

/// Indices must be in range (Error FE203 else). Time grows with n log n. For self-intersections
/// there is inspect_mesh in solver/meshing/self_intersections.h.
MeshCheck check_mesh(const Points& points, const std::vector<Triangle>& triangles);

/// Tets with a dihedral angle below 1 or above 179 degrees.
Flaw flat_tets(const TetMesh& mesh);

/// "12 open edges (3-4, 7-9, …)": the flaw with its first places; empty if there is none.
std::string describe(const Flaw& flaw, const std::string& singular, const std::string& plural);

/// Smallest angle of all triangles in degrees; 180 without triangles.
double least_angle(const Points& points, const std::vector<Triangle>& triangles);

} // namespace sinew::solver
