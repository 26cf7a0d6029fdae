// How many cells a refined lattice has at least.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/refined_count.h"

#include "solver/index.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace sinew::solver {
namespace {

/// Beside the surface, parts of cells are asked for their side down to this level. What they then hold of the solid is
/// nearly all of it, and there are few of them.
constexpr int deepest_asked = 3;

class Counter {
  public:
    Counter(const RefinedCount& what, std::int64_t most, const MeshingControl& control)
        : what_(what)
        , most_(most)
        , control_(control) {
        grids_.push_back(what.grid);
        while (std::ssize(grids_) <= what.paint.highest()) grids_.push_back(grids_.back().finer());
    }

    std::int64_t count() {
        const int highest = what_.paint.highest();
        // Coarse levels first, with what lies inside: of a solid that is refined throughout they tell already.
        for (int deepest = 1; deepest <= std::min(highest, deepest_asked) && !is_enough(); ++deepest)
            count_to(deepest, true);
        const std::int64_t inside = inside_;
        if (highest > deepest_asked && !is_enough()) count_to(highest, false);
        inside_ = inside;
        return total();
    }

  private:
    void count_to(int deepest, bool with_inside) {
        if (with_inside) inside_ = 0;
        cut_ = 0, deepest_ = deepest, with_inside_ = with_inside;
        const MeshingPhase phase{control_, 0.5, 0.5, "counting the tets"};
        phase.run(what_.coarse.tets.size(), 4, [&](std::size_t i) {
            const CellState state = what_.coarse.states[i];
            if (state == CellState::touched) count_cut(0, what_.coarse.tets[i], what_.coarse.touching(i));
            if (state == CellState::inside && with_inside) count_inside(0, what_.coarse.tets[i]);
        });
    }

    std::int64_t total() const { return std::ssize(what_.coarse.tets) + 8 * cut_ + inside_; }
    bool is_enough() const { return total() > most_; }

    /// Counts the cells at the surface that are cut, of which each gives eight more.
    void count_cut(int level, std::int64_t number, std::span<const int> triangles) {
        const auto seen = [&](int n, std::int64_t tet, int t) {
            const double scale = static_cast<double>(std::int64_t{1} << n);
            const auto& c = what_.corners[at(t)];
            return seen_from(grids_[at(n)], tet, {scale * c[0], scale * c[1], scale * c[2]});
        };
        const auto wants_more = [&](int t) { return what_.paint.wants_more(level, t, seen(level, number, t)); };
        if (is_enough() || std::ranges::none_of(triangles, wants_more)) return;
        ++cut_;
        if (level + 1 == deepest_ && !with_inside_) return;
        for (const std::int64_t child : grids_[at(level)].children(number)) {
            std::vector<int> touching;
            for (const int t : triangles)
                if (touches_tet(seen(level + 1, child, t), touch_slack)) touching.push_back(t);
            if (!touching.empty() && level + 1 < deepest_) count_cut(level + 1, child, touching);
            if (touching.empty() && with_inside_ && is_inside(level + 1, child)) count_inside(level + 1, child);
        }
    }

    bool is_inside(int level, std::int64_t number) const {
        if (what_.is_surface_only || what_.paint.highest_inside() <= level || is_enough()) return false;
        return untouched_state(what_.solid, corner_positions(grids_[at(level)], number)) == CellState::inside;
    }

    /// Adds all that an inner cell is surely cut into.
    void count_inside(int level, std::int64_t number) {
        const auto c = corner_positions(grids_[at(level)], number);
        const Vec3 middle = (c[0] + c[1] + c[2] + c[3]) / 4;
        double radius = 0;
        for (const Vec3& p : c) radius = std::max(radius, (p - middle).norm());
        std::int64_t parts = 1;
        for (int least = what_.paint.least_inside(level, middle, radius); least > level; --least) {
            if (parts > most_) break;
            parts *= 8, inside_ += parts;
        }
    }

    const RefinedCount& what_;
    const std::int64_t most_;
    const MeshingControl& control_;
    std::vector<BccGrid> grids_; ///< by level
    std::atomic<std::int64_t> cut_ = 0, inside_ = 0;
    int deepest_ = 0;
    bool with_inside_ = false;
};

} // namespace

std::int64_t RefinedCount::at_least(std::int64_t most, const MeshingControl& control) const {
    const auto parts = [](std::int64_t cells, int levels) {
        return static_cast<double>(cells) * 8 / 7 * std::exp2(3 * levels);
    };
    const auto touched = std::ranges::count(coarse.states, CellState::touched);
    const auto inside = std::ssize(coarse.states) - touched;
    const double rest = static_cast<double>(most - std::ssize(coarse.tets));
    if (parts(touched, paint.highest()) + parts(inside, paint.highest_inside()) < rest) return 0;
    return Counter(*this, most, control).count();
}

} // namespace sinew::solver
