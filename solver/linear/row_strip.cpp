// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/row_strip.h"

#include "solver/index.h"

namespace sinew::solver {

void RowStrip::clear() { rows.clear(), start.assign(1, 0), entries.clear(); }

void RowStrip::end_row(int row) {
    rows.push_back(row);
    start.push_back(static_cast<int>(entries.size()));
}

Vec3 RowStrip::product(const BlockList& a, std::size_t place, const std::vector<double>& x) const {
    Float4 sum = {0, 0, 0, 0};
    for (int k = start[place]; k < start[place + 1]; ++k) {
        const std::size_t e = at(entries[at(k)]);
        const FloatBlock& b = a.blocks[e];
        const double* v = x.data() + 3 * at(a.column[e]);
        sum += b.col(0) * static_cast<float>(v[0]) + b.col(1) * static_cast<float>(v[1]) +
               b.col(2) * static_cast<float>(v[2]);
    }
    return {sum[0], sum[1], sum[2]};
}

} // namespace sinew::solver
