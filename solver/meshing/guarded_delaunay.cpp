// The one place that knows CGAL's 3D triangulation.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/guarded_delaunay.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_boundary.h"
#include "solver/meshing/boundary_recovery.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace sinew::solver {
namespace {

enum Side : char { unknown, outside, inside };

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<char, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
using Cell = Delaunay::Cell_handle;
using Facet = Delaunay::Facet;

struct TriangleHash {
    std::size_t operator()(const Triangle& t) const {
        std::uint64_t h = 0;
        for (const int v : t) h = (h ^ static_cast<std::uint64_t>(v)) * 0x9e3779b97f4a7c15u + (h >> 29);
        return h;
    }
};

Triangle sorted(Triangle t) {
    std::sort(t.begin(), t.end());
    return t;
}

/// The same tet with its corners in one order.
Tet canonical(Tet t) {
    // Even permutations keep the orientation: the smallest first, then the smallest of the rest.
    const auto low = std::min_element(t.begin(), t.end()) - t.begin();
    if (low != 0) {
        std::swap(t[0], t[static_cast<std::size_t>(low)]);
        low == 1 ? std::swap(t[2], t[3]) : std::swap(t[1], t[low == 2 ? 3 : 2]);
    }
    while (t[1] > t[2] || t[1] > t[3]) t = {t[0], t[2], t[3], t[1]};
    return t;
}

class Builder {
  public:
    Builder(const Points& surface, const std::vector<Triangle>& triangles, const MeshingControl& control)
        : surface_(surface)
        , triangles_(triangles)
        , control_(control) {
        for (const Triangle& t : triangles) kept_.insert(sorted(t));
    }

    GuardedDelaunay make(const Points& inner) {
        GuardedDelaunay out;
        insert_surface();
        const bool is_complete = missing().empty();
        if (!is_complete) insert_box();
        out.vertices = surface_;
        for (std::size_t i = 0; i < inner.size(); ++i) {
            watch(i, inner.size());
            if (insert_guarded(inner[i], static_cast<int>(out.vertices.size())))
                out.vertices.push_back(inner[i]);
            else
                out.left_out.push_back(static_cast<int>(i));
        }
        if (!is_complete) {
            recover(out);
            return out;
        }
        find_sides();
        collect(out.tets);
        return out;
    }

  private:
    static Kernel::Point_3 point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

    void watch(std::size_t done, std::size_t all) const {
        if (done % 256) return;
        if (control_.stop && control_.stop()) throw Stopped();
        if (control_.progress)
            control_.progress(static_cast<double>(done) / static_cast<double>(all), "inserting points");
    }

    void insert_surface() {
        std::vector<std::pair<Kernel::Point_3, int>> all;
        for (std::size_t v = 0; v < surface_.size(); ++v) all.emplace_back(point(surface_[v]), static_cast<int>(v));
        delaunay_.insert(all.begin(), all.end());
        if (control_.stop && control_.stop()) throw Stopped();
    }

    /// Eight points far around: then the surface lies inside of what is triangulated, where flips can reach
    /// it. Their numbers are negative.
    void insert_box() {
        const Box box = bounding_box(surface_);
        const double reach = 2 * box.size().norm();
        for (int k = 0; k < 8; ++k) {
            const Vec3 way(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
            delaunay_.insert(point(box.centre() + reach * way))->info() = -1 - k;
        }
    }

    /// Puts the missing triangles into what is triangulated so far, and keeps the tets inside.
    void recover(GuardedDelaunay& out) {
        const int box_first = static_cast<int>(out.vertices.size());
        Points all = out.vertices;
        all.resize(all.size() + 8);
        std::vector<Tet> tets;
        for (auto c = delaunay_.finite_cells_begin(); c != delaunay_.finite_cells_end(); ++c) {
            Tet t;
            for (int k = 0; k < 4; ++k) {
                const auto v = c->vertex(k);
                t[at(k)] = v->info() >= 0 ? v->info() : box_first - 1 - v->info();
                if (v->info() < 0) all[at(t[at(k)])] = {v->point().x(), v->point().y(), v->point().z()};
            }
            tets.push_back(canonical(t));
        }
        std::sort(tets.begin(), tets.end());
        TetComplex complex(std::move(all), std::move(tets));
        out.missing = recover_boundary(complex, triangles_, control_);
        if (!out.missing.empty()) return;
        out.tets = inside_of(complex.living(), box_first, box_first + 8);
        out.vertices = std::move(complex.vertices);
        TetMesh used{std::move(out.vertices), std::move(out.tets), {}};
        // The box goes, and so do points that the recovery has cut off or put outside; the surface's are all
        // in use.
        drop_unused_vertices(used);
        out.vertices = std::move(used.vertices);
        out.tets = std::move(used.tets);
    }

    /// Tets that lie an odd number of triangles away from those with a vertex of the box.
    std::vector<Tet> inside_of(const std::vector<Tet>& tets, int far_first, int far_end) const {
        std::unordered_map<Triangle, std::array<int, 2>, TriangleHash> beside;
        const auto face = [&](std::size_t t, std::size_t k) {
            const Tet& c = tets[t];
            return sorted({c[(k + 1) % 4], c[(k + 2) % 4], c[(k + 3) % 4]});
        };
        for (std::size_t t = 0; t < tets.size(); ++t)
            for (std::size_t k = 0; k < 4; ++k) {
                const auto [entry, is_new] =
                    beside.try_emplace(face(t, k), std::array<int, 2>{static_cast<int>(t), -1});
                if (!is_new) entry->second[1] = static_cast<int>(t);
            }
        std::vector<char> side(tets.size(), unknown);
        std::vector<std::size_t> open;
        for (std::size_t t = 0; t < tets.size(); ++t)
            if (std::any_of(tets[t].begin(), tets[t].end(), [&](int v) { return v >= far_first && v < far_end; }))
                side[t] = outside, open.push_back(t);
        std::vector<Tet> out;
        while (!open.empty()) {
            const std::size_t t = open.back();
            open.pop_back();
            if (side[t] == inside) out.push_back(tets[t]);
            for (std::size_t k = 0; k < 4; ++k) {
                const Triangle f = face(t, k);
                const auto& [a, b] = beside.at(f);
                const int n = a == static_cast<int>(t) ? b : a;
                if (n < 0 || side[at(n)] != unknown) continue;
                const char across = side[t] == outside ? inside : outside;
                side[at(n)] = kept_.contains(f) ? across : side[t];
                open.push_back(at(n));
            }
        }
        for (Tet& t : out) t = canonical(t);
        std::sort(out.begin(), out.end());
        return out;
    }

    std::vector<int> missing() const {
        std::vector<Delaunay::Vertex_handle> handle(surface_.size());
        for (auto v = delaunay_.finite_vertices_begin(); v != delaunay_.finite_vertices_end(); ++v)
            handle[at(v->info())] = v; // nothing but the surface is in yet
        std::vector<int> out;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            const auto& [a, b, c] = triangles_[t];
            Cell cell;
            int i, j, k;
            if (!delaunay_.is_facet(handle[at(a)], handle[at(b)], handle[at(c)], cell, i, j, k))
                out.push_back(static_cast<int>(t));
        }
        return out;
    }

