// A clamped bar is let go in gravity and swings for a second: the problem whose trajectories in time and space are
// known.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/beams.h"
#include "tools/bench/models.h"

namespace sinew::bench {

/// Stiffness across the bar over that along it, in the anisotropic law; the other laws do not read it.
inline constexpr double bar_anisotropy = 0.5;

struct BarRelease {
    LawName law = laws[0]; ///< without known trajectories: neo-Hookean has the log law's material, anisotropic StVK's
    IntegratorName integrator = integrators[0];
    int cells = 8;    ///< along the bar of 0.4 x 0.1 x 0.1 m; a quarter of it across
    int substeps = 1; ///< of a frame of 1/24 s
    double tolerance_factor = 1e-4;
    solver::LinearMethod linear = solver::LinearMethod::automatic;
    ElementName element = elements[0];
};

struct BarTrajectory {
    solver::Points tip; ///< of the corner (.4, .1, .1), at frames 0…24 [m]
    Work work;
};

/// Throws solver::Error and solver::Stopped.
BarTrajectory run_bar(const BarRelease& bar, const std::stop_token& stop = {});

/// Whether trajectories are known for this law.
bool bar_is_known(const LawName& law);
/// The same mesh and lumped mass, exact in time. Known for 8 and 16 cells; empty otherwise.
solver::Points bar_on_mesh(const LawName& law, int cells);
/// Exact in space and time, to a few millimetres.
solver::Points bar_continuum(const LawName& law);
/// An integrator's own sequence on 8 cells at a whole number of substeps; empty where it is not known.
solver::Points bar_scheme(const LawName& law, const IntegratorName& integrator, int substeps);

/// Root of the mean square distance over the frames [m].
double rms_distance(const solver::Points& a, const solver::Points& b);
double largest_distance(const solver::Points& a, const solver::Points& b);

} // namespace sinew::bench
