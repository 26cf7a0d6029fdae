// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/point_cache.h"

#include "solver/error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>

namespace sinew::solver {

namespace {

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

/// Four bytes of the file as a number; the machine is little-endian.
template <class T>
T number_at(const std::string& bytes, std::size_t at, bool big_endian) {
    std::array<char, 4> raw;
    std::memcpy(raw.data(), bytes.data() + at, 4);
    if (big_endian) std::reverse(raw.begin(), raw.end());
    T out;
    static_assert(sizeof out == 4);
    std::memcpy(&out, raw.data(), 4);
    return out;
}

/// Points of all samples; a file of so many would take a hundred terabytes.
constexpr std::size_t most_numbers = std::size_t{1} << 43;

[[noreturn]] void refuse(const std::string& path, const std::string& what, const char* hint) {
    throw Error("IO403", path + ": " + what, hint);
}

std::size_t count_at(const std::string& bytes, std::size_t at, bool big_endian, const std::string& path,
                     const char* of_what) {
    const auto n = number_at<std::int32_t>(bytes, at, big_endian);
    if (n < 1)
        refuse(path, "byte " + std::to_string(at) + " says that there are " + std::to_string(n) + " " + of_what,
               "Write the cache again.");
    return static_cast<std::size_t>(n);
}

} // namespace

bool is_point_cache(const std::string& path) {
    const std::string ending = ending_of(path);
    return ending == ".pc2" || ending == ".mdd";
}

PointCache PointCache::parse(std::string bytes, const std::string& path) {
    PointCache out;
    out.path_ = path;
    const std::string ending = ending_of(path);
    if (!is_point_cache(path)) throw Error("IO404", path + ": '" + ending + "' is no point cache", "use .pc2 or .mdd");
    out.swapped_ = ending == ".mdd";
    const std::size_t header = out.swapped_ ? 8 : 32;
    if (bytes.size() < header)
        refuse(path, "it ends within its first " + std::to_string(header) + " bytes", "Write the cache again.");
    if (out.swapped_) {
        out.samples = count_at(bytes, 0, true, path, "frames");
        out.points = count_at(bytes, 4, true, path, "points");
        out.data_ = header + 4 * out.samples; // their times come first
    } else {
        constexpr std::string_view mark("POINTCACHE2\0", 12);
        if (std::string_view(bytes).substr(0, mark.size()) != mark)
            refuse(path, "it does not begin with POINTCACHE2", "Write a PC2 file, or give it the ending of its kind.");
        out.points = count_at(bytes, 16, false, path, "points");
        out.first_frame = number_at<float>(bytes, 20, false);
        out.frames_apart = number_at<float>(bytes, 24, false);
        out.samples = count_at(bytes, 28, false, path, "samples");
        if (!std::isfinite(out.first_frame) || !(out.frames_apart > 0) || !std::isfinite(out.frames_apart))
            refuse(path, "its start frame and sampling rate are no frames", "Write the cache again.");
        out.data_ = header;
    }
    // Points and samples are below 2^31 each; twelve bytes for each of both are more than 64 bits can say.
    const bool is_beyond = out.points * out.samples > most_numbers;
    const std::size_t wanted = is_beyond ? 0 : out.data_ + 12 * out.points * out.samples;
    if (is_beyond || bytes.size() != wanted)
        refuse(path,
               std::string(is_beyond || bytes.size() < wanted ? "it is cut off: " : "it is too long: ") +
                   std::to_string(out.samples) + " samples of " + std::to_string(out.points) + " points take " +
                   (is_beyond ? "far more" : std::to_string(wanted)) + " bytes, and it has " +
                   std::to_string(bytes.size()),
               "Write the cache again.");
    for (std::size_t k = 0; out.swapped_ && k < out.samples; ++k) {
        out.seconds.push_back(number_at<float>(bytes, header + 4 * k, true));
        if (!std::isfinite(out.seconds.back()) || (k > 0 && !(out.seconds[k] > out.seconds[k - 1])))
            refuse(path, "the time of sample " + std::to_string(k + 1) + " does not follow the one before",
                   "Write the cache again.");
    }
    out.bytes_ = std::move(bytes);
    return out;
}

Points PointCache::at(std::size_t sample) const {
    Points out(points);
    std::size_t byte = data_ + 12 * points * sample;
    for (std::size_t v = 0; v < points; ++v)
        for (int c = 0; c < 3; ++c, byte += 4) {
            out[v][c] = number_at<float>(bytes_, byte, swapped_);
            if (!std::isfinite(out[v][c]))
                throw Error("FE202",
                            path_ + ": vertex " + std::to_string(v) + " of sample " + std::to_string(sample + 1) +
                                " is not a finite number",
                            "Write the cache again.");
        }
    return out;
}

double PointCache::frame_of(std::size_t sample, double fps) const {
    if (seconds.empty()) return first_frame + static_cast<double>(sample) * frames_apart;
    return 1 + (seconds[sample] - seconds.front()) * fps;
}

} // namespace sinew::solver
