// Recorded motion: matrices of bones and numbers by frame, from a JSON file of the kind
// {"fps": 24, "frames": [{"frame": 1, "elbow_flexion_deg": 0.5, "bones": {"ulna": [16 numbers, row-major]}}, …]}.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/file_access.h"
#include "engine/value.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::nodes {

/// What a file of motion of bones looks like, for hints.
inline constexpr const char* motion_form =
    R"({"frames": [{"frame": 1, "bones": {"ulna": [16 numbers]}}, …]} is meant.)";

/// Samples sorted by frame; before the first and after the last the motion stands still.
struct MatrixTrack {
    std::vector<double> frames;
    std::vector<engine::Matrix4> matrices;
    std::optional<double> fps; ///< that the file says it was recorded at; no step reads it
    /// The sample itself at a sample's frame and between two equal samples. In between, the rotation turns by
    /// slerp about the axis of the screw that joins the samples (so a hinge stays a hinge, wherever the
    /// origin lies), and stretch changes linearly; without rotation the translation is linear.
    engine::Matrix4 at(double frame) const;
};

struct NumberTrack {
    std::vector<double> frames, values;
    std::optional<double> fps;     ///< as above
    double at(double frame) const; ///< linear; exact on flat spans
};

/// Throw solver::Error IO4xx; IO403 also if a frame lacks the bone or the channel.
MatrixTrack read_matrix_track(const engine::FileAccess& files, const std::string& path, const std::string& bone);
NumberTrack read_number_track(const engine::FileAccess& files, const std::string& path, const std::string& channel);
/// The same from the bytes of a file; messages name `path`.
MatrixTrack parse_matrix_track(std::string_view text, const std::string& path, const std::string& bone);
NumberTrack parse_number_track(std::string_view text, const std::string& path, const std::string& channel);

/// Where a graph frame lies on a track that runs `rate` track frames per graph frame; graph frame 1 shows
/// track frame 1 + offset.
double track_frame(double graph_frame, double offset, double rate);

} // namespace sinew::nodes
