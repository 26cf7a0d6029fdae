// The one place that knows CGAL's surface mesher.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/surface_mesher.h"

#include "solver/index.h"

#include <CGAL/Complex_2_in_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_with_circumcenter_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Implicit_surface_3.h>
#include <CGAL/Robust_circumcenter_traits_3.h>
#include <CGAL/Surface_mesh_cell_base_3.h>
#include <CGAL/Surface_mesh_default_criteria_3.h>
#include <CGAL/Surface_mesh_vertex_base_3.h>
#include <CGAL/Triangulation_data_structure_3.h>
#include <CGAL/make_surface_mesh.h>

#include <algorithm>
#include <limits>
#include <map>
#include <unordered_map>

namespace sinew::solver {
namespace {

/// Gives a vertex or cell of a triangulation the number of its creation, by which CGAL's queues then order
/// it. Without it they go by address, and every run gives another mesh.
template <class Base>
class Stamped : public Base {
  public:
    template <class Tds>
    struct Rebind_TDS { // CGAL's name
        using Other = Stamped<typename Base::template Rebind_TDS<Tds>::Other>;
    };
    using Base::Base;
    using Has_timestamp = CGAL::Tag_true; // CGAL's name
    std::size_t time_stamp() const { return stamp_; }
    void set_time_stamp(std::size_t stamp) { stamp_ = stamp; }

  private:
    std::size_t stamp_ = static_cast<std::size_t>(-1);
};

using Traits = CGAL::Robust_circumcenter_traits_3<CGAL::Exact_predicates_inexact_constructions_kernel>;
using VertexBase = Stamped<CGAL::Surface_mesh_vertex_base_3<Traits>>;
using CellBase =
    Stamped<CGAL::Delaunay_triangulation_cell_base_with_circumcenter_3<Traits, CGAL::Surface_mesh_cell_base_3<Traits>>>;
using Triangulation =
    CGAL::Delaunay_triangulation_3<Traits, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
using Complex = CGAL::Complex_2_in_triangulation_3<Triangulation>;
using Point = Triangulation::Point;
using Surface = CGAL::Implicit_surface_3<Traits>;

struct EdgeUse {
    int triangle;
    bool forward;
};

/// How much the triangle speaks for its direction: positive if the field rises along its normal.
double vote(const Points& points, const Triangle& t, const SurfaceMesherInput& in) {
    const Vec3 &a = points[at(t[0])], &b = points[at(t[1])], &c = points[at(t[2])];
    const Vec3 cross = (b - a).cross(c - a), centre = (a + b + c) / 3;
    const double area = cross.norm();
    if (!(area > 0)) return 0;
    const Vec3 aside = cross * (0.1 * in.radius / area);
    return area * (in.field(centre + aside) - in.field(centre - aside));
}

/// Turns triangles so that neighbours over edges with two triangles agree, and each part so that most of it
/// faces outwards.
void orient(const Points& points, std::vector<Triangle>& triangles, const SurfaceMesherInput& in) {
    std::map<std::pair<int, int>, std::vector<EdgeUse>> edges;
    const auto key = [](int a, int b) { return std::pair{std::min(a, b), std::max(a, b)}; };
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            edges[key(a, b)].push_back({static_cast<int>(t), a < b});
        }
    std::vector<signed char> turned(triangles.size(), -1);
    for (std::size_t s = 0; s < triangles.size(); ++s) {
        if (turned[s] >= 0) continue;
        turned[s] = 0;
        std::vector<int> part{static_cast<int>(s)};
        double outwards = 0;
        for (std::size_t i = 0; i < part.size(); ++i) {
            const int t = part[i];
            outwards += (turned[at(t)] ? -1 : 1) * vote(points, triangles[at(t)], in);
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& uses = edges.at(key(triangles[at(t)][k], triangles[at(t)][(k + 1) % 3]));
                if (uses.size() != 2) continue;
                const EdgeUse &here = uses[0].triangle == t ? uses[0] : uses[1],
                              &there = uses[0].triangle == t ? uses[1] : uses[0];
                if (turned[at(there.triangle)] >= 0) continue;
                turned[at(there.triangle)] = static_cast<signed char>(turned[at(t)] ^ (here.forward == there.forward));
                part.push_back(there.triangle);
            }
        }
        if (outwards < 0)
            for (const int t : part) turned[at(t)] ^= 1;
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (turned[t] == 1) std::swap(triangles[t][1], triangles[t][2]);
}

SurfaceMesherOutput extract(const Complex& complex, const SurfaceMesherInput& in,
                            const std::vector<Triangulation::Vertex_handle>& seeds) {
    SurfaceMesherOutput out;
    std::unordered_map<std::size_t, int> number; // by time stamp
    for (auto f = complex.facets_begin(); f != complex.facets_end(); ++f) {
        Triangle t;
        for (int k = 0; k < 3; ++k) {
            const auto v = f->first->vertex(Triangulation::vertex_triple_index(f->second, k));
            const auto [entry, is_new] = number.try_emplace(v->time_stamp(), static_cast<int>(out.points.size()));
            if (is_new) out.points.emplace_back(v->point().x(), v->point().y(), v->point().z());
            t[at(k)] = entry->second;
        }
        out.triangles.push_back(t);
    }
    orient(out.points, out.triangles, in);
    for (const auto& v : seeds) {
        const auto found = number.find(v->time_stamp());
        out.vertex_of_seed.push_back(found == number.end() ? -1 : found->second);
    }
    return out;
}

/// The middle of the shortest edge.
Vec3 densest_place(const Triangulation& triangulation) {
    double shortest = std::numeric_limits<double>::infinity();
    Point middle(0, 0, 0);
    for (auto e = triangulation.finite_edges_begin(); e != triangulation.finite_edges_end(); ++e) {
        const Point &a = e->first->vertex(e->second)->point(), &b = e->first->vertex(e->third)->point();
        const double length2 = CGAL::to_double(CGAL::squared_distance(a, b));
        if (length2 < shortest) shortest = length2, middle = CGAL::midpoint(a, b);
    }
    return {middle.x(), middle.y(), middle.z()};
}

} // namespace

SurfaceMesherOutput mesh_level_set(const SurfaceMesherInput& in) {
    const auto point = [](const Vec3& p) { return Point(p.x(), p.y(), p.z()); };
    Triangulation triangulation;
    std::vector<Triangulation::Vertex_handle> seeds;
    for (const Vec3& p : in.seeds) {
        if (seeds.size() % 1024 == 0 && in.watch) in.watch();
        seeds.push_back(triangulation.insert(point(p)));
    }
    Complex complex(triangulation);
    // Crossings are found to a thousandth of the triangle size.
    const Surface surface([&in](const Point& p) { return in.field(Vec3(p.x(), p.y(), p.z())); },
                          Traits::Sphere_3(point(in.inside), in.reach * in.reach), 1e-3 * in.radius / in.reach);
    const CGAL::Surface_mesh_default_criteria_3<Triangulation> criteria(in.least_angle, in.radius, in.distance);
    try {
        if (in.is_manifold)
            CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Manifold_tag(), 0);
        else
            CGAL::make_surface_mesh(complex, surface, criteria, CGAL::Non_manifold_tag(), 0);
        return extract(complex, in, seeds);
    } catch (Endless& endless) {
        endless.densest = densest_place(triangulation);
        throw;
    }
}

} // namespace sinew::solver
