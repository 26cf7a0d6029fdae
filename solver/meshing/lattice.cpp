// The tet lattice of zTet.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/lattice.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/bcc_grid.h"
#include "solver/meshing/refined_cells.h"
#include "solver/meshing/self_intersections.h"
#include "solver/meshing/sheet_shell.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>

namespace sinew::solver {
namespace {

/// Lattice numbers of the finest level must fit into 64 bits, lattice coordinates into 32.
constexpr double most_cubes_along = 400000;
constexpr std::int64_t most_tets = 20'000'000; // about 4 GB while they are made

/// Share of the solid's volume that least coverages may add.
constexpr double most_excess = 0.1;

std::string number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", x);
    return text;
}

double side_or_default(const LatticeOptions& options, double longest) {
    return options.tet_size > 0 ? options.tet_size : longest / 3.5;
}

/// The side of the coarse cubes; throws where it would make no sense or too many cubes.
double checked_side(const Solid& solid, const LatticeOptions& options, int levels) {
    if (!(options.tet_size >= 0) || !std::isfinite(options.tet_size))
        throw Error("FE222", "the tet size must be positive, or 0 for the default");
    if (!(options.least_coverage >= 0) || options.least_coverage > 1)
        throw Error("FE222", "the least coverage must lie in 0 to 1");
    if (options.moments != 1 && options.moments != 4) throw std::logic_error("moments are of degree 1 or 4");
    const double longest = solid.box.size().maxCoeff();
    const double side = side_or_default(options, longest);
    const double along = std::ceil(longest / side * std::exp2(levels) * (1 - 1e-12));
    const double limit = std::min<double>(options.max_resolution, most_cubes_along);
    if (!(along <= limit)) {
        const std::string count = along < 1e15 ? std::to_string(static_cast<long long>(along)) : "over 1e15";
        throw Error("FE210",
                    "the lattice would have " + count + " cubes along the longest side of " + number(longest) +
                        ", with a tet size of " + number(side) +
                        (levels > 0 ? ", refined " + std::to_string(levels) + " times" : "") + "; the limit is " +
                        std::to_string(static_cast<long long>(limit)),
                    std::string("raise the tet size or the maximum resolution") +
                        (levels > 0 ? ", or refine less" : "") +
                        "; if the mesh is in another unit than the tet size, scale it by a transform");
    }
    return side;
}

TetMesh assemble(const BccGrid& finest, const std::vector<LatticePiece>& pieces, const LatticeOptions& options,
                 const MeshingControl& control) {
    std::vector<std::int64_t> numbers;
    numbers.reserve(4 * pieces.size());
    for (const LatticePiece& p : pieces)
        for (const auto& key : p.corners) numbers.push_back(finest.vertex_number(key));
    std::vector<std::int64_t> sorted = numbers;
    control.ask(); // of millions each step takes a second or so
    parallel_sort(sorted.begin(), sorted.end());
    control.ask();
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());

    control.ask();
    TetMesh mesh;
    mesh.vertices.reserve(sorted.size());
    for (std::int64_t number : sorted) mesh.vertices.push_back(finest.position(finest.vertex_key(number)));
    mesh.tets.resize(pieces.size());
    mesh.coverage.resize(pieces.size());
    const double least = std::max(options.least_coverage, std::numeric_limits<double>::min());
    parallel_for(pieces.size(), 256, [&](std::size_t t) {
        for (std::size_t k = 0; k < 4; ++k)
            mesh.tets[t][k] =
                static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), numbers[4 * t + k]) - sorted.begin());
        mesh.coverage[t] = std::max(pieces[t].share, least);
    });
    control.ask();
    mesh.cut.degree = options.moments;
    for (std::size_t t = 0; t < pieces.size(); ++t)
        if (pieces[t].moments) mesh.cut.tets.push_back(static_cast<int>(t));
    const std::size_t count = moment_count(options.moments);
    mesh.cut.moments.resize(count * mesh.cut.tets.size());
    for (std::size_t k = 0; k < mesh.cut.tets.size(); ++k)
        std::copy_n(pieces[static_cast<std::size_t>(mesh.cut.tets[k])].moments.get(), count,
                    mesh.cut.moments.begin() + static_cast<std::ptrdiff_t>(count * k));
    return mesh;
}

/// How much heavier than the solid the tets are: the least coverage counts as mass and stiffness.
double excess(const BccGrid& finest, const std::vector<LatticePiece>& pieces, double least_coverage) {
    double solid = 0, counted = 0;
    for (const LatticePiece& p : pieces) {
        const double volume = tet_volume(finest.position(p.corners[0]), finest.position(p.corners[1]),
                                         finest.position(p.corners[2]), finest.position(p.corners[3]));
        solid += p.share * volume;
        counted += std::max(p.share, least_coverage) * volume;
    }
    return solid > 0 ? counted / solid - 1 : std::numeric_limits<double>::infinity();
}

