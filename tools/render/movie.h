// Pictures to an MP4 file, with the ffmpeg that is installed.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/render/image.h"

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>

namespace sinew::render {

/// What ffmpeg or the file system said.
class MovieError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The first ffmpeg in the PATH.
std::optional<std::filesystem::path> find_ffmpeg();

/// Collects pictures as PNG files in a temporary folder, which goes away with the object.
class Movie {
  public:
    Movie(); ///< throws MovieError
    ~Movie();
    Movie(const Movie&) = delete;

    /// All of one size, with even sides. Throws MovieError.
    void add(const Image& picture);
    /// The bytes of an MP4 file (H.264, 4:2:0, which every player knows). Empty if `stop` asked for it.
    /// Throws MovieError.
    std::string encode(const std::filesystem::path& ffmpeg, double fps, std::stop_token stop = {}) const;

  private:
    std::filesystem::path folder_;
    int count_ = 0;
};

} // namespace sinew::render
