// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/contact/contact_element.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Place of a pair of corners among the ten blocks, for i <= j.
std::size_t block_of(int i, int j) { return at(4 * i - i * (i - 1) / 2 + (j - i)); }

} // namespace

void ContactElement::set(const CollisionBody& source, int point, const CollisionBody& target, int triangle,
                         const Numbering& numbering, const BlockPattern& pattern) {
    if (point == point_ && triangle == triangle_) return;
    point_ = point, triangle_ = triangle;
    nodes_.clear(), entries_.clear();
    const auto add = [&](const CollisionBody& body, int p, int corner) {
        if (!body.deforms()) return;
        for (const RideTerm& t : body.ride(p))
            nodes_.push_back({corner, t.vertex, numbering.unknown[at(t.vertex)], t.weight});
    };
    add(source, point, 0);
    for (int c = 0; c < 3; ++c) add(target, target.triangles()[at(triangle)][at(c)], c + 1);
    coupled_ = true;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
        for (std::size_t j = 0; j < nodes_.size(); ++j) {
            const Node &row = nodes_[i], &column = nodes_[j];
            if (row.unknown < 0 || column.unknown < 0 || row.unknown > column.unknown) continue;
            const int block = pattern.find(row.unknown, column.unknown);
            if (block < 0)
                coupled_ = false;
            else
                entries_.push_back({block, static_cast<int>(i), static_cast<int>(j)});
        }
}

void ContactElement::add_gradient(const std::array<double, 4>& by_corners, const Vec3& g, double* by_vertices) const {
    for (const Node& n : nodes_)
        Eigen::Map<Vec3>(by_vertices + 3 * at(n.vertex)) += by_corners[at(n.corner)] * n.weight * g;
}

void ContactElement::add_hessian(const ContactBlocks& blocks, double factor, BlockMatrix& a) const {
    for (const Entry& e : entries_) {
        const Node &row = nodes_[at(e.row)], &column = nodes_[at(e.column)];
        const bool across = (row.corner == 0) != (column.corner == 0);
        if (!coupled_ && across) continue;
        const double weight = (coupled_ ? factor : 2 * factor) * row.weight * column.weight;
        const Mat3& block = blocks[block_of(std::min(row.corner, column.corner), std::max(row.corner, column.corner))];
        double* to = a.block(at(e.block));
        // Row-major 3 x 3; a block of a lower corner with a higher one is the transpose of the other.
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                to[3 * r + c] += weight * (row.corner <= column.corner ? block(r, c) : block(c, r));
    }
}

} // namespace sinew::solver
