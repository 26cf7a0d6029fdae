// The level set's grid: which blocks it passes, exact distances there, signs, cavities.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/distance_grid.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <memory>

namespace sinew::solver {
namespace {

constexpr int cells = DistanceGrid::cells, samples = DistanceGrid::samples;
constexpr std::size_t block_samples = samples * samples * samples;
using Block = std::array<int, 3>;

/// Triangles cut into pieces no longer than `length`; those between two places that are both inside are left
/// out.
class OuterPieces {
  public:
    OuterPieces(const Soup& soup, const SurfaceTree& tree, double length, const MeshingControl& control)
        : soup_(soup)
        , tree_(tree)
        , length_(length)
        , control_(control) {}

    Soup make() {
        std::vector<std::vector<std::array<Vec3, 3>>> kept(soup_.triangles.size());
        std::vector<char> hidden(kept.size(), 0);
        constexpr std::size_t run = 1024;
        const auto find = [&](std::size_t t) {
            const Triangle& c = soup_.triangles[t];
            const std::array<Vec3, 3> whole{soup_.points[at(c[0])], soup_.points[at(c[1])], soup_.points[at(c[2])]};
            std::size_t pieces = 0;
            cut(whole, kept[t], pieces);
            hidden[t] = kept[t].size() != pieces;
            if (!hidden[t]) kept[t] = {whole};
        };
        for (std::size_t first = 0; first < kept.size(); first += run) {
            if (control_.stop && control_.stop()) throw Stopped();
            parallel_for(std::min(run, kept.size() - first), 64, [&](std::size_t i) { find(first + i); });
        }
        any_hidden_ = std::find(hidden.begin(), hidden.end(), 1) != hidden.end();
        Soup out;
        for (const auto& pieces : kept)
            for (const auto& p : pieces) {
                const int first = static_cast<int>(out.points.size());
                out.points.insert(out.points.end(), p.begin(), p.end());
                out.triangles.push_back({first, first + 1, first + 2});
            }
        return out;
    }
    bool any_hidden() const { return any_hidden_; }

  private:
    void cut(const std::array<Vec3, 3>& c, std::vector<std::array<Vec3, 3>>& kept, std::size_t& pieces) const {
        std::size_t longest = 0;
        const auto length2 = [&](std::size_t k) { return (c[(k + 1) % 3] - c[k]).squaredNorm(); };
        for (std::size_t k = 1; k < 3; ++k)
            if (length2(k) > length2(longest)) longest = k;
        if (length2(longest) > length_ * length_) {
            const Vec3 &a = c[longest], &b = c[(longest + 1) % 3], &apex = c[(longest + 2) % 3];
            const Vec3 middle = 0.5 * (a + b);
            cut({a, middle, apex}, kept, pieces);
            cut({middle, b, apex}, kept, pieces);
            return;
        }
        ++pieces;
        if (separates(c)) kept.push_back(c);
    }

    /// Whether inside and outside lie on the two sides of the piece.
    bool separates(const std::array<Vec3, 3>& c) const {
        const Vec3 cross = (c[1] - c[0]).cross(c[2] - c[0]);
        const double area = cross.norm();
        if (!(area > 0)) return false; // its edges belong to neighbours as well
        const Vec3 centre = (c[0] + c[1] + c[2]) / 3, aside = cross * (1e-4 * length_ / area);
        return is_inside(centre + aside) != is_inside(centre - aside);
    }
    bool is_inside(const Vec3& p) const { return std::abs(tree_.winding_number(p)) > 0.5; }

    const Soup& soup_;
    const SurfaceTree& tree_;
    double length_;
    const MeshingControl& control_;
    bool any_hidden_ = false;
};

class Builder {
  public:
    Builder(const Soup& soup, double iso, int resolution, const MeshingControl& control)
        : soup_(soup)
        , iso_(iso)
        , control_(control)
        , tree_(std::make_unique<SurfaceTree>(soup.points, soup.triangles)) {
        place(resolution);
        if (iso < 0) {
            OuterPieces pieces(soup, *tree_, 2 * grid_.step, control);
            const Soup outer = pieces.make();
            if (pieces.any_hidden() && !outer.triangles.empty())
                distances_ = std::make_unique<SurfaceTree>(outer.points, outer.triangles);
        }
    }

