// Which build of Sinew this is, for frames that are kept on disk.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace sinew::embed {

/// Changes with every build of the program or shared library that this code is in: its file's size and time.
std::string build_mark();

} // namespace sinew::embed
