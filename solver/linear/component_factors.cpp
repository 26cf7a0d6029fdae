// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/component_factors.h"

#include "solver/index.h"
#include "solver/linear/cholesky.h"
#include "solver/linear/single_cholesky.h"
#include "solver/parallel.h"

#include <algorithm>
#include <atomic>

namespace sinew::solver {

namespace {

/// Of the bytes that all may take beside each other: a component of less has its own.
constexpr std::size_t own_share = 8;

} // namespace

ComponentFactors::ComponentFactors(const BlockPattern& pattern, Factoring factoring, std::size_t most_beside) {
    const bool plain = factoring == Factoring::plain;
    const std::vector<int> component = plain ? std::vector<int>(at(pattern.rows), 0) : components(pattern);
    std::vector<int> part_of(component.size(), -1), local(component.size());
    for (std::size_t i = 0; i < component.size(); ++i) {
        int& part = part_of[at(component[i])];
        if (part < 0) {
            part = static_cast<int>(parts_.size());
            parts_.push_back(std::make_unique<Part>());
        }
        std::vector<int>& rows = parts_[at(part)]->rows;
        local[i] = static_cast<int>(rows.size());
        rows.push_back(static_cast<int>(i));
    }
    std::vector<SingleCholesky*> singles;
    for (auto& part : parts_) {
        std::vector<std::pair<int, int>> couplings;
        std::size_t blocks = 0;
        for (const int i : part->rows) blocks += at(pattern.row_start[at(i) + 1] - pattern.row_start[at(i)]);
        couplings.reserve(blocks + part->rows.size()), part->source.reserve(blocks);
        for (const int i : part->rows)
            for (int e = pattern.row_start[at(i)]; e < pattern.row_start[at(i) + 1]; ++e) {
                couplings.emplace_back(local[at(i)], local[at(pattern.column[at(e)])]);
                part->source.push_back(e); // rows and columns come sorted, as make_pattern keeps them
            }
        part->pattern = make_pattern(static_cast<int>(part->rows.size()), couplings);
        std::vector<int>().swap(part->pattern.lower_start);
        std::vector<std::pair<int, int>>().swap(part->pattern.lower);
        if (factoring == Factoring::single) {
            auto single = std::make_unique<SingleCholesky>(part->pattern);
            singles.push_back(single.get());
            part->factor = std::move(single);
        } else
            part->factor = std::make_unique<Cholesky>(part->pattern, plain);
        part->in.resize(3 * part->rows.size());
        part->out.resize(3 * part->rows.size());
    }
    std::size_t working = 0;
    for (const SingleCholesky* single : singles) working += single->working_bytes();
    SingleCholesky* first = nullptr;
    for (std::size_t k = 0; k < singles.size() && working > most_beside; ++k) {
        if (singles[k]->working_bytes() <= most_beside / own_share) continue;
        parts_[k]->in_one_room = true;
        if (first) singles[k]->share_memory(*first);
        if (!first) first = singles[k];
    }
    std::stable_sort(parts_.begin(), parts_.end(),
                     [](const auto& a, const auto& b) { return a->rows.size() > b->rows.size(); });
}

bool ComponentFactors::rests(const Part& part, std::span<const char> resting) {
    return !resting.empty() && std::ranges::all_of(part.rows, [&](int row) { return resting[at(row)] != 0; });
}

template <class Whole>
bool ComponentFactors::factorize_whole(const Whole& a, std::span<const char> resting) {
    std::atomic<bool> good = true, indefinite = false;
    const auto make = [&](Part& part) {
        if (rests(part, resting)) return;
        part.made = part.factor->factorize({part.pattern, a, part.source});
        if (part.made) return;
        good = false;
        if (part.factor->surely_indefinite()) indefinite = true;
    };
    for (const auto& part : parts_)
        if (part->in_one_room) make(*part);
    parallel_for(parts_.size(), 1, [&](std::size_t k) {
        if (!parts_[k]->in_one_room) make(*parts_[k]);
    });
    surely_indefinite_ = indefinite;
    return good;
}

bool ComponentFactors::factorize(const BlockMatrix& a, std::span<const char> resting) {
    return factorize_whole(a, resting);
}

bool ComponentFactors::factorize(std::span<const float> rounded, std::span<const char> resting) {
    return factorize_whole(rounded, resting);
}

void ComponentFactors::release_if_large() {
    constexpr std::size_t large = std::size_t{16} << 20;
    std::size_t bytes = 0;
    for (const auto& part : parts_) bytes += part->factor->bytes();
    if (bytes < large) return; // to take it again would cost more than it is worth
    for (const auto& part : parts_) part->factor->release(), part->made = false;
}

void ComponentFactors::forget() {
    for (const auto& part : parts_) part->made = false;
}

std::vector<char> ComponentFactors::rows_without() const {
    std::vector<char> out;
    std::size_t rows = 0;
    for (const auto& part : parts_) rows += part->rows.size();
    for (const auto& part : parts_) {
        if (part->made) continue;
        out.resize(rows);
        for (const int row : part->rows) out[at(row)] = 1;
    }
    return out;
}

bool ComponentFactors::is_made(std::span<const char> resting) const {
    return std::ranges::all_of(parts_, [&](const auto& part) { return part->made || rests(*part, resting); });
}

void ComponentFactors::solve(const double* in, double* out, std::span<const char> resting) {
    parallel_for(parts_.size(), 1, [&](std::size_t k) {
        Part& part = *parts_[k];
        if (rests(part, resting)) {
            for (const int row : part.rows) std::copy_n(in + 3 * row, 3, out + 3 * row);
            return;
        }
        if (parts_.size() == 1) return part.factor->solve(in, out); // its rows are those of the whole
        for (std::size_t i = 0; i < part.rows.size(); ++i)
            std::copy_n(in + 3 * part.rows[i], 3, part.in.data() + 3 * i);
        part.factor->solve(part.in.data(), part.out.data());
        for (std::size_t i = 0; i < part.rows.size(); ++i)
            std::copy_n(part.out.data() + 3 * i, 3, out + 3 * part.rows[i]);
    });
}

} // namespace sinew::solver
