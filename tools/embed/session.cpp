// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/embed/session.h"

#include "engine/check.h"
#include "engine/format/graph_file.h"
#include "engine/text.h"
#include "nodes/mesh_names.h"
#include "nodes/register_all.h"
#include "solver/error.h"
#include "solver/mesh/surface_mesh.h"
#include "tools/embed/build_mark.h"
#include "tools/embed/frame_json.h"
#include "tools/embed/graph_walk.h"
#include "tools/embed/most_threads.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <list>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

namespace sinew::embed {

using engine::Edit;
using engine::Graph;
using engine::Plug;
using engine::Value;

namespace {

engine::Diagnostic diagnostic(std::string code, std::string message, std::string hint, const Plug& at) {
    engine::Diagnostic d;
    d.code = std::move(code);
    d.node = at.node, d.attribute = at.attribute;
    d.message = std::move(message), d.hint = std::move(hint);
    return d;
}

/// Counts, and passes on. What the host's observer throws stays here until the call that ran meanwhile takes it: a
/// worker would lose its frame by it, and end the program where it tells of the end of its work in a destructor.
class Watch : public engine::Observer {
  public:
    explicit Watch(Observer* next)
        : next_(next) {}
    void begins(const std::string& node, double frame) override {
        at_work().push_back(this);
        pass([&](Observer& o) { o.begins(node, frame); });
    }
    void ends(const std::string& node, double frame) override {
        at_work().pop_back();
        pass([&](Observer& o) { o.ends(node, frame); });
    }
    void computed(const std::string& node, double frame, double seconds) override {
        ++computed_count;
        pass([&](Observer& o) { o.computed(node, frame, seconds); });
    }
    void stepped(const std::string& node, double frame, double seconds) override {
        ++stepped_count;
        pass([&](Observer& o) { o.stepped(node, frame, seconds); });
    }
    void reused(const std::string& node, double frame) override {
        ++reused_count;
        pass([&](Observer& o) { o.reused(node, frame); });
    }
    void warning(const engine::Diagnostic& d) override {
        pass([&](Observer& o) { o.warning(d); });
    }
    void progress(const std::string& node, double done, std::string_view what) override {
        pass([&](Observer& o) { o.progress(node, done, what); });
    }
    /// What the observer threw, once.
    std::exception_ptr take_error() {
        const std::lock_guard lock(mutex_);
        return std::exchange(error_, nullptr);
    }
    /// Whether it is the host's observer that this thread is in.
    bool tells_here() const { return telling_ == std::this_thread::get_id(); }
    /// Whether this thread computes a node of the session.
    bool works_here() const { return std::ranges::find(at_work(), this) != at_work().end(); }
    std::atomic<std::int64_t> computed_count = 0, stepped_count = 0, reused_count = 0;
    std::function<void()> stop; ///< ends the evaluations that run

