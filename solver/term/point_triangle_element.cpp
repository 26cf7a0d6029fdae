// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/point_triangle_element.h"

#include "solver/index.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

void PointTriangleElement::set(std::span<const RideTerm> ride, const CarriedSurface& target, int triangle,
                               const Numbering& numbering, const BlockPattern& pattern) {
    set_nodes(ride, target, triangle, numbering);
    if (!has_entries_) find_entries(pattern);
}

void PointTriangleElement::set_nodes(std::span<const RideTerm> ride, const CarriedSurface& target, int triangle,
                                     const Numbering& numbering) {
    const RideTerm* const first = ride.empty() ? nullptr : ride.data();
    if (triangle == triangle_ && first == ride_ && &target == target_) return;
    const Triangle& t = target.triangles()[at(triangle)];
    take_nodes({ride, target.free_ride(t[0]), target.free_ride(t[1]), target.free_ride(t[2])}, numbering);
    ride_ = first, target_ = &target, triangle_ = triangle, split_ = 1;
}

void PointTriangleElement::set(const std::array<std::span<const RideTerm>, 4>& rides, int split,
                               const Numbering& numbering, const BlockPattern& pattern) {
    triangle_ = -1, split_ = split;
    take_nodes(rides, numbering);
    find_entries(pattern);
}

void PointTriangleElement::take_nodes(const std::array<std::span<const RideTerm>, 4>& rides,
                                      const Numbering& numbering) {
    nodes_.clear(), has_entries_ = false;
    for (int c = 0; c < 4; ++c)
        for (const RideTerm& t : rides[at(c)])
            nodes_.push_back({c, t.vertex, numbering.unknown[at(t.vertex)], t.weight});
}

void PointTriangleElement::find_entries(const BlockPattern& pattern) {
    entries_.clear(), free_.clear(), has_entries_ = true;
    const auto coupled_among = [&](int first_corner, int last_corner) {
        for (const Node& row : nodes_)
            for (const Node& column : nodes_) {
                if (std::min(row.corner, column.corner) < first_corner) continue;
                if (std::max(row.corner, column.corner) > last_corner) continue;
                if (row.unknown < 0 || column.unknown < 0 || row.unknown > column.unknown) continue;
                if (pattern.find(row.unknown, column.unknown) < 0) return false;
            }
        return true;
    };
    coupled_ = coupled_among(0, 3);
    if (coupled_)
        group_ = {0, 0, 0, 0};
    else if (split_ == 1 && coupled_among(1, 3))
        group_ = {0, 1, 1, 1};
    else if (split_ == 2 && coupled_among(0, 1) && coupled_among(2, 3))
        group_ = {0, 0, 1, 1};
    else
        group_ = {0, 1, 2, 3};
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].unknown >= 0) free_.push_back({nodes_[i].corner, nodes_[i].unknown, nodes_[i].weight});
        for (std::size_t j = 0; j < nodes_.size(); ++j) {
            const Node &row = nodes_[i], &column = nodes_[j];
            if (group_[at(row.corner)] != group_[at(column.corner)]) continue;
            if (row.unknown < 0 || column.unknown < 0 || row.unknown > column.unknown) continue;
            entries_.push_back({pattern.find(row.unknown, column.unknown), static_cast<int>(i), static_cast<int>(j)});
        }
    }
}

void PointTriangleElement::add_gradient(const std::array<double, 4>& by_corners, const Vec3& g,
                                        double* by_vertices) const {
    for (const Node& n : nodes_)
        Eigen::Map<Vec3>(by_vertices + 3 * at(n.vertex)) += by_corners[at(n.corner)] * n.weight * g;
}

void PointTriangleElement::add_hessian(const PointTriangleBlocks& blocks, double factor, BlockMatrix& a) const {
    for (const Entry& e : entries_) {
        const Node &row = nodes_[at(e.row)], &column = nodes_[at(e.column)];
        const double weight = factor * row.weight * column.weight;
        const Mat3& block =
            blocks[Overlay::block_of(std::min(row.corner, column.corner), std::max(row.corner, column.corner))];
        double* to = a.block(at(e.block));
        // Row-major 3 x 3; a block of a lower corner with a higher one is the transpose of the other.
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                to[3 * r + c] += weight * (row.corner <= column.corner ? block(r, c) : block(c, r));
    }
    if (coupled_) return;
    if (group_[1] == group_[2] && group_[2] == group_[3]) {
        a.overlay.add_across(free_, {factor * blocks[1], factor * blocks[2], factor * blocks[3]});
        return;
    }
    PointTriangleBlocks across;
    std::size_t entry = 0;
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t d = c; d < 4; ++d, ++entry)
            across[entry] = group_[c] == group_[d] ? Mat3(Mat3::Zero()) : Mat3(factor * blocks[entry]);
    a.overlay.add(free_, across);
}

std::array<double, 2> PointTriangleElement::stiffness_below(const std::array<double, 4>& by_corners,
                                                            const BlockMatrix& a) const {
    std::array<double, 2> out{0, 0};
    for (const Node& n : nodes_) {
        const std::size_t side = n.corner < split_ ? 0 : 1;
        if (n.unknown < 0) continue;
        const double* diagonal = a.block(at(a.pattern->row_start[at(n.unknown)]));
        const double share = n.weight * std::abs(by_corners[at(n.corner)]);
        out[side] += share * (diagonal[0] + diagonal[4] + diagonal[8]) / 3;
    }
    return out;
}

} // namespace sinew::solver
