// `sinew run`: evaluates a plug frame after frame and writes what it gives.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/json_text.h"
#include "tools/cli/kept_warnings.h"
#include "tools/cli/long_task.h"
#include "tools/cli/motion_range.h"
#include "tools/cli/print.h"
#include "tools/cli/problems.h"
#include "tools/cli/progress.h"
#include "tools/cli/read_files.h"
#include "tools/cli/run_output.h"
#include "tools/cli/unfinished.h"
#include "tools/cli/writable_folder.h"
#include "tools/doubts/doubts.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/recorder.h"
#include "tools/viewer/run_page.h"

#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>
#include <set>
#include <unistd.h>

namespace sinew::cli {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// What the command line asks for.
struct Plan {
    std::shared_ptr<const engine::Graph> graph;
    std::vector<engine::Plug> plugs;
    std::vector<std::string> needed; ///< nodes that the plugs depend on
    std::vector<std::string> solvers;
    std::vector<int> frames;
    fs::path out; ///< empty: nothing is written
    std::set<std::string> formats;
};

std::set<std::string> parse_formats(const Arguments& arguments) {
    const std::vector<std::string> known{"glb", "obj", "ply"};
    std::set<std::string> formats;
    for (const std::string& word : split(arguments.value("--format").value_or("glb"), ',')) {
        if (std::find(known.begin(), known.end(), word) == known.end())
            throw UsageError("unknown format '" + word + "'; known are glb, obj and ply." + did_you_mean(word, known));
        formats.insert(word);
    }
    return formats;
}

Plan make_plan(const Arguments& arguments, const std::shared_ptr<const engine::Graph>& graph) {
    Plan plan;
    plan.graph = graph;
    for (const std::string& text : arguments.values("--pull"))
        if (const engine::Plug plug = parse_plug(*graph, text); std::ranges::find(plan.plugs, plug) == plan.plugs.end())
            plan.plugs.push_back(plug);
    if (plan.plugs.empty()) plan.plugs.push_back(default_plug(*graph));
    std::vector<std::string> pulled;
    for (const engine::Plug& plug : plan.plugs) pulled.push_back(plug.node);
    plan.needed = upstream_of(*graph, pulled);
    plan.solvers = simulations(*graph, plan.needed);
    // The one that no other reads comes first: it is what the report tells of.
    std::vector<std::string> read;
    for (const std::string& solver : plan.solvers)
        for (const std::string& name : upstream_of(*graph, {solver}))
            if (name != solver) read.push_back(name);
    std::stable_partition(plan.solvers.begin(), plan.solvers.end(), [&](const std::string& solver) {
        return std::find(read.begin(), read.end(), solver) == read.end();
    });
    if (const auto text = arguments.value("--frames")) {
        plan.frames = parse_frames(*text);
    } else {
        plan.frames.resize(static_cast<std::size_t>(graph->timing().end - graph->timing().start + 1));
        std::iota(plan.frames.begin(), plan.frames.end(), graph->timing().start);
    }
    std::sort(plan.frames.begin(), plan.frames.end());
    plan.out = arguments.value("--out").value_or("");
    if (plan.out.empty() && arguments.has("--out")) throw UsageError("--out needs the name of a folder.");
    plan.formats = parse_formats(arguments);
    if (plan.out.empty() && arguments.has("--format")) throw UsageError("--format needs --out DIR.");
    if (plan.out.empty() && arguments.has("--open")) throw UsageError("--open needs --out DIR.");
    return plan;
}

ProgressStyle style_of(const Arguments& arguments) {
    if (arguments.has("--json")) return ProgressStyle::json;
    if (arguments.has("--quiet")) return ProgressStyle::quiet;
    return isatty(STDERR_FILENO) && isatty(STDOUT_FILENO) ? ProgressStyle::bar : ProgressStyle::lines;
}

class Run {
  public:
    /// \param notes of the reader
    Run(const Invocation& in, Departure& departure, Plan plan, std::vector<engine::Diagnostic> notes)
        : in_(in)
        , departure_(departure)
        , plan_(std::move(plan))
        , notes_(std::move(notes))
        , json_(in.arguments.has("--json"))
        , progress_(style_of(in.arguments), plan_.graph, static_cast<int>(plan_.frames.size()), in.out, in.err)
        , policy_(store_policy(in.arguments, *plan_.graph))
        , evaluator_(policy_, in.arguments.whole_number("--threads", 0, 1, most_threads), &progress_)
        , output_(plan_.out, plan_.formats, fs::path(plan_.graph->file()).stem().string(), plan_.graph->timing().fps,
                  scene_axes(*plan_.graph, plan_.needed), plan_.frames.size(), run_mark(*plan_.graph),
                  plan_.graph->files()) {
        read_.add(*plan_.graph);
        report_.graph = in.arguments.operand(0).value();
        report_.threads = evaluator_.threads();
        report_.memory_bytes = memory_budget(in.arguments);
        if (!plan_.solvers.empty()) {
            report_.bodies = connected(*plan_.graph, plan_.solvers.front(), "bodies");
            report_.attachments = connected(*plan_.graph, plan_.solvers.front(), "attachments");
        }
        departure_.closes_by([this] { end_early(std::make_exception_ptr(engine::Cancelled())); });
    }
    ~Run() { departure_.forbid(); }
    Run(const Run&) = delete;