    bool is_kept(const Facet& f) const {
        Triangle t;
        for (int k = 0; k < 3; ++k) {
            const auto v = f.first->vertex(Delaunay::vertex_triple_index(f.second, k));
            if (delaunay_.is_infinite(v) || v->info() < 0 || v->info() >= static_cast<int>(surface_.size()))
                return false;
            t[at(k)] = v->info();
        }
        return kept_.contains(sorted(t));
    }

    /// The cells whose balls hold p; none if a triangle of the surface lies between two of them. Ends at the
    /// first such triangle: where all vertices lie on one sphere, every ball holds p.
    std::vector<Cell> free_zone(const Kernel::Point_3& p, Cell first) const {
        std::vector<Cell> zone{first};
        first->tds_data().mark_in_conflict();
        bool is_free = true;
        for (std::size_t i = 0; i < zone.size() && is_free; ++i)
            for (int k = 0; k < 4 && is_free; ++k) {
                const Cell n = zone[i]->neighbor(k);
                const bool is_known = n->tds_data().is_in_conflict();
                if (!is_known && delaunay_.side_of_sphere(n, p, true) != CGAL::ON_BOUNDED_SIDE) continue;
                if (is_kept({zone[i], k})) is_free = false;
                if (is_known) continue;
                n->tds_data().mark_in_conflict();
                zone.push_back(n);
            }
        for (const Cell& c : zone) c->tds_data().clear();
        return is_free ? zone : std::vector<Cell>{};
    }

    bool insert_guarded(const Vec3& p, int number) {
        Delaunay::Locate_type type;
        int i, j;
        const Cell where = delaunay_.locate(point(p), type, i, j, hint_);
        hint_ = where;
        if (type == Delaunay::VERTEX || type == Delaunay::OUTSIDE_CONVEX_HULL) return false;
        const std::vector<Cell> zone = free_zone(point(p), where);
        if (zone.empty()) return false;
        Facet border;
        for (const Cell& c : zone) c->tds_data().mark_in_conflict();
        for (int k = 0; k < 4; ++k)
            for (const Cell& c : zone)
                if (border.first == Cell() && !c->neighbor(k)->tds_data().is_in_conflict()) border = {c, k};
        for (const Cell& c : zone) c->tds_data().clear();
        const auto v = delaunay_.insert_in_hole(point(p), zone.begin(), zone.end(), border.first, border.second);
        v->info() = number;
        hint_ = v->cell();
        return true;
    }

    /// From infinity inwards; a triangle of the surface changes the side.
    void find_sides() {
        for (auto c = delaunay_.all_cells_begin(); c != delaunay_.all_cells_end(); ++c) c->info() = unknown;
        std::vector<Cell> open{delaunay_.infinite_cell()};
        open.front()->info() = outside;
        while (!open.empty()) {
            const Cell c = open.back();
            open.pop_back();
            for (int k = 0; k < 4; ++k) {
                const Cell n = c->neighbor(k);
                if (n->info() != unknown) continue;
                const char across = c->info() == outside ? inside : outside;
                n->info() = is_kept({c, k}) ? across : c->info();
                open.push_back(n);
            }
        }
    }

    /// By rising vertex numbers, so that nothing depends on the order in which cells were made.
    void collect(std::vector<Tet>& tets) const {
        for (auto c = delaunay_.finite_cells_begin(); c != delaunay_.finite_cells_end(); ++c) {
            if (c->info() != inside) continue;
            Tet t;
            for (int k = 0; k < 4; ++k) t[at(k)] = c->vertex(k)->info();
            tets.push_back(canonical(t));
        }
        std::sort(tets.begin(), tets.end());
    }

    const Points& surface_;
    const std::vector<Triangle>& triangles_;
    const MeshingControl& control_;
    std::unordered_set<Triangle, TriangleHash> kept_;
    Delaunay delaunay_;
    Cell hint_;
};

} // namespace

GuardedDelaunay guarded_delaunay(const Points& surface, const std::vector<Triangle>& triangles, const Points& inner,
                                 const MeshingControl& control) {
    return Builder(surface, triangles, control).make(inner);
}

} // namespace sinew::solver
