// Soup -> distance grid -> seeds -> surface mesher.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/iso_mesh.h"

#include "solver/error.h"
#include "solver/mesh/mesh_check.h"
#include "solver/meshing/distance_grid.h"
#include "solver/meshing/iso_seeds.h"
#include "solver/meshing/soup.h"
#include "solver/meshing/surface_mesher.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace sinew::solver {
namespace {

std::string short_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

void check(const IsoMeshOptions& o) {
    const auto refuse = [](const std::string& what) { throw Error("FE206", what); };
    if (!std::isfinite(o.iso_value)) refuse("the iso value is not finite");
    if (!(o.triangle_size >= 0) || !std::isfinite(o.triangle_size))
        refuse("triangle size " + short_number(o.triangle_size) + " is not a length");
    if (o.resolution < 16 || o.resolution > 1024)
        refuse("resolution " + std::to_string(o.resolution) + " is not between 16 and 1024");
    if (!(o.most_seconds >= 0)) refuse("a time limit of " + short_number(o.most_seconds) + " s");
}

/// The caller's control with the time limit added.
class Watch {
  public:
    Watch(const MeshingControl& control, double most_seconds)
        : control_(control)
        , most_seconds_(most_seconds)
        , begin_(Clock::now()) {}

    void check() const {
        if (control_.stop && control_.stop()) throw Stopped();
        if (most_seconds_ > 0 && std::chrono::duration<double>(Clock::now() - begin_).count() > most_seconds_)
            throw Error("FE233", "the iso mesh is not ready after " + short_number(most_seconds_) + " s",
                        "Raise maxTime, or choose a larger triangleSize or a smaller resolution.");
    }
    void progress(double done, std::string_view what) {
        done_ = std::max(done_, std::min(done, 1.0));
        if (control_.progress) control_.progress(done_, what);
    }
    /// Progress of a part of the work, from `from` to `to`.
    MeshingControl part(double from, double to) {
        return {[this] {
                    check();
                    return false;
                },
                [this, from, to](double done, std::string_view what) { progress(from + (to - from) * done, what); }};
    }

  private:
    using Clock = std::chrono::steady_clock;
    const MeshingControl& control_;
    double most_seconds_, done_ = 0;
    Clock::time_point begin_;
};

/// The share of the whole that the grid takes.
constexpr double grid_share = 0.4;

SurfaceMesherOutput run_mesher(const DistanceGrid& grid, const IsoSeeds& seeds, double size, bool is_manifold,
                               Watch& watch) {
    SurfaceMesherInput in;
    in.seeds = seeds.points;
    in.inside = seeds.inside;
    in.reach =
        2 * grid.step * DistanceGrid::cells * Vec3(grid.blocks[0], grid.blocks[1], grid.blocks[2]).norm();
    in.is_manifold = is_manifold;
    // The mean edge comes out at about 1.1 radii.
    in.radius = 0.9 * size;
    in.distance = 0.1 * size;
    // Measured: 60 to 150 evaluations a seed.
    const double expected = 100.0 * static_cast<double>(seeds.points.size());
    std::size_t evaluations = 0;
    in.field = [&](const Vec3& p) {
        if (++evaluations % 4096 == 0) {
            watch.check();
            const double share = static_cast<double>(evaluations) / expected;
            watch.progress(grid_share + (1 - grid_share) * share / (share + 0.3), "meshing the level set");
        }
        return grid.value(p);
    };
    return mesh_level_set(in);
}

/// Components none of whose seeds became a corner.
std::vector<int> lost_components(const IsoSeeds& seeds, const SurfaceMesherOutput& mesh) {
    std::vector<char> found(seeds.areas.size(), 0);
    for (std::size_t s = 0; s < seeds.points.size(); ++s)
        if (mesh.vertex_of_seed[s] >= 0) found[static_cast<std::size_t>(seeds.component[s])] = 1;
    std::vector<int> lost;
    for (std::size_t c = 0; c < found.size(); ++c)
        if (!found[c]) lost.push_back(static_cast<int>(c));
    return lost;
}

void check_count(double area, double size) {
    constexpr double most = 2e7;
    const double triangles = area / (size * size * std::sqrt(3.0) / 4);
    if (triangles > most)
        throw Error("FE232",
                    "the iso mesh would have about " + short_number(triangles) + " triangles, more than " +
                        short_number(most),
                    "Choose a larger triangleSize.");
}

void check_manifold(const IsoMesh& mesh) {
    const MeshCheck found = check_mesh(mesh.points, mesh.triangles);
    if (found.is_closed() && found.is_manifold()) return;
    std::string flaws;
    for (const std::string& f :
         {describe(found.open_edges, "open edge", "open edges"),
          describe(found.non_manifold_edges, "edge with more than two triangles",
                   "edges with more than two triangles"),
          describe(found.badly_oriented_edges, "edge between opposite sides", "edges between opposite sides"),
          describe(found.non_manifold_vertices, "vertex with several fans", "vertices with several fans")})
        if (!f.empty()) flaws += (flaws.empty() ? "" : ", ") + f;
    throw Error("FE234", "the iso mesh is not a closed manifold: " + flaws,
                "Choose a smaller triangleSize or a higher resolution.");
}

double size_for(const Soup& soup) { return bounding_box(soup.points).size().norm() / 40; }

} // namespace

