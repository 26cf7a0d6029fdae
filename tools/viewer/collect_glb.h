// Reads back the animated GLB that `sinew run` writes by default, so that a plain output folder can be
// viewed.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/viewer/view_data.h"

#include <filesystem>
#include <memory>
#include <set>

namespace sinew::viewer {

/// The newest GLB in `folder`, or an empty path.
std::filesystem::path find_glb(const std::filesystem::path& folder);

struct GlbFrames {
    std::set<int> numbers;
    double fps = 24, units_per_metre = 1;
    char up = 'y';
};

/// Bodies and frames of one file. Numbers of vertices are those of the file, welded where several lie on one
/// spot in every frame; polygons are triangles.
class GlbRun {
  public:
    /// Throws std::runtime_error with the reason if the file cannot be read.
    explicit GlbRun(const std::filesystem::path& file);
    ~GlbRun();
    const GlbFrames& frames() const;
    /// The bodies at `chosen` frames, all of them in frames().numbers.
    std::vector<ViewBody> bodies(const std::vector<int>& chosen, std::vector<ViewNote>& notes) const;

  private:
    struct Content;
    std::unique_ptr<Content> content_;
};

} // namespace sinew::viewer
