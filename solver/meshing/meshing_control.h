// How a long meshing is watched and stopped.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

namespace sinew::solver {

/// Both may be empty. They are called often, from the thread that meshes, and must be quick; neither can
/// change a result.
struct MeshingControl {
    std::function<bool()> stop;           ///< true: give up; the meshing throws Stopped
    std::function<void(double)> progress; ///< 0 to 1, never falling
};

} // namespace sinew::solver
