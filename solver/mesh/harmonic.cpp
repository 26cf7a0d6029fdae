// Smooth extension of painted surface values into the volume.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/harmonic.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/linear/scalar_cholesky.h"
#include "solver/mesh/dirichlet_energy.h"

#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace sinew::solver {
namespace {

using Vector = Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

/// Minimises f.K.f / 2 subject to B.f = v by the method of multipliers: A = K + B^T.W.B with a large W is
/// factorised once; a few cheap corrections of the multipliers then meet v to rounding where it can be met,
/// and in the least-squares sense where not. Each step solves for a correction only, which also removes the
/// rounding error of the large W.
class HarmonicSolver {
  public:
    HarmonicSolver(const TetMesh& mesh, const Embedding& surface, const std::vector<double>& areas,
                   const std::vector<char>& painted)
        : mesh_(mesh)
        , surface_(surface) {
        for (std::size_t p = 0; p < painted.size(); ++p)
            if (painted[p]) points_.push_back(p);
        if (points_.empty()) throw Error("FE212", "no point is painted, so there is nothing to extend into the volume");
        number_vertices();
        assemble(areas);
    }

    std::vector<double> extend(const std::vector<double>& values, HarmonicRange range) const {
        Vector v(points_.size());
        for (std::size_t i = 0; i < points_.size(); ++i) {
            v[static_cast<Eigen::Index>(i)] = values[points_[i]];
            if (!std::isfinite(values[points_[i]]))
                throw Error("FE202", "the painted value of point " + std::to_string(points_[i]) + " is not finite");
        }
        const double low = v.minCoeff(), high = v.maxCoeff();
        Vector target = v;
        Vector f = solve(target);
        if (range == HarmonicRange::painted) {
            const double slack = 1e-12 * (high - low);
            const bool beyond = f.minCoeff() < low - slack || f.maxCoeff() > high + slack;
            f = f.cwiseMax(low).cwiseMin(high);
            if (beyond) relax_within(target, low, high, f);
        }
        std::vector<double> result(mesh_.vertices.size());
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = number_[i] >= 0 ? f[number_[i]] : values[nearest_[i]];
        return result;
    }

  private:
    /// Unknowns are the vertices of parts with paint; the others take a constant.
    void number_vertices() {
        const std::vector<int> part = connected_parts(mesh_);
        std::vector<char> has_paint(part.size(), 0);
        for (std::size_t p : points_) has_paint[at(part[at(mesh_.tets[at(surface_.tet[p])][0])])] = 1;
        number_.assign(part.size(), -1);
        for (std::size_t v = 0; v < part.size(); ++v)
            if (has_paint[at(part[v])]) number_[v] = count_++;
        if (at(count_) == part.size()) return;

        std::vector<double> x;
        for (const Vec3& p : mesh_.vertices) x.insert(x.end(), p.data(), p.data() + 3);
        Points positions;
        apply(surface_, mesh_.tets, x.data(), positions);
        std::vector<double> distance(part.size(), std::numeric_limits<double>::infinity());
        std::vector<std::size_t> of_part(part.size(), points_[0]);
        for (std::size_t v = 0; v < part.size(); ++v) {
            if (number_[v] >= 0) continue;
            for (std::size_t p : points_) {
                const double d = (positions[p] - mesh_.vertices[v]).squaredNorm();
                if (d < distance[at(part[v])]) distance[at(part[v])] = d, of_part[at(part[v])] = p;
            }
        }
        nearest_.resize(part.size());
        for (std::size_t v = 0; v < part.size(); ++v) nearest_[v] = of_part[at(part[v])];
    }

