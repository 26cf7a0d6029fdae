// Soup -> distance grid -> seeds -> surface mesher.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/iso_mesh.h"

#include "solver/error.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/distance_grid.h"
#include "solver/meshing/iso_seeds.h"
#include "solver/meshing/mesh_frame.h"
#include "solver/meshing/shells.h"
#include "solver/meshing/soup.h"
#include "solver/meshing/surface_mesher.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>

namespace sinew::solver {
namespace {

std::string short_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

constexpr int most_resolution = 1024;

void check(const IsoMeshOptions& o) {
    const auto refuse = [](const std::string& what) { throw Error("FE222", what); };
    if (!std::isfinite(o.iso_value)) refuse("the iso value is not finite");
    if (!(o.triangle_size >= 0) || !std::isfinite(o.triangle_size))
        refuse("triangle size " + short_number(o.triangle_size) + " is not a length");
    if (o.resolution < 16 || o.resolution > most_resolution)
        refuse("resolution " + std::to_string(o.resolution) + " is not between 16 and " +
               std::to_string(most_resolution));
}

/// The caller's control with the time limit added.
class Watch {
  public:
    Watch(const MeshingControl& control, double most_seconds)
        : control_(with_time_limit(control, most_seconds, "the iso mesh is",
                                   "Raise maxTime, or choose a larger triangleSize or a smaller resolution.")) {}

