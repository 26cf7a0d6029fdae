// Fills a ViewScene: from a graph, by evaluating its frames, or from a folder that `sinew run` wrote.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "tools/viewer/flesh.h"
#include "tools/viewer/view_data.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

namespace sinew::viewer {

/// Who evaluates, and who wants to know how far it is.
struct Evaluation {
    std::shared_ptr<const engine::Graph> graph;
    engine::Evaluator* evaluator = nullptr;
    std::vector<int> frames; ///< rising
    std::stop_token stop = {};
    std::function<void(int frame)> begin_frame = {};
    std::function<bool(int frame)> was_stepped = {}; ///< false = the frame was found ready
    std::function<void(const ViewFrame&)> end_frame = {};
    std::vector<engine::Plug> shown = {}; ///< whose meshes; empty = outMeshes of shown_nodes
    bool keeps_frames = true;             ///< a later frame that fails ends the run with a note; without, it throws
    bool with_lattices = true;            ///< without: smaller, but no tets, fibres, marks and heat maps
    std::shared_ptr<FleshMemory> memory = std::make_shared<FleshMemory>(); ///< of one run unless it is shared
};

/// The nodes whose meshes are shown: all zSolvers and zEmbedders, in file order.
std::vector<std::string> shown_nodes(const engine::Graph& graph);

/// What the bodies of a zSolver's outMeshes will be called, which is known before anything is computed; empty for any
/// other plug.
std::vector<std::string> solver_body_names(const engine::Graph& graph, const engine::Plug& meshes);

/// A frame that fails ends the collection: the frames before it are kept and a note says why. Throws Failure
/// if not even the first frame works (any frame, without `keeps_frames`), and Cancelled.
ViewScene collect_graph(const Evaluation& evaluation);

/// The same frame by frame, while a run goes; `frames` is not read.
class GraphCollector {
  public:
    explicit GraphCollector(Evaluation evaluation);
    ~GraphCollector();
    /// Frames rise. Nothing is added any more after a frame that failed.
    void add(int frame);
    /// What has been added up to now; more may be added.
    ViewScene so_far() const;
    struct Place {
        std::string body;
        std::shared_ptr<const solver::Points> points; ///< scene units
    };
    /// Where the bodies are in a frame, which need not have been added.
    std::vector<Place> look(int frame);
    ViewScene finish();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// OBJ sequences in `folder`, its report and its graph if there are any. Never throws for what is missing or
/// unreadable: notes say it, and what is there is shown.
/// \param frames empty = all
ViewScene collect_folder(const std::filesystem::path& folder, const std::vector<int>& frames = {});

} // namespace sinew::viewer
