// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/field/points.h"

#include "solver/parallel.h"
#include "solver/sort_into.h"

#include <algorithm>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 256;

/// Nodes of each pair (a, b), a <= b, of a quadratic tet.
constexpr auto node_pairs = [] {
    std::array<std::array<int, 2>, quadratic_pairs> out{};
    std::size_t pair = 0;
    for (int a = 0; a < quadratic_nodes; ++a)
        for (int b = a; b < quadratic_nodes; ++b) out[pair++] = {a, b};
    return out;
}();

} // namespace

VolumePoints::VolumePoints(const Scene& scene, const std::vector<int>& bodies)
    : system_(scene.system()) {
    Shapes whole;
    for (int q = 0; q < quadratic_points; ++q) {
        double at[4];
        for (int c = 0; c < 4; ++c) at[c] = usual_coordinate(c == q);
        quadratic_shape(at, whole[static_cast<std::size_t>(q)].data());
    }
    shapes_ = {whole};
    // Quadratic ones first: their points then stand four by four.
    for (const ElementKind kind : {ElementKind::quadratic, ElementKind::linear})
        for (const TissueBatches& t : system_.tissues)
            if (t.kind == kind && std::find(bodies.begin(), bodies.end(), t.body) != bodies.end()) add(t);
    const std::vector<Deformable>& all = system_.numbering.deformables;
    for (std::size_t d = 0; d < all.size(); ++d) {
        if (!all[d].is_sheet || std::find(bodies.begin(), bodies.end(), all[d].body) == bodies.end()) continue;
        bodies_.push_back({nullptr, all[d].body, d, count(), all[d].vertex_count});
        tet_start_.emplace_back(), tets_.emplace_back();
    }
}

void VolumePoints::add(const TissueBatches& t) {
    const Deformable& d = system_.numbering.deformables[t.deformable];
    const bool quadratic = t.kind == ElementKind::quadratic;
    const OfBody body{&t, t.body, t.deformable, count(), quadratic ? quadratic_points * t.tet_count : d.vertex_count};
    bodies_.push_back(body);
    tet_start_.emplace_back(), tets_.emplace_back();
    if (!quadratic) return;
    std::size_t next = 0; // of the cut tets
    for (std::size_t tet = 0; tet < t.tet_count; ++tet) {
        const bool is_cut = next < t.cut.tets.size() && t.cut.tets[next] == static_cast<int>(tet);
        shapes_of_.push_back(is_cut ? static_cast<int>(shapes_.size()) : 0);
        if (!is_cut) continue;
        Shapes& own = shapes_.emplace_back();
        for (std::size_t q = 0; q < quadratic_points; ++q)
            quadratic_shape(t.cut.points[next].point[q].data(), own[q].data());
        ++next;
    }
    sort_into(d.vertex_count, tet_start_.back(), tets_.back(), [&](const auto& visit) {
        for (std::size_t tet = 0; tet < t.tet_count; ++tet)
            for (int n = 0; n < quadratic_nodes; ++n)
                visit(static_cast<std::size_t>(vertex(body, tet, n)) - d.first_vertex,
                      static_cast<int>(tet) * quadratic_nodes + n);
    });
}

void VolumePoints::add_couplings(Couplings& couplings) const {
    for (const OfBody& b : bodies_)
        for (std::size_t tet = 0; is_quadratic(b) && tet < b.tissue->tet_count; ++tet)
            for (const auto& [m, n] : node_pairs) couplings.emplace_back(vertex(b, tet, m), vertex(b, tet, n));
}

void VolumePoints::bind(const BlockPattern& pattern) {
    pattern_ = &pattern;
    const bool any = std::any_of(bodies_.begin(), bodies_.end(), [&](const OfBody& b) { return is_quadratic(b); });
    if (!any) return;
    const auto row = [&](int v) { return system_.numbering.unknown[static_cast<std::size_t>(v)]; };
    sort_into(pattern.block_count(), pair_start_, pairs_, [&](const auto& visit) {
        for (const OfBody& b : bodies_)
            for (std::size_t tet = 0; is_quadratic(b) && tet < b.tissue->tet_count; ++tet)
                for (std::size_t pair = 0; pair < quadratic_pairs; ++pair) {
                    const int i = row(vertex(b, tet, node_pairs[pair][0]));
                    const int j = row(vertex(b, tet, node_pairs[pair][1]));
                    if (i < 0 || j < 0) continue;
                    const std::size_t first = b.first + quadratic_points * tet;
                    visit(static_cast<std::size_t>(pattern.find(std::min(i, j), std::max(i, j))),
                          static_cast<int>(first / quadratic_points * quadratic_pairs + pair));
                }
    });
}