    ExitCode operator()() {
        try {
            const engine::FileAccess& files = plan_.graph->files();
            if (!plan_.out.empty()) files.check(plan_.out, "--out");
            if (const auto file = in_.arguments.value("--report")) files.check(*file, "--report");
            if (!plan_.out.empty()) check_could_be_made(plan_.out, "--out");
            if (const auto file = in_.arguments.value("--report")) {
                check_writable_file(*file, "--report");
                read_.check_kept(*file, "--report");
                output_.check_apart(*file, "--report", in_.arguments.has("--open"));
            }
            // All that is wrong at once, before anything is written or simulated. What this computes is kept.
            const KeptWarnings kept(policy_, *plan_.graph, plan_.needed);
            const auto failures = engine::remember_failures();
            std::vector<engine::Diagnostic> problems = std::move(notes_);
            for (auto& d : find_problems(plan_.graph, evaluator_, plan_.needed, in_.stop, failures))
                problems.push_back(std::move(d));
            refuse_unknown_types(problems);
            sort_by_place(problems);
            if (has_error(problems)) throw engine::Failure(std::move(problems));
            for (const engine::Diagnostic& d : problems) progress_.warning(d);
            warn_of_doubts(kept, failures);
            warn_of_timing();
            warn_of_motion();
            if (!plan_.out.empty()) expect_sizes();
            if (!plan_.out.empty()) check_writable(plan_.out, "--out");
            begin_output();
            for (const int frame : plan_.frames) evaluate(frame);
            const auto here = departure_.hold();
            output_.wait(); // the last frame's
        } catch (...) {
            const auto here = departure_.hold();
            end_early(std::current_exception());
            throw;
        }
        departure_.forbid(); // all is there: what follows only writes it
        try {
            close();
        } catch (...) { // the frames are simulated: what they took and how they went is not lost with a file
            end_early(std::current_exception());
            throw;
        }
        if (!plan_.out.empty())
            for (const engine::Diagnostic& d : output_.older_files()) progress_.warning(d);
        report_.wall_s = seconds_since(start_);
        report_.computed = progress_.computed_by_type();
        write_report();
        if (!plan_.out.empty()) mark_finished(plan_.out, mark(), plan_.graph->files());
        progress_.clear();
        print_summary();
        const std::string faults = faults_text(report_);
        if (!in_.arguments.has("--strict") || faults.empty()) return done;
        in_.err << "sinew run: " << faults << " (--strict)\n";
        return solve_failed;
    }

  private:
    UnfinishedRun mark() const {
        if (plan_.frames.empty()) return {report_.graph, 0, 0, 0, report_.error, false};
        return {report_.graph,       plan_.frames.front(),
                plan_.frames.back(), static_cast<int>(plan_.frames.size()),
                report_.error,       false};
    }

    bool is_quiet() const { return json_ || in_.arguments.has("--quiet"); }

    /// What nodes say of themselves, too, which those who find a frame on disk do not evaluate.
    void warn_of_doubts(const KeptWarnings& kept, const std::shared_ptr<engine::Failures>& failures) {
        if (const auto warnings = kept.read()) {
            std::set<std::string> told;
            for (const engine::Diagnostic& d : progress_.warnings()) told.insert(d.code + d.node + d.message);
            for (const engine::Diagnostic& d : *warnings)
                if (!told.contains(d.code + d.node + d.message)) progress_.warning(d);
            return;
        }
        const LongTask task(in_.err, "looking for what is hardly meant", is_quiet());
        for (const engine::Diagnostic& d :
             doubts::find_doubts(plan_.graph, evaluator_, plan_.needed, start_frame(*plan_.graph, plan_.needed),
                                 doubts::Look::in_passing, in_.stop, failures))
            progress_.warning(d);
        kept.keep(progress_.warnings());
    }