    DistanceGrid make() {
        find_blocks();
        fill_blocks();
        if (!soup_.is_closed) fill_cavities();
        return std::move(grid_);
    }

  private:
    void place(int resolution) {
        const Box box = bounding_box(soup_.points);
        const Vec3 size = box.size() + Vec3::Constant(2 * std::max(iso_, 0.0));
        // Four of the cells along the longest side are space around the level set.
        grid_.step = size.maxCoeff() / std::max(resolution - 4, 1);
        for (std::size_t d = 0; d < 3; ++d)
            grid_.blocks[d] = static_cast<int>(std::ceil((size[static_cast<int>(d)] / grid_.step + 4) / cells - 1e-9));
        const Vec3 whole = Vec3(grid_.blocks[0], grid_.blocks[1], grid_.blocks[2]) * (cells * grid_.step);
        grid_.origin = box.centre() - 0.5 * whole;
    }

    std::size_t block_count() const {
        return static_cast<std::size_t>(std::int64_t{1} * grid_.blocks[0] * grid_.blocks[1] * grid_.blocks[2]);
    }
    Block block(std::size_t n) const {
        const auto nx = static_cast<std::size_t>(grid_.blocks[0]), ny = static_cast<std::size_t>(grid_.blocks[1]);
        return {static_cast<int>(n % nx), static_cast<int>(n / nx % ny), static_cast<int>(n / nx / ny)};
    }
    Vec3 centre(const Block& b) const {
        return grid_.origin + (cells * grid_.step) * (Vec3(b[0], b[1], b[2]) + Vec3::Constant(0.5));
    }
    /// From a block's centre to its corners, a little rounded up.
    double block_radius() const { return 0.5 * cells * grid_.step * std::sqrt(3.0) * (1 + 1e-9); }
    const SurfaceTree& distances() const { return distances_ ? *distances_ : *tree_; }
    /// 1 outside, -1 inside.
    int sign(const Vec3& p) const { return soup_.is_closed && std::abs(tree_->winding_number(p)) > 0.5 ? -1 : 1; }

    /// Calls work(i) for i in [0, count), a run at a time, and asks between runs whether to stop.
    template <class Work>
    void watched(std::size_t count, double from, double to, const Work& work) const {
        constexpr std::size_t run = 512;
        for (std::size_t first = 0; first < count; first += run) {
            if (control_.stop && control_.stop()) throw Stopped();
            if (control_.progress)
                control_.progress(from + (to - from) * static_cast<double>(first) / static_cast<double>(count),
                                  "measuring distances");
            parallel_for(std::min(run, count - first), 4, [&](std::size_t i) { work(first + i); });
        }
    }

    void find_blocks() {
        grid_.slot.assign(block_count(), 0);
        centre_distance_.resize(block_count());
        const double radius = block_radius(), level = std::abs(iso_);
        watched(block_count(), 0, 0.3, [&](std::size_t n) {
            const Vec3 c = centre(block(n));
            const double d = distances().closest(c).distance;
            centre_distance_[n] = d;
            if (d > level + radius)
                grid_.slot[n] = sign(c) > 0 ? DistanceGrid::all_outside : DistanceGrid::all_inside;
            else if (d + radius < level)
                grid_.slot[n] = iso_ > 0 ? DistanceGrid::all_inside : DistanceGrid::all_outside;
        });
        for (std::size_t n = 0; n < block_count(); ++n)
            if (grid_.slot[n] == 0) {
                grid_.slot[n] = static_cast<int>(grid_.filled.size());
                grid_.filled.push_back(block(n));
            }
        constexpr std::size_t most = 500000; // 1.5 GB of samples
        if (grid_.filled.size() > most)
            throw Error("FE232",
                        "the level set passes " + std::to_string(grid_.filled.size()) +
                            " blocks of the grid, more than " + std::to_string(most),
                        "Choose a smaller resolution.");
    }

    void fill_blocks() {
        grid_.values.resize(grid_.filled.size() * block_samples);
        watched(grid_.filled.size(), 0.3, 1, [&](std::size_t place) { fill_block(place); });
    }

