// The page of a run that has just ended, of the frames that were collected while it went.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/cli/report.h"
#include "tools/viewer/view_data.h"

#include <filesystem>

namespace sinew::viewer {

/// Writes `folder`/view.html and returns its absolute path. Throws Failure (IO405).
/// \param scene with the report's frames or the first of them
std::filesystem::path write_run_page(const std::filesystem::path& folder, ViewScene scene, const cli::RunReport& report,
                                     const engine::FileAccess& files = {});

} // namespace sinew::viewer
