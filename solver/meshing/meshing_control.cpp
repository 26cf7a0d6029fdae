// A time limit for meshing.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/meshing_control.h"

#include <chrono>
#include <sstream>

namespace sinew::solver {

MeshingControl with_time_limit(const MeshingControl& control, double most_seconds, std::string_view what,
                               std::string_view hint) {
    using Clock = std::chrono::steady_clock;
    std::ostringstream seconds;
    seconds << most_seconds << " s";
    if (!(most_seconds >= 0)) throw Error("FE222", "a time limit of " + seconds.str());
    if (most_seconds == 0) return control;
    const std::string late = std::string(what) + " not ready after " + seconds.str();
    return {[stop = control.stop, most_seconds, late, hint = std::string(hint), begin = Clock::now()] {
                if (stop && stop()) return true;
                if (std::chrono::duration<double>(Clock::now() - begin).count() > most_seconds)
                    throw Error("FE233", late, hint);
                return false;
            },
            control.progress};
}

} // namespace sinew::solver
