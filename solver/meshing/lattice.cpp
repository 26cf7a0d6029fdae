// The tet lattice of zTet.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/lattice.h"

#include "solver/error.h"
#include "solver/meshing/bcc_grid.h"
#include "solver/meshing/solid.h"
#include "solver/meshing/tet_quadrature.h"
#include "solver/meshing/tet_share.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sinew::solver {
namespace {

/// In barycentric coordinates. Far above rounding, so that a mesh aligned with the lattice touches on all
/// sides alike.
constexpr double touch_slack = 1e-9;
/// A closed surface must fill more than this of a tet for the tet to count.
constexpr double negligible_share = 1e-9;

struct Contact {
    std::int64_t tet;
    int triangle;
    bool operator<(const Contact& o) const { return tet != o.tet ? tet < o.tet : triangle < o.triangle; }
};

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

BccGrid::Key cube_key(const BccGrid& grid, std::int64_t tet) {
    const BccGrid::Key upper = grid.tet_vertices(tet)[1];
    return {upper[0] / 2, upper[1] / 2, upper[2] / 2};
}

BarycentricTriangle in_tet(const BccGrid& grid, const std::array<Vec3, 3>& lattice_corners,
                           std::int64_t tet) {
    const BccGrid::Key cube = cube_key(grid, tet);
    BarycentricTriangle result;
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = bcc_barycentric(cube, static_cast<int>(tet % 12) / 4, static_cast<int>(tet % 4),
                                    lattice_corners[c]);
    return result;
}

/// All tets that one triangle touches.
void find_contacts(const BccGrid& grid, const std::array<Vec3, 3>& corners, int triangle,
                   std::vector<Contact>& out) {
    constexpr double reach = 1e-6; // more than touch_slack, in lattice coordinates
    const Vec3 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
    const Vec3 high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).stableNormalized();
    const double level = normal.dot(corners[0]);
    for (int axis = 0; axis < 3; ++axis) {
        int first[3], last[3];
        for (int d = 0; d < 3; ++d) {
            // Across the axis a group of four tets spans its face (2 units); along it, one unit to either
            // side.
            const double below = d == axis ? low[d] - 1 : low[d] - 2,
                         above = d == axis ? high[d] + 1 : high[d];
            first[d] = std::max(d == axis ? 1 : 0, static_cast<int>(std::ceil((below - reach) / 2)));
            last[d] = std::min(grid.cubes[at(d)] - 1, static_cast<int>(std::floor((above + reach) / 2)));
        }
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int z = first[2]; z <= last[2]; ++z)
            for (int y = first[1]; y <= last[1]; ++y)
                for (int x = first[0]; x <= last[0]; ++x) {
                    // The group is an octahedron-like body; skip it when it lies on one side of the
                    // triangle's plane.
                    Vec3 middle(2 * x + 1, 2 * y + 1, 2 * z + 1);
                    middle[axis] -= 1;
                    const double extent =
                        std::max(std::abs(normal[axis]), std::abs(normal[u]) + std::abs(normal[v]));
                    if (std::abs(normal.dot(middle) - level) > extent + reach) continue;
                    const std::int64_t group = 12 * grid.cube_number({x, y, z}) + 4 * axis;
                    for (int edge = 0; edge < 4; ++edge)
                        if (touches_tet(in_tet(grid, corners, group + edge), touch_slack))
                            out.push_back({group + edge, triangle});
                }
    }
}

std::vector<Contact> find_all_contacts(const BccGrid& grid, const std::vector<std::array<Vec3, 3>>& corners) {
    constexpr std::size_t chunk = 64;
    const std::size_t chunks = (corners.size() + chunk - 1) / chunk;
    std::vector<std::vector<Contact>> found(chunks);
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t c) {
        for (std::size_t t = c * chunk; t < std::min(corners.size(), (c + 1) * chunk); ++t)
            find_contacts(grid, corners[t], static_cast<int>(t), found[c]);
    });
    std::vector<Contact> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    tbb::parallel_sort(all.begin(), all.end());
    return all;
}

