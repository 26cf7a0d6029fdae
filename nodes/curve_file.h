// The points of a curve from a file.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"

#include <string>
#include <string_view>

namespace sinew::nodes {

/// The numbers of a curve from the bytes of a file: of JSON those at `pointer`, else plain text of numbers. Messages
/// name `path`, whose ending tells which. Throws solver::Error IO403.
engine::NumberList parse_curve(std::string_view text, const std::string& path, const std::string& pointer);

} // namespace sinew::nodes
