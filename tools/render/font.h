// A font of strokes for labels in pictures: printable ASCII at any size, with smooth edges. Drawn for Sinew.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/render/image.h"

#include <string_view>

namespace sinew::render {

/// Width in pixels of `text` (UTF-8) where capitals are `size` pixels tall; strokes included.
double text_width(std::string_view text, double size);
/// Mixes `text` into the image; the top left corner of its first capital is at (x, y). Tails of letters hang `size` *
/// 0.3 below its line. What the font does not have is a box. What hangs over the image is cut off.
void draw_text(Image& image, double x, double y, std::string_view text, Pixel colour, double size);

} // namespace sinew::render
