// Closed surface -> checks -> inner points -> guarded Delaunay triangulation -> improvement.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/delaunay_tets.h"

#include "solver/error.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/guarded_delaunay.h"
#include "solver/meshing/inner_points.h"
#include "solver/meshing/mesh_frame.h"
#include "solver/meshing/self_intersections.h"
#include "solver/meshing/starved_points.h"
#include "solver/meshing/tet_improve.h"

#include <algorithm>

namespace sinew::solver {
namespace {

constexpr double least_dihedral = 0.05; ///< of a tet of the result [degrees]

/// Refuses what has no inside, or whose boundary tets could not have.
void check_surface(const MeshCheck& found) {
    if (found.open_edges)
        throw Error("FE230",
                    "the mesh is open: " +
                        describe(found.open_edges, "edge with one triangle", "edges with one triangle"),
                    "Close the mesh, or remesh it by zIsoMesh with isoValue > 0.");
    std::string flaws;
    const auto note = [&](const Flaw& flaw, const std::string& one, const std::string& many) {
        if (flaw) flaws += (flaws.empty() ? "" : ", ") + describe(flaw, one, many);
    };
    note(found.non_manifold_edges, "edge with more than two triangles", "edges with more than two triangles");
    note(found.badly_oriented_edges, "edge whose triangles face opposite sides",
         "edges whose triangles face opposite sides");
    note(found.non_manifold_vertices, "vertex with several fans of triangles",
         "vertices with several fans of triangles");
    note(found.duplicate_triangles, "repeated triangle", "repeated triangles");
    note(found.degenerate_triangles, "triangle without area", "triangles without area");
    note(found.coinciding_vertices, "vertex at the place of another", "vertices at the places of others");
    note(found.unused_vertices, "vertex of no triangle", "vertices of no triangle");
    if (!flaws.empty())
        throw Error("FE236", "the mesh cannot be the boundary of tets: " + flaws,
                    "Repair the mesh, or remesh it by zIsoMesh, whose results can always be filled.");
}

void refuse_crossings(const Points& points, const std::vector<Triangle>& triangles, const MeshingControl& control) {
    if (const Flaw crossing = self_intersections(points, triangles, control.stop))
        throw Error("FE237",
                    "the mesh cannot be the boundary of tets: " +
                        describe(crossing, "pair of crossing triangles", "pairs of crossing triangles"),
                    "Repair the mesh, or remesh it by zIsoMesh, which makes one surface of what overlaps.");
}

[[noreturn]] void refuse_missing(const std::vector<int>& missing) {
    Flaw flaw;
    for (const int t : missing) flaw.add(t);
    throw Error("FE237", describe(flaw, "triangle", "triangles") + " could not be made faces of tets",
                "Remesh the surface by zIsoMesh, whose triangles always can; very flat or long triangles are "
                "to blame.");
}

/// The tets' boundary has the surface's triangles; where it has them the other way round, a part lies inside
/// another (or not) and faces as if it did not (or did).
void refuse_wrong_sides(const std::vector<Tet>& tets, const std::vector<Triangle>& outward) {
    std::vector<Triangle> sides = boundary_triangles(tets);
    const auto lowest_first = [](Triangle t) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        return t;
    };
    for (Triangle& t : sides) t = lowest_first(t);
    std::sort(sides.begin(), sides.end());
    Flaw wrong;
    for (std::size_t t = 0; t < outward.size(); ++t)
        if (std::binary_search(sides.begin(), sides.end(), lowest_first({outward[t][0], outward[t][2], outward[t][1]})))
            wrong.add(static_cast<int>(t));
    if (wrong)
        throw Error("FE236",
                    "the mesh's parts do not bound one solid: " +
                        describe(wrong, "triangle faces into the solid", "triangles face into the solid"),
                    "Turn the triangles of the part that is named: a part inside another bounds a cavity and "
                    "faces the other way than the outer one; parts beside each other face alike.");
}

void refuse_flat(const TetMesh& mesh) {
    Flaw flat;
    const auto x = [&](int v) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const Tet& c = mesh.tets[t];
        if (!(tet_volume(x(c[0]), x(c[1]), x(c[2]), x(c[3])) > 0) ||
            !(dihedral_range(x(c[0]), x(c[1]), x(c[2]), x(c[3]))[0] >= least_dihedral))
            flat.add(mesh.tets[t][0]);
    }
    if (flat)
        throw Error("FE237",
                    describe(flat, "tet stays flat, at vertex", "tets stay flat, at vertices") +
                        "; none may have a dihedral angle below 0.05 degrees",
                    "Remesh the surface by zIsoMesh, whose triangles always give good tets; very flat or long "
                    "triangles are to blame.");
}

