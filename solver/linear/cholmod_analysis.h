// The symbolic half of a factorisation by CHOLMOD: an order of the graph of vertices, expanded to three unknowns a
// vertex, which finds the same fill in half the time.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/block_matrix.h"

#include <cholmod.h>

namespace sinew::solver {

struct CholmodAnalysis {
    /// Sets OpenBLAS to one thread: with two, its sums differ in the last bits. Throws Error FE305 (memory).
    explicit CholmodAnalysis(const BlockPattern& pattern);
    ~CholmodAnalysis();
    CholmodAnalysis(const CholmodAnalysis&) = delete;
    CholmodAnalysis& operator=(const CholmodAnalysis&) = delete;

    cholmod_common common{};
    cholmod_sparse* matrix = nullptr; ///< lower triangle, columns sorted
    cholmod_factor* factor = nullptr; ///< supernodal, without values
    double operations = 0;            ///< of one factorisation

  private:
    void build_structure(const BlockPattern& pattern);
};

} // namespace sinew::solver
