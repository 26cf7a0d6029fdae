// Closed surface -> checks -> inner points -> guarded Delaunay triangulation -> improvement.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/delaunay_tets.h"

#include "solver/error.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/guarded_delaunay.h"
#include "solver/meshing/inner_points.h"
#include "solver/meshing/self_intersections.h"
#include "solver/meshing/tet_improve.h"

#include <algorithm>

namespace sinew::solver {
namespace {

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

void refuse_crossings(const Points& points, const std::vector<Triangle>& triangles) {
    if (const Flaw crossing = self_intersections(points, triangles))
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

/// Every triangle with its lowest corner first, in order.
std::vector<Triangle> canonical(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

MeshingControl part(const MeshingControl& control, double from, double to) {
    MeshingControl out{control.stop, {}};
    if (control.progress)
        out.progress = [&control, from, to](double done, std::string_view what) { control.progress(from + (to - from) * done, what); };
    return out;
}

} // namespace

TetMesh make_delaunay_tets(const Points& points, const std::vector<Triangle>& triangles,
                           const DelaunayTetOptions& options, const MeshingControl& control) {
    check_usable(SurfaceMesh::from_triangles(points, triangles));
    if (!(options.refinement_quality >= 0 && options.refinement_quality <= 1))
        throw Error("FE206", "refinement quality " + std::to_string(options.refinement_quality) +
                                 " is not between 0 and 1");
    const MeshCheck found = check_mesh(points, triangles);
    check_surface(found);
    refuse_crossings(points, triangles);
    std::vector<Triangle> outward = triangles;
    if (found.volume < 0)
        for (Triangle& t : outward) std::swap(t[1], t[2]);

    constexpr std::size_t most_inner = 5000000;
    const double growth = 1.2 * (1 - options.refinement_quality);
    const Points inner = options.refinement_quality > 0
                             ? inner_points(points, outward, growth, most_inner, part(control, 0, 0.2))
                             : Points{};
    GuardedDelaunay filled = guarded_delaunay(points, outward, inner, part(control, 0.2, 0.4));
    if (!filled.missing.empty()) refuse_missing(filled.missing);
    TetMesh mesh;
    mesh.vertices = std::move(filled.vertices);
    mesh.tets = std::move(filled.tets);
    constexpr int passes = 6;
    improve_tets(mesh, passes, part(control, 0.4, 1));
    if (canonical(boundary_triangles(mesh.tets)) != canonical(outward))
        throw Error("FE237", "the boundary of the tets came out different from the mesh",
                    "Remesh the surface by zIsoMesh, and report the mesh: this is a fault of the program.");
    mesh.coverage.assign(mesh.tets.size(), 1.0);
    if (control.progress) control.progress(1, "meshed");
    return mesh;
}

} // namespace sinew::solver
