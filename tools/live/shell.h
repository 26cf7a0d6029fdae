// What stands around the run in `sinew live`: shell.html, as the program carries it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

namespace sinew::live {

std::string_view shell_page();

} // namespace sinew::live
