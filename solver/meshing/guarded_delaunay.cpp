// The one place that knows CGAL's 3D triangulation.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/guarded_delaunay.h"

#include "solver/error.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <unordered_set>

namespace sinew::solver {
namespace {

enum Side : char { unknown, outside, inside };

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<char, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Delaunay =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
using Cell = Delaunay::Cell_handle;
using Facet = Delaunay::Facet;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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
        out.missing = missing();
        if (!out.missing.empty()) return out;
        out.vertices = surface_;
        for (std::size_t i = 0; i < inner.size(); ++i) {
            watch(i, inner.size());
            if (insert_guarded(inner[i], static_cast<int>(out.vertices.size())))
                out.vertices.push_back(inner[i]);
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
        if (control_.progress) control_.progress(static_cast<double>(done) / static_cast<double>(all), "inserting points");
    }

    void insert_surface() {
        std::vector<std::pair<Kernel::Point_3, int>> all;
        for (std::size_t v = 0; v < surface_.size(); ++v)
            all.emplace_back(point(surface_[v]), static_cast<int>(v));
        delaunay_.insert(all.begin(), all.end());
        if (control_.stop && control_.stop()) throw Stopped();
    }

    std::vector<int> missing() const {
        std::vector<Delaunay::Vertex_handle> handle(surface_.size());
        for (auto v = delaunay_.finite_vertices_begin(); v != delaunay_.finite_vertices_end(); ++v)
            handle[at(v->info())] = v;
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
            if (delaunay_.is_infinite(v) || v->info() >= static_cast<int>(surface_.size())) return false;
            t[at(k)] = v->info();
        }
        return kept_.contains(sorted(t));
    }

    bool insert_guarded(const Vec3& p, int number) {
        Delaunay::Locate_type type;
        int i, j;
        const Cell where = delaunay_.locate(point(p), type, i, j, hint_);
        hint_ = where;
        if (type == Delaunay::VERTEX || type == Delaunay::OUTSIDE_CONVEX_HULL) return false;
        std::vector<Facet> border, within;
        std::vector<Cell> cells;
        delaunay_.find_conflicts(point(p), where, std::back_inserter(border), std::back_inserter(cells),
                                 std::back_inserter(within));
        for (const Facet& f : within)
            if (is_kept(f)) return false;
        const auto v = delaunay_.insert_in_hole(point(p), cells.begin(), cells.end(), border.front().first,
                                                border.front().second);
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
            // Even permutations keep the orientation: the smallest first, then the smallest of the rest.
            const auto low = std::min_element(t.begin(), t.end()) - t.begin();
            if (low != 0) {
                std::swap(t[0], t[at(static_cast<int>(low))]);
                low == 1 ? std::swap(t[2], t[3]) : std::swap(t[1], t[low == 2 ? 3 : 2]);
            }
            while (t[1] > t[2] || t[1] > t[3]) t = {t[0], t[2], t[3], t[1]};
            tets.push_back(t);
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

GuardedDelaunay guarded_delaunay(const Points& surface, const std::vector<Triangle>& triangles,
                                 const Points& inner, const MeshingControl& control) {
    return Builder(surface, triangles, control).make(inner);
}

} // namespace sinew::solver