    void fill_block(std::size_t place) {
        const Block& b = grid_.filled[place];
        const double near_centre = centre_distance_[static_cast<std::size_t>(grid_.number(b))];
        const Vec3 c = centre(b);
        std::array<double, block_samples> distance;
        std::array<signed char, block_samples> side;
        side.fill(0);
        // The closest point of the whole surface to the centre tells the side of the block only if the block
        // cannot reach that surface; `tree_`, because hidden pieces count for winding numbers too.
        const bool is_clear = tree_->closest(c, 2 * block_radius()).distance > block_radius();
        const int one_side = is_clear ? sign(c) : 0;
        for (int k = 0; k < samples; ++k)
            for (int j = 0; j < samples; ++j)
                for (int i = 0; i < samples; ++i) {
                    const std::size_t s = DistanceGrid::sample(i, j, k);
                    const Vec3 p = grid_.position(b[0] * cells + i, b[1] * cells + j, b[2] * cells + k);
                    const double reach = i > 0 ? distance[s - 1] + grid_.step : near_centre + (p - c).norm();
                    distance[s] = distances().closest(p, reach * (1 + 1e-9)).distance;
                    side[s] = static_cast<signed char>(one_side ? one_side : side_of(p, s, {i, j, k}, distance, side));
                    auto f = static_cast<float>(side[s] * distance[s] - iso_);
                    if (f == 0) f = -FLT_MIN; // so that a surface inside another part makes no crossing
                    grid_.values[place * block_samples + s] = f;
                }
    }

    /// A sample has its neighbour's side if the step between them is too short to reach the surface.
    int side_of(const Vec3& p, std::size_t s, const std::array<int, 3>& index,
                const std::array<double, block_samples>& distance,
                const std::array<signed char, block_samples>& side) const {
        if (!soup_.is_closed) return 1;
        constexpr std::array<std::size_t, 3> back{1, samples, samples * samples};
        // Distances may leave hidden pieces out; then they do not tell how far the surface is.
        if (!distances_)
            for (std::size_t d = 0; d < 3; ++d)
                if (index[d] > 0 && std::max(distance[s], distance[s - back[d]]) > grid_.step * (1 + 1e-6))
                    return side[s - back[d]];
        return sign(p);
    }

    void fill_cavities();

    const Soup& soup_;
    double iso_;
    const MeshingControl& control_;
    std::unique_ptr<SurfaceTree> tree_, distances_; ///< distances_: without hidden pieces, if that differs
    DistanceGrid grid_;
    std::vector<double> centre_distance_;
};

/// What can be reached from outside through samples and blocks outside the level set.
class Flood {
  public:
    explicit Flood(DistanceGrid& grid)
        : grid_(grid)
        , block_reached_(grid.slot.size(), 0)
        , sample_reached_(grid.values.size(), 0) {}

    void run() {
        // The rim of the grid is outside.
        for (int z = 0; z < grid_.blocks[2]; ++z)
            for (int y = 0; y < grid_.blocks[1]; ++y)
                for (int x = 0; x < grid_.blocks[0]; ++x)
                    for (int d = 0; d < 3; ++d) {
                        const Block b{x, y, z};
                        if (b[at(d)] == 0) reach_face(b, d, 0);
                        if (b[at(d)] == grid_.blocks[at(d)] - 1) reach_face(b, d, cells);
                    }
        while (!open_.empty()) {
            const Place p = open_.back();
            open_.pop_back();
            p.sample < 0 ? leave_block(p.block) : leave_sample(p);
        }
    }

    /// Everything outside that was not reached becomes inside.
    void close_the_rest() {
        for (std::size_t b = 0; b < grid_.slot.size(); ++b)
            if (grid_.slot[b] == DistanceGrid::all_outside && !block_reached_[b])
                grid_.slot[b] = DistanceGrid::all_inside;
        for (std::size_t s = 0; s < grid_.values.size(); ++s)
            if (grid_.values[s] > 0 && !sample_reached_[s]) grid_.values[s] = -grid_.values[s];
    }

  private:
    struct Place {
        Block block;
        int sample = -1; ///< -1: a block without samples
    };