    void check() const {
        if (control_.stop && control_.stop()) throw Stopped();
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
    const MeshingControl control_;
    double done_ = 0;
};

MeshFrame frame_for(const Points& points, const std::vector<Triangle>& triangles, double iso) {
    check_usable(SurfaceMesh::from_triangles(points, triangles));
    Points used;
    for (const Triangle& t : triangles)
        for (const int v : t) used.push_back(points[static_cast<std::size_t>(v)]);
    const Box box = bounding_box(used);
    const double size = box.size().maxCoeff() + 2 * std::max(iso, 0.0);
    MeshFrame frame;
    frame.farthest = std::max(box.max.cwiseAbs().maxCoeff(), box.min.cwiseAbs().maxCoeff());
    if (!(size < 1e60) || !(frame.farthest < 1e60))
        throw Error("FE224", "the mesh is larger than 1e60 units", "Repair the coordinates.");
    if (size == 0) return frame; // nothing but triangles without an area, which the soup refuses
    if (size < 1e-60) throw Error("FE224", "the mesh is smaller than 1e-60 units", "Repair the coordinates.");
    frame.middle = box.centre(), frame.size = size;
    return frame;
}

/// Refuses what the numbers cannot hold once the result is back at its place.
void check_precision(const MeshFrame& frame, double size) {
    const double spacing = frame.farthest * std::numeric_limits<double>::epsilon();
    if (spacing > 1e-5 * size)
        throw Error("FE224",
                    "the mesh lies too far from the origin: numbers there are " + short_number(spacing) +
                        " apart, too much for triangles of size " + short_number(size),
                    "Move the mesh towards the origin.");
}

/// Takes out triangles that lie on each other face to face: nothing is between them, and a level set of the
/// signed distance would be crumbs along them. Throws Error FE211 if nothing is left to have an inside.
void drop_opposite(Soup& soup) {
    std::map<Triangle, std::vector<std::size_t>> at_place; // by sorted corners; a soup has each direction once
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
        Triangle key = soup.triangles[t];
        std::sort(key.begin(), key.end());
        at_place[key].push_back(t);
    }
    std::vector<char> gone(soup.triangles.size(), 0);
    for (const auto& [corners, uses] : at_place)
        if (uses.size() == 2)
            for (const std::size_t t : uses) gone[t] = 1;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
        if (!gone[t]) soup.triangles[kept++] = soup.triangles[t];
    soup.triangles.resize(kept);
    if (kept == 0)
        throw Error("FE223", "the surface is closed but encloses no volume: every triangle lies on another",
                    "Take the doubled faces away, or give an isoValue above 0 to wrap them.");
}

/// The share of the whole that the grid takes.
constexpr double grid_share = 0.4;

std::string place_text(const Vec3& p) {
    return "(" + short_number(p.x()) + ", " + short_number(p.y()) + ", " + short_number(p.z()) + ")";
}

/// What is meshed, as messages need it: in the caller's coordinates.
struct Scales {
    double iso, triangle, cell;
    int resolution;
    bool is_manifold;
    /// Triangles finer than this follow the kinks of the distance between the grid's samples, not the surface.
    double least_triangle() const { return 0.5 * cell; }
    /// Sheets wrapped at less than this may fall between the grid's samples.
    double least_iso() const { return 0.5 * cell; }
    /// The resolution at which `small`, half a cell or more, would be one.
    int resolution_for(double small) const {
        return static_cast<int>(std::ceil(std::min(1e6, resolution * 0.5 * cell / small)));
    }
};

[[noreturn]] void refuse_endless(const Vec3& place, const Scales& scales) {
    if (scales.triangle < scales.least_triangle()) {
        const int finer = scales.resolution_for(scales.triangle);
        const double factor = std::ceil(10 * scales.least_triangle() / scales.triangle) / 10;
        throw Error("FE234",
                    "the level set cannot be meshed: triangles of " + short_number(scales.triangle) +
                        " are finer than the grid's cells of " + short_number(scales.cell) +
                        ", at whose sides the distance has kinks; they become smaller and smaller near " +
                        place_text(place),
                    (finer <= most_resolution ? "Raise resolution to " + std::to_string(finer) + " or more, or"
                                              : std::string("Raise")) +
                        " triangleSize to " + short_number(factor) + " times its value.");
    }
    throw Error("FE234",
                "the level set cannot be meshed: triangles become smaller and smaller near " + place_text(place) +
                    ", where it meets itself in an edge or a point, or bends too sharply",
                scales.is_manifold ? "Give a slightly larger or smaller isoValue, so that parts overlap or come apart "
                                     "there, or switch produceManifoldMesh off."
                                   : "Give a slightly larger or smaller isoValue.");
}

SurfaceMesherOutput run_mesher(const DistanceGrid& grid, const IsoSeeds& seeds, double size, const Scales& scales,
                               const MeshFrame& frame, Watch& watch) {
    SurfaceMesherInput in;
    in.seeds = seeds.points;
    in.inside = seeds.inside;
    in.reach = 2 * grid.step * DistanceGrid::cells * Vec3(grid.blocks[0], grid.blocks[1], grid.blocks[2]).norm();
    in.is_manifold = scales.is_manifold;
    // The mean edge comes out at about 1.1 radii.
    in.radius = 0.9 * size;
    in.distance = 0.1 * size;
    // Measured: 60 to 150 evaluations a seed.
    const double expected = 100.0 * static_cast<double>(seeds.points.size());
    std::size_t evaluations = 0;
    in.watch = [&] { watch.check(); };
    // Far beyond that, triangles become smaller and smaller at one place.
    const double most = 1e6 + 10 * expected;
    in.field = [&](const Vec3& p) {
        if (static_cast<double>(evaluations) > most) throw Endless();
        if (++evaluations % 4096 == 0) {
            watch.check();
            const double share = static_cast<double>(evaluations) / expected;
            watch.progress(grid_share + (1 - grid_share) * share / (share + 0.3), "meshing the level set");
        }
        return grid.value(p);
    };
    try {
        return mesh_level_set(in);
    } catch (const Endless& endless) {
        refuse_endless(frame.out(endless.densest), scales);
    }
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

/// Components of which crumbs alone were meshed: where two sides of the level set are much closer to each other than
/// triangles are wide, the mesher sees neither.
std::vector<int> torn_components(const IsoSeeds& seeds, const SurfaceMesherOutput& mesh, double size) {
    std::vector<int> parent(mesh.points.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int v) {
        while (parent[static_cast<std::size_t>(v)] != v)
            v = parent[static_cast<std::size_t>(v)] =
                parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(v)])];
        return v;
    };
    for (const Triangle& t : mesh.triangles)
        for (int k = 1; k < 3; ++k) parent[static_cast<std::size_t>(root(t[static_cast<std::size_t>(k)]))] = root(t[0]);
    std::vector<int> component(mesh.points.size(), -1); // of each root
    for (std::size_t s = 0; s < seeds.points.size(); ++s)
        if (const int v = mesh.vertex_of_seed[s]; v >= 0)
            component[static_cast<std::size_t>(root(v))] = seeds.component[s];
    std::vector<double> areas(seeds.areas.size(), 0.0);
    for (const Triangle& t : mesh.triangles) {
        const int c = component[static_cast<std::size_t>(root(t[0]))];
        const Vec3& p = mesh.points[static_cast<std::size_t>(t[0])];
        if (c >= 0)
            areas[static_cast<std::size_t>(c)] += 0.5 * (mesh.points[static_cast<std::size_t>(t[1])] - p)
                                                            .cross(mesh.points[static_cast<std::size_t>(t[2])] - p)
                                                            .norm();
    }
    // The seeds' estimate of an area is 0.65 to 1 of it. Components of a few triangles may be rough.
    std::vector<int> torn;
    for (std::size_t c = 0; c < areas.size(); ++c)
        if (seeds.areas[c] > 10 * size * size && areas[c] > 0 && areas[c] < 0.4 * seeds.areas[c])
            torn.push_back(static_cast<int>(c));
    return torn;
}

