// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/wrap.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/surface_pieces.h"
#include "solver/meshing/iso_mesh.h"
#include "solver/meshing/self_intersections.h"
#include "tools/rig/graph_text.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>

namespace sinew::rig {

using engine::Diagnostic;
using engine::Severity;
using solver::at;
using solver::Points;
using solver::Triangle;

namespace {

/// In grid cells.
constexpr double narrowest_wrap = 0.6, widest_wrap = 4.8;

/// What counts as a solid is so many times thicker than a sheet in the same wrap would be.
constexpr double least_thickness = 1.5;

/// Of all of the surface; smaller pieces are crumbs, which decide nothing.
constexpr double least_piece = 0.1;

/// Volume by area^(3/2), which is 0.094 of a ball and 0.004 of a sheet a hundred times as long as thick.
constexpr double least_volume = 1e-6;

/// Of a closed part whose faces are turned alike.
bool encloses_nothing(const Part& part) {
    double area = 0;
    for (const double a : solver::vertex_areas(part.points, part.triangles)) area += a;
    return std::abs(solver::enclosed_volume(part.points, part.triangles)) <= least_volume * std::pow(area, 1.5);
}

/// What keeps a mesh from being used as it is; empty if nothing does. Parts whose vertices are only split along edges
/// are as good as closed.
std::string fault_of(const Part& part, const solver::MeshCheck& check) {
    const auto it_has = [](const solver::Flaw& flaw, const char* one, const char* many) {
        return "it has " + solver::describe(flaw, one, many);
    };
    if (check.open_edges && !check.encloses) return it_has(check.open_edges, "open edge", "open edges");
    if (check.non_manifold_edges)
        return it_has(check.non_manifold_edges, "edge with over two triangles", "edges with over two triangles");
    if (check.badly_oriented_edges)
        return it_has(check.badly_oriented_edges, "edge whose triangles face different ways",
                      "edges whose triangles face different ways");
    if (part.kind == Kind::muscle && encloses_nothing(part)) return "it encloses nothing"; // a bone may be a plate
    if (check.volume < 0) return "its faces look inwards";
    return "";
}

/// What meshing says of a shell that triangles cannot follow.
bool is_lost(const solver::Error& e) { return e.code == "FE231" || e.code == "FE234"; }

/// Whether each large piece of the surface at this distance bounds a solid: through holes that are too wide it goes in,
/// and is a shell of twice the distance, as it is around a sheet.
bool is_solid(const solver::IsoMesh& mesh, double distance) {
    const solver::SurfacePieces pieces = solver::find_pieces_by_place(mesh.points, mesh.triangles);
    std::vector<double> volumes(pieces.count()), areas(pieces.count());
    const solver::Vec3 origin = mesh.points.empty() ? solver::Vec3::Zero() : mesh.points.front();
    for (const Triangle& t : mesh.triangles) {
        const solver::Vec3 a = mesh.points[at(t[0])] - origin, b = mesh.points[at(t[1])] - origin,
                           c = mesh.points[at(t[2])] - origin;
        const std::size_t piece = at(pieces.of_point[at(t[0])]);
        volumes[piece] += a.dot(b.cross(c)) / 6;
        areas[piece] += 0.5 * (b - a).cross(c - a).norm();
    }
    const double least_area = least_piece * std::accumulate(areas.begin(), areas.end(), 0.0);
    for (std::size_t p = 0; p < pieces.count(); ++p)
        if (areas[p] >= least_area && !(2 * volumes[p] > least_thickness * 2 * distance * areas[p])) return false;
    return pieces.count() > 0;
}

/// One part being wrapped.
class Wrapping {
  public:
    Wrapping(const Part& part, double cell, const std::function<bool()>& stop)
        : part_(part)
        , triangle_size_(solver::default_triangle_size(part.points, part.triangles))
        , cell_(cell) {
        control_.stop = stop;
    }

    /// Empty where it is a shell. Where that may well be, it is told from few triangles first: those of a shell take
    /// long.
    std::optional<solver::IsoMesh> solid_at(double cells, const Lids& lids, bool is_likely) const {
        try {
            if (!is_likely && !is_solid(made(cells, lids, true), distance(cells))) return {};
            solver::IsoMesh out = made(cells, lids, false);
            if (is_solid(out, distance(cells))) return out;
        } catch (const solver::Error& e) {
            if (!is_lost(e)) throw;
        }
        return {};
    }

