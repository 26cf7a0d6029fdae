// A tet mesh whose tets come and go: what improvement and boundary recovery share.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"

#include <optional>

namespace sinew::solver {

/// The faces of a tet, each seen from outside and followed by the corner across; its edges.
inline constexpr std::array<std::array<std::size_t, 4>, 4> tet_faces{
    {{1, 2, 3, 0}, {0, 3, 2, 1}, {0, 1, 3, 2}, {0, 2, 1, 3}}};
inline constexpr std::array<std::array<std::size_t, 2>, 6> tet_edges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

inline bool has_corner(const Tet& t, int v) { return t[0] == v || t[1] == v || t[2] == v || t[3] == v; }

class TetComplex {
  public:
    static constexpr int longest_ring = 9;

    TetComplex(Points vertices, std::vector<Tet> tets);

    Points vertices;
    std::vector<std::vector<int>> tets_of; ///< of each vertex, living ones

    std::size_t count() const { return tets_.size(); } ///< living and dead
    const Tet& tet(int t) const { return tets_[static_cast<std::size_t>(t)]; }
    bool is_alive(int t) const { return alive_[static_cast<std::size_t>(t)] != 0; }
    std::vector<Tet> living() const;

    int add_vertex(const Vec3& p);
    /// Takes the last vertex away; no living tet may use it.
    void drop_last_vertex();
    /// Takes old tets out and puts fresh ones in; gives the numbers of these.
    std::vector<int> replace(const std::vector<int>& old, const std::vector<Tet>& fresh);

    /// The tets around edge ab and the vertices of the ring about it, in order.
    struct Ring {
        int a, b;
        std::vector<int> tets, vertices;
    };
    /// None if there is no such edge, it lies in the boundary, or its ring is too long.
    std::optional<Ring> ring_of(int a, int b) const;
    /// The tet beside t that has the corners a, b, c too; -1 if there is none.
    int beside(int t, int a, int b, int c) const;
    bool has_edge(int a, int b) const;
    bool has_face(int a, int b, int c) const;

  private:
    std::vector<Tet> tets_;
    std::vector<char> alive_;
};

} // namespace sinew::solver