    void assemble(const std::vector<double>& areas) {
        K_ = dirichlet_matrix(mesh_, number_, count_);
        Entries rows;
        const Eigen::Index point_count = static_cast<Eigen::Index>(points_.size());
        W_.resize(point_count);
        for (Eigen::Index i = 0; i < point_count; ++i) {
            const std::size_t p = points_[at(i)];
            for (std::size_t k = 0; k < 4; ++k)
                rows.emplace_back(static_cast<int>(i), number_[at(mesh_.tets[at(surface_.tet[p])][k])],
                                  surface_.barycentric[p][k]);
            W_[i] = std::isfinite(areas[p]) ? std::max(areas[p], 0.0) : 0.0;
        }
        B_.resize(point_count, count_);
        B_.setFromTriplets(rows.begin(), rows.end());
        // A point without area is still painted: it keeps a small weight.
        const double mean = W_.mean();
        if (!(mean > 0))
            W_.setOnes();
        else
            W_ = (W_ / mean).cwiseMax(1e-2);
        const Sparse squares = B_.transpose() * (W_.asDiagonal() * B_);
        const double scale = Vector(K_.diagonal()).maxCoeff();
        W_ *= 1e5 * scale / std::max(Vector(squares.diagonal()).maxCoeff(), 1e-300);
        A_ = K_ + Sparse(B_.transpose() * (W_.asDiagonal() * B_));
        factorize(scale);
    }

    /// A small multiple of the identity keeps pivots above zero. It stands only in the matrix that corrects, so it
    /// costs accuracy nowhere. Where rounding of the large W still beats it (several points in tets of no coverage),
    /// more of it is taken; the solution is the same, found in more steps.
    void factorize(double scale) {
        factor_ = std::make_unique<ScalarCholesky>(A_);
        double added = 0;
        for (double share = 1e-13; share < 1e-8; share *= 100) {
            for (int i = 0; i < count_; ++i) A_.coeffRef(i, i) += share * scale - added;
            added = share * scale;
            if (factor_->factorize(A_)) return;
        }
        throw Error("FE208", "painted values cannot be extended into the volume: the tet mesh is degenerate");
    }

    /// `target` comes as the painted values and leaves with the multipliers that hold them.
    Vector solve(Vector& target) const {
        constexpr int rounds = 12;
        const Vector v = target;
        const double spread = std::max(v.maxCoeff() - v.minCoeff(), 1e-300);
        Vector f = Vector::Constant(count_, v.mean());
        for (int round = 0; round < rounds; ++round) {
            const Vector step = factor_->solve(force(target, f));
            f += step;
            target += v - B_ * f;
            if (step.cwiseAbs().maxCoeff() <= 1e-14 * spread) break;
        }
        return f;
    }

    /// Where values were cut off at the bounds, the paint nearby is no longer met as well as the bounds allow: sharp
    /// paint makes the free solution swing to both sides, and only one of them was cut. That is a matter of the tets
    /// about the surface, so Gauss-Seidel sweeps mend it, each value kept within the bounds: they never raise what is
    /// minimised and need no factor.
    void relax_within(const Vector& target, double low, double high, Vector& f) const {
        constexpr int most_sweeps = 400;
        constexpr double enough = 1e-6;
        const Vector pull = B_.transpose() * (W_.asDiagonal() * target);
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            double largest = 0;
            for (int k = 0; k < count_; ++k) {
                const int i = sweep % 2 ? count_ - 1 - k : k; // to and fro, so that no direction is favoured
                double rest = pull[i], own = 0;
                for (Sparse::InnerIterator entry(A_, i); entry; ++entry) {
                    rest -= entry.value() * f[entry.row()];
                    if (entry.row() == i) own = entry.value();
                }
                const double value = std::clamp(f[i] + rest / own, low, high);
                largest = std::max(largest, std::abs(value - f[i]));
                f[i] = value;
            }
            if (largest <= enough * (high - low)) return;
        }
    }

    Vector force(const Vector& target, const Vector& f) const {
        return B_.transpose() * (W_.asDiagonal() * Vector(target - B_ * f)) - K_ * f;
    }

