// Counts what a piece of code takes from the heap, through whatever library: malloc and its kin are this program's own.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

namespace sinew::test {

/// Blocks taken from the heap so far by all threads; growing a block counts. Always 0 under a sanitizer, which has a
/// malloc of its own: ask counts_allocations() first.
struct Allocations {
    std::size_t all = 0;             ///< by whatever library
    std::size_t by_operator_new = 0; ///< of them by C++ code other than Eigen
};
Allocations allocations();
bool counts_allocations();

} // namespace sinew::test
