// The outputs of one node and what it warned about, as bytes for the disk store.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/store.h"
#include "engine/registry.h"

#include <span>
#include <vector>

namespace sinew::engine {

/// What a kept entry was made from: the node's name, and the content of each input upstream by name
/// (Program::recipe). For `explain`; nothing is found by it.
struct KeptInputs {
    std::string node;
    std::vector<std::pair<std::string, Digest>> contents;
};

/// Every output's type must have a codec (Registry::add sees to that for types that are kept).
std::vector<std::byte> encode_entry(const Registry& registry, const NodeType& type, const Entry& entry,
                                    const KeptInputs& inputs);
/// Throws BadBytes: another codec's bytes, or values whose digests are not those that were written.
Entry decode_entry(const Registry& registry, const NodeType& type, std::span<const std::byte> bytes);
/// Throws BadBytes.
KeptInputs decode_inputs(std::span<const std::byte> bytes);

} // namespace sinew::engine