    void warn_of_timing() {
        if (const auto doubt = find_timing_doubt(plan_.graph->timing(), plan_.frames, "run")) progress_.warning(*doubt);
    }

    void warn_of_motion() {
        if (plan_.frames.empty()) return;
        const int first = std::min(plan_.frames.front(), start_frame(*plan_.graph, plan_.needed));
        for (const engine::Diagnostic& d : find_motion_doubts(*plan_.graph, plan_.needed, first, plan_.frames.back()))
            progress_.warning(d);
    }

    /// Of what comes, from what there is before the first step: it has just been computed.
    void expect_sizes() {
        const double frame = start_frame(*plan_.graph, plan_.needed);
        if (in_.arguments.has("--open")) read_.check_kept(plan_.out / "view.html", "--open");
        for (const engine::Plug& plug : plan_.plugs) {
            const engine::Value value = evaluator_.pull({plan_.graph, plug, frame, in_.stop});
            output_.check_kept(read_, *plan_.graph, plug, value, plan_.frames);
            output_.expect(*plan_.graph, plug, value);
        }
    }

    /// The finished frames stay, and the report says what was done up to here. Also called by another thread while the
    /// run's own computes: whatever is read here is changed under Departure::hold.
    void end_early(const std::exception_ptr& why) {
        if (std::exchange(has_ended_, true)) return;
        report_.wall_s = seconds_since(start_);
        report_.computed = progress_.computed_by_type();
        report_.error = describe(why);
        if (output_.failed_frame()) report_.error->frame = *output_.failed_frame();
        progress_.clear();
        if (has_begun_) close_after_failure();
    }

    /// From here on there is something to close, and a run that is killed leaves its mark.
    void begin_output() {
        const auto here = departure_.hold();
        report_.setup_s = seconds_since(start_);
        has_begun_ = true;
        if (!plan_.out.empty()) mark_unfinished(plan_.out, mark(), plan_.graph->files());
        if (!in_.arguments.has("--open")) return;
        viewer::Evaluation e;
        e.graph = plan_.graph, e.evaluator = &evaluator_, e.stop = in_.stop;
        page_scene_ = std::make_unique<viewer::GraphCollector>(std::move(e));
    }

    RunError describe(const std::exception_ptr& what) const {
        try {
            std::rethrow_exception(what);
        } catch (const engine::Failure& failure) {
            const auto all = failure.diagnostics();
            const auto error = std::find_if(all.begin(), all.end(), [](const engine::Diagnostic& one) {
                return one.severity == engine::Severity::error;
            });
            const engine::Diagnostic& d = error == all.end() ? all.front() : *error;
            return {frame_, d.code, d.node, d.message};
        } catch (const std::exception& other) {
            return {frame_, "", "", other.what()};
        }
    }

    /// What another solver that the frame needed did for it.
    static void add_solver(const solver::StepRecord& other, solver::StepRecord& all) {
        all.residual = std::max(all.residual, other.residual), all.converged = all.converged && other.converged;
        all.newton_iterations += other.newton_iterations, all.linear_iterations += other.linear_iterations;
        all.factorizations += other.factorizations, all.halvings += other.halvings;
        all.seconds_assembly += other.seconds_assembly, all.seconds_factor += other.seconds_factor;
        all.seconds_solve += other.seconds_solve, all.seconds_other += other.seconds_other;
        all.min_j = std::min(all.min_j, other.min_j), all.inverted += other.inverted;
    }

