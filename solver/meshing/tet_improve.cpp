// Smoothing, edge removal, 2-3 flips and edge splits in a tet mesh with a fixed boundary.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_improve.h"

#include "solver/error.h"
#include "solver/mesh/tet_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sinew::solver {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr double fair = 0.5;  ///< tets below are worth a flip
constexpr double bad = 0.2;   ///< tets below are worth a new vertex
constexpr double gain = 1e-6; ///< least improvement, so that no two states alternate
constexpr int longest_ring = 9;

/// The faces of a tet, each seen from outside and followed by the corner across.
constexpr std::array<std::array<std::size_t, 4>, 4> faces{
    {{1, 2, 3, 0}, {0, 3, 2, 1}, {0, 1, 3, 2}, {0, 2, 1, 3}}};
constexpr std::array<std::array<std::size_t, 2>, 6> edges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

bool has(const Tet& t, int v) { return t[0] == v || t[1] == v || t[2] == v || t[3] == v; }

class Improver {
  public:
    Improver(TetMesh& mesh, const MeshingControl& control)
        : mesh_(mesh)
        , control_(control)
        , tets_of_(mesh.vertices.size())
        , is_fixed_(mesh.vertices.size(), 0)
        , alive_(mesh.tets.size(), 1) {
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            for (const int v : mesh.tets[t]) tets_of_[at(v)].push_back(static_cast<int>(t));
        for (const Triangle& t : boundary_triangles(mesh.tets))
            for (const int v : t) is_fixed_[at(v)] = 1;
    }

    void run(int passes) {
        for (int pass = 0; pass < passes; ++pass) {
            const double from = static_cast<double>(pass) / passes, each = 1.0 / passes;
            smooth_all(from, from + 0.5 * each);
            const std::size_t flips = flip_all(from + 0.5 * each, from + each);
            if (pass > 0 && flips == 0) break;
        }
        split_bad();
        drop_dead();
    }

  private:
    const Vec3& x(int v) const { return mesh_.vertices[at(v)]; }
    const Tet& tet(int t) const { return mesh_.tets[at(t)]; }
    double quality(const Tet& t) const { return tet_quality(x(t[0]), x(t[1]), x(t[2]), x(t[3])); }
    double worst_of(const std::vector<int>& tets) const {
        double worst = std::numeric_limits<double>::infinity();
        for (const int t : tets) worst = std::min(worst, quality(tet(t)));
        return worst;
    }
    void report(double from, double to, std::size_t done, std::size_t all) const {
        if (done % 256) return;
        if (control_.stop && control_.stop()) throw Stopped();
        if (control_.progress)
            control_.progress(from + (to - from) * static_cast<double>(done) /
                                         static_cast<double>(std::max<std::size_t>(all, 1)));
    }

    // ---- changes of connectivity ----

    int add(const Tet& t) {
        const int number = static_cast<int>(mesh_.tets.size());
        mesh_.tets.push_back(t);
        alive_.push_back(1);
        for (const int v : t) tets_of_[at(v)].push_back(number);
        return number;
    }
    void remove(int t) {
        alive_[at(t)] = 0;
        for (const int v : tet(t)) std::erase(tets_of_[at(v)], t);
    }
    void replace(const std::vector<int>& old, const std::vector<Tet>& fresh) {
        for (const int t : old) remove(t);
        for (const Tet& t : fresh) add(t);
    }

