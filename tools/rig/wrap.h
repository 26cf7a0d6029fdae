// Closed surfaces around parts that cannot be simulated as they are.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/parts.h"

#include <functional>
#include <vector>

namespace sinew::rig {

/// Grid cells along the longest side of what is wrapped.
constexpr int wrap_resolution = 256;

/// Puts a closed surface around each part that is not closed, has edges with over two triangles, is turned inside out,
/// or is a muscle that encloses nothing: the narrowest that bounds a solid, with lids over holes that it would go
/// through, and only where those do not help a wider one. Warns of wide holes (DG163) and of parts that no surface
/// makes a solid of, which get a shell (DG178). Throws engine::Failure (FE2xx) if none can be made, solver::Stopped.
void wrap_open(std::vector<Part>& parts, std::vector<engine::Diagnostic>& notes, const std::function<bool()>& stop);

} // namespace sinew::rig
