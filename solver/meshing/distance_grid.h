// A level set of a surface's distance on a grid that is filled in only where the level set passes.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/closest_point.h"
#include "solver/meshing/meshing_control.h"
#include "solver/meshing/soup.h"

#include <array>
#include <cstdint>

namespace sinew::solver {

/// f(x) = distance to the surface - iso: negative inside the level set, positive outside. Around a closed
/// surface the distance is negative inside, that is where the winding number exceeds one half in size. Around
/// an open one it is positive everywhere, and cavities that cannot be reached from outside are filled.
/// Samples are exact distances to the triangles (single precision in store) on the corners of cubic cells,
/// linear in each direction between; the cells come in blocks, and only blocks near the level set have
/// samples.
struct DistanceGrid {
    static constexpr int cells = 8;           ///< of a block, along each side
    static constexpr int samples = cells + 1; ///< of a block, along each side; neighbours repeat them
    static constexpr int all_outside = -1, all_inside = -2;

    Vec3 origin = Vec3::Zero();  ///< position of the first sample
    double step = 1;             ///< side of a cell
    std::array<int, 3> blocks{}; ///< along x, y, z
    std::vector<int> slot;       ///< of each block (x fastest): place of its samples, or all_outside, all_inside
    std::vector<std::array<int, 3>> filled; ///< the blocks with samples, in the order of `slot`
    std::vector<float> values;              ///< samples^3 numbers a filled block, x fastest; never zero

    static std::size_t sample(int i, int j, int k) { return static_cast<std::size_t>((k * samples + j) * samples + i); }
    float at(int place, int i, int j, int k) const {
        return values[static_cast<std::size_t>(place) * (samples * samples * samples) + sample(i, j, k)];
    }
    int& slot_of(const std::array<int, 3>& b) { return slot[static_cast<std::size_t>(number(b))]; }
    int slot_of(const std::array<int, 3>& b) const { return slot[static_cast<std::size_t>(number(b))]; }
    std::int64_t number(const std::array<int, 3>& b) const {
        return (std::int64_t{b[2]} * blocks[1] + b[1]) * blocks[0] + b[0];
    }
    bool holds(const std::array<int, 3>& b) const {
        return b[0] >= 0 && b[1] >= 0 && b[2] >= 0 && b[0] < blocks[0] && b[1] < blocks[1] && b[2] < blocks[2];
    }
    /// Position of sample (i, j, k) counted over the whole grid.
    Vec3 position(int i, int j, int k) const { return origin + step * Vec3(i, j, k); }
    /// f at any point; outside the grid and in blocks without samples only its sign is right.
    double value(const Vec3& p) const;
};

/// Grid with `resolution` cells along the longest side of the box that holds the level set, two cells of
/// space around. Results do not depend on the number of threads. An iso value below zero is measured from the
/// outside of overlapping parts (pieces of the surface that lie inside other parts do not count).
/// \param soup  closed, if iso <= 0
/// Throws Stopped; Error FE232 (the grid needs too much memory).
DistanceGrid make_distance_grid(const Soup& soup, double iso, int resolution, const MeshingControl& control);

} // namespace sinew::solver
