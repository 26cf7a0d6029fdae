// Mesh sequences on disk: DIR/obj/biceps.0001.obj. Each OBJ says in its first line what body it is, so that a
// folder of them is enough to draw the scene.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"
#include "tools/cli/open_graph.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace sinew::cli {

/// "biceps.0001.obj"; negative frames keep their sign.
std::string frame_file_name(const std::string& name, int frame, const std::string& ending);

/// Writes one body of one frame as "obj" or "ply" below `folder`.
void write_body(const std::filesystem::path& folder, const std::string& format, const BodyLabel& label,
                const nodes::Mesh& mesh, int frame, const SceneAxes& axes, const engine::FileAccess& files = {});

/// An OBJ sequence that write_body made (or any NAME.FRAME.obj files).
struct BodySequence {
    BodyLabel label;
    std::map<int, std::filesystem::path> files; ///< by frame
};

struct SequenceFolder {
    std::vector<BodySequence> bodies; ///< by name
    std::set<int> frames;
    char up = 'y';
};

/// Looks in `folder` and in `folder`/obj. Empty if there are no sequences.
SequenceFolder find_sequences(const std::filesystem::path& folder);

} // namespace sinew::cli
