// Points that ride on vertices, each on one vertex or on those of a tet, and the way back: gradients and Hessians by
// points become those by unknowns. What rides on the same tet is summed up there first, so that a fine surface on
// coarse tets does not reach into the matrix once for every point.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/embedded_point.h"
#include "solver/numbering.h"
#include "solver/term/term.h"

#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

class CarriedPoints {
  public:
    /// \param carrier of each point: points with the same number ride on the vertices of the same tet. Numbers need not
    /// follow each other.
    /// \param links pairs of points (i <= j), sorted, each once, whose second derivatives add_hessian takes.
    /// A point that no vertex carries stays where `move` finds it.
    CarriedPoints(const Numbering& numbering, const std::vector<PointWeights>& points, const std::vector<int>& carrier,
                  const std::vector<std::pair<int, int>>& links);

    std::size_t count() const { return count_; }
    /// Where the points are for vertices at x, 3 a point.
    void move(const Positions& x, std::span<double> points) const;

    /// Takes the gradient by points, 3 each, for the functions after it.
    void set_gradient(std::span<const double> by_points);
    void add_gradient(std::span<double> by_unknowns) const;
    void add_held_gradient(std::span<double> by_vertices) const;
    /// Adds to each deformable's the squares of what each carrier gets, before carriers cancel.
    void add_squared_gradient(std::span<double> of_deformables) const;

    void add_couplings(Couplings& couplings) const;
    void bind(const BlockPattern& pattern);
    /// `blocks`: 9 numbers a link, row-major: the second derivatives by its points i (rows) and j.
    void add_hessian(std::span<const double> blocks, BlockMatrix& a);
    /// Whether each point is a vertex of its own, as those of a sheet are. Then, after bind, a link's second
    /// derivatives are a block of the matrix; links may be added side by side.
    bool are_vertices() const { return !link_block_.empty(); }
    void add_link(std::size_t link, const double* block, BlockMatrix& a) const;

  private:
    struct Carrier {
        std::size_t first_vertex, vertex_count; ///< in vertex_
        std::size_t first_point, point_count;   ///< in point_
        std::size_t first_weight;               ///< in weight_, vertex_count numbers a point
        // Of its share of the Hessian: rows are its own vertices that are unknowns, columns all unknowns that its
        // points are linked to, by number; each row from its own column on.
        std::size_t first_column = 0, column_count = 0; ///< in column_
        std::size_t first_entry = 0, entry_count = 0;   ///< in entries_, 9 a block
    };
    /// From a point to one that it is linked to.
    struct Neighbour {
        int point;               ///< place in point_
        int link;                ///< twice its number, plus one if the block has to be transposed
        std::size_t first_place; ///< in place_: columns of the neighbour's vertices in the share of this one's carrier
    };
    void find_neighbours(const std::vector<std::pair<int, int>>& links);
    void find_columns();
    void find_link_blocks(const BlockPattern& pattern);
    void add_share(const Carrier& c, std::span<const double> blocks, double* scratch);

    const Numbering& numbering_;
    std::size_t count_;
    std::vector<Carrier> carriers_;
    std::vector<int> vertex_, unknown_; ///< of each carrier, by number; unknown or -1
    std::vector<int> point_;            ///< as numbered outside, by carriers
    std::vector<int> carrier_of_;       ///< of each place in point_
    std::vector<double> weight_;
    std::vector<double> gradient_;                   ///< 3 a place in vertex_
    std::vector<int> of_unknown_start_, of_unknown_; ///< places in vertex_
    std::vector<std::size_t> neighbour_start_;       ///< per place in point_
    std::vector<Neighbour> neighbours_;
    std::vector<int> place_;             ///< columns, -1 where held
    std::vector<int> column_;            ///< unknowns
    std::vector<std::size_t> row_start_; ///< per place in vertex_: its own column; past the end where held
    std::size_t most_columns_ = 0;
    std::vector<double> entries_, scratch_;
    std::vector<int> block_, block_start_, of_block_; ///< blocks of the pattern that get something, and their entries
    std::size_t link_count_;
    /// Of points that are vertices, per link: twice its block of the pattern, plus one where it is transposed there; -1
    /// where one is held.
    std::vector<int> link_block_;
};

} // namespace sinew::solver
