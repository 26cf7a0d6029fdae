// The frame around the saved bytes of a simulation state: whose state it is, and whether the bytes are whole.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/digest.h"
#include "engine/node_type.h"

#include <span>
#include <string>
#include <vector>

namespace sinew::engine {

/// Header and payload. `key` is the chain's key of the frame: type, numerics and everything that went into
/// the state.
std::vector<std::byte> wrap_state(const NodeType& type, const Digest& key, std::span<const std::byte> payload);

struct UnwrappedState {
    std::span<const std::byte> payload;
    std::string fault; ///< why the bytes must not be used; empty = they may
};
UnwrappedState unwrap_state(const NodeType& type, const Digest& key, std::span<const std::byte> bytes);

} // namespace sinew::engine
