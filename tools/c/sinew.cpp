// The functions of sinew.h: each finds what its handle stands for, checks its arguments and calls the session.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/c/sinew.h"

#include "tools/c/errors.h"
#include "tools/c/handles.h"
#include "tools/c/structs.h"

#include <mutex>

namespace sinew::c {

namespace {

static_assert(sizeof(int) == sizeof(std::int32_t));
static_assert(static_cast<int>(engine::Severity::error) == SINEW_ERROR &&
              static_cast<int>(engine::Severity::note) == 0);

/// Passes events on to the host, and lets nothing that it throws get into a worker.
class Callbacks : public engine::Observer {
  public:
    explicit Callbacks(const sinew_options& options)
        : options_(options) {}
    void computed(const std::string& node, double frame, double seconds) override {
        tell(SINEW_COMPUTED, node, frame, seconds, 1, "");
    }
    void stepped(const std::string& node, double frame, double seconds) override {
        tell(SINEW_STEPPED, node, frame, seconds, 1, "");
    }
    void reused(const std::string& node, double frame) override { tell(SINEW_REUSED, node, frame, 0, 1, ""); }
    void progress(const std::string& node, double done, std::string_view what) override {
        tell(SINEW_PROGRESS, node, 0, 0, done, std::string(what));
    }
    void warning(const engine::Diagnostic& d) override {
        if (!options_.on_warning) return;
        const sinew_diagnostic told = describe(d);
        call([&] {
            options_.on_warning(options_.user, &told);
            return 0;
        });
    }
    embed::Session* session = nullptr; ///< whose evaluations end where the host says so

  private:
    void tell(sinew_event_kind kind, const std::string& node, double frame, double seconds, double done,
              const std::string& what) {
        if (!options_.on_event) return;
        const sinew_event event{sizeof event, kind, node.c_str(), frame, seconds, done, what.c_str()};
        call([&] { return options_.on_event(options_.user, &event); });
    }
    template <class Call>
    void call(Call&& host) {
        int answer = 1;
        try {
            answer = host();
        } catch (...) { // a host in C++ that throws wants no more
        }
        if (answer != 0 && session) session->cancel();
    }
    const sinew_options options_;
};

embed::Options options_of(const sinew_options& o) {
    embed::Options out;
    out.threads = o.threads;
    out.memory_bytes = o.memory_bytes;
    if (o.cache_folder) out.cache_folder = o.cache_folder;
    if (o.cache_bytes > 0) out.cache_bytes = o.cache_bytes;
    if (o.root_folder) out.root_folder = o.root_folder;
    return out;
}

struct OpenSession {
    explicit OpenSession(const sinew_options& options)
        : callbacks(options)
        , session(options_of(options), &callbacks) {
        callbacks.session = &session;
    }
    Callbacks callbacks;
    embed::Session session;
};

struct OpenFrame {
    explicit OpenFrame(embed::Frame f)
        : frame(std::move(f)) {
        const engine::Value& v = frame.value;
        if (v.is<bool>()) single = v.as<bool>();
        if (v.is<std::int64_t>()) single = static_cast<double>(v.as<std::int64_t>());
        if (v.is<double>()) single = v.as<double>();
    }
    const std::string& report() {
        std::call_once(once, [this] { text = frame.report_json(); });
        return text;
    }
    const embed::Frame frame;
    double single = 0;

