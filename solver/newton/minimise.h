// Newton's method with line search on the incremental potential. Hessians are exact; only where one is not positive
// definite is it assembled again with every element's eigenvalues clamped (always clamping costs 2 to 2.4 times the
// iterations: `sinew bench levers`). Scenes with sheets, which seldom are, take truncated directions within a trust
// region instead (linear/truncated_newton.h). Converged: on every tissue |gradient| <= tolerance x the forces at work
// there, or down to what rounding makes of zero: below what rounding of positions does to forces (Potential::balance),
// or where whole Newton steps no longer bring it down (rounding_floor.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/linear_solver.h"
#include "solver/newton/arcs.h"
#include "solver/newton/islands.h"
#include "solver/newton/potential.h"
#include "solver/newton/rounding_floor.h"
#include "solver/step.h"

#include <memory>

namespace sinew::solver {

struct NewtonOptions {
    int max_iterations = 10;
    double tolerance = 1e-6; ///< on Balance::residual
    LinearMethod method = LinearMethod::automatic;
};

/// Buffers that live as long as the pattern.
struct NewtonWorkspace {
    BlockMatrix hessian;
    std::unique_ptr<BlockMatrix> projected; ///< of scenes with sheets: the Hessian is needed beside it
    LinearSolver linear;
    std::vector<double> gradient, direction, trial;
    std::vector<double> gradient_here;    ///< while the one of a model takes its place
    std::vector<double> springs, elastic; ///< see Potential::add_up_springs
    std::vector<double> gain;             ///< that the direction promises each tissue [J]
    std::vector<char> carried;            ///< deformables that start from where a hold takes them
    std::vector<char> staying;            ///< that do not start in flight, where others do; scratch
    Arcs arcs;
    std::vector<BodyForces> forces, forces_here; ///< at the last evaluation with gradient; before a look elsewhere
    RoundingFloor floor;
    Islands islands;
    std::vector<char> resting; ///< flags of deformables
    std::size_t renewals = 0;  ///< of roughly_solved, how many residuals terms have been asked to renew at
    double worst_residual = 0; ///< of all calls since it was last set to 0
    int worst_deformable = -1; ///< whose that is
    explicit NewtonWorkspace(const Potential& potential)
        : hessian(potential.pattern())
        , linear(potential.pattern(), potential.places())
        , islands(potential.numbering(), potential.pattern()) {}
};

/// Moves x (3 a vertex) to the minimum, starting from x, from where holds take their bodies or from free flight,
/// whichever has the lower value, some bodies in flight and others not. Adds to the record's iterations and seconds;
/// residual and converged are kept at the worst over several calls. Throws Error FE302 where no step can be taken, with
/// the body that is farthest from balance, and Stopped when asked to.
void minimise(Potential& potential, NewtonWorkspace& work, const NewtonOptions& options, const StepControl& control,
              std::vector<double>& x, LinearMemory& memory, StepRecord& record);

} // namespace sinew::solver
