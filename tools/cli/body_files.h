// Mesh sequences on disk: DIR/obj/biceps.0001.obj. Each OBJ says in its first line what body it is, so that a
// folder of them is enough to draw the scene.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"
#include "tools/cli/open_graph.h"

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sinew::cli {

/// "biceps.0001.obj"; negative frames keep their sign.
std::string frame_file_name(const std::string& name, int frame, const std::string& ending);

/// Writes one body of one frame as "obj" or "ply" below `folder`.
/// \param run what run_mark gives, or nothing; in OBJ alone
void write_body(const std::filesystem::path& folder, const std::string& format, const BodyLabel& label,
                const nodes::Mesh& mesh, int frame, const SceneAxes& axes, const std::string& run = {},
                const engine::FileAccess& files = {});

/// A short text that runs of one graph have alike, whatever frames of it they run: of its nodes and values, not of the
/// files that these name, nor of its last frame.
std::string run_mark(const engine::Graph& graph);
/// The one in an OBJ that write_body made; empty if there is none.
std::string read_run_mark(const std::filesystem::path& obj);
/// "biceps.0001.obj" -> (biceps, 1), for files of this ending.
std::optional<std::pair<std::string, int>> parse_frame_file(const std::filesystem::path& file,
                                                            const std::string& ending);

/// An OBJ sequence that write_body made (or any NAME.FRAME.obj files).
struct BodySequence {
    BodyLabel label;
    std::map<int, std::filesystem::path> files; ///< by frame
};

struct SequenceFolder {
    std::vector<BodySequence> bodies; ///< by name
    std::set<int> frames;
    char up = 'y';
    std::vector<std::filesystem::path> no_files; ///< called as frames are, but pipes, devices or links to nowhere
};

/// Looks in `folder` and in `folder`/obj. Empty if there are no sequences.
SequenceFolder find_sequences(const std::filesystem::path& folder);

} // namespace sinew::cli
