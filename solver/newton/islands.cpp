// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/islands.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {

Islands::Islands(const Numbering& numbering, const BlockPattern& pattern) {
    const std::size_t n = numbering.deformables.size();
    std::vector<int> deformable(at(pattern.rows));
    for (std::size_t d = 0; d < n; ++d) {
        const Deformable& body = numbering.deformables[d];
        std::fill_n(deformable.begin() + static_cast<std::ptrdiff_t>(body.first_unknown), body.unknown_count,
                    static_cast<int>(d));
    }
    std::vector<std::pair<int, int>> ties;
    for (std::size_t i = 0; i < deformable.size(); ++i)
        for (int e = pattern.row_start[i]; e < pattern.row_start[i + 1]; ++e) {
            const std::pair tie(deformable[i], deformable[at(pattern.column[at(e)])]);
            if (tie.first != tie.second && (ties.empty() || ties.back() != tie)) ties.push_back(tie);
        }
    const std::vector<int> lowest = components(make_pattern(static_cast<int>(n), ties));
    island_.resize(n);
    for (std::size_t d = 0; d < n; ++d) island_[d] = at(lowest[d]) == d ? count_++ : island_[at(lowest[d])];
}

bool Islands::keep_whole(std::vector<char>& deformables) {
    whole_.assign(count_, 1);
    for (std::size_t d = 0; d < island_.size(); ++d)
        if (!deformables[d]) whole_[island_[d]] = 0;
    bool any = false;
    for (std::size_t d = 0; d < island_.size(); ++d) {
        deformables[d] = whole_[island_[d]];
        any = any || deformables[d];
    }
    return any;
}

} // namespace sinew::solver
