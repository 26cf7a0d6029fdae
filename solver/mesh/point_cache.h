// Point caches: the vertices of one mesh over time, without its faces. PC2 (little-endian, header "POINTCACHE2") and
// MDD (big-endian), as written by modelling programs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::solver {

class PointCache {
  public:
    /// Throws Error IO404 unless the ending is .pc2 or .mdd; IO403 (with the byte) for a header that is none, and for
    /// files that are shorter or longer than it says.
    static PointCache parse(std::string bytes, const std::string& path);

    std::size_t points = 0, samples = 0;
    /// PC2: the frame of the first sample and from one to the next, as the file says.
    double first_frame = 0, frames_apart = 1;
    /// MDD: the time of each sample [s]; empty for PC2.
    std::vector<double> seconds;

    /// Throws Error FE202 (with the vertex) for a place that is no finite number.
    Points at(std::size_t sample) const;
    /// Where sample k is: PC2 as its header says; MDD k frames after frame 1, by its times at `fps`.
    double frame_of(std::size_t sample, double fps) const;

  private:
    std::string bytes_, path_;
    std::size_t data_ = 0; ///< where samples begin
    bool swapped_ = false; ///< big-endian
};

/// ".pc2" and ".mdd"
bool is_point_cache(const std::string& path);

} // namespace sinew::solver