void VolumePoints::share_out(const std::vector<double>& of_tet, std::vector<double>& of_point) {
    of_point.resize(count());
    const bool lumps =
        std::any_of(bodies_.begin(), bodies_.end(), [&](const OfBody& b) { return b.tissue && !is_quadratic(b); });
    if (lumps) {
        lumped_.start(system_.numbering, *pattern_);
        lumped_.add_tets(system_, of_tet);
    }
    for (const OfBody& b : bodies_)
        if (is_quadratic(b)) {
            for (std::size_t i = 0; i < b.count; ++i)
                of_point[b.first + i] = b.tissue->cut.mass_factor / quadratic_points *
                                        of_tet[b.tissue->first_batch * lanes + i / quadratic_points];
        } else if (b.tissue) {
            const auto from = lumped_.weight().begin() +
                              static_cast<std::ptrdiff_t>(system_.numbering.deformables[b.deformable].first_vertex);
            std::copy_n(from, b.count, of_point.begin() + static_cast<std::ptrdiff_t>(b.first));
        }
}

Vec3 VolumePoints::carried(std::size_t point, const std::vector<double>& of_vertices) const {
    std::size_t k = 0;
    while (point >= bodies_[k].first + bodies_[k].count) ++k;
    const OfBody& b = bodies_[k];
    const std::size_t i = point - b.first;
    const auto at = [&](std::size_t v) {
        return Vec3(of_vertices[3 * v], of_vertices[3 * v + 1], of_vertices[3 * v + 2]);
    };
    if (!is_quadratic(b)) return at(system_.numbering.deformables[b.deformable].first_vertex + i);
    Vec3 sum = Vec3::Zero();
    const auto& shape = shapes(point / quadratic_points)[i % quadratic_points];
    for (int n = 0; n < quadratic_nodes; ++n)
        sum += shape[static_cast<std::size_t>(n)] * at(static_cast<std::size_t>(vertex(b, i / quadratic_points, n)));
    return sum;
}

void VolumePoints::add_to_vertices(const std::vector<Vec3>& at_points, std::vector<double>& at_vertices) const {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
        const OfBody& b = bodies_[k];
        const Deformable& d = system_.numbering.deformables[b.deformable];
        parallel_for(d.vertex_count, grain, [&](std::size_t i) {
            Vec3 sum = Vec3::Zero();
            if (!is_quadratic(b)) {
                sum = at_points[b.first + i];
            } else {
                for (int e = tet_start_[k][i]; e < tet_start_[k][i + 1]; ++e) {
                    const std::size_t code = static_cast<std::size_t>(tets_[k][static_cast<std::size_t>(e)]);
                    const std::size_t first = b.first + code / quadratic_nodes * quadratic_points;
                    const Shapes& shape = shapes(first / quadratic_points);
                    for (std::size_t q = 0; q < quadratic_points; ++q)
                        sum += shape[q][code % quadratic_nodes] * at_points[first + q];
                }
            }
            for (std::size_t c = 0; c < 3; ++c)
                at_vertices[3 * (d.first_vertex + i) + c] += sum[static_cast<Eigen::Index>(c)];
        });
    }
}

void VolumePoints::add_to_hessian(const std::vector<Mat3>& at_points, BlockMatrix& a) const {
    const auto add = [&](std::size_t block, const Mat3& m) {
        for (int c = 0; c < 9; ++c) a.block(block)[c] += m(c / 3, c % 3);
    };
    for (const OfBody& b : bodies_) {
        if (is_quadratic(b)) continue;
        const Deformable& d = system_.numbering.deformables[b.deformable];
        parallel_for(d.unknown_count, grain, [&](std::size_t i) {
            const std::size_t u = d.first_unknown + i;
            const std::size_t v = static_cast<std::size_t>(system_.numbering.vertex_of_unknown[u]) - d.first_vertex;
            add(static_cast<std::size_t>(pattern_->row_start[u]), at_points[b.first + v]);
        });
    }
    if (pairs_.empty()) return;
    parallel_for(pattern_->block_count(), grain, [&](std::size_t block) {
        if (pair_start_[block] == pair_start_[block + 1]) return;
        Mat3 sum = Mat3::Zero();
        for (int e = pair_start_[block]; e < pair_start_[block + 1]; ++e) {
            const std::size_t code = static_cast<std::size_t>(pairs_[static_cast<std::size_t>(e)]);
            const auto& nodes = node_pairs[code % quadratic_pairs];
            const std::size_t m = static_cast<std::size_t>(nodes[0]), n = static_cast<std::size_t>(nodes[1]);
            const Shapes& shape = shapes(code / quadratic_pairs);
            const std::size_t first = code / quadratic_pairs * quadratic_points;
            for (std::size_t q = 0; q < quadratic_points; ++q)
                sum += (shape[q][m] * shape[q][n]) * at_points[first + q];
        }
        add(block, sum);
    });
}

} // namespace sinew::solver