  private:
    /// Of the nodes that the calling thread computes, one within the other.
    static std::vector<const Watch*>& at_work() {
        thread_local std::vector<const Watch*> list;
        return list;
    }
    /// One call at a time, those of readers among them.
    template <class Call>
    void pass(Call&& call) {
        if (!next_) return;
        const std::lock_guard lock(mutex_);
        telling_ = std::this_thread::get_id();
        try {
            call(*next_);
        } catch (...) {
            if (!error_) error_ = std::current_exception();
            if (stop) stop();
        }
        telling_ = std::thread::id();
    }
    Observer* next_;
    std::atomic<std::thread::id> telling_;
    std::mutex mutex_;
    std::exception_ptr error_;
};

engine::StorePolicy policy_of(const Options& options, const engine::FileAccess& files) {
    engine::StorePolicy policy;
    if (options.memory_bytes > 0) policy = engine::StorePolicy::within(options.memory_bytes);
    policy.disk_folder = options.cache_folder;
    policy.files = files;
    policy.keeps_frames = !options.cache_folder.empty();
    policy.disk_bytes = options.cache_bytes;
    if (policy.keeps_frames) policy.build = build_mark();
    return policy;
}

[[noreturn]] void refuse_count(const Plug& at, const engine::AttributeInfo& info, std::size_t count,
                               const std::string& fit) {
    throw Misuse("DG123", std::to_string(count) + " numbers for a " + std::string(info.type_name), "send " + fit, at);
}

/// The numbers as the attribute's type. What no type fits becomes a list, about which the edit then says what is wrong.
Value to_value(const Plug& at, const engine::AttributeInfo* info, const std::vector<double>& v) {
    if (!info || info->kind != engine::AttributeKind::literal || info->def.is<engine::NumberList>())
        return Value::of<engine::NumberList>(v);
    if (info->def.is<engine::Vec3>()) {
        if (v.size() != 3) refuse_count(at, *info, v.size(), "x, y and z");
        return Value::of<engine::Vec3>({v[0], v[1], v[2]});
    }
    if (info->def.is<engine::Matrix4>()) {
        if (v.size() != 16) refuse_count(at, *info, v.size(), "16, row by row");
        engine::Matrix4 m{};
        std::copy(v.begin(), v.end(), m.begin());
        return Value::of<engine::Matrix4>(m);
    }
    if (v.size() != 1) refuse_count(at, *info, v.size(), "one");
    if (info->def.is<bool>()) {
        if (v[0] != 0 && v[0] != 1)
            throw Misuse("DG123", engine::number_text(v[0]) + " for a switch", "send 0 or 1", at);
        return Value::of<bool>(v[0] != 0);
    }
    if (info->def.is<std::int64_t>() && v[0] == std::floor(v[0]) && std::abs(v[0]) < 9e15)
        return Value::of<std::int64_t>(static_cast<std::int64_t>(v[0]));
    return Value::of<double>(v[0]);
}

const engine::AttributeInfo* info_of(const Graph& graph, const Plug& at) {
    const engine::Node* node = graph.find(at.node);
    return node && node->type ? node->type->find_input(at.attribute) : nullptr;
}

/// The meshes in a value: one, several or none.
std::vector<nodes::Mesh> meshes_in(const Value& value) {
    if (value.is<nodes::Mesh>()) return {value.as<nodes::Mesh>()};
    if (value.is<nodes::MeshList>()) return value.as<nodes::MeshList>().meshes;
    return {};
}

/// Of an edit: a node or input that there is not is the caller's mistake; the graph is as right as before.
auto committed(Edit& edit) {
    try {
        return edit.commit();
    } catch (const engine::Failure& f) {
        const auto all = f.diagnostics();
        const auto names_nothing = [](const engine::Diagnostic& d) { return d.code == "DG040" || d.code == "DG011"; };
        if (std::none_of(all.begin(), all.end(), names_nothing)) throw;
        throw Misuse(std::vector<engine::Diagnostic>(all.begin(), all.end()));
    }
}

/// \param at the output that is asked for
void check_frame(double frame, const Plug& at) {
    if (!std::isfinite(frame)) throw Misuse("DG104", "the frame is not a finite number", "ask for a frame", at);
}

std::vector<double> as_numbers(std::span<const int> whole) { return {whole.begin(), whole.end()}; }

/// Before anything of the mesh that was sent last is given up for it.
void check_faces(const std::string& node, const HostMesh& mesh) {
    const auto refuse = [&](const std::string& message, const std::string& hint) {
        throw Misuse("DG125", message, hint, {node, ""});
    };
    const auto text = [](auto number) { return std::to_string(number); };
    if (mesh.points.size() % 3 != 0)
        refuse(text(mesh.points.size()) + " numbers are no list of points", "give x, y and z of each vertex");
    const std::size_t vertices = mesh.points.size() / 3;
    const std::size_t corners = mesh.face_vertices.size();
    std::vector<int> triangles;
    if (mesh.face_sizes.empty()) {
        if (corners % 3 != 0)
            refuse(text(corners) + " corners are no list of triangles",
                   "give three a triangle, or the sizes of the faces");
        triangles.assign(corners / 3, 3);
    }
    try {
        solver::check_faces(vertices, mesh.face_sizes.empty() ? triangles : mesh.face_sizes, mesh.face_vertices);
    } catch (const solver::Error& why) {
        refuse(why.what(), why.hint);
    }
}

} // namespace

Misuse::Misuse(std::string code, std::string message, std::string hint, Plug at)
    : Failure(diagnostic(std::move(code), std::move(message), std::move(hint), at)) {}

std::optional<std::size_t> Frame::find(std::string_view name) const {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end()) return {};
    return static_cast<std::size_t>(it - names.begin());
}