  private:
    std::once_flag once;
    std::string text;
};

struct Tables {
    Handles<OpenSession> sessions;
    Handles<OpenFrame> frames;
};

/// The one thing of a program that the interface keeps: C has nothing else to hold it. Never destroyed, because hosts
/// end with threads that still call.
Tables& tables() {
    static Tables& all = *new Tables;
    return all;
}

/// Runs a call: errors of the one before are forgotten, what it throws becomes a status and errors.
template <class Call>
sinew_status guarded(Call&& call) noexcept {
    try {
        forget_errors();
        call();
        forget_errors(); // those of calls that a callback made meanwhile on this thread
        return SINEW_OK;
    } catch (...) {
        return keep_current_exception();
    }
}

template <class T>
std::shared_ptr<T> alive(Handles<T>& table, const void* handle, const char* kind) {
    auto found = handle ? table.find(reinterpret_cast<std::uintptr_t>(handle)) : nullptr;
    if (!found)
        throw embed::Misuse("DG120",
                            handle ? std::string("this is no ") + kind + " that is alive"
                                   : std::string("the ") + kind + " is null",
                            "use the handle that was given out, and only until it is released");
    return found;
}

enum class From { anywhere, outside_of_callbacks };

std::shared_ptr<OpenSession> session_of(sinew_session* handle, From from = From::outside_of_callbacks) {
    auto found = alive(tables().sessions, handle, "session");
    if (from == From::outside_of_callbacks) found->session.refuse_in_callback();
    return found;
}

std::shared_ptr<OpenFrame> frame_of(sinew_frame* handle) { return alive(tables().frames, handle, "frame"); }

std::string text_of(const char* text, const char* name) {
    if (!text) refuse(std::string(name) + " is null", "give a text");
    return text;
}

template <class T>
T& target(T* out, const char* name = "out") {
    if (!out) refuse(std::string(name) + " is null", "give the address for the result");
    return *out;
}

template <class T>
std::span<const T> list_of(const T* first, std::size_t count, const char* name) {
    if (!first && count > 0) refuse(std::string(name) + " is null", "give the numbers, or a count of 0");
    if (count > (std::size_t{1} << 40)) refuse("there cannot be " + std::to_string(count) + " " + name, "check it");
    return {first, count};
}

embed::HostValue value_of(const sinew_input& input) {
    if (input.text && input.numbers) refuse("an input has both numbers and a text", "give one of them");
    if (input.text) return std::string(input.text);
    const auto numbers = list_of(input.numbers, input.count, "numbers");
    return std::vector<double>(numbers.begin(), numbers.end());
}

std::vector<double> points_of(const sinew_mesh& mesh) {
    const std::size_t stride = mesh.point_stride == 0 ? 3 * sizeof(double) : mesh.point_stride;
    if (mesh.point_count == 0) refuse("the mesh has no points", "give point_count and points");
    list_of(mesh.points, mesh.point_count, "points");
    if (stride < 3 * sizeof(double) || stride % sizeof(double) != 0)
        refuse("point_stride is " + std::to_string(stride), "give a multiple of 8 bytes, 24 or more");
    std::vector<double> out(3 * mesh.point_count);
    const auto* bytes = reinterpret_cast<const char*>(mesh.points);
    for (std::size_t i = 0; i < mesh.point_count; ++i)
        std::memcpy(out.data() + 3 * i, bytes + i * stride, 3 * sizeof(double));
    return out;
}

sinew_mesh mesh_of(const embed::Frame& frame, std::size_t index) {
    const nodes::Mesh& m = frame.meshes[index];
    static_assert(sizeof(solver::Vec3) == 3 * sizeof(double) && sizeof(solver::Triangle) == 3 * sizeof(int));
    sinew_mesh out{};
    out.name = frame.names[index].c_str();
    out.points = m.points->empty() ? nullptr : m.points->front().data();
    out.point_count = m.points->size();
    out.point_stride = sizeof(solver::Vec3);
    out.face_sizes = m.topology->face_sizes.data(), out.face_count = m.topology->face_sizes.size();
    out.face_vertices = m.topology->face_vertices.data(), out.corner_count = m.topology->face_vertices.size();
    out.triangles = m.topology->triangles.empty() ? nullptr : m.topology->triangles.front().data();
    out.triangle_count = m.topology->triangles.size();
    return out;
}

std::span<const double> numbers_of(const OpenFrame& f) {
    const engine::Value& v = f.frame.value;
    if (v.is<engine::NumberList>()) return v.as<engine::NumberList>();
    if (v.is<engine::Vec3>()) return v.as<engine::Vec3>();
    if (v.is<engine::Matrix4>()) return v.as<engine::Matrix4>();
    if (v.is<bool>() || v.is<std::int64_t>() || v.is<double>()) return {&f.single, 1};
    throw embed::Misuse("DG122", "a " + std::string(v.type_name()) + " is no list of numbers",
                        "ask for them of outputs that are numbers", f.frame.plug);
}

} // namespace

std::uintptr_t next_number() {
    static std::atomic<std::uintptr_t> last = 0;
    return ++last;
}

} // namespace sinew::c

