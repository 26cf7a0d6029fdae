// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/overlay.h"

#include "solver/index.h"
#include "solver/parallel.h"

namespace sinew::solver {

void Overlay::clear() { blocks_.clear(), carriers_.clear(), first_.clear(), element_.clear(), rows_.clear(); }

void Overlay::add(std::span<const Carrier> carriers, const Blocks& blocks) {
    first_.push_back(carriers_.size());
    carriers_.insert(carriers_.end(), carriers.begin(), carriers.end());
    element_.insert(element_.end(), carriers.size(), static_cast<int>(blocks_.size()));
    blocks_.push_back(blocks);
}

void Overlay::finish(int rows) {
    if (empty()) return;
    first_.push_back(carriers_.size());
    // A counting sort, into room that is kept: this happens at every Newton iteration.
    start_.assign(at(rows) + 1, 0);
    for (const Carrier& c : carriers_) ++start_[at(c.row) + 1];
    for (std::size_t r = 0; r < at(rows); ++r) start_[r + 1] += start_[r];
    next_.assign(start_.begin(), start_.end() - 1);
    entries_.resize(carriers_.size());
    for (std::size_t i = 0; i < carriers_.size(); ++i)
        entries_[at(next_[at(carriers_[i].row)]++)] = static_cast<int>(i);
    for (int r = 0; r < rows; ++r)
        if (start_[at(r) + 1] > start_[at(r)]) rows_.push_back(r);
    forces_.resize(blocks_.size());
}

void Overlay::add_product(const double* x, double* y) const {
    parallel_for(blocks_.size(), 128, [&](std::size_t e) {
        std::array<Vec3, corners> places{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        for (std::size_t i = first_[e]; i < first_[e + 1]; ++i) {
            const Carrier& c = carriers_[i];
            places[at(c.corner)] += c.weight * Eigen::Map<const Vec3>(x + 3 * at(c.row));
        }
        std::array<Vec3, corners>& out = forces_[e];
        for (Vec3& f : out) f.setZero();
        std::size_t entry = 0;
        for (std::size_t i = 0; i < corners; ++i)
            for (std::size_t j = i; j < corners; ++j, ++entry) {
                const Mat3& block = blocks_[e][entry];
                out[i] += block * places[j];
                if (j > i) out[j] += block.transpose() * places[i];
            }
    });
    parallel_for(rows_.size(), 128, [&](std::size_t k) {
        const std::size_t row = at(rows_[k]);
        Vec3 sum = Vec3::Zero();
        for (int i = start_[row]; i < start_[row + 1]; ++i) {
            const std::size_t entry = at(entries_[at(i)]);
            const Carrier& c = carriers_[entry];
            sum += c.weight * forces_[at(element_[entry])][at(c.corner)];
        }
        Eigen::Map<Vec3>(y + 3 * row) += sum;
    });
}

} // namespace sinew::solver
