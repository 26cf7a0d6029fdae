// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/live/session.h"

#include "engine/atomic_file.h"
#include "engine/format/graph_file.h"
#include "engine/format/graph_text.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/problems.h"
#include "tools/viewer/block.h"
#include "tools/viewer/collect.h"
#include "tools/viewer/page.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

namespace sinew::live {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

namespace {

/// How often files are looked at.
constexpr std::chrono::milliseconds look_every{25};
/// A page is made again while a run goes on when this has passed, and so many times what the last one took: a run is
/// hardly held up.
constexpr std::chrono::milliseconds page_every{1000};
constexpr int page_share = 4;
/// For the first frame that is new, in frames that are there.
constexpr double longest_search_s = 1;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Json as_json(const std::vector<engine::Diagnostic>& diagnostics) {
    Json out = Json::array();
    for (const engine::Diagnostic& d : diagnostics) {
        out.push_back(Json::parse(engine::to_json(d)));
        out.back()["text"] = engine::to_text(d);
    }
    return out;
}

/// What the graph's files give each node's inputs, by node: JSON as it stands there, or as an including file overrides
/// it.
std::map<std::string, Json> inputs_as_written(const engine::Graph& graph) {
    const Json file = Json::parse(engine::write_graph(graph), nullptr, true, true);
    std::map<std::string, Json> out;
    for (const auto& [name, node] : file.at("nodes").items()) out[name] = node.value("inputs", Json::object());
    for (const auto& [prefix, include] : graph.includes()) {
        for (auto& [name, inputs] : inputs_as_written(*include->graph)) out[prefix + "." + name] = std::move(inputs);
        const Json& written = file.at("includes").at(prefix);
        if (!written.is_object() || !written.contains("overrides")) continue;
        for (const auto& [input, value] : written.at("overrides").items()) {
            const std::size_t dot = input.rfind('.');
            out[prefix + "." + input.substr(0, dot)][input.substr(dot + 1)] = value;
        }
    }
    return out;
}

/// Types that this program does not know may be why, which the reader notes.
engine::Diagnostic nothing_to_show() {
    engine::Diagnostic d;
    d.code = "DG019";
    d.message = "the graph has neither a zSolver nor a zEmbedder, so there is nothing to show";
    d.hint = "Add a zSolver with bodies.";
    return d;
}

/// Positions as little-endian floats, in base64.
std::string preview_json(int frame, const std::vector<viewer::GraphCollector::Place>& places) {
    Json bodies = Json::array();
    for (const auto& [name, points] : places) {
        std::vector<float> numbers;
        for (const solver::Vec3& p : points ? *points : solver::Points())
            for (int c = 0; c < 3; ++c) numbers.push_back(static_cast<float>(p[c]));
        bodies.push_back({{"name", name},
                          {"positions", viewer::base64({reinterpret_cast<const char*>(numbers.data()),
                                                        numbers.size() * sizeof(float)})}});
    }
    const Json out = {{"frame", frame}, {"bodies", std::move(bodies)}};
    return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace

/// What the evaluator tells while it works.
struct Session::Watcher : engine::Observer {
    explicit Watcher(Session& session)
        : session(session) {}
    void stepped(const std::string&, double frame, double) override {
        const std::lock_guard lock(mutex);
        steps.insert(frame);
        ++count;
    }
    void begins(const std::string& node, double) override;
    void warning(const engine::Diagnostic& d) override {
        const std::lock_guard lock(mutex);
        warnings.push_back(d);
    }
    void begin_run() {
        const std::lock_guard lock(mutex);
        steps.clear(), warnings.clear(), count = 0;
    }
    bool was_stepped(int frame) {
        const std::lock_guard lock(mutex);
        const auto it = steps.lower_bound(frame - 1 + 1e-9);
        return it != steps.end() && *it <= frame;
    }
    int stepped_count() {
        const std::lock_guard lock(mutex);
        return count;
    }
    std::vector<engine::Diagnostic> told() {
        const std::lock_guard lock(mutex);
        return warnings;
    }
    Session& session;
    std::mutex mutex;
    std::set<double> steps;
    std::vector<engine::Diagnostic> warnings;
    int count = 0;
};

/// What the page is told. `number` grows with each change.
struct Session::Status {
    std::uint64_t number = 1, page = 0, preview = 0, run = 0;
    std::string state = "running"; ///< running, ready, wrong
    std::string at_work;           ///< node
    std::vector<engine::Diagnostic> diagnostics;
    std::vector<int> frames; ///< that the newest page holds
    int wanted = 0, done = 0, simulated = 0;
    double preview_s = 0, first_page_s = 0, all_s = 0;
    std::vector<std::string> changed; ///< files that began the run
};

template <class Action>
void Session::tell(const Action& action) {
    const std::lock_guard lock(mutex_);
    action(*status_);
    ++status_->number;
    news_.notify_all();
}

void Session::Watcher::begins(const std::string& node, double) {
    session.tell([&](Status& s) { s.at_work = node; });
}

Session::Session(Options options)
    : options_(std::move(options))
    , status_(std::make_unique<Status>())
    , watcher_(std::make_unique<Watcher>(*this))
    , evaluator_(std::make_unique<engine::Evaluator>(options_.store, options_.threads, watcher_.get())) {
    files_.watch({options_.file});
    worker_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
    looker_ = std::jthread([this](const std::stop_token& stop) { look_at_files(stop); });
}

Session::~Session() {
    looker_.request_stop(), worker_.request_stop();
    {
        const std::lock_guard lock(mutex_);
        current_.request_stop();
        news_.notify_all();
    }
}

std::pair<std::uint64_t, std::string> Session::wait_status(std::uint64_t seen) const {
    std::unique_lock lock(mutex_);
    news_.wait_for(lock, std::chrono::milliseconds(250), [&] { return status_->number > seen; });
    const Status& s = *status_;
    Json changes = Json::array();
    for (const Change& c : changes_) {
        changes.push_back({{"node", c.input.node}, {"attribute", c.input.attribute}, {"value", Json::parse(c.json)}});
        if (c.frame) changes.back()["frame"] = *c.frame;
    }
    const Json out = {{"number", s.number},       {"run", s.run},
                      {"page", s.page},           {"state", s.state},
                      {"node", s.at_work},        {"wanted", s.wanted},
                      {"done", s.done},           {"simulated", s.simulated},
                      {"frames", s.frames},       {"preview", s.preview},
                      {"preview_s", s.preview_s}, {"firstPage_s", s.first_page_s},
                      {"all_s", s.all_s},         {"files", s.changed},
                      {"changes", changes},       {"diagnostics", as_json(s.diagnostics)}};
    return {s.number, out.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

std::shared_ptr<const std::string> Session::page() const {
    const std::lock_guard lock(mutex_);
    return page_;
}

std::shared_ptr<const std::string> Session::preview() const {
    const std::lock_guard lock(mutex_);
    return preview_;
}

std::string Session::nodes() const {
    std::shared_ptr<const engine::Graph> graph;
    {
        const std::lock_guard lock(mutex_);
        graph = graph_;
    }
    Json out = Json::array();
    if (!graph) return out.dump();
    const std::map<std::string, Json> all = inputs_as_written(*graph);
    for (const std::string& name : graph->node_names()) {
        const engine::Node& node = *graph->find(name);
        Json inputs = Json::array();
        const auto found = all.find(name);
        const Json written = found == all.end() ? Json::object() : found->second;
        for (const engine::AttributeInfo& info : node.type ? node.type->inputs : std::vector<engine::AttributeInfo>{}) {
            const std::string attribute(info.name);
            Json row = {{"name", attribute}, {"doc", info.doc}, {"keyable", info.keyable}};
            if (!info.options.empty()) row["options"] = info.options;
            if (const auto it = written.find(attribute); it != written.end()) row["value"] = *it;
            inputs.push_back(std::move(row));
        }
        out.push_back({{"name", name}, {"type", node.type_name}, {"inputs", std::move(inputs)}});
    }
    return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::shared_ptr<const engine::Graph> Session::changed(std::shared_ptr<const engine::Graph> graph) const {
    std::vector<Change> changes;
    {
        const std::lock_guard lock(mutex_);
        changes = changes_;
    }
    return with_changes(std::move(graph), changes);
}

void Session::start_anew() {
    const std::lock_guard lock(mutex_);
    is_due_ = true;
    current_.request_stop();
    news_.notify_all();
}

void Session::change(const Change& change) {
    const std::lock_guard one_after_the_other(changing_);
    std::vector<engine::Diagnostic> notes;
    with_change(changed(options_.open(notes)), change);
    {
        const std::lock_guard lock(mutex_);
        // The last word counts, and a whole input comes in place of its keys.
        std::erase_if(changes_, [&](const Change& c) {
            return c.input == change.input && (!change.frame || c.frame == change.frame);
        });
        changes_.push_back(change);
    }
    start_anew();
}

void Session::discard_changes() {
    const std::lock_guard one_after_the_other(changing_);
    {
        const std::lock_guard lock(mutex_);
        changes_.clear();
    }
    start_anew();
}

void Session::save_changes() {
    const std::lock_guard one_after_the_other(changing_);
    std::vector<Change> changes;
    {
        const std::lock_guard lock(mutex_);
        changes = changes_;
    }
    if (changes.empty()) return;
    // The file as it is, without what the command line sets.
    const engine::GraphText before = engine::graph_text(options_.file, options_.files);
    if (!before.code.empty()) throw engine::Failure(unwritable(options_.file, before.message));
    const std::string text = written_into(before.text, options_.file, options_.files, changes);
    try {
        const auto rights = std::filesystem::status(options_.file).permissions();
        if (text != before.text) engine::write_file(options_.file, text, options_.files);
        std::error_code ignored; // on some file systems there are none
        std::filesystem::permissions(options_.file, rights, ignored);
    } catch (const std::exception& why) {
        throw engine::Failure(unwritable(options_.file, why.what()));
    }
    {
        const std::lock_guard lock(mutex_);
        changes_.clear();
    }
    start_anew();
}

void Session::look_at_files(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::vector<std::string> changed;
        {
            std::unique_lock lock(mutex_);
            news_.wait_for(lock, stop, look_every, [] { return false; });
            changed = files_.take_changed();
        }
        if (changed.empty()) continue;
        // A save may be several files and several writes: wait until nothing changes any more.
        for (int quiet = 0; quiet < 1 && !stop.stop_requested();) {
            std::unique_lock lock(mutex_);
            news_.wait_for(lock, stop, look_every, [] { return false; });
            const std::vector<std::string> more = files_.take_changed();
            changed.insert(changed.end(), more.begin(), more.end());
            quiet = more.empty();
        }
        std::sort(changed.begin(), changed.end());
        changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
        tell([&](Status& s) { s.changed = changed; });
        start_anew();
    }
}

void Session::watch_what_is_named() {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> files = graph_ ? files_of(*graph_) : std::vector<std::string>{};
    for (std::string& file : graphs_named_in(options_.file, options_.files)) files.push_back(std::move(file));
    files_.watch(files);
}

void Session::work(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::stop_token run_stop;
        {
            std::unique_lock lock(mutex_);
            news_.wait(lock, stop, [&] { return is_due_; });
            if (stop.stop_requested()) return;
            is_due_ = false;
            current_ = {};
            run_stop = current_.get_token();
        }
        std::vector<engine::Diagnostic> notes;
        try {
            run(run_stop, notes);
        } catch (const engine::Cancelled&) { // something newer is wanted
        } catch (const engine::Failure& failure) {
            tell([&](Status& s) {
                s.state = "wrong", s.at_work.clear();
                s.diagnostics = notes;
                s.diagnostics.insert(s.diagnostics.end(), failure.diagnostics().begin(), failure.diagnostics().end());
                cli::sort_by_place(s.diagnostics);
            });
        } catch (const std::exception& error) { // no memory, a file that went away while it was read
            tell([&](Status& s) {
                s.state = "wrong", s.at_work.clear();
                s.diagnostics = notes;
                s.diagnostics.emplace_back().message = error.what();
            });
        }
    }
}

void Session::run(const std::stop_token& stop, std::vector<engine::Diagnostic>& notes) {
    const auto start = Clock::now();
    watcher_->begin_run();
    tell([&](Status& s) {
        ++s.run;
        s.state = "running", s.diagnostics.clear();
        s.done = s.simulated = 0, s.preview_s = s.first_page_s = s.all_s = 0;
    });
    watch_what_is_named(); // before it is read: what is saved meanwhile begins another run
    const std::shared_ptr<const engine::Graph> graph = changed(options_.open(notes));
    {
        const std::lock_guard lock(mutex_);
        graph_ = graph;
        files_.watch(files_of(*graph));
    }
    const std::vector<std::string> shown = viewer::shown_nodes(*graph);
    if (shown.empty()) throw engine::Failure(nothing_to_show());
    const std::vector<std::string> needed = cli::upstream_of(*graph, shown);
    std::vector<engine::Diagnostic> problems = cli::find_problems(graph, *evaluator_, needed, stop);
    if (cli::has_error(problems)) throw engine::Failure(std::move(problems));

    std::vector<int> frames = options_.frames;
    if (frames.empty()) {
        frames.resize(static_cast<std::size_t>(std::max(0, graph->timing().end - graph->timing().start + 1)));
        std::iota(frames.begin(), frames.end(), graph->timing().start);
    }
    viewer::Evaluation evaluation;
    evaluation.graph = graph;
    evaluation.evaluator = evaluator_.get();
    evaluation.stop = stop;
    evaluation.keeps_frames = false; // what fails is told here
    evaluation.with_lattices = options_.with_lattices;
    evaluation.memory = memory_;
    evaluation.was_stepped = [&](int frame) { return watcher_->was_stepped(frame); };
    viewer::GraphCollector collector(evaluation);
    std::vector<int> done;
    Clock::time_point last_page{};
    double page_s = 0;
    const auto publish = [&] {
        const auto from = Clock::now();
        auto page = std::make_shared<const std::string>(viewer::write_page(collector.so_far()).html);
        page_s = seconds_since(from);
        last_page = Clock::now();
        const std::lock_guard lock(mutex_);
        if (stop.stop_requested()) return;
        page_ = std::move(page);
        ++status_->page, ++status_->number;
        status_->frames = done;
        if (status_->first_page_s == 0) status_->first_page_s = seconds_since(start);
        news_.notify_all();
    };
    const auto show = [&](int frame) {
        auto text = std::make_shared<const std::string>(preview_json(frame, collector.look(frame)));
        const std::lock_guard lock(mutex_);
        if (stop.stop_requested()) return;
        preview_ = std::move(text);
        ++status_->preview, ++status_->number;
        status_->preview_s = seconds_since(start);
        news_.notify_all();
    };
    // A page takes longer to make and to open than a frame: the first that is new is shown alone. What is computed for
    // it is not computed again, and what fails is told when its turn comes.
    const auto from = Clock::now();
    for (std::size_t i = 0; i < frames.size() && seconds_since(from) < longest_search_s; ++i) {
        const int before = watcher_->stepped_count();
        try {
            collector.look(frames[i]);
        } catch (const engine::Failure&) {
            break;
        }
        if (watcher_->stepped_count() == before) continue;
        show(frames[i]);
        break;
    }
    std::vector<engine::Diagnostic> why_ended;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const int before = watcher_->stepped_count();
        try {
            collector.add(frames[i]);
        } catch (const engine::Failure& failure) {
            if (done.empty()) throw;
            why_ended.assign(failure.diagnostics().begin(), failure.diagnostics().end());
            break;
        }
        done.push_back(frames[i]);
        const bool is_new = watcher_->stepped_count() > before;
        tell([&](Status& s) {
            s.wanted = static_cast<int>(frames.size()), s.done = static_cast<int>(done.size());
            s.simulated = watcher_->stepped_count();
        });
        // The first frame that is new is what somebody waits for; of frames that were there, many come at once.
        const bool is_first = last_page == Clock::time_point{} && is_new;
        const double rest = std::max(std::chrono::duration<double>(page_every).count(), page_share * page_s);
        if (is_first || (last_page != Clock::time_point{} && seconds_since(last_page) > rest)) publish();
    }
    publish();
    tell([&](Status& s) {
        s.state = why_ended.empty() ? "ready" : "wrong", s.at_work.clear();
        s.diagnostics = notes;
        for (const auto* list : {&problems, &why_ended})
            s.diagnostics.insert(s.diagnostics.end(), list->begin(), list->end());
        for (engine::Diagnostic& d : watcher_->told()) s.diagnostics.push_back(std::move(d));
        cli::sort_by_place(s.diagnostics);
        s.all_s = seconds_since(start);
    });
}

} // namespace sinew::live
