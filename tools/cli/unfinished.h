// A mark in the output folder while a run writes into it. It goes when the run is through; what a run leaves
// that was killed or failed says so to whoever looks at the folder later.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"
#include "tools/cli/report.h"

#include <filesystem>
#include <vector>

namespace sinew::cli {

struct UnfinishedRun {
    std::string graph;
    int first = 0, last = 0, count = 0; ///< frames that it was to give
    std::optional<RunError> error;      ///< none: it was killed, or is still at work
    bool is_alive = false;              ///< only known for runs of this machine
};

/// Writes "unfinished.FIRST.json". Throws engine::Failure IO405, IO410.
void mark_unfinished(const std::filesystem::path& folder, const UnfinishedRun& run,
                     const engine::FileAccess& files = {});
/// Takes away the marks of this run and of dead ones whose frames lie within it.
void mark_finished(const std::filesystem::path& folder, const UnfinishedRun& run, const engine::FileAccess& files = {});
/// By first frame; whatever cannot be read is left out.
std::vector<UnfinishedRun> find_unfinished(const std::filesystem::path& folder);

} // namespace sinew::cli
