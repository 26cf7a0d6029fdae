// What the reports beside a run's meshes say (docs/concepts/report.md). They come from disk, so anything may
// be odd.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/cli/report.h"
#include "tools/viewer/view_data.h"

#include <filesystem>
#include <map>

namespace sinew::viewer {

struct FoundReport {
    std::filesystem::path file;
    std::filesystem::file_time_type written;
    std::string graph;
    std::map<int, ViewFrame> frames;
    std::optional<cli::RunError> error; ///< why the run ended early
};

/// All reports in `folder`, the newest first. What cannot be read is told in `notes`.
std::vector<FoundReport> find_reports(const std::filesystem::path& folder, std::vector<ViewNote>& notes);

/// "The run ended before frame 3: …", or what a user's interrupt left.
std::string ended_early(const cli::RunError& error);

} // namespace sinew::viewer
