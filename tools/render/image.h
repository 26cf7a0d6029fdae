// Pictures in memory and as PNG files. Rows run from top to bottom, three bytes a pixel (sRGB).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::render {

using Pixel = std::array<std::uint8_t, 3>;

struct Image {
    int width = 0, height = 0;
    std::vector<Pixel> pixels;

    Image(int w, int h, Pixel fill = {0, 0, 0});
    Pixel& at(int x, int y) { return pixels[index(x, y)]; }
    const Pixel& at(int x, int y) const { return pixels[index(x, y)]; }

  private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

/// Copies `part` into `whole` with its top left corner at (x, y); what hangs over is cut off.
void paste(Image& whole, const Image& part, int x, int y);

/// The bytes of a PNG file. Throws std::runtime_error if libpng refuses.
std::string encode_png(const Image& image);

} // namespace sinew::render
