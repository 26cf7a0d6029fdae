// The coarse lattice around a solid.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/lattice_cells.h"

#include "solver/index.h"
#include "solver/joined_sets.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {
namespace {

struct Contact {
    std::int64_t tet;
    int triangle;
    bool operator<(const Contact& o) const { return tet != o.tet ? tet < o.tet : triangle < o.triangle; }
};

/// All tets that one triangle touches.
void find_contacts(const BccGrid& grid, const std::array<Vec3, 3>& corners, int triangle, std::vector<Contact>& out) {
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
            const double below = d == axis ? low[d] - 1 : low[d] - 2, above = d == axis ? high[d] + 1 : high[d];
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
                    const double extent = std::max(std::abs(normal[axis]), std::abs(normal[u]) + std::abs(normal[v]));
                    if (std::abs(normal.dot(middle) - level) > extent + reach) continue;
                    const std::int64_t group = 12 * grid.cube_number({x, y, z}) + 4 * axis;
                    for (int edge = 0; edge < 4; ++edge)
                        if (touches_tet(seen_from(grid, group + edge, corners), touch_slack))
                            out.push_back({group + edge, triangle});
                }
    }
}

std::vector<Contact> find_all_contacts(const BccGrid& grid, const std::vector<std::array<Vec3, 3>>& corners,
                                       const MeshingPhase& phase) {
    constexpr std::size_t chunk = 64;
    const std::size_t chunks = (corners.size() + chunk - 1) / chunk;
    std::vector<std::vector<Contact>> found(chunks);
    phase.run(chunks, 1, [&](std::size_t c) {
        for (std::size_t t = c * chunk; t < std::min(corners.size(), (c + 1) * chunk); ++t)
            find_contacts(grid, corners[t], static_cast<int>(t), found[c]);
    });
    std::vector<Contact> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    parallel_sort(all.begin(), all.end());
    return all;
}

/// Tets that no triangle touches and that are not outside.
struct Untouched {
    std::int64_t tet;
    CellState state;
};

class Finder {
  public:
    Finder(const Solid& solid, const BccGrid& grid, const MeshingControl& control)
        : solid_(solid)
        , grid_(grid)
        , control_(control)
        , contacts_(find_all_contacts(grid, lattice_corners(solid, grid),
                                      {control, 0.15, 0.3, "finding the tets at the surface"})) {}

    CoarseCells find(bool is_surface_only) {
        std::vector<Untouched> untouched;
        if (!is_surface_only) untouched = solid_.is_closed ? inside_closed() : inside_open();
        CoarseCells cells;
        auto next = untouched.begin();
        for (std::size_t i = 0; i < contacts_.size();) {
            const std::int64_t tet = contacts_[i].tet;
            for (; next != untouched.end() && next->tet < tet; ++next) add(cells, *next);
            for (; i < contacts_.size() && contacts_[i].tet == tet; ++i)
                cells.triangles.push_back(contacts_[i].triangle);
            add(cells, {tet, CellState::touched});
        }
        for (; next != untouched.end(); ++next) add(cells, *next);
        return cells;
    }

  private:
    static void add(CoarseCells& cells, const Untouched& tet) {
        cells.tets.push_back(tet.tet);
        cells.states.push_back(tet.state);
        cells.first.push_back(cells.triangles.size());
    }

    /// Calls `use` for every tet of the grid that no triangle touches.
    template <class Use>
    void for_each_untouched(const Use& use) const {
        std::size_t next = 0;
        for (std::int64_t tet = 0; tet < grid_.tet_count(); ++tet) {
            if (next < contacts_.size() && contacts_[next].tet == tet) {
                while (next < contacts_.size() && contacts_[next].tet == tet) ++next;
                continue;
            }
            if (grid_.holds(tet)) use(tet);
        }
    }

