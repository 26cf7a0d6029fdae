// Limits that attributes of many node types share.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"

namespace sinew::nodes {

/// What a place, a length, a direction or an entry of a matrix, map or list may be at most: products of five of them
/// are still numbers. Every number that an artist writes has a lower and an upper end, so that what could only end as
/// infinity somewhere inside of a solve is told where it was written.
inline constexpr engine::Limits within_reach{.min = -1e60, .max = 1e60};

} // namespace sinew::nodes
