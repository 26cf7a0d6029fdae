// Recovery of edges and faces by flips.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/boundary_recovery.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/tet_quality.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>

namespace sinew::solver {
namespace {

using Edge = std::array<int, 2>;
Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }
Triangle face_of(int a, int b, int c) {
    Triangle t{a, b, c};
    std::sort(t.begin(), t.end());
    return t;
}

/// What stands in the way of an edge or a face.
struct Crossings {
    std::set<Edge> edges;
    std::set<Triangle> faces;
    std::set<int> tets;    ///< those through which it goes
    bool hopeless = false; ///< a vertex lies on what is wanted
    std::size_t count() const { return edges.size() + faces.size(); }
};

class Recovery {
  public:
    Recovery(TetComplex& complex, const std::vector<Triangle>& triangles, const MeshingControl& control)
        : complex_(complex)
        , triangles_(triangles)
        , control_(control) {
        for (const Vec3& p : complex.vertices) points_.emplace_back(p.x(), p.y(), p.z());
        for (const Triangle& t : triangles) {
            wanted_faces_.insert(face_of(t[0], t[1], t[2]));
            for (std::size_t k = 0; k < 3; ++k) wanted_edges_.insert(edge_of(t[k], t[(k + 1) % 3]));
        }
    }

    std::vector<int> run() {
        // Faces free the way for edges and the other way round, so a second round may get what the first did
        // not.
        for (int round = 0; round < 3; ++round) {
            std::size_t missing = 0;
            for (const Edge& e : wanted_edges_) {
                watch();
                if (!complex_.has_edge(e[0], e[1])) missing += !recover([&] { return across_edge(e); });
            }
            for (const Triangle& f : wanted_faces_) {
                watch();
                const bool has_edges =
                    complex_.has_edge(f[0], f[1]) && complex_.has_edge(f[1], f[2]) && complex_.has_edge(f[2], f[0]);
                if (complex_.has_face(f[0], f[1], f[2])) continue;
                missing += !has_edges || !recover([&] { return across_face(f); });
            }
            if (missing == 0) break;
            fill_cavities();
        }
        std::vector<int> out;
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            if (!complex_.has_face(triangles_[t][0], triangles_[t][1], triangles_[t][2]))
                out.push_back(static_cast<int>(t));
        return out;
    }

  private:
    using Find = std::function<Crossings()>;
    /// A triangulation of part of a ring, as tets, and the quality of the worst.
    struct Part {
        double worst = std::numeric_limits<double>::infinity();
        std::vector<Tet> tets;
    };

    void watch() {
        if (++asked_ % 64 == 0 && control_.stop && control_.stop()) throw Stopped();
    }
    int side(int a, int b, int c, int d) const {
        return CGAL::orientation(points_[at(a)], points_[at(b)], points_[at(c)], points_[at(d)]);
    }

    // ---- what crosses ----

    /// How segment ab meets the inside of triangle pqr, none of whose corners it has: 0 not, 1 inside, 2 on
    /// edge `which` (pq, qr, rp), 3 at a corner.
    int meets(int a, int b, const Triangle& t, std::size_t& which) const {
        const int sa = side(t[0], t[1], t[2], a), sb = side(t[0], t[1], t[2], b);
        if (sa * sb >= 0) return 0;
        std::array<int, 3> s{};
        int zeros = 0, positive = 0, negative = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            s[k] = side(a, b, t[k], t[(k + 1) % 3]);
            if (s[k] == 0) ++zeros, which = k;
            positive += s[k] > 0, negative += s[k] < 0;
        }
        if (positive > 0 && negative > 0) return 0;
        return zeros == 0 ? 1 : zeros == 1 ? 2 : 3;
    }

