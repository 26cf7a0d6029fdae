// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholmod_analysis.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/linear/cholmod_threads.h"
#include "solver/linear/vertex_order.h"

#include <string>
#include <vector>

namespace sinew::solver {

CholmodAnalysis::CholmodAnalysis(const BlockPattern& pattern) {
    const std::lock_guard lock(analysis_mutex());
    use_one_blas_thread();
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.try_catch = 1;
    common.quick_return_if_not_posdef = 1;
    build_structure(pattern);
    const std::vector<int> rows = order_rows(pattern, common);
    std::vector<int> order;
    order.reserve(3 * rows.size());
    for (const int i : rows)
        for (int c = 0; c < 3; ++c) order.push_back(3 * i + c);
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
    factor = cholmod_analyze_p(matrix, order.data(), nullptr, 0, &common);
    if (!factor) throw Error("FE305", "the symbolic analysis of the stiffness matrix failed (out of memory?)");
    operations = common.fl;
}

CholmodAnalysis::~CholmodAnalysis() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
}

/// The scalar lower triangle: column 3i+c holds rows 3i+c…3i+2, then three rows a block (i, j > i).
void CholmodAnalysis::build_structure(const BlockPattern& p) {
    std::size_t entries = 0;
    for (int i = 0; i < p.rows; ++i) entries += 6 + 9 * at(p.row_start[at(i) + 1] - p.row_start[at(i)] - 1);
    const std::size_t n = 3 * at(p.rows);
    matrix = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, &common);
    if (!matrix) throw Error("FE305", "not enough memory for a matrix of " + std::to_string(n) + " unknowns");
    int* start = static_cast<int*>(matrix->p);
    int* row = static_cast<int*>(matrix->i);
    int next = 0;
    for (int i = 0; i < p.rows; ++i)
        for (int c = 0; c < 3; ++c) {
            start[3 * i + c] = next;
            for (int r = c; r < 3; ++r) row[next++] = 3 * i + r;
            for (int e = p.row_start[at(i)] + 1; e < p.row_start[at(i) + 1]; ++e)
                for (int r = 0; r < 3; ++r) row[next++] = 3 * p.column[at(e)] + r;
        }
    start[n] = next;
}

} // namespace sinew::solver