using namespace sinew::c;
using sinew::engine::Plug;

const char* sinew_version(void) { return SINEW_VERSION; }

uint32_t sinew_abi_version(void) { return SINEW_ABI_VERSION; }

sinew_status sinew_open(const sinew_options* options, sinew_session** out) {
    return guarded([&] {
        target(out) = nullptr;
        const sinew_options known = options ? read_struct(options, "options") : sinew_options{};
        *out = reinterpret_cast<sinew_session*>(tables().sessions.add(std::make_shared<OpenSession>(known)));
    });
}

sinew_status sinew_close(sinew_session* session) {
    return guarded([&] {
        if (!session) return;
        session_of(session);
        tables().sessions.remove(reinterpret_cast<std::uintptr_t>(session));
    });
}

sinew_status sinew_load_file(sinew_session* session, const char* path) {
    return guarded([&] { session_of(session)->session.load_file(text_of(path, "path")); });
}

sinew_status sinew_load_text(sinew_session* session, const char* text, size_t length, const char* file_name) {
    return guarded([&] {
        const auto all = list_of(text, length, "text");
        session_of(session)->session.load_text({all.data(), all.size()}, file_name ? file_name : "graph.json");
    });
}

sinew_status sinew_get_timing(sinew_session* session, sinew_timing* out) {
    return guarded([&] {
        const auto graph = session_of(session)->session.graph();
        const auto& t = graph->timing();
        write_struct(out, {sizeof(sinew_timing), t.fps, t.start, t.end}, "out");
    });
}

sinew_status sinew_set_json(sinew_session* session, const char* node, const char* attribute, const char* json) {
    return guarded([&] {
        session_of(session)->session.set_json({text_of(node, "node"), text_of(attribute, "attribute")},
                                              text_of(json, "json"));
    });
}

sinew_status sinew_set_numbers(sinew_session* session, const char* node, const char* attribute, const double* numbers,
                               size_t count) {
    return guarded([&] {
        const auto all = list_of(numbers, count, "numbers");
        const sinew::embed::Setting setting{{text_of(node, "node"), text_of(attribute, "attribute")},
                                            std::vector<double>(all.begin(), all.end())};
        session_of(session)->session.set({&setting, 1});
    });
}

sinew_status sinew_set_text(sinew_session* session, const char* node, const char* attribute, const char* text) {
    return guarded([&] {
        const sinew::embed::Setting setting{{text_of(node, "node"), text_of(attribute, "attribute")},
                                            text_of(text, "text")};
        session_of(session)->session.set({&setting, 1});
    });
}

sinew_status sinew_set_inputs(sinew_session* session, double frame, const sinew_input* inputs, size_t count) {
    return guarded([&] {
        const auto open = session_of(session);
        if (count == 0) return;
        check_size(inputs, "inputs");
        std::vector<sinew::embed::Setting> settings;
        for (std::size_t i = 0; i < count; ++i) { // by the size that the caller's header has
            const auto* at = reinterpret_cast<const char*>(inputs) + i * inputs->size;
            const sinew_input input = read_struct(reinterpret_cast<const sinew_input*>(at), "an input");
            if (input.size != inputs->size) refuse("inputs differ in size", "initialise each with SINEW_SIZED");
            settings.push_back({{text_of(input.node, "node"), text_of(input.attribute, "attribute")}, value_of(input)});
        }
        open->session.set_at(frame, settings);
    });
}

