// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/image.h"

#include <algorithm>
#include <png.h>
#include <stdexcept>

namespace sinew::render {

Image::Image(int w, int h, Pixel fill)
    : width(w)
    , height(h)
    , pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}

void paste(Image& whole, const Image& part, int x, int y) {
    const int first = std::max(0, -x), last = std::min(part.width, whole.width - x);
    if (first >= last) return;
    for (int row = std::max(0, -y); row < std::min(part.height, whole.height - y); ++row)
        std::copy_n(&part.at(first, row), last - first, &whole.at(x + first, y + row));
}

std::string encode_png(const Image& image) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width);
    header.height = static_cast<png_uint_32>(image.height);
    header.format = PNG_FORMAT_RGB;
    // An upper bound of the size, so that the picture is compressed once and not once more to measure it.
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
    std::string bytes(size, '\0');
    if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr))
        throw std::runtime_error(std::string("PNG: ") + header.message);
    bytes.resize(size);
    return bytes;
}

} // namespace sinew::render
