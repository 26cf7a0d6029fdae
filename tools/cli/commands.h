// All commands of the program, one file each.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/cli/command.h"

#include <vector>

namespace sinew::cli {

Command run_command();
Command check_command();
Command eval_command();
Command explain_command();
Command nodes_command();
Command graph_command();
Command snapshot_command();
Command view_command();
Command live_command();
Command bench_command();
Command docs_command();
Command cache_command();
Command fmt_command();
Command diff_command();
Command new_command();

/// In the order in which `sinew --help` lists them.
inline std::vector<Command> all_commands() {
    return {run_command(),   check_command(),    eval_command(), explain_command(), nodes_command(),
            graph_command(), snapshot_command(), view_command(), live_command(),    bench_command(),
            docs_command(),  cache_command(),    fmt_command(),  diff_command(),    new_command()};
}

} // namespace sinew::cli