    /// Faces and edges that edge ab would cross, from tet to tet.
    Crossings across_edge(const Edge& e) const {
        Crossings out;
        const auto& [a, b] = e;
        std::vector<int> open;
        std::set<int> seen; // of those met on the way
        const auto visit = [&](int t) {
            if (t >= 0 && seen.insert(t).second) open.push_back(t);
        };
        const auto leave = [&](int number) {
            const Tet& t = complex_.tet(number);
            for (const auto& [i, j, k, l] : tet_faces) {
                const Triangle f{t[i], t[j], t[k]};
                if (std::find(f.begin(), f.end(), a) != f.end() || std::find(f.begin(), f.end(), b) != f.end())
                    continue;
                std::size_t which = 0;
                switch (meets(a, b, f, which)) {
                case 1:
                    out.faces.insert(face_of(f[0], f[1], f[2]));
                    out.tets.insert({number, complex_.beside(number, f[0], f[1], f[2])});
                    visit(complex_.beside(number, f[0], f[1], f[2]));
                    break;
                case 2: {
                    const int p = f[which], q = f[(which + 1) % 3];
                    if (!out.edges.insert(edge_of(p, q)).second) break; // met from another tet of its ring before
                    for (const int s : complex_.tets_of[at(p)])
                        if (has_corner(complex_.tet(s), q)) out.tets.insert(s), visit(s);
                    break;
                }
                case 3:
                    out.hopeless = true;
                    break;
                default:
                    break;
                }
            }
        };
        // The hub of a wide fan is in thousands of tets, through few of which the edge goes.
        for (const int t : complex_.tets_of[at(a)])
            if (leave(t); out.hopeless) return out;
        while (!open.empty() && !out.hopeless) {
            const int t = open.back();
            open.pop_back();
            leave(t);
        }
        return out;
    }

    bool pierces(int p, int q, const Triangle& f) const {
        for (const int v : f)
            if (v == p || v == q) return false;
        std::size_t which = 0;
        return meets(p, q, f, which) != 0;
    }

    /// Edges that a face would be crossed by.
    Crossings across_face(const Triangle& f, std::vector<int> open = {}) const {
        Crossings out;
        for (const int v : f) open.insert(open.end(), complex_.tets_of[at(v)].begin(), complex_.tets_of[at(v)].end());
        std::set<int> seen; // of those met on the way
        while (!open.empty()) {
            const Tet t = complex_.tet(open.back());
            open.pop_back();
            for (const auto& [i, j] : tet_edges) {
                if (!pierces(t[i], t[j], f) || !out.edges.insert(edge_of(t[i], t[j])).second) continue;
                for (const int s : complex_.tets_of[at(t[i])])
                    if (has_corner(complex_.tet(s), t[j])) {
                        out.tets.insert(s);
                        if (seen.insert(s).second) open.push_back(s);
                    }
            }
        }
        return out;
    }

    // ---- flips ----

    /// Clears the way of what `find` looks at; true if nothing is in the way any more.
    bool recover(const Find& find) {
        Crossings now = find();
        while (!now.hopeless && now.count() > 0) {
            watch();
            bool better = false;
            for (const Triangle& f : now.faces)
                if ((better = try_face(f, find, now))) break;
            if (!better)
                for (const Edge& e : now.edges)
                    if ((better = try_edge(e, find, now))) break;
            if (!better) better = try_around(find, now);
            if (!better) return false;
        }
        return !now.hopeless;
    }

    /// Edges and faces beside what crosses: the edges of crossing faces, the faces at crossing edges.
    bool try_around(const Find& find, Crossings& now) {
        std::set<Edge> edges;
        std::set<Triangle> faces;
        for (const Triangle& f : now.faces)
            for (std::size_t k = 0; k < 3; ++k) edges.insert(edge_of(f[k], f[(k + 1) % 3]));
        for (const auto& [p, q] : now.edges)
            for (const int t : complex_.tets_of[at(p)]) {
                if (!has_corner(complex_.tet(t), q)) continue;
                for (const int v : complex_.tet(t))
                    if (v != p && v != q)
                        faces.insert(face_of(p, q, v)), edges.insert(edge_of(p, v)), edges.insert(edge_of(q, v));
            }
        for (const Edge& e : edges)
            if (!now.edges.contains(e) && try_edge(e, find, now)) return true;
        for (const Triangle& f : faces)
            if (!now.faces.contains(f) && try_face(f, find, now)) return true;
        return false;
    }

    bool is_positive(const Tet& t) const { return side(t[0], t[1], t[2], t[3]) > 0; }
    double worth(const Tet& t) const {
        if (!is_positive(t)) return -1;
        const auto x = [&](std::size_t k) -> const Vec3& { return complex_.vertices[at(t[k])]; };
        return std::max(tet_quality(x(0), x(1), x(2), x(3)), 1e-300);
    }

    /// Puts fresh tets in place of old ones if less is in the way then; if not, `old` are the numbers of the
    /// tets that were put back.
    bool exchange(std::vector<int>& old, const std::vector<Tet>& fresh, const Find& find, Crossings& now) {
        std::vector<Tet> before;
        for (const int t : old) before.push_back(complex_.tet(t));
        const std::vector<int> made = complex_.replace(old, fresh);
        Crossings then = find();
        if (!then.hopeless && then.count() < now.count()) {
            now = std::move(then);
            return true;
        }
        old = complex_.replace(made, before);
        return false;
    }

