// How a host watches long meshing and stops it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/error.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string_view>

namespace sinew::solver {

/// Both are called from the thread that called the meshing, and may be empty.
struct MeshingControl {
    std::function<bool()> stop;                                       ///< true = throw Stopped
    std::function<void(double done, std::string_view what)> progress; ///< done in 0 to 1, never falling

    void ask() const {
        if (stop && stop()) throw Stopped();
    }
    void report(double done, std::string_view what) const {
        ask();
        if (progress) progress(done, what);
    }
};

/// The same, but that it gives up: `stop` throws Error FE233 (`what`, as "the tets are", and `hint`) once
/// `most_seconds` of the wall clock have gone by; 0 = never. Throws Error FE222 (a limit below 0 or none at all).
MeshingControl with_time_limit(const MeshingControl& control, double most_seconds, std::string_view what,
                               std::string_view hint);

/// One part of the whole work: body(i) for i in [0, count), in parallel, with a report between blocks of
/// pieces. The pieces are the same for any number of threads.
struct MeshingPhase {
    const MeshingControl& control;
    double from = 0, to = 1; ///< of the whole
    std::string_view what;

    template <class Body>
    void run(std::size_t count, std::size_t grain, const Body& body) const {
        const std::size_t block = std::max<std::size_t>(32 * grain, (count + 49) / 50);
        control.report(from, what);
        for (std::size_t first = 0; first < count; first += block) {
            const std::size_t size = std::min(block, count - first);
            parallel_for(size, grain, [&](std::size_t i) { body(first + i); });
            control.report(from + (to - from) * static_cast<double>(first + size) / static_cast<double>(count), what);
        }
    }
};

} // namespace sinew::solver
