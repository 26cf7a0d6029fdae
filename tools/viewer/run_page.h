// The page of a run that has just ended: its frames are looked up, not simulated again.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "tools/cli/report.h"

#include <filesystem>
#include <memory>
#include <stop_token>

namespace sinew::viewer {

/// Writes `folder`/view.html and returns its absolute path. Throws Failure (IO405).
std::filesystem::path write_run_page(const std::filesystem::path& folder,
                                     const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
                                     const cli::RunReport& report, std::stop_token stop);

} // namespace sinew::viewer
