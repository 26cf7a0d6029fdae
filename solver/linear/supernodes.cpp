// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/supernodes.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/linear/cholmod_threads.h"
#include "solver/linear/vertex_order.h"

#include <algorithm>
#include <cholmod.h>
#include <string>

namespace sinew::solver {

Supernodes find_supernodes(const BlockPattern& pattern) {
    const std::lock_guard lock(analysis_mutex());
    use_one_blas_thread();
    cholmod_common common;
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.try_catch = 1;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.final_ll = 1;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.postorder = 1;
    // Supernodes of so few columns are joined although that fills in zeros; CHOLMOD's own limits, in rows of three.
    common.nrelax[0] = 1, common.nrelax[1] = 5, common.nrelax[2] = 16;
    std::vector<int> order = order_rows(pattern, common);
    cholmod_sparse graph = vertex_graph(pattern);
    cholmod_factor* f = cholmod_analyze_p(&graph, order.data(), nullptr, 0, &common);
    Supernodes out;
    if (f) {
        const int *super = static_cast<const int*>(f->super), *pi = static_cast<const int*>(f->pi),
                  *s = static_cast<const int*>(f->s), *column_rows = static_cast<const int*>(f->ColCount);
        out.order.assign(static_cast<const int*>(f->Perm), static_cast<const int*>(f->Perm) + f->n);
        out.nodes.reserve(f->nsuper);
        for (std::size_t k = 0; k < f->nsuper; ++k) {
            out.nodes.push_back({super[k], super[k + 1] - super[k], pi[k + 1] - pi[k], at(pi[k]), out.value_count});
            out.value_count += 9 * at(out.nodes.back().width) * at(out.nodes.back().rows);
            out.most_rows = std::max(out.most_rows, out.nodes.back().rows);
        }
        out.rows.assign(s, s + f->ssize);
        for (std::size_t i = 0; i < f->n; ++i)
            for (int c = 0; c < 3; ++c) {
                const double numbers = 3.0 * column_rows[i] - c;
                out.operations += numbers * numbers;
            }
        cholmod_free_factor(&f, &common);
    }
    cholmod_finish(&common);
    if (out.order.empty() && pattern.rows > 0)
        throw Error("FE305", "the symbolic analysis of a matrix of " + std::to_string(3 * pattern.rows) +
                                 " unknowns failed (out of memory?)");
    return out;
}

} // namespace sinew::solver
