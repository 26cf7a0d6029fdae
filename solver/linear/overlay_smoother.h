// Gauss-Seidel on the rows that an overlay couples, before and after a preconditioner that knows the pattern alone: in
// what touches, both sides of a contact press on each other, and a factor or grids made of each side's own share see
// each pressed against something that does not give.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/joined_sets.h"
#include "solver/linear/coupled_patch.h"
#include "solver/linear/row_strip.h"

#include <functional>
#include <vector>

namespace sinew::solver {

class OverlaySmoother {
  public:
    /// `fine`: the pattern's share of the matrix. It outlives this.
    explicit OverlaySmoother(const RowBlocks& fine);
    /// Takes the values that `fine` has now, and the overlay's. False: the matrix is not positive definite.
    bool set_values(const Overlay& overlay);
    /// After set_values: of how many patches, which go side by side, the coupled rows are.
    std::size_t patches() const { return patch_count_; }
    /// z = M^-1 r, 3 numbers a row, of the sweeps down the rows, `inner` on what they leave, and the sweeps up:
    /// symmetric where inner is, positive definite where inner and the matrix are. The same bits for any number of
    /// threads.
    using Inner = std::function<void(const std::vector<double>& r, std::vector<double>& z)>;
    void apply(const Inner& inner, const std::vector<double>& r, std::vector<double>& z);

  private:
    void find_rows(const std::vector<int>& rows);
    void find_patches(const Overlay& overlay);

    const RowBlocks& fine_;
    std::vector<int> rows_;          ///< those coupled
    RowStrip beside_;                ///< rows that are not coupled: their entries in columns that are
    RowStrip within_;                ///< all coupled rows: their entries in columns that are not
    std::vector<int> coupled_place_; ///< per row of the whole: its place among rows_, or below 0
    std::vector<int> local_;         ///< likewise: among those of its patch
    std::vector<CoupledPatch> patches_;
    std::size_t patch_count_ = 0; ///< of patches_; further ones keep their memory
    JoinedSets sets_;
    std::vector<int> rows_at_, patch_at_; ///< scratch of find_patches: per coupled row that is its set's root
    std::vector<char> definite_;          ///< per patch
    std::vector<double> swept_, rest_;
};

} // namespace sinew::solver
