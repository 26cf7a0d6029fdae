// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/part_motion.h"

#include "solver/term/type.h"

#include <algorithm>

namespace sinew::solver {

bool has_moving_parts(const Scene& scene) {
    const std::vector<Part>& parts = scene.description().parts;
    return std::any_of(parts.begin(), parts.end(), [](const Part& p) { return p.type->mix != nullptr; });
}

bool has_followers(const Scene& scene) {
    const std::vector<Part>& parts = scene.description().parts;
    return std::any_of(parts.begin(), parts.end(), [](const Part& p) { return p.type->follow != nullptr; });
}

void follow_bones(const Scene& scene, const std::vector<TermMemory>& memories, const std::vector<Points>& bones,
                  std::vector<PartValues>& parts) {
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const TermType& type = *scene.description().parts[k].type;
        const TermMemory* memory = type.follow ? find_memory(memories, type.name) : nullptr;
        if (memory) type.follow(scene, k, *memory, bones, parts[k]);
    }
}

void go_part_way(const Scene& scene, const std::vector<PartValues>& before, double share,
                 std::vector<PartValues>& parts) {
    for (std::size_t k = 0; k < parts.size(); ++k)
        if (const auto mix = scene.description().parts[k].type->mix) mix(before[k], parts[k], share);
}

void keep_places(const Scene& scene, const std::vector<PartValues>& parts, std::vector<PartValues>& kept) {
    kept.resize(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k)
        if (scene.description().parts[k].type->mix) kept[k] = parts[k];
}

} // namespace sinew::solver