    bool try_face(const Triangle& f, const Find& find, Crossings& now) {
        if (wanted_faces_.contains(f)) return false;
        const int t = complex_.beside(-1, f[0], f[1], f[2]);
        const int other = t < 0 ? -1 : complex_.beside(t, f[0], f[1], f[2]);
        if (other < 0) return false;
        const Tet corners = complex_.tet(t);
        for (const auto& [i, j, k, l] : tet_faces) {
            const int a = corners[i], b = corners[j], c = corners[k], below = corners[l];
            if (face_of(a, b, c) != f) continue;
            int above = -1;
            for (const int v : complex_.tet(other))
                if (v != a && v != b && v != c) above = v;
            const std::vector<Tet> fresh{{below, above, a, b}, {below, above, b, c}, {below, above, c, a}};
            for (const Tet& n : fresh)
                if (!is_positive(n)) return false;
            std::vector<int> old{t, other};
            return exchange(old, fresh, find, now);
        }
        return false;
    }

    bool try_edge(const Edge& e, const Find& find, Crossings& now) {
        if (wanted_edges_.contains(e)) return false;
        auto ring = complex_.ring_of(e[0], e[1]);
        if (!ring) return false;
        std::vector<Part> found = parts(*ring, 0, ring->vertices.size() - 1);
        std::stable_sort(found.begin(), found.end(), [](const Part& a, const Part& b) { return a.worst > b.worst; });
        constexpr std::size_t most = 24;
        for (std::size_t i = 0; i < std::min(found.size(), most); ++i)
            if (exchange(ring->tets, found[i].tets, find, now)) return true;
        return false;
    }

    /// All triangulations of the polygon first … last of the ring into tets that are positively oriented.
    std::vector<Part> parts(const TetComplex::Ring& ring, std::size_t first, std::size_t last) const {
        if (last < first + 2) return {Part{}};
        std::vector<Part> out;
        for (std::size_t k = first + 1; k < last; ++k) {
            const Tet lower{ring.a, ring.vertices[first], ring.vertices[k], ring.vertices[last]},
                upper{ring.b, ring.vertices[first], ring.vertices[last], ring.vertices[k]};
            const double w = std::min(worth(lower), worth(upper));
            if (w < 0) continue;
            const std::vector<Part> left = parts(ring, first, k), right = parts(ring, k, last);
            for (const Part& l : left)
                for (const Part& r : right) {
                    Part p{std::min({w, l.worst, r.worst}), l.tets};
                    p.tets.insert(p.tets.end(), r.tets.begin(), r.tets.end());
                    p.tets.push_back(lower);
                    p.tets.push_back(upper);
                    out.push_back(std::move(p));
                }
        }
        return out;
    }

    // ---- cavities ----

    /// What flips did not get: the tets through which missing triangles go are taken out, and what is left on
    /// either side of the triangles is filled from a new vertex that sees all of its walls.
    void fill_cavities() {
        for (const std::vector<Triangle>& patch : missing_patches()) {
            watch();
            const std::set<int> region = region_of(patch);
            if (!region.empty()) fill(patch, region);
        }
    }

    /// Missing triangles, joined over missing edges.
    std::vector<std::vector<Triangle>> missing_patches() const {
        std::vector<Triangle> missing;
        std::map<Edge, std::vector<std::size_t>> over;
        for (const Triangle& t : triangles_) {
            if (complex_.has_face(t[0], t[1], t[2])) continue;
            for (std::size_t k = 0; k < 3; ++k)
                if (const Edge e = edge_of(t[k], t[(k + 1) % 3]); !complex_.has_edge(e[0], e[1]))
                    over[e].push_back(missing.size());
            missing.push_back(t);
        }
        std::vector<std::vector<Triangle>> out;
        std::vector<char> seen(missing.size(), 0);
        for (std::size_t s = 0; s < missing.size(); ++s) {
            if (seen[s]) continue;
            std::vector<std::size_t> members{s};
            seen[s] = 1;
            for (std::size_t i = 0; i < members.size(); ++i)
                for (const auto& [edge, sharing] : over)
                    if (std::find(sharing.begin(), sharing.end(), members[i]) != sharing.end())
                        for (const std::size_t n : sharing)
                            if (!seen[n]) seen[n] = 1, members.push_back(n);
            out.emplace_back();
            for (const std::size_t m : members) out.back().push_back(missing[m]);
        }
        return out;
    }