/// Regions of lattice vertices joined by tets that the surface does not touch: each is inside or outside as a
/// whole.
class Regions {
  public:
    explicit Regions(std::int64_t count)
        : parent_(at(count)) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int root(std::int64_t i) {
        int r = static_cast<int>(i);
        while (parent_[at(r)] != r) r = parent_[at(r)] = parent_[at(parent_[at(r)])];
        return r;
    }
    void join(std::int64_t a, std::int64_t b) {
        const int ra = root(a), rb = root(b);
        parent_[at(std::max(ra, rb))] = std::min(ra, rb);
    }

  private:
    std::vector<int> parent_;
};

struct KeptTet {
    std::int64_t tet;
    double share;
};

class Builder {
  public:
    Builder(const Solid& solid, const BccGrid& grid)
        : solid_(solid)
        , grid_(grid) {
        corners_.reserve(solid.triangles.size());
        for (const Triangle& t : solid.triangles)
            corners_.push_back({grid.coordinates(solid.points[at(t[0])]),
                                grid.coordinates(solid.points[at(t[1])]),
                                grid.coordinates(solid.points[at(t[2])])});
        contacts_ = find_all_contacts(grid, corners_);
        for (std::size_t i = 0; i < contacts_.size(); ++i)
            if (i == 0 || contacts_[i].tet != contacts_[i - 1].tet) starts_.push_back(i);
        starts_.push_back(contacts_.size());
    }

    std::vector<KeptTet> build() {
        std::vector<KeptTet> kept = solid_.is_closed ? inside_closed() : inside_open();
        const std::size_t whole = kept.size();
        kept.resize(whole + starts_.size() - 1);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, starts_.size() - 1, 16), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                kept[whole + i] = {contacts_[starts_[i]].tet, border_share(i)};
        });
        if (solid_.is_closed)
            std::erase_if(kept, [](const KeptTet& k) { return k.share < negligible_share; });
        std::sort(kept.begin(), kept.end(), [](const KeptTet& a, const KeptTet& b) { return a.tet < b.tet; });
        return kept;
    }

  private:
    std::array<Vec3, 4> corner_positions(std::int64_t tet) const {
        const auto keys = grid_.tet_vertices(tet);
        return {grid_.position(keys[0]), grid_.position(keys[1]), grid_.position(keys[2]),
                grid_.position(keys[3])};
    }

    /// Calls `use` for every tet of the grid that no triangle touches.
    template <class Use>
    void for_each_untouched(const Use& use) const {
        std::size_t next = 0;
        for (std::int64_t tet = 0; tet < grid_.tet_count(); ++tet) {
            if (next + 1 < starts_.size() && contacts_[starts_[next]].tet == tet) {
                ++next;
                continue;
            }
            if (grid_.holds(tet)) use(tet);
        }
    }

    std::vector<KeptTet> inside_closed() {
        Regions regions(grid_.vertex_numbers());
        for_each_untouched([&](std::int64_t tet) {
            const auto keys = grid_.tet_vertices(tet);
            for (std::size_t k = 1; k < 4; ++k)
                regions.join(grid_.vertex_number(keys[0]), grid_.vertex_number(keys[k]));
        });
        // One question a region, asked in the middle of its first tet, which no triangle touches.
        constexpr signed char unknown = -1;
        std::vector<signed char> is_inside(at(grid_.vertex_numbers()), unknown);
        std::vector<KeptTet> kept;
        for_each_untouched([&](std::int64_t tet) {
            signed char& inside =
                is_inside[at(regions.root(grid_.vertex_number(grid_.tet_vertices(tet)[0])))];
            if (inside == unknown) {
                const auto c = corner_positions(tet);
                inside = std::abs(solid_.winding_number((c[0] + c[1] + c[2] + c[3]) / 4)) > 0.5;
            }
            if (inside) kept.push_back({tet, 1.0});
        });
        return kept;
    }

    /// An open surface has no regions: the winding number changes smoothly through its holes.
    std::vector<KeptTet> inside_open() {
        std::vector<double> winding(at(grid_.vertex_numbers()), 0.0);
        const auto is_vertex = [](const BccGrid::Key& k) {
            return k[0] % 2 == k[1] % 2 && k[1] % 2 == k[2] % 2;
        };
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, winding.size(), 256), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const BccGrid::Key key = grid_.vertex_key(static_cast<std::int64_t>(i));
                if (is_vertex(key)) winding[i] = std::abs(solid_.winding_number(grid_.position(key)));
            }
        });
        std::vector<KeptTet> kept;
        std::vector<std::size_t> mixed;
        for_each_untouched([&](std::int64_t tet) {
            int inside = 0;
            for (const auto& key : grid_.tet_vertices(tet))
                inside += winding[at(grid_.vertex_number(key))] > 0.5;
            if (inside == 0) return;
            if (inside < 4) mixed.push_back(kept.size());
            kept.push_back({tet, 1.0});
        });
        tbb::parallel_for(std::size_t{0}, mixed.size(), [&](std::size_t i) {
            KeptTet& k = kept[mixed[i]];
            k.share = quadrature_share(solid_, corner_positions(k.tet), false);
        });
        return kept;
    }

    double border_share(std::size_t group) const {
        const std::int64_t tet = contacts_[starts_[group]].tet;
        const std::array<Vec3, 4> corners = corner_positions(tet);
        if (!solid_.is_closed) return quadrature_share(solid_, corners, true);
        std::vector<int> triangles;
        for (std::size_t i = starts_[group]; i < starts_[group + 1]; ++i)
            triangles.push_back(contacts_[i].triangle);
        return closed_share(solid_, corners, triangles);
    }

    const Solid& solid_;
    const BccGrid& grid_;
    std::vector<std::array<Vec3, 3>> corners_; ///< of the triangles, in lattice coordinates
    std::vector<Contact> contacts_;            ///< sorted by tet, then triangle
    std::vector<std::size_t> starts_;          ///< first contact of each touched tet, and the end
};

