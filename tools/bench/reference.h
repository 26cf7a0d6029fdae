// The trusted values that accuracy is measured against, compiled in from tests/solver/data. Closed formulas and values
// of other codes (dolfinx, CalculiX and a separate numpy code; see "meta" in accuracy.json); none was computed by
// this one.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>

namespace sinew::bench {

/// accuracy.json: statics, materials, integrators of one degree of freedom, muscle, free vibration.
const nlohmann::json& reference_values();
/// bar_release.json: a clamped bar let go in gravity, followed for one second.
const nlohmann::json& bar_release_values();

} // namespace sinew::bench
