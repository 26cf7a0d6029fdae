// Seeds on every component of a level set.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/iso_seeds.h"

#include "solver/index.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <unordered_map>

namespace sinew::solver {
namespace {

constexpr int cells = DistanceGrid::cells;
using Index = std::array<int, 3>;

/// Which cells of the filled blocks the level set passes, joined over the faces that it crosses.
class Components {
  public:
    explicit Components(const DistanceGrid& grid)
        : grid_(grid)
        , parent_(grid.filled.size() * cells * cells * cells) {
        std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
        for (std::size_t place = 0; place < grid.filled.size(); ++place)
            for (int k = 0; k < cells; ++k)
                for (int j = 0; j < cells; ++j)
                    for (int i = 0; i < cells; ++i)
                        for (int d = 0; d < 3; ++d) join_above(static_cast<int>(place), {i, j, k}, d);
    }

    /// The component's representative of a cell.
    std::uint32_t find(int place, const Index& cell) { return find(number(place, cell)); }

  private:
    static std::uint32_t number(int place, const Index& c) {
        return static_cast<std::uint32_t>(((place * cells + c[2]) * cells + c[1]) * cells + c[0]);
    }
    std::uint32_t find(std::uint32_t c) {
        while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
        return c;
    }
    /// Joins a cell with the one above its upper face across axis d, if f changes sign on that face.
    void join_above(int place, const Index& c, int d) {
        const std::size_t e = at(d), u = (e + 1) % 3, v = (e + 2) % 3;
        int positive = 0;
        for (int k = 0; k < 4; ++k) {
            Index corner = c;
            ++corner[e];
            corner[u] += k % 2;
            corner[v] += k / 2;
            positive += grid_.at(place, corner[0], corner[1], corner[2]) > 0;
        }
        if (positive == 0 || positive == 4) return;
        Index above = c;
        int other = place;
        if (++above[e] == cells) {
            Index block = grid_.filled[at(place)];
            ++block[e];
            if (!grid_.holds(block)) return;
            other = grid_.slot_of(block);
            if (other < 0) return;
            above[e] = 0;
        }
        const std::uint32_t a = find(number(place, c)), b = find(number(other, above));
        parent_[std::max(a, b)] = std::min(a, b);
    }

    const DistanceGrid& grid_;
    std::vector<std::uint32_t> parent_;
};

struct Crossing {
    Vec3 point;
    int component;
};

/// All crossings of the level set with the grid's lines, each once.
std::vector<Crossing> crossings(const DistanceGrid& grid, IsoSeeds& seeds, const MeshingControl& control) {
    Components components(grid);
    std::unordered_map<std::uint32_t, int> numbers;
    std::vector<Crossing> out;
    bool has_inside = false;
    for (std::size_t place = 0; place < grid.filled.size(); ++place) {
        if (place % 4096 == 0 && control.stop && control.stop()) throw Stopped();
        const Index& block = grid.filled[place];
        const auto slot = static_cast<int>(place);
        for (int k = 0; k < cells; ++k)
            for (int j = 0; j < cells; ++j)
                for (int i = 0; i < cells; ++i) {
                    const float here = grid.at(slot, i, j, k);
                    const Vec3 p = grid.position(block[0] * cells + i, block[1] * cells + j, block[2] * cells + k);
                    if (here < 0 && !has_inside) seeds.inside = p, has_inside = true;
                    const std::array<float, 3> next{grid.at(slot, i + 1, j, k), grid.at(slot, i, j + 1, k),
                                                    grid.at(slot, i, j, k + 1)};
                    for (int d = 0; d < 3; ++d) {
                        const double a = here, b = next[at(d)];
                        if ((a < 0) == (b < 0)) continue;
                        const std::uint32_t root = components.find(slot, {i, j, k});
                        const auto [entry, is_new] = numbers.try_emplace(root, static_cast<int>(numbers.size()));
                        Vec3 q = p;
                        q[d] += grid.step * (a / (a - b));
                        out.push_back({q, entry->second});
                    }
                }
    }
    seeds.areas.assign(numbers.size(), 0.0);
    return out;
}

/// The same order on every machine, without the grid's regularity: four seeds on a circle or five on a sphere
/// are a nuisance to Delaunay triangulations.
void shuffle(std::vector<Crossing>& all) {
    std::mt19937 random(12345);
    for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random() % i]);
}

/// Points no two of which are closer than a distance.
class Thinning {
  public:
    explicit Thinning(double distance)
        : distance_(distance) {}
    bool take(const Vec3& p) {
        const Index c = cell(p);
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    const auto found = taken_.find(key({c[0] + i, c[1] + j, c[2] + k}));
                    if (found == taken_.end()) continue;
                    for (const Vec3& q : found->second)
                        if ((q - p).squaredNorm() < distance_ * distance_) return false;
                }
        taken_[key(c)].push_back(p);
        return true;
    }

  private:
    Index cell(const Vec3& p) const {
        return {static_cast<int>(std::floor(p.x() / distance_)), static_cast<int>(std::floor(p.y() / distance_)),
                static_cast<int>(std::floor(p.z() / distance_))};
    }
    /// Cells 2^21 apart share a key; their points are compared in vain, no more.
    static std::uint64_t key(const Index& c) {
        constexpr std::uint64_t mask = (1u << 21) - 1;
        return (static_cast<std::uint64_t>(c[0]) & mask) << 42 | (static_cast<std::uint64_t>(c[1]) & mask) << 21 |
               (static_cast<std::uint64_t>(c[2]) & mask);
    }
    double distance_;
    std::unordered_map<std::uint64_t, std::vector<Vec3>> taken_;
};

} // namespace

double IsoSeeds::area() const { return std::accumulate(areas.begin(), areas.end(), 0.0); }

IsoSeeds make_iso_seeds(const DistanceGrid& grid, double spacing, const std::vector<int>& finer,
                        const MeshingControl& control) {
    IsoSeeds seeds;
    std::vector<Crossing> all = crossings(grid, seeds, control);
    // A plane of area A is crossed by A (|nx| + |ny| + |nz|) / step^2 lines: 1.5 on average over directions.
    for (const Crossing& c : all) seeds.areas[at(c.component)] += grid.step * grid.step / 1.5;
    shuffle(all);
    constexpr double least_count = 30;
    std::vector<Thinning> thinnings;
    for (std::size_t c = 0; c < seeds.areas.size(); ++c) {
        double apart = std::min(spacing, std::sqrt(seeds.areas[c] / least_count));
        if (c < finer.size()) apart = std::ldexp(apart, -finer[c]);
        thinnings.emplace_back(apart);
    }
    for (const Crossing& c : all)
        if (thinnings[at(c.component)].take(c.point - grid.origin)) {
            seeds.points.push_back(c.point);
            seeds.component.push_back(c.component);
        }
    return seeds;
}

} // namespace sinew::solver
