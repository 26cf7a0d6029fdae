// What all new graphs have: the file's first comment, meshes with their wraps, bones with their motion.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/rig/graph_text.h"
#include "tools/rig/guess.h"
#include "tools/rig/motion.h"

#include <optional>
#include <string>

namespace sinew::rig {

constexpr int graph_fps = 24;

struct TextOptions {
    std::string folder;  ///< of the graph file: paths are written from there
    std::string made_by; ///< the command line, for the first comment
    std::optional<Motion> motion;
    std::optional<int> end; ///< last frame; none: that of the motion, or 24
};

/// "3.2 cm"
std::string length_text(const Rig& rig, double value);
/// Made by what, in which unit, and what is not sure.
std::string head_text(const Rig& rig, const TextOptions& options);
int last_frame(const TextOptions& options);
/// NAMEMesh.outMesh: the mesh as it is simulated.
void write_mesh(GraphText& text, const Rig& rig, const Part& part, const TextOptions& options);
/// The same, and the bone NAME on it, with its motion; `more` are further inputs of zBone.
void write_bone(GraphText& text, const Rig& rig, const Part& part, const TextOptions& options, const Inputs& more = {});
/// Adds to a solver's inputs what the scene's unit and way up ask for.
void add_space(Inputs& inputs, const Rig& rig);

} // namespace sinew::rig
