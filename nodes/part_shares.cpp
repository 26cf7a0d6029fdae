// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/part_shares.h"

#include <algorithm>
#include <numeric>

namespace sinew::nodes {

std::vector<double> solid_volumes(const solver::TetMesh& mesh) {
    std::vector<double> out;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto corner = [&](std::size_t k) -> const solver::Vec3& {
            return mesh.vertices[static_cast<std::size_t>(mesh.tets[t][k])];
        };
        out.push_back((mesh.coverage.empty() ? 1 : mesh.coverage[t]) *
                      solver::tet_volume(corner(0), corner(1), corner(2), corner(3)));
    }
    return out;
}

double sum_of(const std::vector<double>& shares, const std::vector<double>& volumes) {
    return std::inner_product(shares.begin(), shares.end(), volumes.begin(), 0.0);
}

std::vector<std::vector<double>> exclusive_shares(const std::vector<NestedPart>& nested,
                                                  const std::vector<std::vector<double>>& inside,
                                                  const std::vector<double>& volumes, FoundParts& found) {
    const std::size_t count = nested.size(), tets = volumes.size();
    std::vector<std::vector<double>> held = inside; // what a part and those within it have, none of it twice
    found.shared.assign(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<double> limit =
            nested[i].within < 0 ? std::vector<double>(tets, 1.0) : held[static_cast<std::size_t>(nested[i].within)];
        for (std::size_t t = 0; t < tets; ++t) {
            found.shared[i] += std::max(0.0, held[i][t] - limit[t]) * volumes[t];
            held[i][t] = std::min(held[i][t], limit[t]);
        }
    }
    for (int within = -1; within < static_cast<int>(count); ++within)
        for (std::size_t t = 0; t < tets; ++t) {
            double sum = 0;
            for (std::size_t i = 0; i < count; ++i)
                if (nested[i].within == within) sum += held[i][t];
            const double limit = within < 0 ? 1 : held[static_cast<std::size_t>(within)][t];
            if (!(sum > limit)) continue;
            for (std::size_t i = 0; i < count; ++i)
                if (nested[i].within == within) {
                    const double less = held[i][t] * (1 - limit / sum);
                    found.shared[i] += less * volumes[t];
                    held[i][t] -= less;
                }
        }
    std::vector<std::vector<double>> out = held;
    for (std::size_t i = 0; i < count; ++i) {
        if (const double all = sum_of(inside[i], volumes); all > 0) found.shared[i] /= all;
        if (nested[i].within < 0) continue;
        std::vector<double>& around = out[static_cast<std::size_t>(nested[i].within)];
        for (std::size_t t = 0; t < tets; ++t) around[t] = std::max(0.0, around[t] - held[i][t]);
    }
    return out;
}

} // namespace sinew::nodes