    void evaluate(int frame) {
        {
            const auto here = departure_.hold();
            frame_ = frame;
        }
        progress_.begin_frame(frame);
        const Clock::time_point start = Clock::now();
        FrameReport f;
        f.frame = frame;
        engine::Hasher digest;
        std::vector<engine::Value> values;
        for (const engine::Plug& plug : plan_.plugs) {
            values.push_back(evaluator_.pull({plan_.graph, plug, static_cast<double>(frame), in_.stop}));
            digest.add(values.back().digest());
        }
        std::optional<nodes::SolveReport> size;
        if (!plan_.solvers.empty()) {
            const engine::Value value = evaluator_.pull(
                {plan_.graph, {plan_.solvers.front(), "outReport"}, static_cast<double>(frame), in_.stop});
            size = value.as<nodes::SolveReport>();
            f.step = size->record;
            f.worst = size->worst;
            f.inverted_here = size->record.inverted;
            f.lines = size->lines;
            f.is_deep = size->worst.deep_body >= 0;
            // A frame is as good as the worst of its solvers.
            for (std::size_t k = 1; k < plan_.solvers.size(); ++k) {
                const engine::Value other = evaluator_.pull(
                    {plan_.graph, {plan_.solvers[k], "outReport"}, static_cast<double>(frame), in_.stop});
                const auto& report = other.as<nodes::SolveReport>();
                add_solver(report.record, *f.step);
                f.is_deep = f.is_deep || report.worst.deep_body >= 0;
                if (!report.record.converged) continue;
                if (report.record.inverted > 0) report_.inverted_elsewhere.insert(plan_.solvers[k]);
                if (report.worst.deep_body >= 0) report_.deep_elsewhere.insert(plan_.solvers[k]);
            }
        }
        f.wall_s = seconds_since(start);
        f.reused = !plan_.solvers.empty() && !is_simulated_for(frame);
        const auto here = departure_.hold();
        if (size) report_.size = std::move(size);
        if (!plan_.out.empty())
            for (std::size_t i = 0; i < values.size(); ++i) output_.add(*plan_.graph, plan_.plugs[i], frame, values[i]);
        if (page_scene_) page_scene_->add(frame); // now, while all is there: a long run does not fit into memory
        report_.frames.push_back(f);
        progress_.end_frame(f, digest.finish().hex());
        for (std::size_t i = 0; i < values.size(); ++i) print_value(frame, plan_.plugs[i], values[i]);
    }

    /// Frames before the start are the start: it is simulated for the first one that shows it.
    bool is_simulated_for(int frame) {
        const int shown = std::max(frame, start_frame(*plan_.graph, plan_.needed));
        return progress_.was_stepped(shown) && shown_.insert(shown).second;
    }

    /// Numbers and the like; meshes and files go to disk.
    void print_value(int frame, const engine::Plug& plug, const engine::Value& value) {
        if (!meshes_in(value).empty() || value.is<nodes::FileContent>()) return;
        const nlohmann::ordered_json description = describe_value(value);
        if (json_) {
            const nlohmann::ordered_json line = {
                {"event", "value"}, {"frame", frame}, {"plug", plug.text()}, {"value", description}};
            in_.out << json_text(line) << "\n";
        } else {
            progress_.clear();
            in_.out << "frame " << frame << ": " << plug.text() << (description.is_structured() ? "\n" : " = ")
                    << as_text(description);
        }
        in_.out.flush();
    }

    /// Sequences are written beside the next frame's work: that a frame is not there is known after it was listed.
    void leave_out_unwritten() {
        if (const auto failed = output_.failed_frame())
            std::erase_if(report_.frames, [&](const FrameReport& f) { return f.frame == *failed; });
    }

    void close() {
        if (std::exchange(is_closed_, true)) return; // what failed by this is not tried again
        progress_.clear();
        const LongTask task(in_.err, "writing into " + plan_.out.string(), is_quiet() || plan_.out.empty());
        if (!plan_.out.empty()) output_.finish();
        if (page_scene_ && !in_.stop.stop_requested())
            page_ = viewer::write_run_page(plan_.out, page_scene_->finish(), report_, plan_.graph->files());
    }

    void write_report() {
        report_.frames_simulated = progress_.steps();
        report_.kept_bytes = evaluator_.most_stored_bytes();
        report_.made_again = evaluator_.made_again();
        report_.warnings = progress_.warnings();
        if (const auto file = in_.arguments.value("--report"))
            write_file(*file, report_json(report_), plan_.graph->files());
    }

    /// What goes wrong here is told, but the first failure is the one that counts.
    void close_after_failure() {
        // A report in the same folder says it already.
        const auto leave_mark = [this] {
            if (plan_.out.empty()) return;
            const fs::path report = in_.arguments.value("--report").value_or("");
            std::error_code error;
            if (!report.empty() && fs::equivalent(fs::absolute(report).parent_path(), plan_.out, error))
                mark_finished(plan_.out, mark(), plan_.graph->files());
            else
                mark_unfinished(plan_.out, mark(), plan_.graph->files());
        };
        const std::function<void()> parts[] = {[this] { close(); }, [this] { leave_out_unwritten(); },
                                               [this] { write_report(); }, leave_mark};
        for (const auto& part : parts) {
            try {
                part();
            } catch (const engine::Failure& second) {
                print_diagnostics(second.diagnostics(), json_, in_.out, in_.err);
            } catch (const engine::Cancelled&) {     // said by whoever asked for it
            } catch (const std::exception& second) { // no memory left, say
                engine::Diagnostic d;
                d.message = second.what();
                print_diagnostics(std::vector{d}, json_, in_.out, in_.err);
            }
        }
        print_page();
    }

