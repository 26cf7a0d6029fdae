// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/quadratic_tets.h"

#include <algorithm>
#include <limits>

namespace sinew::solver {

namespace {

/// Barycentric coordinates of a place in a tet that is the same for all: a usual integration point, or a corner.
struct Place {
    double near, far; ///< at its own corner, at the others
    int own;
    double coordinate(int corner) const { return corner == own ? near : far; }
};
/// … and of a place that each tet of a batch has to itself.
struct OwnPlace {
    const double (*b)[lanes]; ///< by corner
    Pack coordinate(int corner) const { return Pack::load(b[corner]); }
};

/// Where a batch is integrated.
struct UsualPoints {
    Place operator()(int point) const { return {usual_coordinate(true), usual_coordinate(false), point}; }
};
struct OwnPoints {
    const PointPlaces& places;
    OwnPlace operator()(int point) const { return {places.coordinate[point]}; }
};
/// Calls work with the one or the other.
template <class Work>
void with_points(const EdgeBatch& edges, const Work& work) {
    if (edges.places)
        work(OwnPoints{*edges.places});
    else
        work(UsualPoints{});
}

/// d (corner m of the place's linear tet) / d node: up to two corners a node. `W`: a number, or one for each tet.
template <class W>
struct NodeWeights {
    int count, corner[2];
    W weight[2];
};
template <class AnyPlace>
auto node_weights(const AnyPlace& place, int node) {
    using W = decltype(place.coordinate(0));
    if (node < 4) return NodeWeights<W>{1, {node, 0}, {4 * place.coordinate(node) - 1, 0}};
    const int i = tet_edge_corners[node - 4][0], j = tet_edge_corners[node - 4][1];
    return NodeWeights<W>{2, {i, j}, {4 * place.coordinate(j), 4 * place.coordinate(i)}};
}

struct Nodes {
    Pack x[quadratic_nodes][3];
};

Nodes nodes_of(const TetBatch& batch, const EdgeBatch& edges, const double* x) {
    Nodes out;
    for (int n = 0; n < quadratic_nodes; ++n)
        for (std::size_t c = 0; c < 3; ++c) {
            const int* vertex = n < 4 ? batch.vertex[n] : edges.vertex[n - 4];
            double p[lanes];
            for (int l = 0; l < lanes; ++l) p[l] = x[3 * static_cast<std::size_t>(vertex[l]) + c];
            out.x[n][c] = Pack::load(p);
        }
    return out;
}

template <class AnyPlace>
Corners corners_at(const AnyPlace& place, const Nodes& nodes) {
    Corners out;
    for (auto& corner : out.y)
        for (Pack& c : corner) c = Pack(0.0);
    for (int n = 0; n < quadratic_nodes; ++n) {
        const auto w = node_weights(place, n);
        for (int k = 0; k < w.count; ++k)
            for (int c = 0; c < 3; ++c) out.y[w.corner[k]][c] += Pack(w.weight[k]) * nodes.x[n][c];
    }
    return out;
}

/// Means over the tet and, if wanted, their gradients by the nodes.
struct Means {
    Pack measure{0.0}, j{0.0}, d_measure[quadratic_nodes][3], d_j[quadratic_nodes][3];
    Pressures pressures(const TetModuli& m) const {
        return {Pack::load(m.lambda_mean) * measure, Pack::load(m.volume) * (j - Pack(1.0))};
    }
    Pack energy(const TetModuli& m) const {
        const Pack d = j - Pack(1.0);
        return Pack(0.5) * (Pack::load(m.lambda_mean) * measure * measure + Pack::load(m.volume) * d * d);
    }
};

template <class AnyPoints>
Means means_of(const PointInputs& in, const AnyPoints& points, const Nodes& nodes, bool gradients) {
    Means out;
    if (gradients)
        for (int n = 0; n < quadratic_nodes; ++n)
            for (int c = 0; c < 3; ++c) out.d_measure[n][c] = out.d_j[n][c] = Pack(0.0);
    const bool with_measure = !needs_direction(in.law);
    for (int point = 0; point < quadratic_points; ++point) {
        PointMeasures m;
        m.measure = Pack(0.0);
        point_measures(in.law, in.batch, corners_at(points(point), nodes), with_measure, m);
        out.measure += Pack(0.25) * m.measure;
        out.j += Pack(0.25) * m.j;
        if (!gradients) continue;
        for (int n = 0; n < quadratic_nodes; ++n) {
            const auto w = node_weights(points(point), n);
            for (int k = 0; k < w.count; ++k)
                for (int c = 0; c < 3; ++c) {
                    const Pack weight(0.25 * w.weight[k]);
                    if (with_measure) out.d_measure[n][c] += weight * m.d_measure[w.corner[k]][c];
                    out.d_j[n][c] += weight * m.d_j[w.corner[k]][c];
                }
        }
    }
    return out;
}

/// Stiffness of the springs that keep edges straight [N/m].
Pack straightness(const PointInputs& in, const EdgeBatch& edges) {
    const Pack mu = Pack::load(in.moduli.mu), lambda = Pack::load(in.moduli.lambda), twice = mu + mu;
    return (twice + select(lambda < twice, lambda, twice)) * Pack::load(edges.places->straightness);
}

/// Adds their gradient and returns their energy.
Pack add_straightness(const PointInputs& in, const EdgeBatch& edges, const Nodes& nodes, Pack g[quadratic_nodes][3]) {
    const Pack k = straightness(in, edges);
    Pack squares(0.0);
    for (int e = 0; e < 6; ++e) {
        const int i = tet_edge_corners[e][0], j = tet_edge_corners[e][1];
        for (int c = 0; c < 3; ++c) {
            const Pack d = nodes.x[4 + e][c] - Pack(0.5) * (nodes.x[i][c] + nodes.x[j][c]);
            squares += d * d;
            const Pack force = k * d;
            g[4 + e][c] += force;
            g[i][c] -= Pack(0.5) * force;
            g[j][c] -= Pack(0.5) * force;
        }
    }
    return Pack(0.5) * k * squares;
}

void add_straightness(const PointInputs& in, const EdgeBatch& edges, Pack h[quadratic_pairs][9]) {
    const Pack k = straightness(in, edges);
    const auto add = [&](int a, int b, double factor) {
        if (a > b) std::swap(a, b);
        const int pair = a * quadratic_nodes - a * (a - 1) / 2 + b - a;
        for (int c = 0; c < 3; ++c) h[pair][4 * c] += Pack(factor) * k;
    };
    for (int e = 0; e < 6; ++e) {
        const int i = tet_edge_corners[e][0], j = tet_edge_corners[e][1];
        add(4 + e, 4 + e, 1), add(i, 4 + e, -0.5), add(j, 4 + e, -0.5);
        add(i, i, 0.25), add(j, j, 0.25), add(i, j, 0.25);
    }
}

template <class AnyPoints>
void reference_strain_at(const AnyPoints& points, const TetBatch& batch, const EdgeBatch& edges,
                         const StrainReference& reference, double* out) {
    const auto nodes = [&](const std::vector<double>* x) { return x ? nodes_of(batch, edges, x->data()) : Nodes{}; };
    const Nodes x = nodes(reference.x), between = nodes(reference.x_between), v = nodes(reference.v);
    for (int point = 0; point < quadratic_points; ++point) {
        const auto place = points(point);
        reference_strain(batch, reference, corners_at(place, x), corners_at(place, between), corners_at(place, v),
                         out + point * strain_size);
    }
}

template <class AnyPoints>
void gradient_at(const AnyPoints& points, const PointInputs& in, const EdgeBatch& edges, bool means, const double* x,
                 double* g, ElementSummary& summary) {
    const Nodes nodes = nodes_of(in.batch, edges, x);
    PointInputs at_point = in;
    at_point.share = 0.25;
    Pressures pressures;
    Pack energy(0.0), least_j(0.0), squares(0.0);
    if (means) {
        const Means m = means_of(in, points, nodes, false);
        pressures = m.pressures(in.moduli);
        at_point.pressures = &pressures;
        energy = Pack::load(in.batch.volume) * m.energy(in.moduli);
    }
    Pack sum[quadratic_nodes][3];
    for (auto& node : sum)
        for (Pack& c : node) c = Pack(0.0);
    for (int point = 0; point < quadratic_points; ++point) {
        double force[4 * 3 * lanes];
        if (in.viscosity > 0) at_point.reference_strain = in.reference_strain + point * strain_size;
        ElementSummary s;
        point_gradient(at_point, corners_at(points(point), nodes), force, s);
        energy += Pack::load(s.energy);
        squares += Pack::load(s.fiber_squares);
        const Pack j = Pack::load(s.j);
        least_j = point == 0 ? j : select(j < least_j, j, least_j);
        for (int n = 0; n < quadratic_nodes; ++n) {
            const auto w = node_weights(points(point), n);
            for (int k = 0; k < w.count; ++k)
                for (int c = 0; c < 3; ++c)
                    sum[n][c] += Pack(w.weight[k]) * Pack::load(force + (3 * w.corner[k] + c) * lanes);
        }
    }
    if (edges.places) energy += add_straightness(in, edges, nodes, sum);
    for (int n = 0; n < quadratic_nodes; ++n)
        for (int c = 0; c < 3; ++c) sum[n][c].store(g + (3 * n + c) * lanes);
    energy.store(summary.energy);
    least_j.store(summary.j);
    squares.store(summary.fiber_squares);
}

template <class AnyPoints>
void hessian_at(const AnyPoints& points, const PointInputs& in, const EdgeBatch& edges, bool means, const double* x,
                bool project, double* h) {
    const Nodes nodes = nodes_of(in.batch, edges, x);
    PointInputs at_point = in;
    at_point.share = 0.25;
    Pressures pressures;
    Pack sum[quadratic_pairs][9];
    for (auto& block : sum)
        for (Pack& entry : block) entry = Pack(0.0);
    if (means) {
        const Means m = means_of(in, points, nodes, true);
        pressures = m.pressures(in.moduli);
        at_point.pressures = &pressures;
        const Pack volume = Pack::load(in.batch.volume);
        const Pack by_measure = volume * Pack::load(in.moduli.lambda_mean),
                   by_j = volume * Pack::load(in.moduli.volume);
        int pair = 0;
        for (int a = 0; a < quadratic_nodes; ++a)
            for (int b = a; b < quadratic_nodes; ++b, ++pair)
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c)
                        sum[pair][3 * r + c] +=
                            by_measure * m.d_measure[a][r] * m.d_measure[b][c] + by_j * m.d_j[a][r] * m.d_j[b][c];
    }
    constexpr int block_at[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};
    for (int point = 0; point < quadratic_points; ++point) {
        alignas(64) double blocks[10 * 9 * lanes];
        if (in.viscosity > 0) at_point.reference_strain = in.reference_strain + point * strain_size;
        point_hessian(at_point, corners_at(points(point), nodes), project, blocks);
        decltype(node_weights(points(point), 0)) weights[quadratic_nodes];
        for (int n = 0; n < quadratic_nodes; ++n) weights[n] = node_weights(points(point), n);
        int pair = 0;
        for (int a = 0; a < quadratic_nodes; ++a)
            for (int b = a; b < quadratic_nodes; ++b, ++pair)
                for (int k = 0; k < weights[a].count; ++k)
                    for (int l = 0; l < weights[b].count; ++l) {
                        const int m = weights[a].corner[k], n = weights[b].corner[l];
                        const Pack w(weights[a].weight[k] * weights[b].weight[l]);
                        const double* block = blocks + block_at[m][n] * 9 * lanes;
                        if (m <= n)
                            for (int e = 0; e < 9; ++e) sum[pair][e] += w * Pack::load(block + e * lanes);
                        else
                            for (int e = 0; e < 9; ++e)
                                sum[pair][e] += w * Pack::load(block + (e % 3 * 3 + e / 3) * lanes);
                    }
    }
    if (edges.places) add_straightness(in, edges, sum);
    for (int pair = 0; pair < quadratic_pairs; ++pair)
        for (int e = 0; e < 9; ++e) sum[pair][e].store(h + (9 * pair + e) * lanes);
}

} // namespace

