// The bundled script and style of the page, compiled in. Made by tools/viewer/build_page from
// tools/viewer/page.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

namespace sinew::viewer {

std::string_view page_script();
std::string_view page_style();

} // namespace sinew::viewer
