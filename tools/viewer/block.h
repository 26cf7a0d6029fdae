// Arrays as the page carries them: differences, bytes sorted by significance, deflate. Smooth data becomes
// mostly zeros this way; nothing is lost. page/src/blocks.js is the other side.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::viewer {

struct Block {
    std::string element;    ///< "u8", "u16", "u32", "f32"
    std::size_t length = 0; ///< elements
    int order = 0;          ///< how often differences were taken
    std::size_t stride = 1; ///< between which elements
    std::string deflated;   ///< zlib stream
};

/// Differences x[i] - x[i - stride], wrapping around, taken `order` times.
Block pack(std::span<const std::uint8_t> values, int order = 0, std::size_t stride = 1);
Block pack(std::span<const std::uint16_t> values, int order = 0, std::size_t stride = 1);
Block pack(std::span<const std::uint32_t> values, int order = 0, std::size_t stride = 1);
Block pack(std::span<const float> values);

std::vector<std::uint16_t> unpack_u16(const Block& block);
std::vector<std::uint32_t> unpack_u32(const Block& block);
std::vector<float> unpack_f32(const Block& block);

/// Grid of 65,536 steps an axis over a box. A point is off by half a step an axis at most: 7.6e-6 of the box.
struct Grid {
    std::array<float, 3> origin{};
    std::array<float, 3> step{1, 1, 1};
    std::uint16_t to_grid(float value, std::size_t axis) const;
    float from_grid(std::uint16_t value, std::size_t axis) const {
        return origin[axis] + step[axis] * static_cast<float>(value);
    }
};
/// Around all finite points of all frames (x, y, z after each other).
Grid grid_around(std::span<const std::vector<float>* const> frames);

/// Frames that share a grid: from `first` up to the next run of frames.
struct GridSpan {
    std::size_t first = 0;
    Grid grid;
};
/// A new grid begins where the old one would grow beyond four times the longest side of any of its frames: a
/// frame that flies apart does not coarsen the others, and each is within 6e-5 of its own longest side.
/// Frames of another length than `numbers` take part in none.
std::vector<GridSpan> grids_along(std::span<const std::vector<float>> frames, std::size_t numbers);

std::string base64(std::string_view bytes);

} // namespace sinew::viewer