struct Lattice {
    BccGrid finest;
    std::vector<LatticePiece> pieces;
    bool is_sound(double least_coverage) const { return excess(finest, pieces, least_coverage) <= most_excess; }
};

Lattice lattice_of_side(const Solid& solid, const Paint& paint, double side, const LatticeOptions& options,
                        const MeshingControl& control, bool is_estimate = false) {
    const BccGrid grid = make_bcc_grid(solid.box.centre(), solid.box.size(), side);
    const bool is_surface_only = options.fill == Fill::surface_only;
    const CoarseCells coarse = find_coarse_cells(solid, grid, is_surface_only, control);
    RefinedCells refined =
        refine_cells(solid, grid, coarse, paint, {is_surface_only, most_tets, options.moments, is_estimate}, control);
    BccGrid finest = grid;
    for (int level = 0; level < refined.levels; ++level) finest = finest.finer();
    return {finest, std::move(refined.pieces)};
}

/// Finest cubes may be this many times as long as the solid. Beyond, the least coverage alone is far too heavy, shares
/// are lost in rounding, and at last volumes overflow.
constexpr double most_lengths = 1000;

/// No coarser lattice is sound. Tets at the surface have about its area times their side of volume, and of that the
/// least coverage counts; four times as much allows for how they lie. Thin sheets need so many tets that there is
/// nothing to try.
double coarsest_sound_side(const Solid& solid, const LatticeOptions& options) {
    double area = 0;
    for (const Triangle& t : solid.triangles) {
        const Vec3 &a = solid.points[at(t[0])], &b = solid.points[at(t[1])], &c = solid.points[at(t[2])];
        area += 0.5 * (b - a).cross(c - a).norm();
    }
    return 4 * most_excess / options.least_coverage * std::abs(enclosed_volume(solid.points, solid.triangles)) / area;
}

/// A size below `side` that would do, where one can be found quickly.
std::string finer_advice(const Solid& solid, const Paint& paint, double side, const LatticeOptions& options,
                         const MeshingControl& control) {
    const Vec3 size = solid.box.size();
    const double sensible = 4 * size.maxCoeff() * std::exp2(paint.highest());
    // Refined, the tets at the surface are smaller by as much.
    const double coarsest = coarsest_sound_side(solid, options) * std::exp2(paint.highest());
    for (double smaller = std::min(side / 2, sensible);; smaller /= 2) {
        // A number to be typed, rounded down.
        const double unit = std::pow(10.0, std::floor(std::log10(smaller)) - 1);
        const double typed = std::floor(smaller / unit) * unit;
        const double along = size.maxCoeff() / typed * std::exp2(paint.highest());
        // Each try has up to eight times as many tets as the one before.
        constexpr double most_cubes = 300000;
        constexpr std::size_t most_pieces = 6000;
        if (along > options.max_resolution || ((size / typed).array() + 5).prod() > most_cubes) break;
        if (smaller > coarsest) continue;
        const Lattice tried = lattice_of_side(solid, paint, typed, options, {control.stop, {}});
        if (tried.is_sound(options.least_coverage)) return "choose a tet size of " + number(typed) + " or less";
        if (tried.pieces.size() > most_pieces) break;
    }
    return "choose a smaller tet size, and a higher maximum resolution if that is refused";
}

[[noreturn]] void refuse_huge(const Solid& solid, const Paint& paint, double side, const LatticeOptions& options,
                              const MeshingControl& control) {
    throw Error("FE210",
                "the tet size of " + number(side) + " is too large for this mesh: its longest side is " +
                    number(solid.box.size().maxCoeff()),
                finer_advice(solid, paint, side, options, control));
}

[[noreturn]] void refuse_coarse(const Solid& solid, const Paint& paint, double side, const Lattice& lattice,
                                const LatticeOptions& options, const MeshingControl& control) {
    const double heavier = excess(lattice.finest, lattice.pieces, options.least_coverage);
    throw Error("FE210",
                "the tet size of " + number(side) + " is too large for this mesh: " +
                    (std::isfinite(heavier) ? "with the least share of " + number(options.least_coverage) +
                                                  " that every tet counts as solid, its volume would come out " +
                                                  number(1 + heavier) + " times as large"
                                            : "no tet would hold a share of it"),
                finer_advice(solid, paint, side, options, control));
}

/// Whether each edge has two triangles, all with an area, and none of them meet elsewhere: then winding numbers are 0
/// and 1, as parts face outwards and cavities inwards.
bool is_simple(const Solid& solid, const MeshingControl& control) {
    if (!solid.is_closed || solid.border_edges > 0) return false;
    const MeshCheck found = check_mesh(solid.points, solid.triangles);
    if (!found.is_closed() || found.degenerate_triangles) return false;
    const Flaw crossing =
        self_intersections(solid.points, solid.triangles, control.stop, 1'000'000 + 30 * solid.triangles.size());
    return crossing.is_whole && !crossing;
}

