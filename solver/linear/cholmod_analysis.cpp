// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/cholmod_analysis.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/linear/cholmod_threads.h"

#include <cstring>
#include <string>

namespace sinew::solver {

CholmodAnalysis::CholmodAnalysis(const BlockPattern& pattern, bool with_values) {
    const std::lock_guard lock(analysis_mutex());
    use_one_blas_thread();
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.try_catch = 1;
    common.quick_return_if_not_posdef = 1;
    build_structure(pattern, with_values);
    std::vector<int> order = order_vertices(pattern);
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
void CholmodAnalysis::build_structure(const BlockPattern& p, bool with_values) {
    std::size_t entries = 0;
    for (int i = 0; i < p.rows; ++i) entries += 6 + 9 * at(p.row_start[at(i) + 1] - p.row_start[at(i)] - 1);
    const std::size_t n = 3 * at(p.rows);
    matrix = cholmod_allocate_sparse(n, n, entries, 1, 1, -1, with_values ? CHOLMOD_REAL : CHOLMOD_PATTERN, &common);
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

/// Fill-reducing order of the vertices, three unknowns each.
std::vector<int> CholmodAnalysis::order_vertices(const BlockPattern& p) {
    const std::size_t n = at(p.rows);
    cholmod_sparse* graph = cholmod_allocate_sparse(n, n, p.block_count(), 1, 1, -1, CHOLMOD_PATTERN, &common);
    std::memcpy(graph->p, p.row_start.data(), (n + 1) * sizeof(int));
    std::memcpy(graph->i, p.column.data(), p.block_count() * sizeof(int));
    std::vector<int> vertices(n), unknowns(3 * n);
    const int ok = cholmod_metis(graph, nullptr, 0, 1, vertices.data(), &common);
    cholmod_free_sparse(&graph, &common);
    if (!ok)
        for (std::size_t i = 0; i < n; ++i) vertices[i] = static_cast<int>(i);
    for (std::size_t i = 0; i < n; ++i)
        for (int c = 0; c < 3; ++c) unknowns[3 * i + at(c)] = 3 * vertices[i] + c;
    return unknowns;
}

} // namespace sinew::solver
