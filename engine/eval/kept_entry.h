// The outputs of one node and what it warned about, as bytes for the disk store.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/store.h"
#include "engine/registry.h"

#include <span>
#include <vector>

namespace sinew::engine {

/// Every output's type must have a codec (Registry::add sees to that for types that are kept).
std::vector<std::byte> encode_entry(const Registry& registry, const NodeType& type, const Entry& entry);
/// Throws BadBytes: another codec's bytes, or values whose digests are not those that were written.
Entry decode_entry(const Registry& registry, const NodeType& type, std::span<const std::byte> bytes);

} // namespace sinew::engine
