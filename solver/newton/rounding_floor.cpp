// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/rounding_floor.h"

#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr double comes_down = 0.5; ///< to this share at least, by a step that rounding does not spoil
constexpr double solved = 0.25;    ///< of the least force: what a linear system may leave and still say something
constexpr int enough = 2;
constexpr double clearly_less = 0.75;

} // namespace

void RoundingFloor::take_direction(const Potential& potential, const BlockMatrix& hessian,
                                   const std::vector<double>& gradient, const std::vector<double>& direction) {
    const auto& bodies = potential.numbering().deformables;
    product_.resize(direction.size());
    multiply(hessian, direction.data(), product_.data());
    left_.resize(bodies.size());
    for (std::size_t d = 0; d < bodies.size(); ++d) {
        const std::size_t first = 3 * bodies[d].first_unknown;
        left_[d] = std::sqrt(ordered_sum(3 * bodies[d].unknown_count, [&](std::size_t i) {
            const double r = product_[first + i] + gradient[first + i];
            return r * r;
        }));
    }
}

void RoundingFloor::take_forces(const std::vector<BodyForces>& forces) {
    const bool first = least_.empty();
    least_.resize(forces.size());
    idle_.resize(forces.size());
    for (std::size_t d = 0; d < forces.size(); ++d) {
        const double sum = forces[d].sum;
        if (first || !(sum > comes_down * least_[d]))
            idle_[d] = 0;
        else if (left_[d] <= solved * least_[d])
            ++idle_[d];
        least_[d] = first ? sum : std::min(least_[d], sum);
    }
}

bool RoundingFloor::reached(const std::vector<BodyForces>& forces, double tolerance) const {
    for (std::size_t d = 0; d < forces.size(); ++d) {
        const double residual = forces[d].sum / forces[d].at_work;
        if (residual <= tolerance) continue;
        if (!(residual <= strict) || least_.empty() || idle_[d] < enough) return false;
    }
    return true;
}

bool is_lower(const std::vector<BodyForces>& elsewhere, const std::vector<BodyForces>& here, double tolerance) {
    for (std::size_t d = 0; d < here.size(); ++d)
        if (here[d].sum > tolerance * here[d].at_work && elsewhere[d].sum < clearly_less * here[d].sum) return true;
    return false;
}

} // namespace sinew::solver