/// The cube side to use; throws where it would make no sense or too many cubes.
double checked_side(const Solid& solid, const LatticeOptions& options) {
    if (!(options.tet_size >= 0) || !std::isfinite(options.tet_size))
        throw Error("FE206", "the tet size must be positive, or 0 for the default");
    if (!(options.least_coverage >= 0) || options.least_coverage > 1)
        throw Error("FE206", "the least coverage must lie in 0 to 1");
    const double longest = solid.box.size().maxCoeff();
    const double side = options.tet_size > 0 ? options.tet_size : longest / 3.5;
    const double along = std::ceil(longest / side * (1 - 1e-12));
    if (!(along <= options.max_resolution)) {
        const std::string count = along < 1e15 ? std::to_string(static_cast<long long>(along)) : "over 1e15";
        throw Error("FE210",
                    "the lattice would have " + count + " cubes along the longest side; the limit is " +
                        std::to_string(options.max_resolution),
                    "raise the tet size or the maximum resolution");
    }
    return side;
}

} // namespace

TetMesh make_lattice(const Points& points, const std::vector<Triangle>& triangles,
                     const LatticeOptions& options) {
    const Solid solid = make_solid(points, triangles);
    const double side = checked_side(solid, options);
    const Vec3 size = solid.box.size();
    // Lattice numbers are kept in 32 bits.
    const Vec3 cubes = (size / side).array() + 5;
    if (!(24 * cubes.prod() < std::numeric_limits<int>::max()))
        throw Error("FE210",
                    "the lattice would have about " + std::to_string(static_cast<long long>(cubes.prod())) +
                        " cubes, more than can be numbered",
                    "raise the tet size");
    const BccGrid grid = make_bcc_grid(solid.box.centre(), size, side);
    const std::vector<KeptTet> kept = Builder(solid, grid).build();

    std::vector<std::int64_t> numbers;
    numbers.reserve(4 * kept.size());
    for (const KeptTet& k : kept)
        for (const auto& key : grid.tet_vertices(k.tet)) numbers.push_back(grid.vertex_number(key));
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());

    TetMesh mesh;
    mesh.vertices.reserve(numbers.size());
    for (std::int64_t number : numbers) mesh.vertices.push_back(grid.position(grid.vertex_key(number)));
    mesh.tets.reserve(kept.size());
    mesh.coverage.reserve(kept.size());
    const double least = std::max(options.least_coverage, std::numeric_limits<double>::min());
    for (const KeptTet& k : kept) {
        Tet tet;
        const auto keys = grid.tet_vertices(k.tet);
        for (std::size_t i = 0; i < 4; ++i)
            tet[i] = static_cast<int>(
                std::lower_bound(numbers.begin(), numbers.end(), grid.vertex_number(keys[i])) -
                numbers.begin());
        mesh.tets.push_back(tet);
        mesh.coverage.push_back(std::max(k.share, least));
    }
    return mesh;
}

} // namespace sinew::solver
