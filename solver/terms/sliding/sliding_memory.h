// What sliding attachments keep from step to step: where each of their points lies, and the height that it keeps.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/memory.h"

#include <vector>

namespace sinew::solver {

struct SlidingMemory {
    struct Place {
        double height = 0; ///< over the target, kept [m]
        int triangle = -1; ///< of the target, cut to the size of its tets
        int home = -1;     ///< where it was when the matrix was last laid out; -1: of a bone
        friend bool operator==(const Place&, const Place&) = default;
    };
    static_assert(sizeof(Place) == 16, "no padding: its bytes are kept as they are");
    std::vector<std::vector<Place>> places; ///< per attachment; empty: it does not slide
};

void keep_slides(const SlidingMemory& slides, TermMemory& memory);
/// Nothing slides where none of `memories` is that of sliding attachments. Throws Error IO403 where the bytes do not
/// make sense.
void slides_kept(const std::vector<TermMemory>& memories, SlidingMemory& out);

} // namespace sinew::solver
