// From words on the command line to a graph, its plugs and what else of it the program needs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "nodes/values.h"
#include "tools/cli/arguments.h"
#include "tools/embed/graph_walk.h"
#include "tools/render/look.h"

#include <memory>
#include <string>
#include <vector>

namespace sinew::cli {

struct OpenGraph {
    std::shared_ptr<const engine::Graph> graph;
    std::vector<engine::Diagnostic> notes; ///< warnings of the reader
};

/// Confines what graphs and options name to a folder.
inline constexpr Flag root_flag{"--root", "DIR",
                                "open and write files only in this folder: graph, includes, meshes, motion, outputs, "
                                "cache; neither .., absolute paths nor links lead out of it"};
/// By --root. Throws UsageError, Failure IO411.
engine::FileAccess file_access(const Arguments& arguments);

/// The GRAPH operand, edited by every --set NODE.ATTR=JSON. A value that is no JSON is taken as text, so that
/// `--set biceps.material=NeoHookean` needs no quotes. Throws Failure or UsageError.
OpenGraph open_graph(const Arguments& arguments);
/// The same for another file than the first operand.
OpenGraph open_graph(const Arguments& arguments, const std::string& file);
/// No file, or text that begins as JSON does.
bool may_be_graph(const std::string& file);
/// Of commands that take a graph file or the folder of a run: throws Failure IO401 if there is nothing of that name.
/// Where files are confined, graphs alone are taken, and open_graph says it.
void check_source(const std::filesystem::path& source, const engine::FileAccess& files);
/// Of `file` as it is.
OpenGraph open_graph(const std::string& file, const engine::FileAccess& files = {});

/// For commands that evaluate.
inline constexpr Flag cache_flag{
    "--cache", "DIR",
    "where simulated frames are kept, and the tets of nodes with cacheTetMesh, for later runs; default: beside the "
    "graph, NAME.sinew-cache"};
inline constexpr Flag no_cache_flag{"--no-cache", "", "neither read nor keep anything on disk"};
inline constexpr Flag cache_size_flag{
    "--cache-size", "SIZE",
    "most that is kept there, for example \"20 GB\"; default: 10 GB. What was not used for "
    "longest goes first"};

inline constexpr Flag memory_flag{"--memory", "SIZE",
                                  "most memory for results that are kept, for example 500MB or \"2 GB\"; default: a "
                                  "quarter of the machine's. What is at work comes on top"};

/// Bytes of --memory. Throws UsageError for what is no size, below 1 MB or more than the machine has.
std::size_t memory_budget(const Arguments& arguments);

/// Where results are kept, and how many of them (--memory): in the folder of --cache, else beside the graph file in
/// NAME.sinew-cache, which is made when a node first asks for it. Throws UsageError if both flags are given.
engine::StorePolicy store_policy(const Arguments& arguments, const engine::Graph& graph);
/// The same for a graph file that may not be readable yet.
engine::StorePolicy store_policy(const Arguments& arguments, const std::string& file);

/// "node.output" of this graph. Throws UsageError with the nearest name.
engine::Plug parse_plug(const engine::Graph& graph, const std::string& text);

/// The plug that `run` and `snapshot` pull when none is named: the only zSolver's outMeshes.
engine::Plug default_plug(const engine::Graph& graph);

using embed::connected;
using embed::simulations;
using embed::upstream_of;

/// A frame at which nothing among `nodes` has been stepped yet: the first start frame of their simulations,
/// or the graph's.
int start_frame(const engine::Graph& graph, const std::vector<std::string>& nodes);

/// How the scene's numbers are to be read, from the first solver among `nodes`.
struct SceneAxes {
    double units_per_metre = 1;
    char up = 'y'; ///< the axis against gravity: 'y' or 'z'
};
SceneAxes scene_axes(const engine::Graph& graph, const std::vector<std::string>& nodes);

struct BodyLabel {
    std::string name; ///< unique, and fit for a file name
    render::BodyKind kind = render::BodyKind::plain;
    render::Appearance appearance = {};
};

/// The node's name with everything that a file name had better not hold replaced by '_', at most 200 letters: what is
/// longer is cut and ends with a hash of the name.
std::string file_name(const std::string& node);

/// Names, kinds and looks for the `count` meshes that `plug` gives: the nodes connected to the list that the node
/// works on (zSolver.bodies, zEmbedder.meshes), or the node's own name.
std::vector<BodyLabel> body_labels(const engine::Graph& graph, const engine::Plug& plug, std::size_t count);

/// The meshes in a value: one, several or none.
std::vector<nodes::Mesh> meshes_in(const engine::Value& value);

} // namespace sinew::cli
