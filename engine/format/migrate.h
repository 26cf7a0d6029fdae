// Steps from one format number to the next, each a rewrite of the document's text; files of every released
// format load for ever.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sinew::engine {

constexpr int current_format = 1;

/// Takes the text of a document of format `from` and gives the same document in format `from + 1`.
struct MigrationStep {
    int from;
    std::string (*apply)(std::string_view text);
};

/// In rising order. Empty as long as there is one format.
std::span<const MigrationStep> migration_steps();

/// The step that leaves format `from`, or nullptr.
const MigrationStep* migration_from(int from);

/// The text in format `to`, by one step after the other; nothing if one is missing.
std::optional<std::string> migrated(std::string text, int from, int to, std::span<const MigrationStep> steps);

} // namespace sinew::engine
