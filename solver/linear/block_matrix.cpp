// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/block_matrix.h"

#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/simd.h"
#include "solver/sort_into.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Of columns by rows in any order, duplicates allowed; it sorts them in place.
CoupledRows each_once(int rows, const std::vector<int>& start, std::vector<int>& columns) {
    CoupledRows out;
    out.start.assign(at(rows) + 1, 0);
    parallel_for(at(rows), 64, [&](std::size_t i) {
        const auto first = columns.begin() + start[i], end = columns.begin() + start[i + 1];
        std::sort(first, end);
        out.start[i + 1] = static_cast<int>(std::unique(first, end) - first);
    });
    for (std::size_t i = 0; i < at(rows); ++i) out.start[i + 1] += out.start[i];
    out.column.resize(at(out.start.back()));
    parallel_for(at(rows), 256, [&](std::size_t i) {
        std::copy_n(columns.begin() + start[i], out.start[i + 1] - out.start[i], out.column.begin() + out.start[i]);
    });
    return out;
}

} // namespace

int BlockPattern::find(int i, int j) const {
    const auto first = column.begin() + row_start[at(i)];
    const auto last = column.begin() + row_start[at(i) + 1];
    const auto it = std::lower_bound(first, last, j);
    return it != last && *it == j ? static_cast<int>(it - column.begin()) : -1;
}

CoupledRows coupled_rows(int rows, const std::vector<std::pair<int, int>>& couplings) {
    std::vector<int> start, columns;
    sort_into(at(rows), start, columns, [&](const auto& visit) {
        for (const auto& [i, j] : couplings)
            if (i != j) visit(at(std::min(i, j)), std::max(i, j));
    });
    return each_once(rows, start, columns);
}

BlockPattern make_pattern(int rows, const std::vector<std::pair<int, int>>& couplings) {
    const CoupledRows all = coupled_rows(rows, couplings);
    return make_pattern(rows, std::span(&all, 1));
}

BlockPattern make_pattern(int rows, std::span<const CoupledRows> parts) {
    std::vector<int> start(at(rows) + 1, 0);
    for (std::size_t i = 0; i < at(rows); ++i) {
        start[i + 1] = start[i] + 1; // the diagonal
        for (const CoupledRows& part : parts) start[i + 1] += part.start[i + 1] - part.start[i];
    }
    std::vector<int> columns(at(start.back()));
    parallel_for(at(rows), 256, [&](std::size_t i) {
        auto to = columns.begin() + start[i];
        *to++ = static_cast<int>(i);
        for (const CoupledRows& part : parts)
            to = std::copy(part.column.begin() + part.start[i], part.column.begin() + part.start[i + 1], to);
    });
    CoupledRows all = each_once(rows, start, columns);

    BlockPattern p;
    p.rows = rows;
    p.row_start = std::move(all.start), p.column = std::move(all.column);
    p.lower_start.assign(at(rows) + 1, 0);
    for (std::size_t i = 0; i < at(rows); ++i)
        for (int b = p.row_start[i] + 1; b < p.row_start[i + 1]; ++b) ++p.lower_start[at(p.column[at(b)]) + 1];
    for (std::size_t i = 0; i < at(rows); ++i) p.lower_start[i + 1] += p.lower_start[i];
    p.lower.resize(at(p.lower_start.back()));
    std::vector<int> next(p.lower_start.begin(), p.lower_start.end() - 1);
    for (std::size_t i = 0; i < at(rows); ++i)
        for (int b = p.row_start[i] + 1; b < p.row_start[i + 1]; ++b)
            p.lower[at(next[at(p.column[at(b)])]++)] = {b, static_cast<int>(i)};
    return p;
}

void multiply(const BlockMatrix& a, const double* x, double* y) {
    const BlockPattern& p = *a.pattern;
    parallel_for(at(p.rows), 512, [&](std::size_t i) {
        // Rows of blocks by four lanes, of which the last is left out. No block below the diagonal is the last one, so
        // that nothing is read beyond the end.
        const auto diagonal = at(p.row_start[i]);
        Pack below(0.0), of_row[3] = {Pack(0.0), Pack(0.0), Pack(0.0)};
        for (int e = p.lower_start[i]; e < p.lower_start[i + 1]; ++e) {
            const auto [index, column] = p.lower[at(e)];
            const double* b = a.block(at(index));
            const double* v = x + 3 * at(column);
            below += Pack::load(b) * Pack(v[0]) + Pack::load(b + 3) * Pack(v[1]) + Pack::load(b + 6) * Pack(v[2]);
        }
        for (auto e = diagonal + 1; e < at(p.row_start[i + 1]); ++e) {
            const double* b = a.block(e);
            const double* v = x + 3 * at(p.column[e]);
            const Pack own(Pack::Vector{v[0], v[1], v[2], 0.0});
            for (std::size_t c = 0; c < 3; ++c) of_row[c] += Pack::load(b + 3 * c) * own;
        }
        const double* b = a.block(diagonal);
        const double* v = x + 3 * i;
        for (std::size_t c = 0; c < 3; ++c) {
            const Pack& above = of_row[c];
            y[3 * i + c] = below[static_cast<int>(c)] + ((above[0] + above[1]) + above[2]) +
                           (b[3 * c] * v[0] + b[3 * c + 1] * v[1] + b[3 * c + 2] * v[2]);
        }
    });
    if (!a.overlay.empty()) a.overlay.add_product(x, y);
}

std::vector<int> components(const BlockPattern& pattern) {
    std::vector<int> root(at(pattern.rows));
    for (int i = 0; i < pattern.rows; ++i) root[at(i)] = i;
    const auto find = [&](int i) {
        while (root[at(i)] != i) {
            int& parent = root[at(i)];
            parent = root[at(parent)];
            i = parent;
        }
        return i;
    };
    for (int i = 0; i < pattern.rows; ++i)
        for (int e = pattern.row_start[at(i)]; e < pattern.row_start[at(i) + 1]; ++e) {
            const int a = find(i), b = find(pattern.column[at(e)]);
            root[at(std::max(a, b))] = std::min(a, b);
        }
    for (int i = 0; i < pattern.rows; ++i) root[at(i)] = find(i);
    return root;
}

} // namespace sinew::solver