    /// One line that --quiet keeps: --open asks for it.
    void print_page() {
        if (!page_.empty() && !json_) in_.out << "open " << file_url(page_) << "\n";
        if (!page_.empty() && json_ && report_.error)
            in_.out << json_text(nlohmann::ordered_json({{"event", "page"}, {"page", page_.string()}})) << "\n";
        in_.out.flush();
    }

    void print_summary() {
        if (json_) {
            nlohmann::ordered_json line = {{"event", "done"},
                                           {"frames", report_.frames.size()},
                                           {"wall_s", report_.wall_s},
                                           {"frames_simulated", report_.frames_simulated},
                                           {"frames_reused", report_.reused()},
                                           {"unconverged", report_.unconverged()},
                                           {"inverted", report_.inverted()},
                                           {"deep", report_.deep()},
                                           {"written", nlohmann::ordered_json::array()}};
            for (const fs::path& path : output_.written()) line["written"].push_back(path.string());
            if (!page_.empty()) line["page"] = page_.string();
            in_.out << json_text(line) << "\n";
            return;
        }
        if (in_.arguments.has("--quiet")) return print_page();
        in_.out << summary(report_);
        for (const fs::path& path : output_.written()) in_.out << "wrote " << path.string() << "\n";
        if (report_.made_again > 0)
            in_.err << "note: " << report_.made_again
                    << " results were computed again, because --memory left no room to keep them\n";
        if (plan_.out.empty()) in_.out << "nothing was written; --out DIR keeps the meshes\n";
        if (const auto file = in_.arguments.value("--report")) in_.out << "wrote " << *file << "\n";
        print_page();
    }

    const Invocation& in_;
    Departure& departure_;
    const Plan plan_;
    std::vector<engine::Diagnostic> notes_;
    const bool json_;
    Progress progress_;
    const engine::StorePolicy policy_;
    engine::Evaluator evaluator_;
    RunOutput output_;
    ReadFiles read_;
    RunReport report_;
    std::unique_ptr<viewer::GraphCollector> page_scene_; ///< for --open
    fs::path page_;                                      ///< written for --open
    const Clock::time_point start_ = Clock::now();
    int frame_ = 0;       ///< the one at work
    std::set<int> shown_; ///< steps that a frame has shown
    bool has_begun_ = false, is_closed_ = false, has_ended_ = false;
};

ExitCode run_graph(const Invocation& in) {
    Departure departure(in.stop, "sinew run", in.arguments.has("--json"));
    OpenGraph open = open_graph(in.arguments);
    return Run(in, departure, make_plan(in.arguments, open.graph), std::move(open.notes))();
}

} // namespace

Command run_command() {
    return {"run",
            "evaluate a graph frame after frame and write the meshes",
            {{"GRAPH", "the graph file (JSON)"}},
            {{"--frames", "A-B", "frames, for example 12, 1-24 or 1,64,128; default: the graph's timing"},
             {"--pull", "NODE.PLUG", "what to evaluate; default: outMeshes of the only zSolver", true},
             {"--set", "NODE.ATTR=JSON", "give an input another value", true},
             {"--out", "DIR", "where to write; without it nothing is written", false, 'o'},
             {"--format", "glb,obj,ply", "one animated GLB, a file per body and frame as OBJ or PLY; default: glb"},
             {"--threads", "N", "default: all cores; the result does not depend on it", false, 'j'},
             root_flag,
             memory_flag,
             cache_flag,
             no_cache_flag,
             cache_size_flag,
             {"--report", "FILE", "write times, convergence and sizes of every frame as JSON"},
             {"--open", "", "also write DIR/view.html, a page that plays the run, and say where it is"},
             {"--json", "", "one JSON object a line instead of text"},
             {"--quiet", "", "print warnings and errors only", false, 'q'},
             {"--strict", "",
              "exit code 3 if a frame has not converged, has inverted tets, or leaves bodies deep in each other"}},
            "sinew run graphs/scenes/arm.json --out out/arm --format glb,obj --report out/arm/report.json\n"
            "sinew run graphs/scenes/arm.json --frames 1-10 --set solver.substeps=4 --json",
            run_graph};
}

} // namespace sinew::cli