double default_triangle_size(const Points& points, const std::vector<Triangle>& triangles) {
    return size_for(make_soup(points, triangles));
}

IsoMesh make_iso_mesh(const Points& points, const std::vector<Triangle>& triangles,
                      const IsoMeshOptions& options, const MeshingControl& control) {
    check(options);
    Watch watch(control, options.most_seconds);
    const Soup soup = make_soup(points, triangles);
    if (!soup.is_closed && !(options.iso_value > 0))
        throw Error(
            "FE230",
            "the mesh is open (" + std::to_string(soup.open_edges) +
                " edges are not shared by triangles in opposite directions, the first between vertices " +
                std::to_string(soup.first_open[0]) + " and " + std::to_string(soup.first_open[1]) +
                "), so it has no inside for an iso value of " + short_number(options.iso_value),
            "Give an isoValue above 0, or close the mesh.");
    const double size = options.triangle_size > 0 ? options.triangle_size : size_for(soup);
    const DistanceGrid grid =
        make_distance_grid(soup, options.iso_value, options.resolution, watch.part(0, grid_share));
    IsoSeeds seeds = make_iso_seeds(grid, 1e300);
    if (seeds.points.empty())
        throw Error(
            "FE231", "nothing lies at a distance of " + short_number(options.iso_value) + " from the mesh",
            "A negative isoValue must be smaller in size than the mesh is thick; a thin mesh also needs a "
            "higher resolution.");
    check_count(seeds.area(), size);

    IsoMesh mesh;
    mesh.components = seeds.areas.size();
    std::vector<int> finer(seeds.areas.size(), 0);
    constexpr int attempts = 3;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        seeds = make_iso_seeds(grid, size, finer);
        watch.check();
        SurfaceMesherOutput out = run_mesher(grid, seeds, size, options.is_manifold, watch);
        const std::vector<int> lost = lost_components(seeds, out);
        mesh.points = std::move(out.points);
        mesh.triangles = std::move(out.triangles);
        mesh.lost = lost.size();
        if (lost.empty()) break;
        for (const int c : lost) ++finer[static_cast<std::size_t>(c)];
    }
    if (mesh.triangles.empty())
        throw Error("FE231",
                    "all " + std::to_string(mesh.components) +
                        " pieces of the level set are too small to be meshed",
                    "Choose a smaller triangleSize, a higher resolution or another isoValue.");
    if (options.is_manifold) check_manifold(mesh);
    watch.progress(1, "meshed");
    return mesh;
}

} // namespace sinew::solver