sinew_status sinew_set_input(sinew_session* session, const char* node, const char* attribute, double frame,
                             const double* numbers, size_t count) {
    const sinew_input input{sizeof input, node, attribute, numbers, count, nullptr};
    return sinew_set_inputs(session, frame, &input, 1);
}

sinew_status sinew_set_mesh(sinew_session* session, const char* node, double frame, const sinew_mesh* mesh) {
    return guarded([&] {
        const auto open = session_of(session);
        const sinew_mesh given = read_struct(mesh, "mesh");
        const std::vector<double> points = points_of(given);
        open->session.set_mesh(text_of(node, "node"), frame,
                               {points, list_of(given.face_sizes, given.face_count, "face_sizes"),
                                list_of(given.face_vertices, given.corner_count, "face_vertices")});
    });
}

sinew_status sinew_evaluate(sinew_session* session, const char* plug, double frame, sinew_frame** out) {
    return guarded([&] {
        target(out) = nullptr;
        const auto open = session_of(session);
        auto result = std::make_shared<OpenFrame>(open->session.evaluate(frame, plug ? plug : ""));
        *out = reinterpret_cast<sinew_frame*>(tables().frames.add(std::move(result)));
    });
}

sinew_status sinew_is_ready(sinew_session* session, const char* plug, double frame, int* out) {
    return guarded([&] {
        target(out) = 0;
        *out = session_of(session)->session.is_ready(frame, plug ? plug : "");
    });
}

sinew_status sinew_cancel(sinew_session* session) {
    return guarded([&] { session_of(session, From::anywhere)->session.cancel(); });
}

sinew_status sinew_get_counts(sinew_session* session, sinew_counts* out) {
    return guarded([&] {
        const sinew::embed::Counts c = session_of(session, From::anywhere)->session.counts();
        write_struct(out, {sizeof(sinew_counts), c.simulated, c.computed, c.reused}, "out");
    });
}

sinew_status sinew_mesh_count(sinew_frame* frame, size_t* out) {
    return guarded([&] {
        target(out) = 0;
        *out = frame_of(frame)->frame.meshes.size();
    });
}

sinew_status sinew_find_mesh(sinew_frame* frame, const char* name, size_t* out) {
    return guarded([&] {
        target(out);
        const auto open = frame_of(frame);
        const std::string wanted = text_of(name, "name");
        const auto found = open->frame.find(wanted);
        if (!found)
            throw sinew::embed::Misuse("DG122", "the result has no mesh of \"" + wanted + "\"",
                                       "name a body of the list that was evaluated", open->frame.plug);
        *out = *found;
    });
}

sinew_status sinew_get_mesh(sinew_frame* frame, size_t index, sinew_mesh* out) {
    return guarded([&] {
        const auto open = frame_of(frame);
        check_size(out, "out");
        const std::size_t count = open->frame.meshes.size();
        if (index >= count)
            throw sinew::embed::Misuse("DG122",
                                       "mesh " + std::to_string(index) + " of " + std::to_string(count) + " is wanted",
                                       "count from 0", open->frame.plug);
        write_struct(out, mesh_of(open->frame, index), "out");
    });
}

sinew_status sinew_get_numbers(sinew_frame* frame, const double** numbers, size_t* count) {
    return guarded([&] {
        target(numbers, "numbers") = nullptr, target(count, "count") = 0;
        const auto open = frame_of(frame);
        const auto all = numbers_of(*open);
        *numbers = all.data(), *count = all.size();
    });
}

sinew_status sinew_get_report(sinew_frame* frame, const char** json) {
    return guarded([&] {
        target(json, "json") = nullptr;
        *json = frame_of(frame)->report().c_str();
    });
}

sinew_status sinew_release(sinew_frame* frame) {
    return guarded([&] {
        if (!frame) return;
        frame_of(frame);
        tables().frames.remove(reinterpret_cast<std::uintptr_t>(frame));
    });
}