std::string Frame::report_json() const {
    using Json = nlohmann::ordered_json;
    if (!report) return "{}";
    const auto& r = report->as<nodes::SolveReport>();
    Json out = {{"frame", number}};
    out.update(step_json(r.record));
    out["where"] = where_json(r.worst, bodies, attachments);
    for (const nodes::LineReport& line : r.lines) {
        Json& entry = out["lines_of_action"].emplace_back(line_json(line));
        entry["body"] = name_at(bodies, line.body);
    }
    out["size"] = size_json(r);
    return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

struct Session::Impl {
    explicit Impl(Options options, engine::Observer* observer)
        : registry(options.registry ? options.registry : nodes::make_registry())
        , files(options.root_folder.empty() ? engine::FileAccess() : engine::FileAccess::within(options.root_folder))
        , watch(observer)
        , evaluator(policy_of(options, files), options.threads, &watch) {
        watch.stop = [this] { cancel(); };
    }

    /// The call that the observer is told of holds what others need: they would wait for each other for ever.
    void refuse_in_callback() const {
        if (watch.tells_here())
            throw Misuse("DG140", "the session is called from its own callback",
                         "cancel it there or ask for its counts, and nothing else");
    }

    /// A node that waits for its own session may wait for itself.
    void refuse_in_compute() const {
        if (watch.works_here())
            throw Misuse("DG140", "the session is asked for a value by a node that it computes",
                         "a node reads its inputs alone: connect what it needs");
    }

    /// One at a time, and not within itself.
    class Editing {
      public:
        explicit Editing(Impl& impl)
            : impl_(impl) {
            impl.refuse_in_callback();
            if (impl.editor == std::this_thread::get_id())
                throw Misuse("DG140", "the session is changed within a change of it", "use the Edit that is given");
            lock_ = std::unique_lock(impl.editing);
            impl.editor = std::this_thread::get_id();
        }
        ~Editing() { impl_.editor = std::thread::id(); }

      private:
        Impl& impl_;
        std::unique_lock<std::mutex> lock_;
    };

    void cancel() {
        const std::lock_guard lock(mutex);
        for (std::stop_source& source : running) source.request_stop();
    }

    /// Calls, and throws what the host's observer threw meanwhile in place of what came of it.
    template <class Call>
    auto watched(Call&& call) {
        struct Thrown {
            Watch& watch;
            void operator()() const {
                if (const std::exception_ptr error = watch.take_error()) std::rethrow_exception(error);
            }
        } const thrown{watch};
        try {
            if constexpr (std::is_void_v<decltype(call())>) {
                call();
                thrown();
            } else {
                auto out = call();
                thrown();
                return out;
            }
        } catch (...) {
            thrown();
            throw;
        }
    }

    /// Puts another graph in place and tells the reader's warnings.
    void take(engine::Loaded loaded) {
        {
            const std::lock_guard lock(mutex);
            graph = std::move(loaded.graph);
        }
        for (const engine::Diagnostic& d : loaded.notes) watch.warning(d);
    }

    Plug plug_of(const Graph& g, std::string_view text) const {
        if (!text.empty()) {
            Plug plug = split_plug(text);
            if (plug.node.empty())
                throw Misuse("DG126", "\"" + std::string(text) + "\" names no output", "write node.output");
            if (!g.find(plug.node))
                throw Misuse("DG102", "there is no node \"" + plug.node + "\"",
                             engine::name_hint(plug.node, g.node_names(), {}), plug);
            const engine::NodeType* type = g.find(plug.node)->type;
            if (type && !type->find_output(plug.attribute)) {
                std::vector<std::string> known;
                for (const engine::AttributeInfo& output : type->outputs) known.emplace_back(output.name);
                throw Misuse("DG102", std::string(type->name) + " has no output \"" + plug.attribute + "\"",
                             engine::name_hint(plug.attribute, known, "outputs"), plug);
            }
            return plug;
        }
        const std::vector<std::string> found = last_solvers(g, g.node_names());
        if (found.size() == 1) return {found.front(), "outMeshes"};
        if (found.empty()) throw Misuse("DG126", "the graph has no zSolver", "name what to evaluate: node.output");
        throw Misuse("DG126", "the graph has several solvers: " + engine::listed(found),
                     "name one: " + found.front() + ".outMeshes");
    }

    const std::shared_ptr<const engine::Registry> registry;
    const engine::FileAccess files;
    Watch watch;
    engine::Evaluator evaluator;
    mutable std::mutex mutex; ///< of what follows
    std::mutex editing;       ///< one edit at a time; evaluations need not wait for it
    std::atomic<std::thread::id> editor;
    std::shared_ptr<const Graph> graph;
    std::list<std::stop_source> running;
};

namespace {

Options checked(Options options) {
    if (options.threads < 0 || options.threads > most_threads)
        throw Misuse("DG123", "there cannot be " + std::to_string(options.threads) + " threads",
                     "0 takes all; " + std::to_string(most_threads) + " are the most");
    return options;
}

} // namespace

Session::Session(Options options, engine::Observer* watch)
    : impl_(std::make_unique<Impl>(checked(std::move(options)), watch)) {}
Session::~Session() = default;

void Session::load_file(const std::string& path) {
    const Impl::Editing edits(*impl_);
    impl_->watched([&] { impl_->take(engine::load_graph(impl_->registry, path, impl_->files)); });
}

void Session::load_text(std::string_view json, const std::string& file_name) {
    const Impl::Editing edits(*impl_);
    impl_->watched([&] { impl_->take(engine::read_graph(impl_->registry, json, file_name, impl_->files)); });
}

std::shared_ptr<const Graph> Session::graph() const {
    const std::lock_guard lock(impl_->mutex);
    if (!impl_->graph) throw Misuse("DG121", "no graph is loaded", "load one from a file or text first");
    return impl_->graph;
}

void Session::edit(const std::function<void(Edit&)>& changes) {
    const Impl::Editing edits(*impl_);
    Edit edit(graph());
    changes(edit);
    auto done = committed(edit);
    const std::lock_guard lock(impl_->mutex);
    impl_->graph = std::move(done.graph);
}

void Session::set_json(const Plug& input, const std::string& json) {
    edit([&](Edit& e) { e.set_json(input, json); });
}

void Session::set(std::span<const Setting> settings) {
    edit([&](Edit& e) {
        const std::shared_ptr<const Graph> g = graph();
        for (const Setting& s : settings) {
            const auto* numbers = std::get_if<std::vector<double>>(&s.value);
            if (numbers)
                e.set(s.input, to_value(s.input, info_of(*g, s.input), *numbers));
            else
                e.set_json(s.input, engine::json_quoted(std::get<std::string>(s.value)));
        }
    });
}

void Session::set_at(double frame, std::span<const Setting> settings) {
    if (!std::isfinite(frame)) throw Misuse("DG123", "the frame is not a finite number", "send a frame");
    edit([&](Edit& e) {
        const std::shared_ptr<const Graph> g = graph();
        for (const Setting& s : settings) {
            const auto* numbers = std::get_if<std::vector<double>>(&s.value);
            e.set_input(s.input, frame,
                        numbers ? to_value(s.input, info_of(*g, s.input), *numbers)
                                : Value::of<std::string>(std::get<std::string>(s.value)));
        }
    });
}

void Session::set_mesh(const std::string& node, double frame, const HostMesh& mesh) {
    if (!std::isfinite(frame)) throw Misuse("DG123", "the frame is not a finite number", "send a frame", {node, ""});
    edit([&](Edit& e) {
        const std::shared_ptr<const Graph> g = graph();
        const engine::Node* n = g->find(node);
        if (n && n->type_name != "hostMesh")
            throw Misuse("DG123", "\"" + node + "\" is a " + n->type_name + " and takes no mesh from a host",
                         "send it to a hostMesh", {node, ""});
        if (n) check_faces(node, mesh);
        std::vector<double> points(mesh.points.begin(), mesh.points.end());
        if (!n) { // which is told once
            e.set_input({node, "points"}, frame, Value::of<engine::NumberList>(std::move(points)));
            return;
        }
        const auto bound = [&](const char* input) -> const engine::Binding* {
            const auto it = n->inputs.find(input);
            return it != n->inputs.end() ? &it->second : nullptr;
        };
        // Points of another count are another mesh, even with the same faces.
        const auto counts_differ = [&] {
            const auto* keys = std::get_if<engine::Curve>(bound("points"));
            return keys && keys->width() != points.size();
        };
        const auto differs = [&](const char* input, const Value& value) {
            const auto* there = std::get_if<Value>(bound(input));
            return !there || there->digest() != value.digest();
        };
        if (!mesh.face_vertices.empty()) {
            const Value corners = Value::of<engine::NumberList>(as_numbers(mesh.face_vertices));
            const Value sizes = Value::of<engine::NumberList>(as_numbers(mesh.face_sizes));
            if (differs("faceVertices", corners) || differs("faceSizes", sizes) || counts_differ()) {
                // Another mesh: nothing of the one before holds.
                e.set({node, "faceVertices"}, corners).set({node, "faceSizes"}, sizes).reset({node, "points"});
                if (mesh.face_sizes.empty())
                    e.reset({node, "restPoints"});
                else
                    e.set({node, "restPoints"}, Value::of<engine::NumberList>(points));
            }
        }
        e.set_input({node, "points"}, frame, Value::of<engine::NumberList>(std::move(points)));
    });
}

Frame Session::evaluate(double frame, std::string_view plug, std::stop_token stop) {
    impl_->refuse_in_callback();
    impl_->refuse_in_compute();
    return impl_->watched([&] { return evaluated(frame, plug, std::move(stop)); });
}

Frame Session::evaluated(double frame, std::string_view plug, std::stop_token stop) {
    Frame out;
    const std::shared_ptr<const Graph> g = graph();
    std::list<std::stop_source>::iterator mine;
    {
        const std::lock_guard lock(impl_->mutex);
        mine = impl_->running.emplace(impl_->running.end());
    }
    struct Leave {
        Impl& impl;
        std::list<std::stop_source>::iterator mine;
        ~Leave() {
            const std::lock_guard lock(impl.mutex);
            impl.running.erase(mine);
        }
    } leave{*impl_, mine};
    const std::stop_callback link(stop, [source = *mine]() mutable { source.request_stop(); });
    out.plug = impl_->plug_of(*g, plug);
    check_frame(frame, out.plug);
    out.number = frame;
    out.value = impl_->evaluator.pull({g, out.plug, frame, mine->get_token(), {}});
    out.meshes = meshes_in(out.value);
    out.names = nodes::mesh_names(*g, out.plug, out.meshes.size());
    out.names.resize(out.meshes.size());
    if (out.meshes.size() == 1 && out.names[0].empty()) out.names[0] = out.plug.node;
    const std::vector<std::string> solvers = last_solvers(*g, upstream_of(*g, {out.plug.node}));
    if (!solvers.empty()) {
        out.report = impl_->evaluator.pull({g, {solvers.front(), "outReport"}, frame, mine->get_token(), {}});
        out.bodies = connected(*g, solvers.front(), "bodies");
        out.attachments = connected(*g, solvers.front(), "attachments");
    }
    return out;
}

bool Session::is_ready(double frame, std::string_view plug) const {
    // By keys alone where there is a whole number of frames: to explain why not is to look at all that is on disk.
    if (std::abs(frame) > 1e9 || frame != std::floor(frame)) // also what is no number
        return explain(frame, plug).readiness == engine::Readiness::ready;
    impl_->refuse_in_callback();
    const auto g = graph();
    const Plug at = impl_->plug_of(*g, plug);
    const int number = static_cast<int>(frame);
    return impl_->watched([&] {
        return !impl_->evaluator.valid_frames({g, at, frame, {}, {}}, number, number).empty();
    });
}

engine::Verdict Session::explain(double frame, std::string_view plug) const {
    impl_->refuse_in_callback();
    const auto g = graph();
    const Plug at = impl_->plug_of(*g, plug);
    check_frame(frame, at);
    return impl_->watched([&] { return impl_->evaluator.explain({g, at, frame, {}, {}}); });
}

void Session::refuse_in_callback() const { impl_->refuse_in_callback(); }

void Session::cancel() { impl_->cancel(); }

Counts Session::counts() const {
    return {impl_->watch.stepped_count, impl_->watch.computed_count, impl_->watch.reused_count};
}

} // namespace sinew::embed