    std::vector<Untouched> inside_closed() {
        control_.report(0.3, "finding the inside");
        // Of lattice vertices: each is inside or outside as a whole.
        JoinedSets regions(at(grid_.vertex_numbers()));
        for_each_untouched([&](std::int64_t tet) {
            const auto keys = grid_.tet_vertices(tet);
            for (std::size_t k = 1; k < 4; ++k)
                regions.join(grid_.vertex_number(keys[0]), grid_.vertex_number(keys[k]));
        });
        control_.report(0.4, "finding the inside");
        // One question a region, asked in the middle of its first tet, which no triangle touches.
        constexpr signed char unknown = -1;
        std::vector<signed char> is_inside(at(grid_.vertex_numbers()), unknown);
        std::vector<Untouched> kept;
        for_each_untouched([&](std::int64_t tet) {
            signed char& inside = is_inside[at(regions.root(grid_.vertex_number(grid_.tet_vertices(tet)[0])))];
            if (inside == unknown) inside = untouched_state(solid_, corner_positions(grid_, tet)) == CellState::inside;
            if (inside) kept.push_back({tet, CellState::inside});
        });
        return kept;
    }

    /// An open surface has no regions: the winding number changes smoothly through its holes.
    std::vector<Untouched> inside_open() {
        std::vector<char> inside(at(grid_.vertex_numbers()), 0);
        const auto is_vertex = [](const BccGrid::Key& k) { return k[0] % 2 == k[1] % 2 && k[1] % 2 == k[2] % 2; };
        const MeshingPhase phase{control_, 0.3, 0.45, "finding the inside"};
        phase.run(inside.size(), 256, [&](std::size_t i) {
            const BccGrid::Key key = grid_.vertex_key(static_cast<std::int64_t>(i));
            if (is_vertex(key)) inside[i] = solid_.tree.inside_either_way(grid_.position(key));
        });
        std::vector<Untouched> kept;
        for_each_untouched([&](std::int64_t tet) {
            int count = 0;
            for (const auto& key : grid_.tet_vertices(tet)) count += inside[at(grid_.vertex_number(key))];
            if (count > 0) kept.push_back({tet, count < 4 ? CellState::mixed : CellState::inside});
        });
        return kept;
    }

    const Solid& solid_;
    const BccGrid& grid_;
    const MeshingControl& control_;
    std::vector<Contact> contacts_; ///< sorted by tet, then triangle
};

} // namespace

std::vector<std::array<Vec3, 3>> lattice_corners(const Solid& solid, const BccGrid& grid) {
    std::vector<std::array<Vec3, 3>> corners;
    corners.reserve(solid.triangles.size());
    for (const Triangle& t : solid.triangles)
        corners.push_back({grid.coordinates(solid.points[at(t[0])]), grid.coordinates(solid.points[at(t[1])]),
                           grid.coordinates(solid.points[at(t[2])])});
    return corners;
}

BarycentricTriangle seen_from(const BccGrid& grid, std::int64_t tet, const std::array<Vec3, 3>& lattice_triangle) {
    const BccGrid::Key upper = grid.tet_vertices(tet)[1];
    const BccGrid::Key cube{upper[0] / 2, upper[1] / 2, upper[2] / 2};
    BarycentricTriangle result;
    for (std::size_t c = 0; c < 3; ++c)
        result[c] =
            bcc_barycentric(cube, static_cast<int>(tet % 12) / 4, static_cast<int>(tet % 4), lattice_triangle[c]);
    return result;
}

std::array<Vec3, 4> corner_positions(const BccGrid& grid, std::int64_t tet) {
    const auto keys = grid.tet_vertices(tet);
    return {grid.position(keys[0]), grid.position(keys[1]), grid.position(keys[2]), grid.position(keys[3])};
}

CellState untouched_state(const Solid& solid, const std::array<Vec3, 4>& c) {
    const auto is_inside = [&](const Vec3& p) { return solid.tree.inside_either_way(p); };
    if (solid.is_closed) return is_inside((c[0] + c[1] + c[2] + c[3]) / 4) ? CellState::inside : CellState::outside;
    const auto count = std::count_if(c.begin(), c.end(), is_inside);
    return count == 4 ? CellState::inside : count > 0 ? CellState::mixed : CellState::outside;
}

CoarseCells find_coarse_cells(const Solid& solid, const BccGrid& grid, bool is_surface_only,
                              const MeshingControl& control) {
    return Finder(solid, grid, control).find(is_surface_only);
}

} // namespace sinew::solver
