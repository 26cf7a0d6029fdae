// The C interface under a host that makes every mistake: each is refused and told, none ends the program.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/c/sinew.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

const std::string graph =
    R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 9}, "nodes": {
    "cube": {"type": "polyCube"}, "flesh": {"type": "zMaterial"}, "move": {"type": "transform"},
    "sent": {"type": "hostMesh"},
    "block": {"type": "zTissue", "inputs": {"mesh": {"from": "cube.outMesh"},
              "materials": [{"from": "flesh.outMaterial"}]}},
    "solver": {"type": "zSolver", "inputs": {"scale": 1, "bodies": [{"from": "block.outBody"}]}}}})";

/// The code of the only error of the last call.
std::string code() {
    if (sinew_error_count() != 1) return std::to_string(sinew_error_count()) + " errors";
    sinew_diagnostic d = SINEW_SIZED(sinew_diagnostic);
    REQUIRE(sinew_error(0, &d) == SINEW_OK);
    CHECK(std::strlen(d.message) > 0);
    const std::string code = d.code;
    if (code.starts_with("DG12")) CHECK(std::strlen(d.hint) > 0);
    return code;
}

struct Session {
    sinew_session* handle = nullptr;
    explicit Session(bool load = true, const sinew_options* options = nullptr) {
        REQUIRE(sinew_open(options, &handle) == SINEW_OK);
        if (load) REQUIRE(sinew_load_text(handle, graph.data(), graph.size(), nullptr) == SINEW_OK);
    }
    ~Session() { sinew_close(handle); }
    Session(const Session&) = delete;
};

struct Call {
    const char* name;
    std::function<sinew_status(sinew_session*)> call;
};

const double numbers[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

std::vector<Call> session_calls() {
    static sinew_frame* frame = nullptr;
    static sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
    static sinew_timing timing = SINEW_SIZED(sinew_timing);
    static sinew_counts counts = SINEW_SIZED(sinew_counts);
    static sinew_input input{sizeof(sinew_input), "move", "trackOffset", numbers, 1, nullptr};
    static int ready = 0;
    mesh.points = numbers, mesh.point_count = 3;
    return {{"load_file", [](sinew_session* s) { return sinew_load_file(s, "no.json"); }},
            {"load_text", [](sinew_session* s) { return sinew_load_text(s, "{}", 2, nullptr); }},
            {"get_timing", [](sinew_session* s) { return sinew_get_timing(s, &timing); }},
            {"set_json", [](sinew_session* s) { return sinew_set_json(s, "move", "scale", "[1, 1, 1]"); }},
            {"set_numbers", [](sinew_session* s) { return sinew_set_numbers(s, "move", "trackOffset", numbers, 1); }},
            {"set_text", [](sinew_session* s) { return sinew_set_text(s, "move", "rotateOrder", "zyx"); }},
            {"set_input", [](sinew_session* s) { return sinew_set_input(s, "move", "trackOffset", 1, numbers, 1); }},
            {"set_inputs", [](sinew_session* s) { return sinew_set_inputs(s, 1, &input, 1); }},
            {"set_mesh", [](sinew_session* s) { return sinew_set_mesh(s, "sent", 1, &mesh); }},
            {"evaluate", [](sinew_session* s) { return sinew_evaluate(s, nullptr, 1, &frame); }},
            {"is_ready", [](sinew_session* s) { return sinew_is_ready(s, nullptr, 1, &ready); }},
            {"cancel", [](sinew_session* s) { return sinew_cancel(s); }},
            {"get_counts", [](sinew_session* s) { return sinew_get_counts(s, &counts); }}};
}

} // namespace

