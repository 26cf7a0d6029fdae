// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/collect.h"

#include "engine/eval/state_file.h"
#include "nodes/simulation_state.h"
#include "tools/cli/names_apart.h"
#include "tools/cli/open_graph.h"
#include "tools/viewer/faults.h"
#include "tools/viewer/flesh.h"
#include "tools/viewer/overlays.h"
#include "tools/viewer/read_report.h"
#include "tools/viewer/recorder.h"

#include <chrono>
#include <set>

namespace sinew::viewer {

using engine::Plug;
using engine::Value;

namespace {

bool is_solver_meshes(const engine::Graph& graph, const Plug& plug) {
    return plug.attribute == "outMeshes" && graph.find(plug.node)->type_name == "zSolver";
}

/// A node whose meshes are shown, and what of the scene it fills.
struct Source {
    Plug meshes;
    bool is_solver = false;
    std::vector<std::string> nodes;  ///< of its bodies
    std::vector<std::size_t> bodies; ///< in the scene
    std::vector<std::size_t> solved; ///< of those that take part: positions in `bodies`
};

class Collector {
  public:
    explicit Collector(Evaluation e)
        : e_(std::move(e)) {
        const engine::Graph& graph = *e_.graph;
        scene_.source = graph.file();
        scene_.is_evaluated = true;
        scene_.title = std::filesystem::path(graph.file()).stem().string();
        scene_.fps = graph.timing().fps;
        scene_.graph = layout_graph(graph);
        std::vector<Plug> shown = e_.shown;
        if (shown.empty())
            for (const std::string& name : shown_nodes(graph)) shown.push_back({name, "outMeshes"});
        std::vector<std::string> nodes;
        for (const Plug& plug : shown) nodes.push_back(plug.node);
        const cli::SceneAxes axes = cli::scene_axes(graph, cli::upstream_of(graph, nodes));
        scene_.units_per_metre = axes.units_per_metre, scene_.up = axes.up;
        for (Plug& plug : shown) {
            const bool is_solver = is_solver_meshes(graph, plug);
            sources_.push_back({std::move(plug), is_solver, {}, {}, {}});
        }
        if (sources_.empty())
            scene_.notes.push_back(
                {true, "The graph has neither a zSolver nor a zEmbedder, so there are no bodies to show."});
    }

    void add(int frame) {
        if (has_ended_) return;
        try {
            add_frame(frame);
        } catch (const engine::Failure& failure) {
            if (scene_.frames.empty() || !e_.keeps_frames) throw;
            const engine::Diagnostic& d = failure.diagnostics().front();
            end({frame, d.code, d.node, d.message});
        } catch (const engine::Cancelled& cancelled) {
            if (scene_.frames.empty() || !e_.keeps_frames) throw;
            end({frame, "", "", cancelled.what()});
        }
    }

    bool has_ended() const { return has_ended_; }

    std::vector<GraphCollector::Place> look(int frame) {
        stop_ = e_.stop;
        std::vector<GraphCollector::Place> out;
        std::set<std::string> taken;
        for (const Source& source : sources_) {
            const std::vector<nodes::Mesh> meshes = cli::meshes_in(pull(source.meshes, frame));
            const std::vector<std::string> names = names_of(source, meshes.size(), taken);
            for (std::size_t i = 0; i < meshes.size(); ++i) out.push_back({names[i], meshes[i].points});
        }
        return out;
    }

    ViewScene finish() {
        for (BodyRecorder& recorder : recorders_) {
            scene_.bodies.push_back(recorder.finish(scene_.notes));
            keep_to_flesh(scene_.bodies.back(), e_.memory.get());
        }
        find_faults(scene_);
        return std::move(scene_);
    }

  private:
    void end(const cli::RunError& why) {
        scene_.notes.push_back({true, ended_early(why)});
        has_ended_ = true;
    }

    Value pull(const Plug& plug, int frame) const {
        return e_.evaluator->pull({e_.graph, plug, static_cast<double>(frame), stop_});
    }

    void add_frame(int frame) {
        using Clock = std::chrono::steady_clock;
        if (e_.begin_frame) e_.begin_frame(frame);
        stop_ = e_.stop;
        const auto start = Clock::now();
        std::vector<std::vector<nodes::Mesh>> meshes;
        for (const Source& source : sources_) meshes.push_back(cli::meshes_in(pull(source.meshes, frame)));
        ViewFrame view{.frame = frame};
        view.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
        view.reused = e_.was_stepped && !e_.was_stepped(frame);
        for (const Source& source : sources_)
            if (source.is_solver && !view.step)
                view.step = pull({source.meshes.node, "outReport"}, frame).as<nodes::SolveReport>().record;
        std::vector<Value> marks;
        for (const Source& source : sources_)
            marks.push_back(source.is_solver && e_.with_lattices ? pull({source.meshes.node, "outMarks"}, frame)
                                                                 : Value());
        // All that can fail has been computed now, so a frame is added whole or not at all.
        stop_ = {};
        if (scene_.frames.empty())
            for (std::size_t i = 0; i < sources_.size(); ++i) begin(sources_[i], meshes[i], frame);
        for (std::size_t i = 0; i < sources_.size(); ++i) record(sources_[i], meshes[i], frame);
        for (std::size_t i = 0; i < sources_.size(); ++i)
            if (marks[i]) add_marks(marks[i].as<nodes::MarkList>(), sources_[i].bodies, view.marks);
        scene_.frames.push_back(view);
        if (e_.end_frame) e_.end_frame(view);
    }