std::vector<std::array<int, 6>> edge_vertices(const std::vector<Tet>& tets,
                                              const std::vector<std::array<int, 2>>& edges, int first) {
    std::vector<std::array<int, 6>> out(tets.size());
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (std::size_t e = 0; e < 6; ++e) {
            const auto [a, b] = std::minmax(tets[t][static_cast<std::size_t>(tet_edge_corners[e][0])],
                                            tets[t][static_cast<std::size_t>(tet_edge_corners[e][1])]);
            const auto at = std::lower_bound(edges.begin(), edges.end(), std::array<int, 2>{a, b});
            out[t][e] = first + static_cast<int>(at - edges.begin());
        }
    return out;
}

void quadratic_shape(const double* b, double* values) {
    for (int i = 0; i < 4; ++i) values[i] = b[i] * (2 * b[i] - 1);
    for (int e = 0; e < 6; ++e) values[4 + e] = 4 * b[tet_edge_corners[e][0]] * b[tet_edge_corners[e][1]];
}

void quadratic_reference_strain(const TetBatch& batch, const EdgeBatch& edges, const StrainReference& reference,
                                double* out) {
    with_points(edges, [&](const auto& points) { reference_strain_at(points, batch, edges, reference, out); });
}

void quadratic_gradient(const PointInputs& in, const EdgeBatch& edges, bool means, const double* x, double* g,
                        ElementSummary& summary) {
    with_points(edges, [&](const auto& points) { gradient_at(points, in, edges, means, x, g, summary); });
}

void quadratic_hessian(const PointInputs& in, const EdgeBatch& edges, bool means, const double* x, bool project,
                       double* h) {
    with_points(edges, [&](const auto& points) { hessian_at(points, in, edges, means, x, project, h); });
}

void quadratic_least_j(const TetBatch& batch, const EdgeBatch& edges, const double* x, double* least) {
    const Nodes nodes = nodes_of(batch, edges, x);
    Pack out(std::numeric_limits<double>::infinity());
    const auto take = [&](const auto& place, const bool* left_out) {
        PointMeasures m;
        point_measures(ElasticLaw::anisotropic, batch, corners_at(place, nodes), false, m);
        for (int l = 0; l < lanes; ++l)
            if (!left_out || !left_out[l]) out.v[l] = m.j[l] < out.v[l] || !(m.j[l] == m.j[l]) ? m.j[l] : out.v[l];
    };
    for (int point = 0; point < 4; ++point) {
        take(Place{1, 0, point}, edges.places ? edges.places->outside[point] : nullptr);
        if (edges.places)
            take(OwnPlace{edges.places->coordinate[point]}, nullptr);
        else
            take(UsualPoints{}(point), nullptr);
    }
    out.store(least);
}

} // namespace sinew::solver