TEST_CASE("null, released, foreign and invented handles are refused by every function", "[embed]") {
    Session open;
    sinew_session* released = nullptr;
    REQUIRE(sinew_open(nullptr, &released) == SINEW_OK);
    REQUIRE(sinew_close(released) == SINEW_OK);
    sinew_frame* frame = nullptr;
    REQUIRE(sinew_evaluate(open.handle, nullptr, 1, &frame) == SINEW_OK);
    int local = 0;
    for (auto* handle :
         {static_cast<sinew_session*>(nullptr), released, reinterpret_cast<sinew_session*>(frame),
          reinterpret_cast<sinew_session*>(&local), reinterpret_cast<sinew_session*>(~std::uintptr_t{0})})
        for (const Call& c : session_calls()) {
            INFO(c.name << " of " << handle);
            CHECK(c.call(handle) == SINEW_USAGE);
            CHECK(code() == "DG120");
        }
    CHECK(sinew_close(released) == SINEW_USAGE);
    CHECK(sinew_close(nullptr) == SINEW_OK);

    std::size_t count = 0;
    const double* values = nullptr;
    const char* text = nullptr;
    sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
    REQUIRE(sinew_get_mesh(frame, 0, &mesh) == SINEW_OK);
    REQUIRE(sinew_release(frame) == SINEW_OK);
    for (auto* handle : {static_cast<sinew_frame*>(nullptr), frame, reinterpret_cast<sinew_frame*>(open.handle)}) {
        CHECK((sinew_mesh_count(handle, &count) == SINEW_USAGE && code() == "DG120"));
        CHECK((sinew_find_mesh(handle, "block", &count) == SINEW_USAGE && code() == "DG120"));
        CHECK((sinew_get_mesh(handle, 0, &mesh) == SINEW_USAGE && code() == "DG120"));
        CHECK((sinew_get_numbers(handle, &values, &count) == SINEW_USAGE && code() == "DG120"));
        CHECK((sinew_get_report(handle, &text) == SINEW_USAGE && code() == "DG120"));
    }
    CHECK(sinew_release(frame) == SINEW_USAGE);
    CHECK(sinew_release(nullptr) == SINEW_OK);
}

TEST_CASE("a session without a graph says so", "[embed]") {
    Session empty(false);
    for (const Call& c : session_calls()) {
        const std::string name = c.name;
        if (name.starts_with("load") || name == "cancel" || name == "get_counts") continue;
        INFO(name);
        CHECK(c.call(empty.handle) == SINEW_USAGE);
        CHECK(code() == "DG121");
    }
}

