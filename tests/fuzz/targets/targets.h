// What reads bytes that others wrote, each as a function of bytes alone: libFuzzer calls it, and so do the tests with
// what was found. A target returns for whatever is refused with a diagnostic; a promise that is broken is a
// std::logic_error.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::fuzz {

struct Target {
    std::string_view name;
    void (*run)(std::string_view bytes);
};

std::span<const Target> all_targets();
const Target* find_target(std::string_view name); ///< nullptr if there is none

// One source a room of readers.
void read_graph_text(std::string_view bytes);
void read_included_graphs(std::string_view bytes);
void read_surface_as(std::string_view bytes, const std::string& file);
void read_tets_as(std::string_view bytes, const std::string& file);
void read_tetgen_files(std::string_view bytes);
void read_glb_file(std::string_view bytes);
void read_point_cache_as(std::string_view bytes, const std::string& file);
void read_motion(std::string_view bytes);
void read_curve_file(std::string_view bytes);
void read_painted_map(std::string_view bytes);
void read_kept_value(std::string_view bytes);
void read_kept_frame(std::string_view bytes);
void read_kept_rows(std::string_view bytes);
void read_saved_state(std::string_view bytes);

/// Inputs of several files: what stands before each line "%%%%" is one of them.
std::vector<std::string_view> files_in(std::string_view bytes);

} // namespace sinew::fuzz