    /// The tets through which a patch goes; none if a vertex lies on it.
    std::set<int> region_of(const std::vector<Triangle>& patch) const {
        std::set<int> region;
        for (const Triangle& t : patch)
            for (std::size_t k = 0; k < 3; ++k) {
                const Edge e = edge_of(t[k], t[(k + 1) % 3]);
                if (complex_.has_edge(e[0], e[1])) continue;
                const Crossings c = across_edge(e);
                if (c.hopeless) return {};
                region.insert(c.tets.begin(), c.tets.end());
            }
        for (const Triangle& t : patch) {
            const Crossings c = across_face(t, std::vector<int>(region.begin(), region.end()));
            region.insert(c.tets.begin(), c.tets.end());
        }
        region.erase(-1);
        return region;
    }

    void fill(const std::vector<Triangle>& patch, const std::set<int>& region) {
        // Walls of the region, seen from outside; nothing that is wanted may lie within.
        std::vector<Triangle> walls;
        for (const int number : region) {
            const Tet& t = complex_.tet(number);
            for (const auto& [i, j, k, l] : tet_faces) {
                const int other = complex_.beside(number, t[i], t[j], t[k]);
                if (!region.contains(other))
                    walls.push_back({t[i], t[j], t[k]});
                else if (wanted_faces_.contains(face_of(t[i], t[j], t[k])))
                    return;
            }
        }
        std::set<int> on_walls;
        for (const Triangle& w : walls) on_walls.insert(w.begin(), w.end());
        for (const int number : region)
            for (const int v : complex_.tet(number))
                if (is_wanted_vertex(v) && !on_walls.contains(v)) return;
        for (const int number : region)
            for (const auto& [i, j] : tet_edges)
                if (const Tet& t = complex_.tet(number); wanted_edges_.contains(edge_of(t[i], t[j])) &&
                                                         !(on_walls.contains(t[i]) && is_on_walls(walls, t[i], t[j])))
                    return;
        std::size_t used = 0;
        std::vector<Tet> fresh;
        std::vector<Triangle> turned = patch;
        for (Triangle& t : turned) std::swap(t[1], t[2]);
        for (const std::vector<Triangle>& side_of_patch : {patch, turned}) {
            std::vector<Triangle> shell = walls_beside(walls, side_of_patch);
            if (shell.empty()) return;
            used += shell.size();
            shell.insert(shell.end(), side_of_patch.begin(), side_of_patch.end());
            Vec3 eye;
            if (!find_eye(shell, eye)) return;
            const int v = complex_.add_vertex(eye);
            points_.emplace_back(eye.x(), eye.y(), eye.z());
            for (const Triangle& t : shell) fresh.push_back({v, t[0], t[1], t[2]});
        }
        // Walls that the patch does not reach, around a hole in the region, would be filled over.
        if (used == walls.size()) complex_.replace(std::vector<int>(region.begin(), region.end()), fresh);
    }

    static bool is_on_walls(const std::vector<Triangle>& walls, int a, int b) {
        return std::any_of(walls.begin(), walls.end(), [&](const Triangle& w) {
            return std::find(w.begin(), w.end(), a) != w.end() && std::find(w.begin(), w.end(), b) != w.end();
        });
    }

    bool is_wanted_vertex(int v) const {
        return std::any_of(complex_.tets_of[at(v)].begin(), complex_.tets_of[at(v)].end(), [&](int t) {
            const Tet& c = complex_.tet(t);
            return std::any_of(c.begin(), c.end(),
                               [&](int w) { return w != v && wanted_edges_.contains(edge_of(v, w)); });
        });
    }

