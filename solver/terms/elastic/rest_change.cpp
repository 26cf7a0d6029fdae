// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/rest_change.h"

#include "solver/error.h"
#include "solver/material/viscosity.h"
#include "solver/parallel.h"
#include "solver/terms/elastic/layer_mix.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace sinew::solver {

namespace {

constexpr std::size_t batch_grain = 32;
/// Lengths at rest grow or shrink by no more than this.
constexpr double most_change = 1e3;

template <class Part>
bool part_scales(const Part& in) {
    return in.rest_scale_envelope != 0 &&
           std::any_of(in.layers.begin(), in.layers.end(), [](const MaterialValues& m) { return m.rest_scale != 1; });
}
bool scales(const TissueInputs& in) {
    return part_scales(in) || std::any_of(in.subtissues.begin(), in.subtissues.end(), part_scales<SubtissueInputs>);
}
bool grows(const TissueInputs& in) {
    return std::any_of(in.fibers.begin(), in.fibers.end(),
                       [](const FiberValues& f) { return f.growth != 1 && f.envelope != 0; });
}

std::string text(double value) {
    char out[32];
    std::snprintf(out, sizeof out, "%.6g", value);
    return out;
}

/// s^e of a tet; of one that several parts share the mean of theirs by their shares, which is geometric as growth is.
double rest_scale(const TissueRest& rest, const TissueInputs& in, std::size_t tet) {
    const auto of = [&](const std::vector<MaterialValues>& layers, const std::vector<std::vector<double>>& weights,
                        double exponent) { return std::pow(mix_layers(layers, weights, tet).rest_scale, exponent); };
    const double own = own_share(rest, tet);
    double scale = 1;
    if (own > 0) scale = of(in.layers, rest.layer_weights, own * in.rest_scale_envelope);
    for (std::size_t i = 0; i < rest.subtissues.size(); ++i)
        if (const double share = rest.subtissues[i].shares[tet]; share > 0)
            scale *= of(in.subtissues[i].layers, rest.subtissues[i].layer_weights,
                        share * in.subtissues[i].rest_scale_envelope);
    return scale;
}

[[noreturn]] void refuse(const std::string& what) {
    throw Error("FE247", what,
                "lengths at rest may become " + text(most_change) + " times smaller to " + text(most_change) +
                    " times larger");
}

/// log of s^e, or of g^w where both act fully.
double checked_log(double scale, double exponent, const char* what) {
    if (!(scale > 0) || !std::isfinite(scale))
        refuse("the " + std::string(what) + " is " + text(scale) + "; it must be above 0");
    return exponent * std::log(scale);
}

/// The direction in which a line of the flesh runs that ran along `a`; zero where there is none.
Vec3 along(const Mat3& stretch, const Vec3& a) { return (stretch * a).stableNormalized(); }

} // namespace

bool changes_rest(const TissueInputs& in) { return scales(in) || grows(in); }

bool same_rest_change(const TissueInputs& a, const TissueInputs& b) {
    if (scales(a) != scales(b) || grows(a) != grows(b)) return false;
    const auto same_layer = [](const MaterialValues& m, const MaterialValues& n) {
        return m.rest_scale == n.rest_scale && m.envelope == n.envelope;
    };
    const auto same_fiber = [](const FiberValues& f, const FiberValues& g) {
        return f.growth == g.growth && (f.growth == 1 || f.envelope == g.envelope);
    };
    const auto same_part = [&](const auto& p, const auto& q) {
        return p.rest_scale_envelope == q.rest_scale_envelope &&
               std::equal(p.layers.begin(), p.layers.end(), q.layers.begin(), q.layers.end(), same_layer);
    };
    return (!scales(a) || (same_part(a, b) && std::equal(a.subtissues.begin(), a.subtissues.end(), b.subtissues.begin(),
                                                         b.subtissues.end(), same_part))) &&
           (!grows(a) || std::equal(a.fibers.begin(), a.fibers.end(), b.fibers.begin(), b.fibers.end(), same_fiber));
}

Mat3 rest_change(const TissueRest& rest, const TissueInputs& in, std::size_t tet, const RestShapes& shapes) {
    Mat3 g = Mat3::Identity();
    const Mat3 stretch = shapes.act() ? shapes.stretch(tet) : Mat3::Identity();
    if (shapes.act()) g = stretch;
    if (scales(in)) g *= rest_scale(rest, in, tet);
    for (std::size_t k = 0; k < in.fibers.size(); ++k) {
        const FiberValues& f = in.fibers[k];
        const Vec3 a = shapes.act() ? along(stretch, rest.fibers[k].directions[tet]) : rest.fibers[k].directions[tet];
        const double weight = f.envelope * rest.fibers[k].weights[tet];
        if (f.growth == 1 || weight == 0 || a.squaredNorm() == 0) continue;
        const double across = std::pow(f.growth, weight);
        g = (across * Mat3::Identity() + (1 - across) * a * a.transpose()) * g;
    }
    return g;
}

