// Geometric multigrid for any mesh: coarse unknowns live on regular grids laid over the rest positions of each body,
// twice as wide from level to level, and are interpolated linearly in the simplices that cut the grid's cubes. Linear
// functions, and with them rigid motions, are in every coarse space. Coarse matrices are Galerkin products. Smoothing:
// one Gauss-Seidel sweep forward before and one backward after, within fixed chunks of rows; between chunks old values
// are read. So one cycle is a symmetric operator, its cost is some three products with the matrix, and its bits do not
// depend on threads.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/row_blocks.h"
#include "solver/types.h"

#include <memory>

namespace sinew::solver {

/// Where the unknowns are, for the coarse grids.
struct UnknownPlaces {
    Points points;               ///< at rest [m]
    std::vector<int> body;       ///< unknowns of different bodies share no coarse ones
    std::vector<char> left_out;  ///< flags of unknowns that grids do not carry: a cycle leaves 0 there; empty: none
    std::vector<double> spacing; ///< per body: mean distance of neighbours [m]
    bool any_sheet = false; ///< some body is cloth: stiff along the sheet and soft across it, too much so for grids
};

class Multigrid {
  public:
    Multigrid(const RowBlocks& fine, const UnknownPlaces& places);
    ~Multigrid();
    /// Takes the values that `fine` has now. False: a diagonal block is not positive definite.
    bool set_values();
    /// z = one cycle on r; 3 numbers a row.
    void apply(const std::vector<double>& r, std::vector<double>& z);
    int level_count() const;

  private:
    struct Level;
    void cycle(std::size_t level);
    std::vector<std::unique_ptr<Level>> levels_;
    struct Coarsest;
    std::unique_ptr<Coarsest> coarsest_;
};

} // namespace sinew::solver
