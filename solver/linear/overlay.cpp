// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/overlay.h"

#include "solver/index.h"
#include "solver/parallel.h"

namespace sinew::solver {

void Overlay::clear() { elements_.clear(), blocks_.clear(), carriers_.clear(), element_.clear(), rows_.clear(); }

void Overlay::add_element(std::span<const Carrier> carriers, std::span<const Mat3> blocks, bool across) {
    element_.insert(element_.end(), carriers.size(), static_cast<int>(elements_.size()));
    elements_.push_back({carriers_.size(), blocks_.size(), across});
    carriers_.insert(carriers_.end(), carriers.begin(), carriers.end());
    blocks_.insert(blocks_.end(), blocks.begin(), blocks.end());
}

void Overlay::add(std::span<const Carrier> carriers, const Blocks& blocks) { add_element(carriers, blocks, false); }

void Overlay::add_across(std::span<const Carrier> carriers, const std::array<Mat3, 3>& blocks) {
    add_element(carriers, blocks, true);
}

void Overlay::hold(const std::vector<char>& rows) {
    std::size_t kept = 0, kept_carriers = 0, next = 0;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const Element element = elements_[e];
        const std::size_t first = kept_carriers,
                          end = e + 1 < elements_.size() ? elements_[e + 1].first_carrier : carriers_.size();
        std::array<bool, corners> moves{};
        for (; next < end; ++next) {
            const Carrier& c = carriers_[next];
            if (rows[at(c.row)]) continue;
            moves[at(c.corner)] = true;
            carriers_[kept_carriers] = c, element_[kept_carriers++] = static_cast<int>(kept);
        }
        if (couples(element, moves))
            elements_[kept++] = {first, element.first_block, element.across};
        else
            kept_carriers = first;
    }
    elements_.resize(kept), carriers_.resize(kept_carriers), element_.resize(kept_carriers);
}

/// Whether it has a block between corners that move.
bool Overlay::couples(const Element& element, const std::array<bool, corners>& moves) const {
    const Mat3* block = blocks_.data() + element.first_block;
    for (std::size_t i = 0; i < (element.across ? 1 : corners); ++i)
        for (std::size_t j = i + (element.across ? 1 : 0); j < corners; ++j, ++block)
            if (moves[i] && moves[j] && !block->isZero(0)) return true;
    return false;
}

void Overlay::finish(int rows) {
    if (empty()) return;
    forces_.resize(elements_.size());
    elements_.push_back({carriers_.size(), blocks_.size(), false});
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
}

void Overlay::add_product(const double* x, double* y) const {
    parallel_for(forces_.size(), 128, [&](std::size_t e) {
        std::array<Vec3, corners> places{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        for (std::size_t i = elements_[e].first_carrier; i < elements_[e + 1].first_carrier; ++i) {
            const Carrier& c = carriers_[i];
            places[at(c.corner)] += c.weight * Eigen::Map<const Vec3>(x + 3 * at(c.row));
        }
        std::array<Vec3, corners>& out = forces_[e];
        for (Vec3& f : out) f.setZero();
        const Mat3* next = blocks_.data() + elements_[e].first_block;
        if (elements_[e].across) {
            for (std::size_t c = 1; c < corners; ++c, ++next)
                out[0] += *next * places[c], out[c] = next->transpose() * places[0];
            return;
        }
        for (std::size_t i = 0; i < corners; ++i)
            for (std::size_t j = i; j < corners; ++j) {
                const Mat3& block = *next++;
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