    solver::IsoMesh made(double cells, const Lids& lids, bool is_coarse) const {
        solver::IsoMeshOptions options;
        options.resolution = wrap_resolution;
        options.iso_value = distance(cells);
        options.is_manifold = !is_coarse;
        if (is_coarse) options.triangle_size = 2 * triangle_size_;
        Points points = part_.points;
        std::vector<Triangle> triangles = part_.triangles;
        const int first = static_cast<int>(points.size());
        points.insert(points.end(), lids.points.begin(), lids.points.end());
        for (const auto& [a, b, c] : lids.triangles) triangles.push_back({first + a, first + b, first + c});
        return solver::make_iso_mesh(points, triangles, options, control_);
    }

    /// As the graph has it.
    double distance(double cells) const { return std::strtod(number(cells * cell_).c_str(), nullptr); }

  private:
    const Part& part_;
    const double triangle_size_, cell_;
    solver::MeshingControl control_;
};

void take(Part& part, solver::IsoMesh made, double distance) {
    part.is_wrapped = true;
    part.wrap = distance;
    part.points = std::move(made.points);
    part.triangles = std::move(made.triangles);
    part.box = solver::bounding_box(part.points);
}

void wrap(Part& part, double cell, const std::function<bool()>& stop) {
    const solver::MeshCheck check = solver::inspect_mesh(part.points, part.triangles);
    part.why_wrapped = fault_of(part, check);
    if (part.why_wrapped.empty()) return;
    const Wrapping wrapping(part, cell, stop);
    // Where triangles are only turned differently, or doubled, the surface itself can be made anew.
    if (check.encloses) {
        try {
            return take(part, wrapping.made(0, {}, false), 0);
        } catch (const solver::Error& e) {
            if (e.code != "FE223" && !(part.kind == Kind::muscle && encloses_nothing(part))) throw;
        }
    }
    Lids lids = make_lids(part.points, part.triangles, narrowest_wrap * cell);
    if (auto solid = wrapping.solid_at(narrowest_wrap, {}, lids.count == 0))
        return take(part, std::move(*solid), wrapping.distance(narrowest_wrap));
    if (lids.count > 0)
        if (auto solid = wrapping.solid_at(narrowest_wrap, lids, true)) {
            part.lids = std::move(lids);
            return take(part, std::move(*solid), wrapping.distance(narrowest_wrap));
        }
    // Where rims are too tangled for lids, or it is an edge where they just meet, a wider wrap may close it.
    for (double cells = 2 * narrowest_wrap; cells <= widest_wrap; cells *= 2)
        if (auto solid = wrapping.solid_at(cells, {}, false))
            return take(part, std::move(*solid), wrapping.distance(cells));
    part.is_hollow = true;
    take(part, wrapping.made(widest_wrap, {}, false), wrapping.distance(widest_wrap));
}

/// What the user is to know of it; empty if nothing.
std::optional<Diagnostic> note_of(const Part& part, double cell) {
    const std::string file = "'" + part.file + "'";
    if (part.is_hollow)
        return say(Severity::warning, "DG178", part.name,
                   file + " stays hollow: " + part.why_wrapped + ", and no surface up to " + rough(part.wrap) +
                       " around it encloses a solid; it becomes a shell " + rough(2 * part.wrap) + " thick",
                   "Close its holes; what is meant as a sheet needs two sides and a thickness.");
    if (part.lids.count > 0)
        return say(Severity::warning, "DG163", part.name,
                   file + " has " +
                       (part.lids.count == 1 ? "a wide hole, about "
                                             : std::to_string(part.lids.count) + " wide holes, the widest about ") +
                       rough(part.lids.widest) + " across; straight lids close " +
                       (part.lids.count == 1 ? "it" : "them"),
                   "Close the holes in the mesh if they are to have another shape.");
    if (part.wrap > 2 * cell)
        return say(Severity::warning, "DG163", part.name,
                   file + " has wide holes: the surface that closes them is " + rough(part.wrap) +
                       " around it, by which the body gets larger",
                   "Close the holes in the mesh.");
    return {};
}

} // namespace

void wrap_open(std::vector<Part>& parts, std::vector<Diagnostic>& notes, const std::function<bool()>& stop) {
    std::vector<Diagnostic> wrong;
    for (Part& part : parts) {
        if (part.keeps_file) continue;
        try {
            const double cell = part.box.size().maxCoeff() / wrap_resolution;
            wrap(part, cell, stop);
            if (auto note = note_of(part, cell)) notes.push_back(std::move(*note));
        } catch (const solver::Error& e) {
            wrong.push_back(say(
                Severity::error, e.code, part.name,
                part.file + ": " + part.why_wrapped + ", and no surface can be put around it: " + e.what(), e.hint));
        }
    }
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
}

} // namespace sinew::rig