    void reach_block(const Block& b) {
        auto& reached = block_reached_[static_cast<std::size_t>(grid_.number(b))];
        if (reached) return;
        reached = 1;
        open_.push_back({b, -1});
    }
    /// Sample (i, j, k) of a block, if it is outside the level set.
    void reach_sample(const Block& b, int place, const std::array<int, 3>& i) {
        const std::size_t s = DistanceGrid::sample(i[0], i[1], i[2]), all = at(place) * block_samples + s;
        if (sample_reached_[all] || grid_.values[all] < 0) return;
        sample_reached_[all] = 1;
        open_.push_back({b, static_cast<int>(s)});
    }
    /// The samples of a block on its lower (0) or upper (cells) face across axis d, or the block itself.
    void reach_face(const Block& b, int d, int end) {
        if (!grid_.holds(b)) return;
        const int place = grid_.slot_of(b);
        if (place == DistanceGrid::all_outside) reach_block(b);
        if (place < 0) return;
        for (int u = 0; u < samples; ++u)
            for (int v = 0; v < samples; ++v) {
                std::array<int, 3> i;
                i[at(d)] = end;
                i[at((d + 1) % 3)] = u;
                i[at((d + 2) % 3)] = v;
                reach_sample(b, place, i);
            }
    }
    void leave_block(const Block& b) {
        for (int d = 0; d < 3; ++d) {
            Block n = b;
            --n[at(d)];
            reach_face(n, d, cells);
            n[at(d)] += 2;
            reach_face(n, d, 0);
        }
    }
    void leave_sample(const Place& p) {
        const std::array<int, 3> i{p.sample % samples, p.sample / samples % samples, p.sample / (samples * samples)};
        const int place = grid_.slot_of(p.block);
        for (std::size_t d = 0; d < 3; ++d)
            for (int way : {-1, 1}) {
                std::array<int, 3> n = i;
                n[d] += way;
                if (n[d] >= 0 && n[d] <= cells) reach_sample(p.block, place, n);
            }
        share(p.block, i);
    }
    /// The same sample in the neighbouring blocks that repeat it.
    void share(const Block& b, const std::array<int, 3>& i) {
        for (std::size_t d = 0; d < 3; ++d) {
            if (i[d] != 0 && i[d] != cells) continue;
            Block n = b;
            n[d] += i[d] == 0 ? -1 : 1;
            if (!grid_.holds(n)) continue;
            std::array<int, 3> j = i;
            j[d] = cells - i[d];
            const int place = grid_.slot_of(n);
            if (place == DistanceGrid::all_outside) reach_block(n);
            if (place >= 0) reach_sample(n, place, j);
        }
    }

    DistanceGrid& grid_;
    std::vector<char> block_reached_, sample_reached_;
    std::vector<Place> open_;
};

void Builder::fill_cavities() {
    Flood flood(grid_);
    flood.run();
    flood.close_the_rest();
}

} // namespace

double DistanceGrid::value(const Vec3& p) const {
    const Vec3 g = (p - origin) / step;
    std::array<int, 3> cell, b, in;
    Vec3 t;
    for (int d = 0; d < 3; ++d) {
        const auto e = static_cast<std::size_t>(d);
        if (!(g[d] >= 0) || g[d] > blocks[e] * cells) return step;
        cell[e] = std::min(static_cast<int>(g[d]), blocks[e] * cells - 1);
        t[d] = g[d] - cell[e];
        b[e] = cell[e] / cells;
        in[e] = cell[e] % cells;
    }
    const int place = slot_of(b);
    if (place < 0) return place == all_outside ? step : -step;
    const float* v = &values[static_cast<std::size_t>(place) * block_samples + sample(in[0], in[1], in[2])];
    constexpr int y = samples, z = samples * samples;
    const auto along_x = [&](const float* f) { return f[0] + t[0] * (f[1] - static_cast<double>(f[0])); };
    const auto mix = [](double a, double c, double s) { return a + s * (c - a); };
    return mix(mix(along_x(v), along_x(v + y), t[1]), mix(along_x(v + z), along_x(v + y + z), t[1]), t[2]);
}

DistanceGrid make_distance_grid(const Soup& soup, double iso, int resolution, const MeshingControl& control) {
    return Builder(soup, iso, resolution, control).make();
}

} // namespace sinew::solver
