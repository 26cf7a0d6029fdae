// Cavities and stars.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_cavity.h"

#include "solver/index.h"
#include "solver/mesh/tet_quality.h"

#include <algorithm>
#include <limits>

namespace sinew::solver {
void TetCavity::start(int tet) {
    ++round_;
    tets_.clear();
    add(tet);
}

void TetCavity::add(int tet) {
    if (mark_.size() < complex_.count()) mark_.resize(complex_.count() + complex_.count() / 2, 0);
    mark_[at(tet)] = round_;
    tets_.push_back(tet);
}

std::vector<TetCavity::Wall> TetCavity::walls() const {
    std::vector<Wall> out;
    for (const int t : tets_)
        for (const auto& [i, j, k, l] : tet_faces) {
            const Tet& c = complex_.tet(t);
            const int beyond = complex_.beside(t, c[i], c[j], c[k]);
            if (beyond < 0 || at(beyond) >= mark_.size() || !holds(beyond))
                out.push_back({{c[i], c[k], c[j]}, t, beyond});
        }
    return out;
}

double TetCavity::quality(const Wall& w, const Vec3& p) const {
    const Points& x = complex_.vertices;
    return tet_quality(x[at(w.face[0])], x[at(w.face[1])], x[at(w.face[2])], p);
}

bool TetCavity::make_star_shaped(const Vec3& p, double least_quality) {
    const int first = tets_.front();
    for (;;) {
        std::vector<int> blind;
        for (const Wall& w : walls())
            if (!(quality(w, p) > least_quality)) blind.push_back(w.owner);
        if (blind.empty()) return true;
        for (const int t : blind) mark_[at(t)] = 0;
        if (!holds(first)) return false;
        // What still hangs together with the first tet.
        std::vector<int> kept{first};
        const int old = round_++;
        mark_[at(first)] = round_;
        for (std::size_t n = 0; n < kept.size(); ++n)
            for (const auto& [i, j, k, l] : tet_faces) {
                const Tet& c = complex_.tet(kept[n]);
                const int beyond = complex_.beside(kept[n], c[i], c[j], c[k]);
                if (beyond < 0 || at(beyond) >= mark_.size() || mark_[at(beyond)] != old) continue;
                mark_[at(beyond)] = round_;
                kept.push_back(beyond);
            }
        tets_ = std::move(kept);
    }
}

double TetCavity::grow_for(const Vec3& p, std::size_t most_tets) {
    double best = 0;
    std::size_t best_count = 0;
    while (tets_.size() <= most_tets) {
        if (const double q = star_quality(p); q > best && q > present_quality()) best = q, best_count = tets_.size();
        double worst = std::numeric_limits<double>::infinity();
        int next = -1;
        for (const Wall& w : walls())
            if (const double q = quality(w, p); q < worst) worst = q, next = w.beyond;
        if (next < 0) break; // the boundary is in the way
        add(next);
    }
    const std::vector<int> order = std::move(tets_);
    start(order.front());
    for (std::size_t i = 1; i < best_count; ++i) add(order[i]);
    return best;
}

double TetCavity::star_quality(const Vec3& p) const {
    std::vector<int> before, after;
    for (const int t : tets_) before.insert(before.end(), complex_.tet(t).begin(), complex_.tet(t).end());
    double worst = std::numeric_limits<double>::infinity();
    for (const Wall& w : walls()) {
        worst = std::min(worst, quality(w, p));
        after.insert(after.end(), w.face.begin(), w.face.end());
    }
    const auto count = [](std::vector<int>& v) {
        std::sort(v.begin(), v.end());
        return std::unique(v.begin(), v.end()) - v.begin();
    };
    return count(before) == count(after) ? worst : 0;
}

double TetCavity::present_quality() const {
    const Points& x = complex_.vertices;
    double worst = std::numeric_limits<double>::infinity();
    for (const int t : tets_) {
        const Tet& c = complex_.tet(t);
        worst = std::min(worst, tet_quality(x[at(c[0])], x[at(c[1])], x[at(c[2])], x[at(c[3])]));
    }
    return worst;
}

std::vector<int> TetCavity::fill(int v) {
    std::vector<Tet> fresh;
    for (const Wall& w : walls()) fresh.push_back({w.face[0], w.face[1], w.face[2], v});
    return complex_.replace(tets_, fresh);
}

} // namespace sinew::solver
