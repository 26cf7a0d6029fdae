// What the program tells the shell. Part of the documented interface: never renumbered.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::cli {

enum ExitCode : int { done = 0, graph_wrong = 1, wrong_usage = 2, solve_failed = 3, cancelled = 4, internal_error = 5 };

} // namespace sinew::cli
