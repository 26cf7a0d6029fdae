// A multigrid cycle between two exact solves of the block of held unknowns (held_rows.h): a symmetric preconditioner,
// positive definite where the matrix is. The first solve leaves nothing to do in the block but what the grids will
// change there; the second takes that up.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/component_factors.h"
#include "solver/linear/held_rows.h"
#include "solver/linear/linear_costs.h"
#include "solver/linear/row_strip.h"

#include <vector>

namespace sinew::solver {

/// Of a HeldBlock: known before there is one, so that no choice hangs on whether there is. Zeros if nothing is held.
LinearCosts held_costs(const BlockPattern& pattern, const HeldRows& held);

/// The held rows and their columns.
struct HeldPart {
    std::vector<int> rows;   ///< that are held, ascending
    std::vector<int> source; ///< per block of the pattern: the block of the whole
    BlockPattern pattern;
};

class HeldBlock {
  public:
    /// `held`: some rows are. `fine`: the whole matrix. It and the pattern outlive this.
    HeldBlock(const BlockPattern& pattern, const RowBlocks& fine, const HeldRows& held);
    /// Takes the values that `fine` has now, of which `a` is the original. False: not positive definite.
    bool set_values(const BlockMatrix& a);
    /// z = block, cycle, block on r; 3 numbers a row. The cycle leaves pinned rows at 0.
    void apply(Multigrid& cycle, const std::vector<double>& r, std::vector<double>& z);

  private:
    const RowBlocks& fine_;
    const HeldPart part_;
    BlockMatrix matrix_;
    ComponentFactors factors_;
    RowStrip beside_; ///< free rows: their entries in held columns
    RowStrip within_; ///< all held rows: their entries in columns that grids carry
    std::vector<double> in_, out_, rest_, held_;
};

} // namespace sinew::solver
