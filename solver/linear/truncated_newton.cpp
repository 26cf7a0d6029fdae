// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/truncated_newton.h"

#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

/// Along negative curvature no farther than so many times the step of the preconditioner.
constexpr double farthest = 20;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return ordered_sum(a.size(), [&](std::size_t i) { return a[i] * b[i]; });
}

} // namespace

TruncatedNewton::Result TruncatedNewton::solve(const BlockMatrix& a, ComponentFactors& preconditioner,
                                               const std::vector<double>& b, std::vector<double>& x, double tolerance,
                                               int most_iterations, double longest) {
    Result result;
    const std::size_t n = b.size();
    x.assign(n, 0.0);
    r_ = b, z_.resize(n), ap_.resize(n);
    preconditioner.solve(r_.data(), z_.data());
    p_ = z_;
    double rz = dot(r_, z_), pmp = rz, xmp = 0, xmx = 0; // p^T M p, x^T M p, x^T M x
    const double goal = tolerance * tolerance * rz;
    while (rz > goal && result.iterations < most_iterations) {
        ++result.iterations;
        multiply(a, p_.data(), ap_.data());
        const double curvature = dot(p_, ap_);
        result.negative = !(curvature > 0);
        double step = result.negative ? farthest * rz / pmp : rz / curvature;
        // To where x^T M x + 2 s x^T M p + s^2 p^T M p is the square of the longest.
        const double room = longest * longest - xmx;
        const double limit = room > 0 ? room / (xmp + std::sqrt(xmp * xmp + room * pmp)) : 0;
        const bool ends = step > limit;
        if (ends) step = limit;
        if (!std::isfinite(step)) return result;
        for (std::size_t i = 0; i < n; ++i) x[i] += step * p_[i];
        xmx += step * (2 * xmp + step * pmp);
        result.length = std::sqrt(std::max(0.0, xmx));
        if (result.negative || ends) return result;
        for (std::size_t i = 0; i < n; ++i) r_[i] -= step * ap_[i];
        preconditioner.solve(r_.data(), z_.data());
        const double next = dot(r_, z_), beta = next / rz;
        rz = next;
        xmp = beta * (xmp + step * pmp);
        pmp = rz + beta * beta * pmp;
        for (std::size_t i = 0; i < n; ++i) p_[i] = z_[i] + beta * p_[i];
    }
    result.converged = rz <= goal;
    return result;
}

} // namespace sinew::solver
