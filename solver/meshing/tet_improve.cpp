// Smoothing, edge removal, 2-3 flips and edge splits in a tet mesh with a fixed boundary.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_improve.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/tet_cavity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::solver {
namespace {

constexpr double fair = 0.5;  ///< tets below are worth a flip
constexpr double bad = 0.35;  ///< tets below are worth a new vertex
constexpr double flat = 0.02; ///< tets below are worth a new vertex anywhere near
constexpr double gain = 1e-6; ///< least improvement, so that no two states alternate
class Improver {
  public:
    Improver(TetMesh& mesh, const MeshingControl& control)
        : mesh_(mesh)
        , control_(control)
        , complex_(std::move(mesh.vertices), std::move(mesh.tets))
        , cavity_(complex_)
        , is_fixed_(complex_.vertices.size(), 0) {
        for (const Triangle& t : boundary_triangles(complex_.living()))
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
        mend_flat();
        mesh_.vertices = std::move(complex_.vertices);
        mesh_.tets = complex_.living();
    }

  private:
    using Ring = TetComplex::Ring;
    const Vec3& x(int v) const { return complex_.vertices[at(v)]; }
    const Tet& tet(int t) const { return complex_.tet(t); }
    const std::vector<int>& star(int v) const { return complex_.tets_of[at(v)]; }
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
                                         static_cast<double>(std::max<std::size_t>(all, 1)),
                              "improving tets");
    }

    // ---- changes of connectivity ----

    /// Replaces the tets around an edge by tets on triangles of its ring, if the worst gets better.
    bool remove_edge(int a, int b) {
        const std::optional<Ring> ring = complex_.ring_of(a, b);
        if (!ring) return false;
        const std::size_t n = ring->vertices.size();
        const double old = worst_of(ring->tets);
        // best[i][j]: the worst quality over the best triangulation of the polygon i, i + 1 … j.
        std::array<std::array<double, TetComplex::longest_ring>, TetComplex::longest_ring> best{};
        std::array<std::array<std::size_t, TetComplex::longest_ring>, TetComplex::longest_ring> by{};
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
        complex_.replace(ring->tets, fresh);
        return true;
    }

    /// Two tets on a face become three around the edge between the corners across, if the worst gets better.
    bool remove_face(int t, std::size_t face) {
        const auto& [i, j, k, l] = tet_faces[face];
        const int a = tet(t)[i], b = tet(t)[j], c = tet(t)[k], below = tet(t)[l];
        const int other = complex_.beside(t, a, b, c);
        if (other < 0) return false;
        int above = -1;
        for (const int v : tet(other))
            if (v != a && v != b && v != c) above = v;
        const double old = std::min(quality(tet(t)), quality(tet(other)));
        const std::vector<Tet> fresh{{below, above, a, b}, {below, above, b, c}, {below, above, c, a}};
        double worst = std::numeric_limits<double>::infinity();
        for (const Tet& f : fresh) worst = std::min(worst, quality(f));
        if (!(worst > std::max(old, 0.0) + gain)) return false;
        complex_.replace({t, other}, fresh);
        return true;
    }

    bool flip(int t) {
        const Tet corners = tet(t);
        for (const auto& [i, j] : tet_edges)
            if (remove_edge(corners[i], corners[j])) return true;
        for (std::size_t f = 0; f < 4; ++f)
            if (remove_face(t, f)) return true;
        return false;
    }

    /// Living tets below a quality, worst first.
    std::vector<int> below(double limit) const {
        std::vector<std::pair<double, int>> found;
        for (int t = 0; t < static_cast<int>(complex_.count()); ++t) {
            if (!complex_.is_alive(t)) continue;
            if (const double q = quality(tet(t)); q < limit) found.push_back({q, t});
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
            if (complex_.is_alive(poor[i])) flips += flip(poor[i]);
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
        const std::vector<int>& around = star(v);
        if (around.empty()) return;
        double best = worst_of(around);
        Vec3& place = complex_.vertices[at(v)];
        Vec3 middle = Vec3::Zero();
        for (const int t : around)
            for (const int n : tet(t))
                if (n != v) middle += x(n);
        middle /= static_cast<double>(3 * around.size());
        const auto try_at = [&](const Vec3& p) {
            const Vec3 before = place;
            place = p;
            const double q = worst_of(around);
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
            const auto worst = *std::min_element(around.begin(), around.end(),
                                                 [&](int s, int t) { return quality(tet(s)) < quality(tet(t)); });
            const Vec3 up = rise(tet(worst), v);
            bool moved = false;
            for (const double share : {0.5, 0.2, 0.05})
                if ((moved = try_at(place + share * up))) break;
            if (!moved) break;
        }
    }

    /// From the opposite face upwards, as long as the side of a regular tet on that face would be.
    Vec3 rise(const Tet& t, int v) const {
        for (const auto& [i, j, k, l] : tet_faces)
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
            if (!complex_.is_alive(t)) continue;
            const Tet corners = tet(t);
            for (const auto& [i, j] : tet_edges)
                if (split_edge(corners[i], corners[j])) break;
        }
        settle();
    }

    void settle() {
        for (int round = 0; round < 3; ++round) {
            for (const int t : below(fair))
                for (const int v : tet(t))
                    if (!is_fixed_[at(v)]) smooth(v);
            flip_all(1, 1);
        }
    }

    /// What flips and vertices on edges leave flat: a vertex beside the tet, from which all around is filled.
    void mend_flat() {
        for (int round = 0; round < 4; ++round) {
            bool any = false;
            for (const int t : below(flat)) {
                report(1, 1, 0, 1);
                if (complex_.is_alive(t) && insert_near(t)) any = true;
            }
            if (!any) return;
            settle();
        }
    }

    bool insert_near(int t) {
        const auto middle_of = [&](int s) {
            const Tet& c = tet(s);
            return Vec3((x(c[0]) + x(c[1]) + x(c[2]) + x(c[3])) / 4);
        };
        // Within the tets beside it, and in the middle of all tets around.
        Points places;
        const Tet corners = tet(t);
        for (const auto& [i, j, k, l] : tet_faces)
            if (const int n = complex_.beside(t, corners[i], corners[j], corners[k]); n >= 0)
                places.push_back(middle_of(n));
        Vec3 sum = Vec3::Zero();
        double count = 0;
        for (const int v : corners)
            for (const int s : star(v)) sum += middle_of(s), count += 1;
        places.push_back(sum / count);
        places.push_back(0.5 * (sum / count + middle_of(t)));
        constexpr std::size_t most_tets = 60;
        double best = 0;
        Vec3 place;
        for (const Vec3& p : places) {
            cavity_.start(t);
            if (const double q = cavity_.grow_for(p, most_tets); q > best + gain) best = q, place = p;
        }
        if (best == 0) return false;
        cavity_.start(t);
        cavity_.grow_for(place, most_tets);
        const int v = complex_.add_vertex(place);
        is_fixed_.push_back(0);
        cavity_.fill(v);
        for (int k = 0; k < 3; ++k) smooth(v);
        return true;
    }

    bool split_edge(int a, int b) {
        const std::optional<Ring> ring = complex_.ring_of(a, b);
        if (!ring) return false;
        const double old = worst_of(ring->tets);
        const int middle = complex_.add_vertex(0.5 * (x(a) + x(b)));
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
        complex_.replace(ring->tets, fresh);
        for (int k = 0; k < 3; ++k) smooth(middle);
        if (worst_of(star(middle)) > std::max(old, 0.0) + gain) return true;
        complex_.replace(std::vector<int>(star(middle)), whole);
        complex_.drop_last_vertex();
        is_fixed_.pop_back();
        return false;
    }

    TetMesh& mesh_;
    const MeshingControl& control_;
    TetComplex complex_;
    TetCavity cavity_;
    std::vector<char> is_fixed_;
};

} // namespace

void improve_tets(TetMesh& mesh, int passes, const MeshingControl& control) {
    if (passes > 0) Improver(mesh, control).run(passes);
}

} // namespace sinew::solver
