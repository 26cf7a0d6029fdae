// All node types of Sinew, by name.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/registry.h"

#include <memory>

namespace sinew::nodes {

/// Adds every node type; the list in register_all.cpp names them.
void register_all(engine::Registry& registry);
/// A registry with all of them.
std::shared_ptr<const engine::Registry> make_registry();

} // namespace sinew::nodes
