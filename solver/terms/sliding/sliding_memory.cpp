// The bytes of SlidingMemory: how many points each attachment slides with, then all their places.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/sliding/sliding_memory.h"

#include "solver/term/memory_bytes.h"
#include "solver/terms/sliding/sliding.h"

namespace sinew::solver {

void keep_slides(const SlidingMemory& slides, TermMemory& memory) {
    std::size_t size = sizeof(std::uint64_t);
    for (const auto& places : slides.places) size += size_in_memory(places);
    std::byte* to = memory.bytes.rewrite(size).data();
    const std::uint64_t count = slides.places.size();
    std::memcpy(to, &count, sizeof count);
    to += sizeof count;
    for (const auto& places : slides.places) put_in_memory(places, to);
}

void slides_kept(const std::vector<TermMemory>& memories, SlidingMemory& out) {
    for (auto& places : out.places) places.clear();
    const TermMemory* memory = find_memory(memories, sliding_type.name);
    if (!memory || memory->bytes.empty()) return;
    std::span<const std::byte> bytes = memory->bytes;
    std::uint64_t count = 0;
    if (bytes.size() >= sizeof count) std::memcpy(&count, bytes.data(), sizeof count);
    if (bytes.size() < sizeof count || count > bytes.size() / sizeof count)
        throw Error("IO403", "the sliding attachments of a saved simulation state end too early");
    bytes = bytes.subspan(sizeof count);
    out.places.resize(count);
    for (auto& places : out.places) take_from_memory(bytes, places, "sliding attachments");
    if (!bytes.empty())
        throw Error("IO403", "the sliding attachments of a saved simulation state have bytes left over");
}

} // namespace sinew::solver