/// Every triangle with its lowest corner first, in order.
std::vector<Triangle> canonical(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

MeshingControl part(const MeshingControl& control, double from, double to) {
    MeshingControl out{control.stop, {}};
    if (control.progress)
        out.progress = [&control, from, to](double done, std::string_view what) {
            control.progress(from + (to - from) * done, what);
        };
    return out;
}

} // namespace

TetMesh make_delaunay_tets(const Points& points, const std::vector<Triangle>& triangles,
                           const DelaunayTetOptions& options, const MeshingControl& watched) {
    const MeshingControl control =
        with_time_limit(watched, options.most_seconds, "the tets are",
                        "Raise maxTime, or remesh the surface by zIsoMesh: triangles that are long take longest.");
    check_usable(SurfaceMesh::from_triangles(points, triangles));
    if (!(options.refinement_quality >= 0 && options.refinement_quality <= 1))
        throw Error("FE222",
                    "refinement quality " + std::to_string(options.refinement_quality) + " is not between 0 and 1");
    const MeshCheck found = check_mesh(points, triangles);
    check_surface(found);
    refuse_crossings(points, triangles, control);
    std::vector<Triangle> outward = triangles;
    if (found.volume < 0)
        for (Triangle& t : outward) std::swap(t[1], t[2]);

    const Box box = bounding_box(points);
    const MeshFrame frame{box.centre(), box.size().maxCoeff()};
    Points near = points;
    for (Vec3& p : near) p = frame.in(p);
    constexpr std::size_t most_inner = 5000000;
    const double growth = 1.2 * (1 - options.refinement_quality);
    const InnerPoints inner = options.refinement_quality > 0
                                  ? inner_points(near, outward, growth, most_inner, part(control, 0, 0.2))
                                  : InnerPoints{};
    GuardedDelaunay filled = guarded_delaunay(near, outward, inner.points, part(control, 0.2, 0.35));
    if (!filled.missing.empty()) refuse_missing(filled.missing);
    refuse_wrong_sides(filled.tets, outward);
    TetMesh mesh;
    mesh.vertices = std::move(filled.vertices);
    mesh.tets = std::move(filled.tets);
    InnerPoints left_out;
    for (const int i : filled.left_out) {
        left_out.points.push_back(inner.points[static_cast<std::size_t>(i)]);
        left_out.edges.push_back(inner.edges[static_cast<std::size_t>(i)]);
    }
    add_starved_points(mesh, left_out, part(control, 0.35, 0.4));
    constexpr int passes = 6;
    improve_tets(mesh, passes, part(control, 0.4, 1));
    for (Vec3& p : mesh.vertices) p = frame.out(p);
    std::copy(points.begin(), points.end(), mesh.vertices.begin());
    if (canonical(boundary_triangles(mesh.tets)) != canonical(outward))
        throw Error("FE237", "the boundary of the tets came out different from the mesh",
                    "Remesh the surface by zIsoMesh, and report the mesh: this is a fault of the program.");
    refuse_flat(mesh);
    mesh.coverage.assign(mesh.tets.size(), 1.0);
    if (control.progress) control.progress(1, "meshed");
    return mesh;
}

} // namespace sinew::solver