/// Whether the excess is too large even where rounding made shares too small, and tets that hold next to nothing fall
/// out of the lattice.
bool is_surely_coarse(const Lattice& estimate, double least_coverage) {
    constexpr double rounding = 1e-11, negligible = 2e-9;
    double solid = 0, added = 0;
    for (const LatticePiece& p : estimate.pieces) {
        const double volume =
            tet_volume(estimate.finest.position(p.corners[0]), estimate.finest.position(p.corners[1]),
                       estimate.finest.position(p.corners[2]), estimate.finest.position(p.corners[3]));
        solid += (p.share + rounding) * volume;
        if (p.share > negligible) added += std::max(0.0, least_coverage - p.share - rounding) * volume;
    }
    return added > (most_excess + 1e-6) * solid;
}

/// Of a thin solid the tets take long to measure, each in hundreds of parts; what is refused for its volume afterwards
/// is told by an estimate.
void refuse_thin(const Solid& solid, const Paint& paint, double side, const LatticeOptions& options,
                 const MeshingControl& control) {
    const double finest = side / std::exp2(paint.highest());
    if (finest < coarsest_sound_side(solid, options) || !is_simple(solid, control)) return;
    const Lattice estimate = lattice_of_side(solid, paint, side, options, {control.stop, {}}, true);
    if (is_surely_coarse(estimate, options.least_coverage))
        refuse_coarse(solid, paint, side, estimate, options, control);
}

bool is_shell(const Points& points, const std::vector<Triangle>& triangles, const LatticeOptions& options) {
    if (options.fill != Fill::surface_only) return false;
    SurfaceMesh view;
    view.points = points;
    view.triangles = triangles;
    check_usable(view); // of the mesh as given, so that messages number its vertices
    return options.thickness > 0 || is_sheet(points, triangles);
}

TetMesh make_shell_lattice(const Points& points, const std::vector<Triangle>& triangles, LatticeOptions options,
                           const MeshingControl& control) {
    if (options.refinement.size() > 1) {
        if (options.refinement.size() != points.size())
            throw Error("FE204", std::to_string(options.refinement.size()) + " numbers of refinement for " +
                                     std::to_string(points.size()) + " vertices");
        const std::vector<double> above = options.refinement; // and the same below
        options.refinement.insert(options.refinement.end(), above.begin(), above.end());
    }
    Points used;
    for (const Triangle& t : triangles)
        for (const int v : t) used.push_back(points[at(v)]);
    options.tet_size = side_or_default(options, bounding_box(used).size().maxCoeff());
    options.fill = Fill::empty_cavities;
    const double thickness = options.thickness > 0 ? options.thickness : options.tet_size / 10;
    const SheetShell shell = make_sheet_shell(points, triangles, thickness);
    return make_lattice(shell.points, shell.triangles, options, control);
}

} // namespace

TetMesh make_lattice(const Points& points, const std::vector<Triangle>& triangles, const LatticeOptions& options,
                     const MeshingControl& control) {
    if (is_shell(points, triangles, options)) return make_shell_lattice(points, triangles, options, control);
    const Solid solid = make_solid(points, triangles, options.fill, control);
    const Paint paint(solid, options.refinement, options.propagation);
    const double side = checked_side(solid, options, paint.highest());
    const Vec3 size = solid.box.size();
    // Numbers of coarse tets are kept in 32 bits.
    const Vec3 cubes = (size / side).array() + 5;
    if (!(24 * cubes.prod() < std::numeric_limits<int>::max()))
        throw Error("FE210",
                    "the lattice would have about " + std::to_string(static_cast<long long>(cubes.prod())) +
                        " cubes, more than can be numbered",
                    "raise the tet size");
    // Tets fill the solid and the whole of a surface's tets besides, so there are at least this many, 12 to a cube.
    // Where parts overlap the volume counts twice, but not beyond the box.
    const double volume = std::min(std::abs(enclosed_volume(solid.points, solid.triangles)), size.prod());
    if (options.fill != Fill::surface_only && 12 * volume > static_cast<double>(most_tets) * side * side * side)
        throw Error("FE210",
                    "the lattice would have about " +
                        std::to_string(std::llround(12 * volume / (side * side * side) / 1e6)) +
                        " million tets; the limit is " + std::to_string(most_tets / 1'000'000) + " million",
                    "raise the tet size");
    if (side > most_lengths * size.maxCoeff() * std::exp2(paint.highest()))
        refuse_huge(solid, paint, side, options, control);
    refuse_thin(solid, paint, side, options, control);
    const Lattice lattice = lattice_of_side(solid, paint, side, options, control);
    if (!lattice.is_sound(options.least_coverage)) refuse_coarse(solid, paint, side, lattice, options, control);
    return assemble(lattice.finest, lattice.pieces, options, control);
}

} // namespace sinew::solver
