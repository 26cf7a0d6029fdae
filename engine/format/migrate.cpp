// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/migrate.h"

#include <algorithm>

namespace sinew::engine {

std::span<const MigrationStep> migration_steps() { return {}; }

const MigrationStep* migration_from(int from) {
    for (const MigrationStep& s : migration_steps())
        if (s.from == from) return &s;
    return nullptr;
}

std::optional<std::string> migrated(std::string text, int from, int to, std::span<const MigrationStep> steps) {
    for (; from < to; ++from) {
        const auto step =
            std::find_if(steps.begin(), steps.end(), [&](const MigrationStep& s) { return s.from == from; });
        if (step == steps.end()) return {};
        text = step->apply(text);
    }
    return text;
}

} // namespace sinew::engine