[[noreturn]] void refuse_torn(const IsoSeeds& seeds, const std::vector<int>& torn, const MeshFrame& frame,
                              const Scales& scales) {
    std::size_t first = 0;
    while (seeds.component[first] != torn.front()) ++first;
    const std::string where = "the surface near " + place_text(frame.out(seeds.points[first]));
    if (!(scales.iso > 0))
        throw Error(
            "FE231", where + " is a sheet too thin for the triangles: crumbs of it would be left",
            "Give an isoValue above 0 so that it gets a thickness, a smaller triangleSize, or a higher resolution.");
    std::string hint = "Give a larger isoValue, a higher resolution, or a smaller triangleSize.";
    if (scales.iso < scales.least_iso()) { // smaller triangles would follow the crumbs
        const int finer = scales.resolution_for(scales.iso);
        hint = "Give an isoValue of " + short_number(scales.least_iso()) + " (half a grid cell) or more" +
               (finer <= most_resolution ? ", or a resolution of " + std::to_string(finer) + " or more." : ".");
    }
    throw Error("FE231",
                where + " is a sheet of thickness " + short_number(2 * scales.iso) +
                    " (twice the isoValue), too thin for grid cells of " + short_number(scales.cell) +
                    " and triangles of " + short_number(scales.triangle) + ": crumbs of it would be left",
                hint);
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
          describe(found.non_manifold_edges, "edge with more than two triangles", "edges with more than two triangles"),
          describe(found.badly_oriented_edges, "edge between opposite sides", "edges between opposite sides"),
          describe(found.non_manifold_vertices, "vertex with several fans", "vertices with several fans")})
        if (!f.empty()) flaws += (flaws.empty() ? "" : ", ") + f;
    throw Error("FE234", "the iso mesh is not a closed manifold: " + flaws,
                "Choose a smaller triangleSize or a higher resolution.");
}

double size_for(const Soup& soup) { return bounding_box(soup.points).size().norm() / 40; }

} // namespace

double default_triangle_size(const Points& points, const std::vector<Triangle>& triangles) {
    frame_for(points, triangles, 0);
    return size_for(make_soup(points, triangles));
}

IsoMesh make_iso_mesh(const Points& points, const std::vector<Triangle>& triangles, const IsoMeshOptions& options,
                      const MeshingControl& control) {
    check(options);
    Watch watch(control, options.most_seconds);
    const MeshFrame frame = frame_for(points, triangles, options.iso_value);
    Points near = points;
    for (Vec3& p : near) p = frame.in(p);
    Soup soup = make_soup(near, triangles);
    if (!soup.is_closed && !(options.iso_value > 0))
        throw Error("FE230",
                    "the mesh is open (" + std::to_string(soup.open_edges) +
                        " edges are not shared by triangles in opposite directions, the first between vertices " +
                        std::to_string(soup.first_open[0]) + " and " + std::to_string(soup.first_open[1]) +
                        "), so it has no inside for an iso value of " + short_number(options.iso_value),
                    "Give an isoValue above 0, or close the mesh.");
    if (!(options.iso_value > 0)) drop_opposite(soup);
    const std::size_t buried = turn_outwards(soup.points, soup.triangles);
    const double iso = frame.in(options.iso_value);
    // Triangles larger than the level set are no different from one another.
    const double most_size = 2 * (bounding_box(soup.points).size().norm() + 4 * std::abs(iso));
    const double size =
        options.triangle_size > 0 ? std::min(frame.in(options.triangle_size), most_size) : size_for(soup);
    check_precision(frame, frame.out(size));
    const DistanceGrid grid = make_distance_grid(soup, iso, options.resolution, watch.part(0, grid_share));
    IsoSeeds seeds = make_iso_seeds(grid, 1e300, {}, watch.part(0, 1));
    if (seeds.points.empty())
        throw Error("FE231", "nothing lies at a distance of " + short_number(options.iso_value) + " from the mesh",
                    "A negative isoValue must be smaller in size than the mesh is thick; a thin mesh also needs a "
                    "higher resolution.");
    check_count(seeds.area(), size);

    IsoMesh mesh;
    mesh.components = seeds.areas.size();
    mesh.buried = soup.is_closed ? buried : 0;
    std::vector<int> finer(seeds.areas.size(), 0);
    const Scales scales{options.iso_value, frame.out(size), frame.out(grid.step), options.resolution,
                        options.is_manifold};
    constexpr int attempts = 3;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        seeds = make_iso_seeds(grid, size, finer, watch.part(0, 1));
        watch.check();
        SurfaceMesherOutput out = run_mesher(grid, seeds, size, scales, frame, watch);
        const std::vector<int> lost = lost_components(seeds, out), torn = torn_components(seeds, out, size);
        mesh.points = std::move(out.points);
        mesh.triangles = std::move(out.triangles);
        mesh.lost = lost.size();
        if (lost.empty() && torn.empty()) break;
        for (const int c : lost) ++finer[static_cast<std::size_t>(c)];
        for (const int c : torn) ++finer[static_cast<std::size_t>(c)];
        if (attempt + 1 == attempts && !torn.empty()) refuse_torn(seeds, torn, frame, scales);
    }
    if (mesh.triangles.empty())
        throw Error("FE231",
                    "all " + std::to_string(mesh.components) + " pieces of the level set are too small to be meshed",
                    "Choose a smaller triangleSize, a higher resolution or another isoValue.");
    if (options.is_manifold) check_manifold(mesh);
    for (Vec3& p : mesh.points) p = frame.out(p);
    watch.progress(1, "meshed");
    return mesh;
}

} // namespace sinew::solver
