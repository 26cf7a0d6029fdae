// A bitmap font for labels in pictures: capital letters, digits and a little punctuation.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/render/image.h"

#include <string_view>

namespace sinew::render {

/// Size in pixels of `text` at this whole-number scale.
int text_width(std::string_view text, int scale);
int text_height(int scale);
/// Writes `text` with its top left corner at (x, y). Small letters are shown as capitals, unknown ones as a
/// box.
void draw_text(Image& image, int x, int y, std::string_view text, Pixel colour, int scale);

} // namespace sinew::render
