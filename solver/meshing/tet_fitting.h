// Tets on their way of being fitted to the borders of layers (layer_border.h): how one smooth part of a border is
// taken.
//   tet_fitting.cpp   what the border crosses, splits, what is solid     border_vertices.cpp   where vertices go
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/border_patches.h"
#include "solver/meshing/layer_border.h"

#include <map>
#include <optional>

namespace sinew::solver {

class TetFitting {
  public:
    TetFitting(const TetMesh& tets, const Points& surface, const std::vector<Triangle>& triangles,
               const MeshingControl& control);
    /// Whether the surface cuts the tets as they say.
    bool is_sound() const { return is_sound_; }
    /// Fits the tets to a patch, which must outlive the fitting.
    void fit(const BorderPatch& patch);
    /// The tets. `patches`: all that they were fitted to, by place.
    FittedTets result(const std::vector<std::vector<BorderPatch>>& patches) const;

  private:
    struct Piece {
        Tet tet;
        int parent;
        double coverage;
        std::vector<double> moments; ///< empty where the surface cuts nothing off
        bool changed = false;        ///< coverage and moments are those of another shape
    };

    std::array<Vec3, 4> corners(const Tet& tet) const { return corners_of(vertices_, tet); }
    double solid_share(const std::array<Vec3, 4>& c) const { return closed_share(*tissue_, c, skin_->touching(c)); }
    bool find_sound() const;
    /// Whether a patch was taken at a vertex: that which has this number.
    bool is_on(int v, int number) const {
        return std::binary_search(borders_[at(v)].begin(), borders_[at(v)].end(), number);
    }
    void touch(int v, int number) {
        std::vector<int>& list = borders_[at(v)];
        if (list.empty() || list.back() != number) list.push_back(number);
    }

    /// Tets through whose solid part the patch runs.
    void find_crossed(const BorderPatch& patch);
    bool runs_inside(const BarycentricPolygon& part, const std::array<Vec3, 4>& c, bool is_cut) const;
    /// Whether some of a triangle in a tet with edges of this length lies inside the tissue and off its skin.
    bool is_inside(const std::array<Vec3, 3>& triangle, double length, int depth) const;
    /// Of some vertices the pieces about them, and the mesh's boundary there.
    void find_stars(const std::vector<char>& wanted);
    void find_heights(const BorderPatch& patch);
    /// Where the patch cuts the edges of crossed tets.
    void find_edges(const BorderPatch& patch);
    /// Vertices near the patch go onto it where they may.
    void move_vertices(const BorderPatch& patch, int number);
    /// The place nearest to a vertex on the patch, and on all parts of the border that it lies on.
    Vec3 foot(int v, const BorderPatch& patch) const;
    /// Whether a vertex may go there, along an edge to another one or (`along` = v) within what it lies on: tets stay
    /// this good (tet_quality), or half as good as they were.
    bool may_move(int v, const Vec3& to, int along, double quality) const;
    void move(int v, const Vec3& to);
    void split_edges(int number);
    /// Flat sides of tets that end on a curved border lie on one side of it. So their vertices go over it, until the
    /// sides have as much of it on the one as on the other: then volumes are right.
    void balance(const BorderPatch& patch, int number);
    /// Of changed tets, what is solid.
    void measure_changed();
    /// What a tet's flat sides leave of a patch that its vertices lie on, per volume of the tet.
    double slack(const Tet& tet, const BorderPatch& patch, int number) const;

    Points vertices_;
    std::vector<std::vector<int>> borders_; ///< of each vertex: patches that it lies on, increasing
    std::vector<Piece> pieces_;
    int degree_;
    bool knows_coverage_, is_sound_ = false;
    std::vector<const BorderPatch*> patches_; ///< by number
    std::shared_ptr<const Solid> tissue_;     ///< where tets are solid in part
    std::optional<TriangleFinder> skin_;
    // of the patch in hand
    std::vector<std::size_t> crossed_;
    std::vector<std::vector<int>> stars_;        ///< pieces about a vertex
    std::vector<Points> sides_;                  ///< of each vertex: normals of the mesh's boundary there
    std::map<int, double> heights_;              ///< of the crossed tets' vertices
    std::map<std::array<int, 2>, double> edges_; ///< that the patch cuts, and where
};

} // namespace sinew::solver
