// One point and one triangle, or two edges, and what carries them: the way from derivatives by the four corners to
// those by unknowns.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/numbering.h"
#include "solver/term/carried_surface.h"
#include "solver/term/point_triangle.h"

#include <vector>

namespace sinew::solver {

class PointTriangleElement {
  public:
    /// Makes it stand for a point, which rides as given, and a triangle; nothing where it does already: the ride is one
    /// that a surface keeps, and tells points of all bodies apart.
    void set(std::span<const RideTerm> ride, const CarriedSurface& target, int triangle, const Numbering& numbering,
             const BlockPattern& pattern);
    /// The same as far as add_gradient needs it: where entries of the pattern are is not looked for.
    void set_nodes(std::span<const RideTerm> ride, const CarriedSurface& target, int triangle,
                   const Numbering& numbering);
    /// Makes it stand for four corners that ride as given, of which the first `split` are one side, a point (1) or an
    /// edge (2), and the others the other.
    void set(const std::array<std::span<const RideTerm>, 4>& rides, int split, const Numbering& numbering,
             const BlockPattern& pattern);
    /// Forgets which entries of the pattern it writes to.
    void forget() { triangle_ = -1, has_entries_ = false; }

    /// Adds L_c g to each vertex that carries corner c: a gradient of 3 numbers a vertex.
    void add_gradient(const std::array<double, 4>& by_corners, const Vec3& g, double* by_vertices) const;
    /// Whether the pattern couples all that it does.
    bool coupled() const { return coupled_; }
    /// Adds blocks by corners times a factor: to the pattern's blocks those among what carries the point and those
    /// among what carries the triangle, or one of its corners, as far as the pattern couples them; the others to the
    /// overlay.
    void add_hessian(const PointTriangleBlocks& blocks, double factor, BlockMatrix& a) const;
    /// The diagonal that the matrix has where the two sides are, mean over directions and weighed by `by_corners` and
    /// what carries them [N/m]; 0 where it is held.
    std::array<double, 2> stiffness_below(const std::array<double, 4>& by_corners, const BlockMatrix& a) const;

  private:
    struct Node {
        int corner, vertex, unknown; ///< unknown = -1: held
        double weight;
    };
    struct Entry {
        int block;       ///< of the pattern
        int row, column; ///< nodes
    };
    void take_nodes(const std::array<std::span<const RideTerm>, 4>& rides, const Numbering& numbering);
    void find_entries(const BlockPattern& pattern);
    const RideTerm* ride_ = nullptr; ///< of the point, where surfaces keep it; null: nothing that is free carries it
    const CarriedSurface* target_ = nullptr;
    int triangle_ = -1, split_ = 1;
    std::vector<Node> nodes_;
    std::vector<Entry> entries_;
    std::array<int, 4> group_{}; ///< per corner: those of one group are coupled in the pattern
    std::vector<Overlay::Carrier> free_;
    bool coupled_ = true;
    bool has_entries_ = false; ///< whether they are those of the nodes
};

} // namespace sinew::solver
