// Which element Hessians are there at the same time, and where they add up. A linear tet's takes 720 bytes, more than
// all else of it together: so those of some thousand tets are made and added up before the next ones take their place.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

namespace sinew::solver {

/// Doubles that the element Hessians of a chunk take at most: 4 MB, 5,824 linear tets.
inline constexpr std::size_t chunk_entries = std::size_t{1} << 19;

/// Batches one after another, of one tissue or several. Chunks follow each other in the order of the batches, so a
/// block of the matrix adds up in that order, whatever their size is.
struct HessianChunk {
    struct Part {
        std::size_t tissue, first, end;             ///< batches of it
        std::size_t first_block = 0, end_block = 0; ///< its among `blocks`: tissues have no vertex in common
    };
    std::vector<Part> parts;
    std::size_t first_entry = 0; ///< place of its first number among those of all elements
    std::vector<int> blocks;     ///< of the pattern, that its tets reach, each once
    std::vector<int> start;      ///< per block and one past the end: of its contributions
    /// Element entries in the order of the tets, each named by twice the place of its first number in the chunk, plus
    /// one if it has to be transposed.
    std::vector<int> contributions;
};

} // namespace sinew::solver