    /// At the first frame: bodies, tets, fibres, attachments, painted maps.
    void begin(Source& source, const std::vector<nodes::Mesh>& meshes, int frame) {
        const engine::Graph& graph = *e_.graph;
        const auto labels = cli::body_labels(graph, source.meshes, meshes.size());
        const std::vector<std::string> names = names_of(source, meshes.size(), names_);
        source.nodes = given_to(source);
        source.nodes.resize(meshes.size(), source.meshes.node);
        for (std::size_t i = 0; i < meshes.size(); ++i) {
            source.bodies.push_back(recorders_.size());
            recorders_.emplace_back(names[i], source.nodes[i], labels[i].kind, static_cast<int>(recorders_.size()),
                                    labels[i].appearance);
            recorders_.back().set_rest(meshes[i].surface());
        }
        if (source.is_solver) begin_solver(source, frame);
    }

    void begin_solver(Source& source, int frame) {
        const engine::Graph& graph = *e_.graph;
        const Puller at_start = [&](const Plug& plug) { return pull(plug, frame); };
        const std::vector<Plug> plugs = connections(graph, source.meshes.node, "bodies");
        const auto solved = pull({source.meshes.node, "outSolved"}, frame);
        for (std::size_t i = 0; i < plugs.size() && i < source.bodies.size(); ++i) {
            const Value value = at_start(plugs[i]);
            const auto& body = value.as<nodes::Body>();
            // A solver that is switched off solves nothing, and then there are no tets to show.
            if (!body.takes_part || solved.as<nodes::Solved>().rests.empty()) continue;
            source.solved.push_back(i);
            const auto* tissue = std::get_if<std::shared_ptr<const solver::TissueRest>>(&body.rest->data);
            if (!tissue) continue;
            BodyRecorder& recorder = recorders_[source.bodies[i]];
            recorder.set_rest(body.rest->mesh.surface());
            if (!e_.with_lattices || body.subtissue) continue; // a subtissue has no tets of its own to show
            recorder.set_lattice((*tissue)->tets, (*tissue)->embedding);
            recorder.body().fibres = fibres_of(graph, plugs[i].node, **tissue);
        }
        for (std::size_t i = 0; i < plugs.size() && i < source.bodies.size(); ++i)
            recorders_[source.bodies[i]].body().maps = maps_of(graph, plugs[i].node, at_start);
        begin_attachments(source, solved.as<nodes::Solved>(), frame);
    }

    void begin_attachments(const Source& source, const nodes::Solved& solved, int frame) {
        if (source.solved.empty() || !e_.with_lattices) return;
        const std::vector<std::byte> saved =
            e_.evaluator->save_state({e_.graph, source.meshes, static_cast<double>(frame), stop_});
        // The engine's header stands before the node's own bytes.
        const engine::NodeType& type = *e_.graph->find(source.meshes.node)->type;
        const std::size_t header = engine::wrap_state(type, {}, {}).size();
        const nodes::SimulationState state = nodes::load_simulation(std::span(saved).subspan(header));
        const std::vector<ActingAttachment> acting = acting_attachments(
            *e_.graph, source.meshes.node, solved, [&](const Plug& plug) { return pull(plug, frame); });
        const solver::AttachmentView attachments = solver::attachments_kept(state.state.memories);
        for (std::size_t a = 0; a < attachments.anchors.size() && a < state.scene.links.size(); ++a) {
            // What slides or is off has no places to draw lines to; marks show where it slides.
            if (a < acting.size() && !acting[a].holds) continue;
            const auto [from, to] = state.scene.links[a];
            if (static_cast<std::size_t>(std::max(from, to)) >= source.solved.size()) continue;
            ViewAttachment view = attachment_of(attachments.anchors[a], *solved.rests[static_cast<std::size_t>(from)],
                                                *solved.rests[static_cast<std::size_t>(to)], scene_.units_per_metre);
            view.node = a < acting.size() ? acting[a].node : "";
            // The lines end in tets, which are those of the tissue that a subtissue is a part of.
            const auto tets_of = [&](int body) {
                return source.solved[static_cast<std::size_t>(solved.carriers[static_cast<std::size_t>(body)])];
            };
            view.source = static_cast<int>(source.bodies[tets_of(from)]);
            view.target = static_cast<int>(source.bodies[tets_of(to)]);
            scene_.attachments.push_back(std::move(view));
        }
    }

