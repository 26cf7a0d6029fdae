// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/migrate.h"

namespace sinew::engine {

std::span<const MigrationStep> migration_steps() { return {}; }

const MigrationStep* migration_from(int from) {
    for (const MigrationStep& s : migration_steps())
        if (s.from == from) return &s;
    return nullptr;
}

} // namespace sinew::engine
