// How many threads a session or a command may be given.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace sinew::embed {

/// More threads than this are a typing error, and no machine is quicker with them.
inline constexpr int most_threads = 1024;

} // namespace sinew::embed