    /// The walls that close the patch, together with which they are the surface of one side of the region;
    /// none if the patch's border does not lie on the walls.
    static std::vector<Triangle> walls_beside(const std::vector<Triangle>& walls, const std::vector<Triangle>& patch) {
        std::map<Edge, int> border; // directed edges of the patch that its triangles do not share
        for (const Triangle& t : patch)
            for (std::size_t k = 0; k < 3; ++k)
                if (!border.erase({t[(k + 1) % 3], t[k]})) border[{t[k], t[(k + 1) % 3]}] = 0;
        // Walls may touch each other along an edge; there it is left open which follows which.
        std::map<Edge, std::vector<std::size_t>> walls_at; // by directed edge
        for (std::size_t w = 0; w < walls.size(); ++w)
            for (std::size_t k = 0; k < 3; ++k) walls_at[{walls[w][k], walls[w][(k + 1) % 3]}].push_back(w);
        std::vector<std::size_t> open;
        std::set<std::size_t> seen;
        const auto reach = [&](const Edge& directed) {
            const auto w = walls_at.find(directed);
            if (w == walls_at.end() || w->second.size() != 1) return;
            if (seen.insert(w->second.front()).second) open.push_back(w->second.front());
        };
        for (const auto& [edge, unused] : border) reach({edge[1], edge[0]});
        while (!open.empty()) {
            const Triangle& t = walls[open.back()];
            open.pop_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const Edge back{t[(k + 1) % 3], t[k]};
                if (!border.contains(back)) reach(back);
            }
        }
        // Together with the patch they must be closed; if not, the patch does not divide the walls.
        std::map<Edge, int> balance;
        std::vector<Triangle> out;
        for (const std::size_t w : seen) out.push_back(walls[w]);
        std::vector<Triangle> shell = out;
        shell.insert(shell.end(), patch.begin(), patch.end());
        for (const Triangle& t : shell)
            for (std::size_t k = 0; k < 3; ++k) {
                const int a = t[k], b = t[(k + 1) % 3];
                balance[edge_of(a, b)] += a < b ? 1 : -1;
            }
        const bool is_closed = std::all_of(balance.begin(), balance.end(), [](const auto& e) { return e.second == 0; });
        return is_closed ? out : std::vector<Triangle>{};
    }

    /// A point that sees the inner side of every triangle: the one deepest inside all planes, as far as steps
    /// away from the nearest plane find it.
    bool find_eye(const std::vector<Triangle>& shell, Vec3& eye) const {
        struct Plane {
            Vec3 normal;
            double offset;
        };
        std::vector<Plane> planes;
        std::set<int> corners;
        for (const Triangle& t : shell) {
            const Vec3 &a = complex_.vertices[at(t[0])], &b = complex_.vertices[at(t[1])],
                       &c = complex_.vertices[at(t[2])];
            const Vec3 cross = (b - a).cross(c - a);
            if (!(cross.norm() > 0)) return false;
            planes.push_back({cross.normalized(), cross.normalized().dot(a)});
            corners.insert(t.begin(), t.end());
        }
        Vec3 p = Vec3::Zero(), low = complex_.vertices[at(*corners.begin())], high = low;
        for (const int v : corners) {
            const Vec3& x = complex_.vertices[at(v)];
            p += x / static_cast<double>(corners.size());
            low = low.cwiseMin(x), high = high.cwiseMax(x);
        }
        // The eye belongs near the patch, so the far walls of the surroundings do not set the scale of the
        // steps.
        const double scale = (high - low).norm();
        double deepest = -std::numeric_limits<double>::infinity();
        constexpr int steps = 3000;
        for (int i = 0; i < steps; ++i) {
            const Plane* nearest = nullptr;
            double depth = std::numeric_limits<double>::infinity();
            for (const Plane& q : planes)
                if (const double d = q.offset - q.normal.dot(p); d < depth) depth = d, nearest = &q;
            if (depth > deepest) deepest = depth, eye = p;
            p -= nearest->normal * (depth < 0 ? -1.2 * depth + 1e-6 * scale : 0.2 * scale / (10.0 + i));
        }
        if (!(deepest > 0)) return false;
        const CGAL::Exact_predicates_inexact_constructions_kernel::Point_3 e(eye.x(), eye.y(), eye.z());
        return std::all_of(shell.begin(), shell.end(), [&](const Triangle& t) {
            return CGAL::orientation(e, points_[at(t[0])], points_[at(t[1])], points_[at(t[2])]) > 0;
        });
    }

    TetComplex& complex_;
    const std::vector<Triangle>& triangles_;
    const MeshingControl& control_;
    std::vector<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3> points_;
    std::set<Edge> wanted_edges_;
    std::set<Triangle> wanted_faces_;
    std::size_t asked_ = 0;
};

} // namespace

std::vector<int> recover_boundary(TetComplex& complex, const std::vector<Triangle>& triangles,
                                  const MeshingControl& control) {
    return Recovery(complex, triangles, control).run();
}

} // namespace sinew::solver
