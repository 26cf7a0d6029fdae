// Adaptive refinement of the BCC lattice that keeps it conforming: red (one tet into eight) and green (one
// tet into two or four beside red ones).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/bcc_grid.h"
#include "solver/meshing/number_map.h"

#include <functional>
#include <vector>

namespace sinew::solver {

/// A red tet is cut at the midpoints of its six edges into eight tets of half the size, all of them BCC tets
/// again (BccGrid::children). A tet beside red ones has midpoints on some of its edges. The sets of edges
/// that a green cut can resolve are: none, one edge (two tets), two opposite edges (four), the three edges of
/// a face (four). Any two of these sets share a set of this kind, so every set of split edges has one
/// smallest of them, or all six edges, that contains it: its closure. Edges of the closure are split too, and
/// a tet with all six is red.
///
/// Red tets at one level halve edges of the next, so an edge of level n is split only where all tets of level
/// n about it exist: the tets they come from are red. Green tets are never cut. Both rules only ever add, so
/// there is one smallest set of red tets and split edges which contains what was asked for; it does not
/// depend on the order of work or the number of threads.
///
/// Dihedral angles: 60 and 90 degrees for red tets; for green ones, over all cuts, at least 30 degrees
/// (two opposite short edges, one short edge) and at most 116.57 (the three edges of a face).
class RedGreen {
  public:
    struct Cell {
        std::int64_t number = 0; ///< tet of its level's grid
        int parent = -1;         ///< cell of the level above; -1 at level 0
        int first_child = -1;    ///< of eight cells of the next level; -1 unless red
        bool is_alive = false;   ///< part of the mesh; others are neither cut nor kept conforming
        bool is_red = false;
    };
    struct Level {
        BccGrid grid;
        std::vector<Cell> cells;
        NumberMap cell_of;     ///< by tet number
        NumberMap split_edges; ///< by the number that the midpoint has in the next level's grid
    };
    enum class Verdict : char { dead, keep, split };
    /// Judges the cells of a level from `first` on. Judgements must depend on the cell alone, and a dead cell
    /// must have no living children.
    using Judge = std::function<std::vector<Verdict>(int level, std::size_t first)>;

    /// `roots`: tets of the grid in increasing order; these are the domain.
    RedGreen(const BccGrid& grid, const std::vector<std::int64_t>& roots);

    /// Refines until every living cell with the verdict `split` is red and all is conforming. `pause` is called every
    /// few thousand cells or edges, on this thread; it may throw.
    void refine(const Judge& judge, const std::function<void()>& pause = {});

    const std::vector<Level>& levels() const { return levels_; }
    /// Bit e is set if edge e of the cell is split; edges in the order 01, 02, 03, 12, 13, 23.
    unsigned pattern(int level, const Cell& cell) const;

  private:
    struct CellName {
        int level, cell;
    };
    struct Edge {
        int level;
        BccGrid::Key a, b;
    };

    void count_work() {
        if (pause_ && ++work_ % 4096 == 0) pause_();
    }
    Level& level(int n) { return levels_[static_cast<std::size_t>(n)]; }
    void make_red(CellName name);
    void split_edge(const Edge& edge);
    bool demand_tets_about(const Edge& edge);
    bool demand(int level, std::int64_t number);
    void settle(CellName name);
    void drain();
    std::vector<std::size_t> make_children();

    std::vector<Level> levels_;
    std::vector<CellName> to_settle_, new_reds_;
    std::vector<Edge> waiting_; ///< split edges about which cells are still to be made
    std::function<void()> pause_;
    std::size_t work_ = 0;
};

/// The smallest of the patterns that a green cut resolves, or all edges, that contains `pattern`.
unsigned closed_pattern(unsigned pattern);
constexpr unsigned all_edges = 63;

/// Corners 0…3 of a tet and the midpoints 4…9 of its edges 01, 02, 03, 12, 13, 23, as four numbers a part.
using GreenPart = std::array<int, 4>;
/// The parts into which a closed pattern (not all edges) cuts a tet, oriented like the tet.
const std::vector<GreenPart>& green_parts(unsigned closed_pattern);

} // namespace sinew::solver