TEST_CASE("null arguments and structures without a size are refused", "[embed]") {
    Session s;
    sinew_frame* frame = nullptr;
    REQUIRE(sinew_evaluate(s.handle, nullptr, 1, &frame) == SINEW_OK);
    const auto refused = [&](sinew_status status) {
        const std::string said = code();
        INFO(sinew_error_text());
        CHECK(status == SINEW_USAGE);
        CHECK(said == "DG123");
    };
    std::size_t count = 0;
    const double* values = nullptr;
    sinew_mesh unsized{}, mesh = SINEW_SIZED(sinew_mesh);
    sinew_options options{}, many = SINEW_SIZED(sinew_options);
    many.threads = -2;
    sinew_session* opened = s.handle;
    refused(sinew_open(nullptr, nullptr));
    refused(sinew_open(&options, &opened));
    CHECK(opened == nullptr);
    refused(sinew_open(&many, &opened));
    refused(sinew_load_file(s.handle, nullptr));
    refused(sinew_load_text(s.handle, nullptr, 5, nullptr));
    refused(sinew_get_timing(s.handle, nullptr));
    refused(sinew_set_json(s.handle, nullptr, "scale", "1"));
    refused(sinew_set_json(s.handle, "move", nullptr, "1"));
    refused(sinew_set_json(s.handle, "move", "scale", nullptr));
    refused(sinew_set_numbers(s.handle, "move", "scale", nullptr, 3));
    refused(sinew_set_numbers(s.handle, "move", "scale", numbers, 2));
    refused(sinew_set_numbers(s.handle, "move", "scale", numbers, ~std::size_t{0}));
    refused(sinew_set_text(s.handle, "move", "rotateOrder", nullptr));
    refused(sinew_set_inputs(s.handle, 1, nullptr, 1));
    sinew_input input{};
    refused(sinew_set_inputs(s.handle, 1, &input, 1));
    input = {sizeof input, "move", nullptr, numbers, 1, nullptr};
    refused(sinew_set_inputs(s.handle, 1, &input, 1));
    input = {sizeof input, "move", "rotateOrder", numbers, 1, "zyx"};
    refused(sinew_set_inputs(s.handle, 1, &input, 1));
    sinew_input two[2] = {{sizeof input, "move", "trackOffset", numbers, 1, nullptr},
                          {sizeof input - 8, "move", "trackOffset", numbers, 1, nullptr}};
    refused(sinew_set_inputs(s.handle, 1, two, 2));
    refused(sinew_set_input(s.handle, "move", "trackOffset", std::nan(""), numbers, 1));
    refused(sinew_set_mesh(s.handle, "sent", 1, nullptr));
    refused(sinew_set_mesh(s.handle, "sent", 1, &mesh));
    mesh.points = numbers, mesh.point_count = 2, mesh.point_stride = 20;
    refused(sinew_set_mesh(s.handle, "sent", 1, &mesh));
    mesh.point_stride = 0, mesh.face_count = 3;
    refused(sinew_set_mesh(s.handle, "sent", 1, &mesh));
    mesh.face_count = 0;
    refused(sinew_set_mesh(s.handle, "cube", 1, &mesh));
    refused(sinew_evaluate(s.handle, nullptr, 1, nullptr));
    refused(sinew_is_ready(s.handle, nullptr, 1, nullptr));
    refused(sinew_get_counts(s.handle, nullptr));
    refused(sinew_mesh_count(frame, nullptr));
    refused(sinew_find_mesh(frame, nullptr, &count));
    refused(sinew_find_mesh(frame, "block", nullptr));
    refused(sinew_get_mesh(frame, 0, nullptr));
    refused(sinew_get_mesh(frame, 0, &unsized));
    refused(sinew_get_numbers(frame, nullptr, &count));
    refused(sinew_get_numbers(frame, &values, nullptr));
    refused(sinew_get_report(frame, nullptr));
    CHECK(sinew_error(0, nullptr) == SINEW_USAGE);
    CHECK(sinew_release(frame) == SINEW_OK);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // which end the program over so large a wish
TEST_CASE("what there is no memory for is told as that, and the session goes on", "[embed]") {
    Session s;
    const double point[3] = {0, 0, 0};
    sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
    mesh.points = point, mesh.point_count = std::size_t{1} << 40; // 26 TB
    CHECK(sinew_set_mesh(s.handle, "sent", 1, &mesh) == SINEW_GRAPH_WRONG);
    CHECK(code() == "FE305");
    sinew_frame* frame = nullptr;
    CHECK(sinew_evaluate(s.handle, nullptr, 1, &frame) == SINEW_OK);
    sinew_release(frame);
}
#endif

TEST_CASE("names, places and frames that are not there are told", "[embed]") {
    Session s;
    sinew_frame* frame = nullptr;
    std::size_t place = 0;
    const double* values = nullptr;
    sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
    const auto fails = [&](sinew_status status, sinew_status wanted, const char* with) {
        const std::string said = code();
        CHECK(status == wanted);
        CHECK(said == with);
    };
    fails(sinew_evaluate(s.handle, "solver", 1, &frame), SINEW_USAGE, "DG126");
    fails(sinew_evaluate(s.handle, "solvr.outMeshes", 1, &frame), SINEW_USAGE, "DG102");
    fails(sinew_evaluate(s.handle, "solver.outMesh", 1, &frame), SINEW_USAGE, "DG102");
    fails(sinew_evaluate(s.handle, nullptr, 1.5, &frame), SINEW_GRAPH_WRONG, "DG103");
    fails(sinew_evaluate(s.handle, nullptr, std::numeric_limits<double>::infinity(), &frame), SINEW_USAGE, "DG104");
    fails(sinew_evaluate(s.handle, nullptr, std::nan(""), &frame), SINEW_USAGE, "DG104");
    int ready = 0;
    fails(sinew_is_ready(s.handle, nullptr, std::nan(""), &ready), SINEW_USAGE, "DG104");
    fails(sinew_is_ready(s.handle, "solver.outMesh", 1, &ready), SINEW_USAGE, "DG102");
    fails(sinew_set_json(s.handle, "move", "scal", "1"), SINEW_USAGE, "DG011");
    fails(sinew_evaluate(s.handle, "sent.outMesh", 1, &frame), SINEW_GRAPH_WRONG, "DG124");
    fails(sinew_set_numbers(s.handle, "moved", "scale", numbers, 3), SINEW_USAGE, "DG040");
    fails(sinew_set_input(s.handle, "move", "scal", 1, numbers, 3), SINEW_USAGE, "DG011");
    fails(sinew_set_input(s.handle, "block", "mesh", 1, numbers, 3), SINEW_GRAPH_WRONG, "DG026");
    mesh.points = numbers, mesh.point_count = 1;
    fails(sinew_set_mesh(s.handle, "sending", 1, &mesh), SINEW_USAGE, "DG040");
    REQUIRE(frame == nullptr);
    REQUIRE(sinew_evaluate(s.handle, nullptr, 1, &frame) == SINEW_OK);
    fails(sinew_get_mesh(frame, 1, &mesh), SINEW_USAGE, "DG122");
    fails(sinew_get_mesh(frame, ~std::size_t{0}, &mesh), SINEW_USAGE, "DG122");
    fails(sinew_find_mesh(frame, "flesh", &place), SINEW_USAGE, "DG122");
    fails(sinew_get_numbers(frame, &values, &place), SINEW_USAGE, "DG122");
    CHECK(sinew_release(frame) == SINEW_OK);
}

TEST_CASE("programs with an older header get what they know, and nothing behind it is touched", "[embed]") {
    Session s;
    sinew_frame* frame = nullptr;
    REQUIRE(sinew_evaluate(s.handle, nullptr, 1, &frame) == SINEW_OK);
    sinew_mesh mesh{};
    std::memset(&mesh, 0x5a, sizeof mesh);
    mesh.size = offsetof(sinew_mesh, face_sizes);
    REQUIRE(sinew_get_mesh(frame, 0, &mesh) == SINEW_OK);
    CHECK(mesh.size == offsetof(sinew_mesh, face_sizes));
    CHECK(mesh.point_count == 8);
    std::uintptr_t untouched = 0;
    std::memcpy(&untouched, &mesh.face_sizes, sizeof untouched);
    CHECK(untouched == 0x5a5a5a5a5a5a5a5a);
    // And one with a newer header: what the library does not know stays.
    struct Newer {
        sinew_counts known;
        std::int64_t more;
    } newer{{sizeof(Newer), 0, 0, 0}, 77};
    REQUIRE(sinew_get_counts(s.handle, &newer.known) == SINEW_OK);
    CHECK(newer.known.simulated == 1);
    CHECK(newer.more == 77);
    CHECK(sinew_release(frame) == SINEW_OK);
}

TEST_CASE("a mesh stays readable after the session has gone and the graph was changed", "[embed]") {
    sinew_frame* frame = nullptr;
    sinew_mesh mesh = SINEW_SIZED(sinew_mesh), again = SINEW_SIZED(sinew_mesh);
    {
        Session s;
        REQUIRE(sinew_evaluate(s.handle, "cube.outMesh", 1, &frame) == SINEW_OK);
        REQUIRE(sinew_get_mesh(frame, 0, &mesh) == SINEW_OK);
        const double wide = 4;
        REQUIRE(sinew_set_numbers(s.handle, "cube", "width", &wide, 1) == SINEW_OK);
    }
    REQUIRE(sinew_get_mesh(frame, 0, &again) == SINEW_OK);
    CHECK(again.points == mesh.points); // no copy
    for (std::size_t i = 0; i < 24; ++i) CHECK(std::abs(mesh.points[i]) == 0.5);
    CHECK(std::string(mesh.name) == "cube");
    CHECK(sinew_release(frame) == SINEW_OK);
}

TEST_CASE("what a callback throws cancels and goes no further", "[embed]") {
    sinew_options options = SINEW_SIZED(sinew_options);
    options.on_event = [](void*, const sinew_event* e) -> int {
        if (e->kind == SINEW_STEPPED) throw std::runtime_error("of the host");
        return 0;
    };
    Session s(true, &options);
    sinew_frame* frame = nullptr;
    CHECK(sinew_evaluate(s.handle, nullptr, 5, &frame) == SINEW_CANCELLED);
    CHECK(frame == nullptr);
}

TEST_CASE("in a callback a session is refused to all but what counts and cancels", "[embed]") {
    static sinew_session* own;
    static std::vector<std::string> refused, allowed;
    refused.clear(), allowed.clear();
    sinew_options options = SINEW_SIZED(sinew_options);
    options.on_event = [](void*, const sinew_event* e) -> int {
        if (e->kind != SINEW_STEPPED || e->frame != 2) return 0;
        for (const Call& c : session_calls()) {
            if (std::string(c.name) == "cancel") continue; // which would end what this is called by
            const sinew_status status = c.call(own);
            if (status == SINEW_OK) allowed.push_back(c.name);
            if (status == SINEW_USAGE && code() == "DG140") refused.push_back(c.name);
        }
        return 0;
    };
    Session s(true, &options);
    own = s.handle;
    sinew_frame* frame = nullptr;
    REQUIRE(sinew_evaluate(s.handle, nullptr, 2, &frame) == SINEW_OK);
    sinew_release(frame);
    CHECK(allowed == std::vector<std::string>{"get_counts"});
    CHECK(refused.size() == session_calls().size() - 2);
}

TEST_CASE("threads may share a session, cancel it and close it while others evaluate", "[embed]") {
    for (int round = 0; round < 4; ++round) {
        sinew_session* s = nullptr;
        REQUIRE(sinew_open(nullptr, &s) == SINEW_OK);
        REQUIRE(sinew_load_text(s, graph.data(), graph.size(), nullptr) == SINEW_OK);
        std::atomic<int> unforeseen = 0;
        std::vector<std::thread> threads;
        for (int t = 0; t < 3; ++t)
            threads.emplace_back([&, t] {
                for (int frame = 1; frame < 8; ++frame) {
                    sinew_frame* result = nullptr;
                    const double lift = t;
                    sinew_set_input(s, "move", "trackOffset", frame, &lift, 1);
                    const sinew_status status = sinew_evaluate(s, nullptr, frame, &result);
                    if (status != SINEW_OK && status != SINEW_CANCELLED && status != SINEW_USAGE) ++unforeseen;
                    if ((status == SINEW_OK) != (result != nullptr)) ++unforeseen;
                    sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
                    if (result && (sinew_get_mesh(result, 0, &mesh) != SINEW_OK || mesh.point_count != 8)) ++unforeseen;
                    sinew_release(result);
                }
            });
        threads.emplace_back([&] {
            for (int i = 0; i < 50; ++i) sinew_cancel(s);
            sinew_close(s);
        });
        for (std::thread& t : threads) t.join();
        CHECK(unforeseen == 0);
    }
}

TEST_CASE("errors belong to the thread whose call failed", "[embed]") {
    CHECK(sinew_load_file(nullptr, "x") == SINEW_USAGE);
    std::thread([] {
        CHECK(sinew_error_count() == 0);
        CHECK(std::string(sinew_error_text()).empty());
    }).join();
    CHECK(sinew_error_count() == 1);
    CHECK(std::string(sinew_error_text()).find("DG120") != std::string::npos);
}