    void record(const Source& source, const std::vector<nodes::Mesh>& meshes, int frame) {
        for (std::size_t i = 0; i < source.bodies.size(); ++i) {
            BodyRecorder& recorder = recorders_[source.bodies[i]];
            if (i < meshes.size())
                recorder.add_points(frame, *meshes[i].points);
            else
                recorder.add_missing(frame);
        }
        if (!source.is_solver || !e_.with_lattices) return;
        const Value value = pull({source.meshes.node, "outSolved"}, frame);
        const auto& solved = value.as<nodes::Solved>();
        const Value report = pull({source.meshes.node, "outReport"}, frame);
        for (std::size_t i = 0; i < source.solved.size(); ++i) {
            BodyRecorder& recorder = recorders_[source.bodies[source.solved[i]]];
            if (!recorder.body().lattice) continue;
            recorder.add_tets(solved.positions.at(i));
            add_excitation(source.nodes[source.solved[i]], static_cast<int>(source.solved[i]),
                           report.as<nodes::SolveReport>(), recorder.body(), frame);
        }
    }

    /// \param place of the tissue in zSolver.bodies
    void add_excitation(const std::string& node, int place, const nodes::SolveReport& report, ViewBody& body,
                        int frame) {
        if (body.fibres.empty()) return;
        const Value value = pull({node, "outBody"}, frame);
        auto inputs = std::get<solver::TissueInputs>(value.as<nodes::Body>().values);
        for (const nodes::LineReport& line : report.lines) // what a line of action adds is known to the solver alone
            if (line.body == place) inputs.fibers[static_cast<std::size_t>(line.fiber)].excitation = line.excitation;
        for (std::size_t i = 0; i < body.fibres.size(); ++i)
            body.fibres[i].excitation.push_back(
                static_cast<float>(inputs.fibers[i].excitation * inputs.fibers[i].envelope));
    }

    /// The nodes wired to a solver's bodies.
    std::vector<std::string> given_to(const Source& source) const {
        std::vector<std::string> out;
        if (source.is_solver)
            for (const Plug& plug : connections(*e_.graph, source.meshes.node, "bodies")) out.push_back(plug.node);
        return out;
    }

    /// What `count` bodies of a source are called, as in a run's files. Nodes keep their names; files have others where
    /// a file cannot be called so.
    /// \param taken by other sources
    std::vector<std::string> names_of(const Source& source, std::size_t count, std::set<std::string>& taken) const {
        std::vector<std::string> out = given_to(source);
        if (!source.is_solver || out.size() != count) {
            out.clear();
            for (const auto& label : cli::body_labels(*e_.graph, source.meshes, count)) out.push_back(label.name);
        }
        cli::tell_apart(out, source.meshes.node,
                        [&](const std::string& name, std::size_t) { return taken.insert(name).second; });
        return out;
    }

    const Evaluation e_;
    bool has_ended_ = false; ///< by a frame that failed
    std::stop_token stop_;
    ViewScene scene_;
    std::vector<Source> sources_;
    std::vector<BodyRecorder> recorders_;
    std::set<std::string> names_;
};

} // namespace

std::vector<std::string> shown_nodes(const engine::Graph& graph) {
    std::vector<std::string> out;
    for (const std::string& name : graph.node_names()) {
        const engine::Node& node = *graph.find(name);
        if (node.type && (node.type_name == "zSolver" || node.type_name == "zEmbedder")) out.push_back(name);
    }
    return out;
}

std::vector<std::string> solver_body_names(const engine::Graph& graph, const Plug& meshes) {
    if (!is_solver_meshes(graph, meshes)) return {};
    std::vector<std::string> out;
    for (const Plug& plug : connections(graph, meshes.node, "bodies")) out.push_back(plug.node);
    return out;
}

ViewScene collect_graph(const Evaluation& evaluation) {
    Collector collector(evaluation);
    for (const int frame : evaluation.frames)
        if (!collector.has_ended()) collector.add(frame);
    return collector.finish();
}

struct GraphCollector::Impl {
    Collector collector;
};

GraphCollector::GraphCollector(Evaluation evaluation)
    : impl_(std::make_unique<Impl>(Impl{Collector(std::move(evaluation))})) {}
GraphCollector::~GraphCollector() = default;
void GraphCollector::add(int frame) { impl_->collector.add(frame); }
ViewScene GraphCollector::so_far() const { return Collector(impl_->collector).finish(); }
std::vector<GraphCollector::Place> GraphCollector::look(int frame) { return impl_->collector.look(frame); }
ViewScene GraphCollector::finish() { return impl_->collector.finish(); }

} // namespace sinew::viewer