void check_rest_scale(const TissueInputs& in) {
    const auto check = [](const auto& part) {
        for (const MaterialValues& m : part.layers) {
            const double log = checked_log(m.rest_scale, part.rest_scale_envelope, "restScale of a material");
            if (!(std::abs(log) <= std::log(most_change)))
                refuse("a restScale of " + text(m.rest_scale) + " to the power of a restScaleEnvelope of " +
                       text(part.rest_scale_envelope) + " scales the tissue at rest by " + text(std::exp(log)));
        }
    };
    check(in);
    for (const SubtissueInputs& part : in.subtissues) check(part);
}

void check_growth(const TissueInputs& in) {
    double sum = 0;
    for (const FiberValues& f : in.fibers)
        sum += std::abs(checked_log(f.growth, f.envelope, "muscleGrowthScale of a fibre"));
    if (!(sum <= std::log(most_change)))
        refuse("the muscleGrowthScale of all fibres together is up to " + text(std::exp(sum)) +
               " or its reciprocal across them");
}

ChangedRest::ChangedRest(const Scene::System& system, const TissueBatches& batches)
    : system_(system)
    , batches_(batches)
    , change_(batches.batch_count)
    , inverse_(batches.batch_count) {
    const auto part = [&](const auto& all, std::size_t first) {
        const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
        return std::vector(begin, begin + static_cast<std::ptrdiff_t>(batches.batch_count));
    };
    tets_ = part(system.batches, batches.first_batch);
    if (batches.kind != ElementKind::quadratic) return;
    edges_ = part(system.edge_batches, batches.first_edge_batch);
    places_.resize(edges_.size());
    for (std::size_t i = 0; i < edges_.size(); ++i)
        if (edges_[i].places) edges_[i].places = places_[i] = std::make_shared<PointPlaces>(*edges_[i].places);
}

void ChangedRest::set(const TissueRest& rest, const TissueInputs& in, const RestShapes& shapes) {
    fibers_.clear(), stiff_.clear();
    if (shapes.act()) fibers_ = batches_.fibers, stiff_ = batches_.anisotropy;
    parallel_for(batches_.batch_count, batch_grain, [&](std::size_t i) {
        const TetBatch& model = system_.batches[batches_.first_batch + i];
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const std::size_t tet = std::min(i * lanes + lane, batches_.tet_count - 1);
            const Mat3 g = rest_change(rest, in, tet, shapes);
            if (shapes.act()) turn_directions(shapes.stretch(tet), i, lane);
            const Mat3 inverse = g.inverse();
            Mat3 shape;
            for (int k = 0; k < 9; ++k) shape(k / 3, k % 3) = model.shape[k][lane];
            const Mat3 changed = shape * inverse;
            for (int k = 0; k < 9; ++k) {
                tets_[i].shape[k][lane] = changed(k / 3, k % 3);
                change_[i].m[k][lane] = g(k / 3, k % 3);
                inverse_[i].m[k][lane] = inverse(k / 3, k % 3);
            }
            tets_[i].volume[lane] = model.volume[lane] * g.determinant();
            if (places_.empty() || !places_[i]) continue;
            // Springs that hold edges straight go by volume over squared length.
            const Mat3 edges = shape.inverse(), grown = g * edges;
            const auto squares = [](const Mat3& e) {
                return e.squaredNorm() + (e.col(0) - e.col(1)).squaredNorm() + (e.col(0) - e.col(2)).squaredNorm() +
                       (e.col(1) - e.col(2)).squaredNorm();
            };
            places_[i]->straightness[lane] =
                system_.edge_batches[batches_.first_edge_batch + i].places->straightness[lane] * g.determinant() *
                squares(edges) / squares(grown);
        }
    });
}

void ChangedRest::turn_directions(const Mat3& stretch, std::size_t i, std::size_t lane) {
    const auto turn = [&](double(&direction)[3][lanes]) {
        const Vec3 turned = along(stretch, {direction[0][lane], direction[1][lane], direction[2][lane]});
        for (int c = 0; c < 3; ++c) direction[c][lane] = turned[c];
    };
    for (auto& field : fibers_) turn(field[i].direction);
    if (!stiff_.empty()) turn(stiff_[i].direction);
}

void ChangedRest::pull(const Matrices& matrices, double* strains) const {
    Pack m[9];
    for (int k = 0; k < 9; ++k) m[k] = Pack::load(matrices.m[k]);
    for (int point = 0; point < batches_.points(); ++point) {
        double* listed = strains + point * strain_size;
        Pack e[9], em[9];
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            e[4 * i] = Pack::load(listed + i * lanes);
            e[3 * j + k] = e[3 * k + j] = Pack::load(listed + (3 + i) * lanes);
        }
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                em[3 * i + j] = e[3 * i] * m[j] + e[3 * i + 1] * m[3 + j] + e[3 * i + 2] * m[6 + j];
        for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j) e[3 * i + j] = m[i] * em[j] + m[3 + i] * em[3 + j] + m[6 + i] * em[6 + j];
        for (int i = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j) e[3 * j + i] = e[3 * i + j];
        Pack out[6];
        list_strain(e, out);
        for (int i = 0; i < 6; ++i) out[i].store(listed + i * lanes);
    }
}

} // namespace sinew::solver
