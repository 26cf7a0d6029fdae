// Deformables that hang together through the blocks of a matrix's pattern: muscles that nothing ties to each other are
// islands of their own, and what is in balance in one of them stays so wherever the others go.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"
#include "solver/numbering.h"

#include <vector>

namespace sinew::solver {

class Islands {
  public:
    Islands(const Numbering& numbering, const BlockPattern& pattern);
    std::size_t count() const { return count_; }
    /// Clears the flags of deformables whose islands have one without; true: some are left.
    bool keep_whole(std::vector<char>& deformables);

  private:
    std::vector<std::size_t> island_; ///< per deformable
    std::size_t count_ = 0;
    std::vector<char> whole_; ///< scratch, per island
};

} // namespace sinew::solver
