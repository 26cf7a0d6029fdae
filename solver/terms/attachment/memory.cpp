// The bytes of AttachmentMemory: how many attachments, then of each its start, how many anchors, and those.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/terms/attachment/anchors.h"
#include "solver/terms/attachment/attachment.h"

#include <cstring>
#include <span>
#include <string>
#include <type_traits>

namespace sinew::solver {

namespace {

static_assert(std::is_trivially_copyable_v<Anchor> && std::is_trivially_copyable_v<AttachmentStart>);
static_assert(sizeof(AttachmentStart) == 5 * sizeof(double), "no padding: its bytes are kept as they are");

void append(const void* from, std::size_t size, std::vector<std::byte>& bytes) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + size);
}

// All counts and items are whole doubles long, so that items can be read where they lie.
static_assert(sizeof(Anchor) % alignof(Anchor) == 0 && sizeof(AttachmentStart) % alignof(Anchor) == 0 &&
              sizeof(std::uint64_t) % alignof(Anchor) == 0);

void take(std::span<const std::byte>& bytes, void* to, std::size_t size) {
    if (bytes.size() < size) throw Error("IO403", "the attachments of a saved simulation state end too early");
    if (size > 0) std::memcpy(to, bytes.data(), size);
    bytes = bytes.subspan(size);
}

/// A count of items of `size` bytes each, which must follow.
std::size_t take_count(std::span<const std::byte>& bytes, std::size_t size) {
    std::uint64_t count = 0;
    take(bytes, &count, sizeof count);
    if (count > bytes.size() / size) throw Error("IO403", "the attachments of a saved simulation state end too early");
    return static_cast<std::size_t>(count);
}

} // namespace

void keep_attachments(const AttachmentMemory& attachments, TermMemory& memory) {
    if (attachments.anchors.empty()) return memory.bytes.clear();
    std::vector<std::byte> bytes;
    const std::uint64_t count = attachments.anchors.size();
    std::size_t total = sizeof count;
    for (const std::vector<Anchor>& anchors : attachments.anchors)
        total += sizeof(AttachmentStart) + sizeof count + anchors.size() * sizeof(Anchor);
    bytes.reserve(total);
    append(&count, sizeof count, bytes);
    for (std::size_t a = 0; a < attachments.anchors.size(); ++a) {
        const std::vector<Anchor>& anchors = attachments.anchors[a];
        const std::uint64_t size = anchors.size();
        append(&attachments.starts[a], sizeof(AttachmentStart), bytes);
        append(&size, sizeof size, bytes);
        append(anchors.data(), size * sizeof(Anchor), bytes);
    }
    memory.bytes = std::move(bytes);
}

AttachmentView attachments_kept(const std::vector<TermMemory>& memories) {
    AttachmentView out;
    const TermMemory* memory = find_memory(memories, attachment_type.name);
    if (!memory) return out;
    out.bytes = memory->bytes;
    std::span<const std::byte> bytes = out.bytes;
    const std::size_t count = take_count(bytes, sizeof(AttachmentStart) + sizeof(std::uint64_t));
    out.anchors.resize(count), out.starts.resize(count);
    for (std::size_t a = 0; a < count; ++a) {
        take(bytes, &out.starts[a], sizeof(AttachmentStart));
        const std::size_t size = take_count(bytes, sizeof(Anchor));
        out.anchors[a] = {reinterpret_cast<const Anchor*>(bytes.data()), size};
        bytes = bytes.subspan(size * sizeof(Anchor));
    }
    if (!bytes.empty()) throw Error("IO403", "the attachments of a saved simulation state have bytes left over");
    return out;
}

void check_kept(const Scene& scene, const std::vector<AttachmentInputs>& inputs, const AttachmentView& kept) {
    const auto& attachments = scene.description().attachments;
    // A state may come from a file.
    if (kept.anchors.size() != attachments.size())
        throw Error("IO403", "a saved simulation state holds " + std::to_string(kept.anchors.size()) +
                                 " attachments, the scene has " + std::to_string(attachments.size()));
    for (std::size_t a = 0; a < attachments.size(); ++a) {
        const bool has_effect = scene.deforms(attachments[a].source) || scene.deforms(attachments[a].target);
        if (!has_effect || inputs[a].mode() == AttachmentMode::none || !kept.anchors[a].empty()) continue;
        Error e("FE240", "it is switched on, but at the start frame nothing of it found a hold",
                "paint source and target where they face each other");
        e.attachment = static_cast<int>(a);
        throw e;
    }
}

} // namespace sinew::solver
