// Which unknowns springs hold so stiffly that grids cannot carry them. Many stiff springs on a skin that cuts through
// the tets leave a stiff and a soft subspace within the same vertices; no smoother by vertices tells them apart, and on
// coarse grids the springs' stiffness spreads over flesh that is free. So these unknowns get a factor of their own
// (held_block.h), those tied to something fixed leave the grids, and bodies that are tied to each other share the grid
// of one of them there (a splitting by what is held as Gross and Reusken 2021, arXiv 2107.01182, propose for cut
// cells).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/multigrid.h"

#include <span>
#include <vector>

namespace sinew::solver {

enum class Held : char { no, pinned, tied };

struct HeldRows {
    std::vector<Held> rows;   ///< per unknown; empty: none is held
    std::vector<int> grid_of; ///< per unknown: the body on whose grids it is carried
    bool operator==(const HeldRows&) const = default;
};

/// `springs`: stiffness of springs by blocks of the pattern, each a multiple of the identity [N/m]; `elastic`:
/// stiffness of what the unknowns are made of, one each [N/m]. An unknown is pinned where springs to what is no unknown
/// are stiffer than that, and tied where those to other bodies are.
HeldRows find_held_rows(const BlockPattern& pattern, std::span<const double> springs, std::span<const double> elastic,
                        const UnknownPlaces& places);

} // namespace sinew::solver