    /// The tets around edge ab and the vertices of the ring about it, in order; none if the edge lies in the
    /// boundary or the ring is too long.
    struct Ring {
        int a, b;
        std::vector<int> tets, vertices;
    };
    std::optional<Ring> ring_of(int a, int b) const {
        Ring ring{a, b, {}, {}};
        std::vector<std::array<int, 2>> steps;
        for (const int t : tets_of_[at(a)]) {
            if (!has(tet(t), b)) continue;
            ring.tets.push_back(t);
            steps.push_back(across(tet(t), a, b));
        }
        if (steps.size() < 3 || steps.size() > longest_ring) return std::nullopt;
        int v = steps.front()[0];
        do {
            ring.vertices.push_back(v);
            const auto next =
                std::find_if(steps.begin(), steps.end(), [&](const auto& s) { return s[0] == v; });
            if (next == steps.end()) return std::nullopt; // the ring is open: a boundary edge
            v = (*next)[1];
        } while (v != steps.front()[0] && ring.vertices.size() <= steps.size());
        if (ring.vertices.size() != steps.size()) return std::nullopt;
        return ring;
    }
    /// The two other corners (c, d) of a tet, such that (a, b, c, d) is positively oriented.
    static std::array<int, 2> across(const Tet& t, int a, int b) {
        std::array<std::size_t, 4> p{};
        std::size_t k = 2;
        for (std::size_t i = 0; i < 4; ++i)
            if (t[i] == a)
                p[0] = i;
            else if (t[i] == b)
                p[1] = i;
            else
                p[k++] = i;
        int swaps = 0; // parity of the permutation p
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) swaps += p[i] > p[j];
        if (swaps % 2) std::swap(p[2], p[3]);
        return {t[p[2]], t[p[3]]};
    }

    /// Replaces the tets around an edge by tets on triangles of its ring, if the worst gets better.
    bool remove_edge(int a, int b) {
        const std::optional<Ring> ring = ring_of(a, b);
        if (!ring) return false;
        const std::size_t n = ring->vertices.size();
        const double old = worst_of(ring->tets);
        // best[i][j]: the worst quality over the best triangulation of the polygon i, i + 1 … j.
        std::array<std::array<double, longest_ring>, longest_ring> best{};
        std::array<std::array<std::size_t, longest_ring>, longest_ring> by{};
        const auto lower = [&](std::size_t i, std::size_t k, std::size_t j) {
            return Tet{a, ring->vertices[i], ring->vertices[k], ring->vertices[j]};
        };
        const auto upper = [&](std::size_t i, std::size_t k, std::size_t j) {
            return Tet{b, ring->vertices[i], ring->vertices[j], ring->vertices[k]};
        };
        for (std::size_t i = 0; i + 1 < n; ++i) best[i][i + 1] = std::numeric_limits<double>::infinity();
        for (std::size_t length = 2; length < n; ++length)
            for (std::size_t i = 0; i + length < n; ++i) {
                const std::size_t j = i + length;
                best[i][j] = -2;
                for (std::size_t k = i + 1; k < j; ++k) {
                    double q = std::min(best[i][k], best[k][j]);
                    if (q <= std::max(best[i][j], old)) continue;
                    q = std::min({q, quality(lower(i, k, j)), quality(upper(i, k, j))});
                    if (q > best[i][j]) best[i][j] = q, by[i][j] = k;
                }
            }
        if (!(best[0][n - 1] > std::max(old, 0.0) + gain)) return false;
        std::vector<Tet> fresh;
        std::vector<std::array<std::size_t, 2>> open{{0, n - 1}};
        while (!open.empty()) {
            const auto [i, j] = open.back();
            open.pop_back();
            if (j < i + 2) continue;
            const std::size_t k = by[i][j];
            fresh.push_back(lower(i, k, j));
            fresh.push_back(upper(i, k, j));
            open.push_back({i, k});
            open.push_back({k, j});
        }
        replace(ring->tets, fresh);
        return true;
    }

    /// Two tets on a face become three around the edge between the corners across, if the worst gets better.
    bool remove_face(int t, std::size_t face) {
        const auto& [i, j, k, l] = faces[face];
        const int a = tet(t)[i], b = tet(t)[j], c = tet(t)[k], below = tet(t)[l];
        int other = -1;
        for (const int s : tets_of_[at(a)])
            if (s != t && has(tet(s), b) && has(tet(s), c)) other = s;
        if (other < 0) return false;
        int above = -1;
        for (const int v : tet(other))
            if (v != a && v != b && v != c) above = v;
        const double old = std::min(quality(tet(t)), quality(tet(other)));
        const std::vector<Tet> fresh{{below, above, a, b}, {below, above, b, c}, {below, above, c, a}};
        double worst = std::numeric_limits<double>::infinity();
        for (const Tet& f : fresh) worst = std::min(worst, quality(f));
        if (!(worst > std::max(old, 0.0) + gain)) return false;
        replace({t, other}, fresh);
        return true;
    }

    bool flip(int t) {
        const Tet corners = tet(t);
        for (const auto& [i, j] : edges)
            if (remove_edge(corners[i], corners[j])) return true;
        for (std::size_t f = 0; f < 4; ++f)
            if (remove_face(t, f)) return true;
        return false;
    }

    /// Living tets below a quality, worst first.
    std::vector<int> below(double limit) const {
        std::vector<std::pair<double, int>> found;
        for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
            if (!alive_[t]) continue;
            if (const double q = quality(mesh_.tets[t]); q < limit) found.push_back({q, static_cast<int>(t)});
        }
        std::sort(found.begin(), found.end());
        std::vector<int> out;
        for (const auto& [q, t] : found) out.push_back(t);
        return out;
    }

    std::size_t flip_all(double from, double to) {
        std::size_t flips = 0;
        const std::vector<int> poor = below(fair);
        for (std::size_t i = 0; i < poor.size(); ++i) {
            report(from, to, i, poor.size());
            if (alive_[at(poor[i])]) flips += flip(poor[i]);
        }
        return flips;
    }

    // ---- positions ----

    void smooth_all(double from, double to) {
        for (std::size_t v = 0; v < is_fixed_.size(); ++v) {
            report(from, to, v, is_fixed_.size());
            if (!is_fixed_[v]) smooth(static_cast<int>(v));
        }
    }

    /// Tries places towards the middle of the neighbours, and for bad tets away from their opposite face.
    void smooth(int v) {
        const std::vector<int>& star = tets_of_[at(v)];
        if (star.empty()) return;
        double best = worst_of(star);
        Vec3& place = mesh_.vertices[at(v)];
        Vec3 middle = Vec3::Zero();
        for (const int t : star)
            for (const int n : tet(t))
                if (n != v) middle += x(n);
        middle /= static_cast<double>(3 * star.size());
        const auto try_at = [&](const Vec3& p) {
            const Vec3 before = place;
            place = p;
            const double q = worst_of(star);
            if (q > best + gain) {
                best = q;
                return true;
            }
            place = before;
            return false;
        };
        const Vec3 start = place;
        for (const double share : {1.0, 0.5, 0.25})
            if (try_at(start + share * (middle - start))) break;
        if (best > fair) return;
        for (int step = 0; step < 4; ++step) {
            const auto worst = *std::min_element(
                star.begin(), star.end(), [&](int s, int t) { return quality(tet(s)) < quality(tet(t)); });
            const Vec3 up = rise(tet(worst), v);
            bool moved = false;
            for (const double share : {0.5, 0.2, 0.05})
                if ((moved = try_at(place + share * up))) break;
            if (!moved) break;
        }
    }

    /// From the opposite face upwards, as long as the side of a regular tet on that face would be.
    Vec3 rise(const Tet& t, int v) const {
        for (const auto& [i, j, k, l] : faces)
            if (t[l] == v) {
                const Vec3 cross = (x(t[j]) - x(t[i])).cross(x(t[k]) - x(t[i]));
                const double twice_area = cross.norm();
                return twice_area > 0 ? Vec3(-cross / std::sqrt(twice_area)) : Vec3::Zero();
            }
        return Vec3::Zero();
    }

    /// A new vertex on an interior edge of every bad tet, where that helps.
    void split_bad() {
        for (const int t : below(bad)) {
            if (!alive_[at(t)]) continue;
            const Tet corners = tet(t);
            for (const auto& [i, j] : edges)
                if (split_edge(corners[i], corners[j])) break;
        }
        for (int round = 0; round < 3; ++round) {
            for (const int t : below(fair))
                for (const int v : tet(t))
                    if (!is_fixed_[at(v)]) smooth(v);
            flip_all(1, 1);
        }
    }

    bool split_edge(int a, int b) {
        const std::optional<Ring> ring = ring_of(a, b);
        if (!ring) return false;
        const double old = worst_of(ring->tets);
        const int middle = static_cast<int>(mesh_.vertices.size());
        mesh_.vertices.push_back(0.5 * (x(a) + x(b)));
        tets_of_.emplace_back();
        is_fixed_.push_back(0);
        std::vector<Tet> fresh, whole;
        for (const int t : ring->tets) {
            whole.push_back(tet(t));
            for (const int end : {a, b}) {
                Tet half = tet(t);
                std::replace(half.begin(), half.end(), end, middle);
                fresh.push_back(half);
            }
        }
        replace(ring->tets, fresh);
        for (int k = 0; k < 3; ++k) smooth(middle);
        if (worst_of(tets_of_[at(middle)]) > std::max(old, 0.0) + gain) return true;
        replace(std::vector<int>(tets_of_[at(middle)]), whole);
        mesh_.vertices.pop_back();
        tets_of_.pop_back();
        is_fixed_.pop_back();
        return false;
    }

    void drop_dead() {
        std::size_t kept = 0;
        for (std::size_t t = 0; t < mesh_.tets.size(); ++t)
            if (alive_[t]) mesh_.tets[kept++] = mesh_.tets[t];
        mesh_.tets.resize(kept);
    }

    TetMesh& mesh_;
    const MeshingControl& control_;
    std::vector<std::vector<int>> tets_of_; ///< of each vertex, living ones
    std::vector<char> is_fixed_, alive_;
};

} // namespace

void improve_tets(TetMesh& mesh, int passes, const MeshingControl& control) {
    if (passes > 0) Improver(mesh, control).run(passes);
}

} // namespace sinew::solver