    const TetMesh& mesh_;
    const Embedding& surface_;
    std::vector<std::size_t> points_;  ///< painted points
    std::vector<int> number_;          ///< unknown of each vertex, or -1
    std::vector<std::size_t> nearest_; ///< painted point of each vertex without unknown
    int count_ = 0;
    Sparse K_, B_, A_;
    Vector W_;
    std::unique_ptr<ScalarCholesky> factor_;
};

void check_sizes(const Embedding& surface, std::size_t areas, std::size_t painted) {
    const std::string points = std::to_string(surface.size()) + " embedded points";
    if (areas != surface.size()) throw Error("FE204", std::to_string(areas) + " areas for " + points);
    if (painted != surface.size()) throw Error("FE204", std::to_string(painted) + " flags for " + points);
}

void check_per_vertex(const TetMesh& mesh, const std::vector<double>& values) {
    if (values.size() != mesh.vertices.size())
        throw Error("FE204", std::to_string(values.size()) + " values for " + std::to_string(mesh.vertices.size()) +
                                 " vertices");
}

} // namespace

std::vector<std::vector<double>> harmonic_extensions(const TetMesh& mesh, const Embedding& surface,
                                                     const std::vector<double>& areas,
                                                     const std::vector<std::vector<double>>& maps,
                                                     const std::vector<char>& painted, HarmonicRange range) {
    check_sizes(surface, areas.size(), painted.size());
    for (const std::vector<double>& values : maps)
        if (values.size() != surface.size())
            throw Error("FE204", std::to_string(values.size()) + " values for " + std::to_string(surface.size()) +
                                     " embedded points");
    std::vector<std::vector<double>> result;
    const HarmonicSolver solver(mesh, surface, areas, painted);
    for (const std::vector<double>& values : maps) result.push_back(solver.extend(values, range));
    return result;
}

std::vector<std::vector<double>> harmonic_extensions(const TetMesh& mesh, const PaintedSurface& surface,
                                                     const std::vector<std::vector<double>>& maps,
                                                     const std::vector<char>& painted, HarmonicRange range) {
    const PaintSamples samples = sample_paint(mesh, surface, painted);
    std::vector<std::vector<double>> sampled;
    for (const std::vector<double>& values : maps) sampled.push_back(samples.values(values));
    return harmonic_extensions(mesh, samples.embedding, samples.areas, sampled, samples.painted(painted), range);
}

std::vector<double> harmonic_extension(const TetMesh& mesh, const Embedding& surface, const std::vector<double>& areas,
                                       const std::vector<double>& values, const std::vector<char>& painted,
                                       HarmonicRange range) {
    return harmonic_extensions(mesh, surface, areas, {values}, painted, range)[0];
}

/// Of a tet's volume: of less than this all that is known of where it lies is rounding.
constexpr double least_inside = 1e-9;

std::vector<double> tet_means(const TetMesh& mesh, const std::vector<double>& per_vertex) {
    check_per_vertex(mesh, per_vertex);
    std::vector<double> means;
    means.reserve(mesh.tets.size());
    for (const Tet& t : mesh.tets)
        means.push_back(0.25 *
                        (per_vertex[at(t[0])] + per_vertex[at(t[1])] + per_vertex[at(t[2])] + per_vertex[at(t[3])]));
    for (std::size_t k = 0; k < mesh.cut.tets.size(); ++k) { // the value at the middle of what is solid
        const double* moments = mesh.cut.of(k);
        const std::size_t tet = at(mesh.cut.tets[k]);
        double sum = 0, inside = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            const double first = std::max(0.0, mesh.cut.degree == 1 ? moments[c] : MomentTensors(moments).first[c]);
            sum += first * per_vertex[at(mesh.tets[tet][c])], inside += first;
        }
        if (inside > least_inside) means[tet] = sum / inside;
    }
    return means;
}

Points unit_gradients(const TetMesh& mesh, const std::vector<double>& per_vertex) {
    check_per_vertex(mesh, per_vertex);
    Points gradients = gradients_of(mesh, per_vertex);
    make_unit(gradients, 1e-9);
    return gradients;
}

} // namespace sinew::solver
