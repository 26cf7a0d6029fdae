// The parts of a surface that hang together, which of them lie inside others, and what that makes a cavity.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <vector>

namespace sinew::solver {

/// Which tets of a lattice are kept, and what a closed shell inside another one means.
enum class Fill {
    surface_only,    ///< tets that the surface passes through, shells inside others too; these mean what they do for
                     ///< empty_cavities, but the surface may have holes
    filled_cavities, ///< all that the outer shells enclose; shells inside others have no meaning
    empty_cavities,  ///< a shell inside another bounds a cavity, one inside a cavity is solid, and so on;
                     ///< whatever way they are turned
};

/// Directed edges of welded triangles that are used more often than their reverse, once for each use too
/// many; in order of their lower, then higher end.
std::vector<std::array<int, 2>> border_edges_of(const std::vector<Triangle>& triangles);

/// Throws Error FE220, with the number of border edges and the first of them, if there are any.
void check_watertight(const std::vector<std::array<int, 2>>& border_edges);

/// Prepares welded triangles for the rule "inside is where the winding number exceeds one half in size": drops
/// shells inside others (filled_cavities), or keeps all, and turns shells so that solids face outwards and
/// cavities inwards, whichever way they came: an inside-out part is as solid as any, also where it crosses
/// another. A shell is what hangs together by edges. It lies in another one when the winding number of that one
/// exceeds one half in size at all of its vertices, so shells that cross do not lie in each other. Shells that
/// are not closed count as one together, and that one is never inside. Triangles stay in order.
/// \return the volumes of the shells that are left, each taken as positive
double apply_fill(const Points& points, std::vector<Triangle>& triangles, Fill fill);

/// Turns closed shells that lie in no other and face inwards, each together with all that lies in it: so
/// cavities stay cavities, and parts that cross are one solid.
/// \return how many closed shells in others bound nothing by the rule "inside is where the winding number exceeds one
///         half in size": it does so on both of their sides, since they face the way of what they lie in
std::size_t turn_outwards(const Points& points, std::vector<Triangle>& triangles);

} // namespace sinew::solver
