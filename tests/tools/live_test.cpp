// `sinew live` by its own interface: who may ask, what a save, a broken save and a change do. The page itself is tested
// in a browser (tests/viewer/live_test.mjs).
// SPDX-License-Identifier: GPL-3.0-or-later
#define CPPHTTPLIB_OPENSSL_SUPPORT
#define CPPHTTPLIB_ZLIB_SUPPORT
#define CPPHTTPLIB_BROTLI_SUPPORT
#include "tests/tools/program.h"
#include "tools/live/watched_files.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <httplib.h>
#include <netinet/in.h>
#include <set>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

using namespace sinew;
using namespace sinew::test;
using nlohmann::json;
using namespace std::chrono_literals;

namespace {

/// All at once: a program that looks meanwhile must not find half of it.
void write(const std::filesystem::path& file, const std::string& text) {
    const std::filesystem::path aside = file.string() + ".new";
    std::ofstream(aside) << text;
    std::filesystem::rename(aside, file);
}

/// The program at work, and what it answers.
struct Live {
    Program program;
    std::string root; ///< "/TOKEN/"
    std::unique_ptr<httplib::Client> http;
    int port = 0;

    explicit Live(const std::vector<std::string>& words)
        : program(words) {
        for (int k = 0; k < 400 && root.empty(); ++k) {
            std::this_thread::sleep_for(25ms);
            const std::string out = program.out();
            const std::size_t at = out.find("http://127.0.0.1:"), end = out.find('\n', at);
            if (at == std::string::npos || end == std::string::npos) continue;
            const std::string rest = out.substr(at + 17, end - at - 17);
            port = std::stoi(rest);
            root = rest.substr(rest.find('/'));
        }
        REQUIRE_FALSE(root.empty());
        http = std::make_unique<httplib::Client>("127.0.0.1", port);
    }
    json status() const { return json::parse(http->Get(root + "status")->body); }
    /// Waits for the end of run `number` or of a later one.
    json ended(int number) const {
        json s;
        for (int k = 0; k < 400; ++k) {
            s = status();
            if (s["run"] >= number && s["state"] != "running") return s;
            std::this_thread::sleep_for(25ms);
        }
        FAIL("no end of run " << number << ": " << s.dump());
        return s;
    }
    int post(const std::string& what, const json& body) const {
        return http->Post(root + what, body.dump(), "application/json")->status;
    }
};

/// Of the answer to a POST that has no header but Host.
std::string first_line(const Live& live, const std::string& what) {
    const int s = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET, to.sin_port = htons(static_cast<std::uint16_t>(live.port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(connect(s, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
    const std::string request = "POST " + live.root + what + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
    REQUIRE(send(s, request.data(), request.size(), 0) == static_cast<ssize_t>(request.size()));
    std::string out(64, '\0');
    out.resize(static_cast<std::size_t>(std::max<ssize_t>(recv(s, out.data(), out.size(), 0), 0)));
    close(s);
    return out.substr(0, out.find('\r'));
}

} // namespace

TEST_CASE("live: only who knows the token and asks for this machine is answered", "[live]") {
    const TemporaryFolder folder;
    const Live live({"live", write_graph(folder, small_graph()), "--no-cache", "--frames", "1-2"});
    CHECK(live.root.size() == 34); // 128 bits in hexadecimal digits between slashes
    CHECK(live.http->Get(live.root)->status == 200);
    CHECK(live.http->Get("/")->status == 404);
    CHECK(live.http->Get("/status")->status == 404);
    CHECK(live.http->Get("/0123456789abcdef0123456789abcdef/status")->status == 404);
    const httplib::Headers elsewhere{{"Host", "example.org:" + std::to_string(live.port)}};
    CHECK(live.http->Get(live.root + "status", elsewhere)->status == 403);
    CHECK(live.http->Post(live.root + "save", elsewhere, "{}", "application/json")->status == 403);
    // Behind a tunnel it is another port of this machine, and never another name.
    for (const char* host : {"127.0.0.1:9000", "localhost:9000", "localhost", "[::1]:9000"})
        CHECK(live.http->Get(live.root + "status", {{"Host", host}})->status == 200);
    for (const char* host :
         {"127.0.0.1.example.org:9000", "localhost.example.org", "example.org", "127.0.0.1:", "127.0.0.2"})
        CHECK(live.http->Get(live.root + "status", {{"Host", host}})->status == 403);
    CHECK(live.http->Get(live.root)->get_header_value("Content-Security-Policy").find("default-src 'none'") == 0);
    CHECK(live.http->Get(live.root)->get_header_value("Cache-Control") == "no-store");
}

TEST_CASE("live: a save runs what changed, a save of the same runs nothing, and Ctrl-C ends it", "[live]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    const std::string file = write_graph(folder, graph);
    Live live({"live", file, "--no-cache"});
    const json first = live.ended(1);
    CHECK(first["state"] == "ready");
    CHECK(first["simulated"] == 6);
    CHECK(first["frames"] == json({1, 2, 3, 4, 5, 6}));
    CHECK(live.http->Get(live.root + "page/1")->body.find("id=\"sinew-scene\"") != std::string::npos);
    const std::string text = read_text(file);
    write(file, text + "\n");
    const json again = live.ended(2);
    CHECK(again["simulated"] == 0);
    CHECK(again["files"] == json({file}));
    for (auto& [name, node] : graph["nodes"].items())
        if (node["type"] == "zSolver") node["inputs"]["gravity"] = {0, -3, 0};
    write(file, graph.dump());
    CHECK(live.ended(3)["simulated"] == 6);
    live.program.signal(SIGINT);
    CHECK(live.program.exit_code() == 0);
}

TEST_CASE("live: the first frame that is new is there before its page, and nothing is packed", "[live]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    const std::string file = write_graph(folder, graph);
    const Live live({"live", file, "--no-cache"});
    const auto look = [&] { return json::parse(live.http->Get(live.root + "preview/1")->body); };
    const json first = live.ended(1);
    CHECK(first["preview"] == 1);
    CHECK((first["preview_s"] > 0 && first["preview_s"] <= first["firstPage_s"]));
    CHECK(look()["frame"] == 2); // the start was there when it was looked for what is wrong
    // With a key at frame 4 the frames before it are those of the last run.
    graph["nodes"]["flesh"]["inputs"]["youngsModulus"] = {{"keys", {{3, 20000}, {4, 40000}}}, {"interp", "step"}};
    write(file, graph.dump());
    CHECK(live.ended(2)["preview"] == 2);
    const json there = look();
    CHECK(there["frame"] == 4);
    REQUIRE(there["bodies"].size() == 3);
    CHECK(there["bodies"][2]["name"] == "block");
    // Its first point as a run writes it.
    const Said ran = run_program(
        {"run", file, "--no-cache", "--frames", "4", "--out", (folder / "out").string(), "--format", "obj"});
    REQUIRE(ran.code == 0);
    const std::string obj = read_text(folder / "out" / "obj" / "block.0004.obj");
    double x = 0, y = 0, z = 0;
    REQUIRE(std::sscanf(obj.c_str() + obj.find("\nv "), "\nv %lf %lf %lf", &x, &y, &z) == 3);
    const std::string packed = there["bodies"][2]["positions"];
    std::vector<unsigned char> bytes;
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < 16; i += 4) {
        std::uint32_t four = 0;
        for (std::size_t k = 0; k < 4; ++k) four = four << 6 | static_cast<std::uint32_t>(letters.find(packed[i + k]));
        for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<unsigned char>(four >> shift));
    }
    std::array<float, 3> point{};
    std::memcpy(point.data(), bytes.data(), sizeof point);
    CHECK(point[0] == Approx(x).margin(1e-5));
    CHECK(point[1] == Approx(y).margin(1e-5));
    CHECK(point[2] == Approx(z).margin(1e-5));
    // A save that changes nothing has nothing new to show. Packing would take longer than sending.
    write(file, graph.dump(2));
    CHECK(live.ended(3)["preview"] == 2);
    for (const char* what : {"nodes", "preview/2", "status", "page/1"}) {
        const auto answer = live.http->Get(live.root + what, {{"Accept-Encoding", "gzip, br"}});
        CHECK_FALSE(answer->has_header("Content-Encoding"));
    }
}

TEST_CASE("live: a broken save is told with its place, and the last page stays", "[live]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, small_graph());
    const Live live({"live", file, "--no-cache", "--frames", "1-2"});
    live.ended(1);
    const std::string page = live.http->Get(live.root + "page/1")->body;
    const std::string text = read_text(file);
    write(file, text.substr(0, text.size() / 2));
    const json wrong = live.ended(2);
    CHECK(wrong["state"] == "wrong");
    REQUIRE(wrong["diagnostics"].size() == 1);
    CHECK(wrong["diagnostics"][0]["code"] == "DG001");
    CHECK(wrong["diagnostics"][0]["text"].get<std::string>().find(file + ":") == 0);
    CHECK(live.http->Get(live.root + "page/1")->body == page);
    write(file, text);
    CHECK(live.ended(3)["state"] == "ready");
}

TEST_CASE("live: a graph that is wrong from the start can be mended, and a file that is not there is refused",
          "[live]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "later.json").string();
    CHECK(run_program({"live", file}).code == 1);
    write(file, "{");
    const Live live({"live", file, "--no-cache", "--frames", "1"});
    CHECK(live.ended(1)["state"] == "wrong");
    CHECK(live.http->Get(live.root + "page/1")->status == 404);
    write(file, small_graph().dump());
    CHECK(live.ended(2)["state"] == "ready");
}

TEST_CASE("live: changes are kept apart from the file until they are written, and what fits nowhere is refused",
          "[live]") {
    const TemporaryFolder folder;
    const json graph = small_graph();
    const std::string file = write_graph(folder, graph), text = "// mine\n" + read_text(file);
    write(file, text);
    std::string solver, material;
    for (const auto& [name, node] : graph["nodes"].items()) {
        if (node["type"] == "zSolver") solver = name;
        if (node["type"] == "zMaterial") material = name;
    }
    const Live live({"live", file, "--no-cache"});
    live.ended(1);
    CHECK(live.post("change", {{"node", solver}, {"attribute", "substeps"}, {"value", 2}}) == 200);
    json s = live.ended(2);
    CHECK(s["simulated"] == 6);
    CHECK(s["changes"] == json::parse(R"([{"node":")" + solver + R"(","attribute":"substeps","value":2}])"));
    CHECK(read_text(file) == text);
    // A key at frame 5 leaves 1 to 4 alone.
    CHECK(live.post("change", {{"node", material}, {"attribute", "massDensity"}, {"value", 1060}, {"frame", 4}}) ==
          200);
    live.ended(3);
    CHECK(live.post("change", {{"node", material}, {"attribute", "massDensity"}, {"value", 2000}, {"frame", 5}}) ==
          200);
    CHECK(live.ended(4)["simulated"] == 2);
    for (const json& bad : {json{{"node", solver}, {"attribute", "substeps"}, {"value", -1}},
                            json{{"node", "nobody"}, {"attribute", "substeps"}, {"value", 1}},
                            json{{"node", solver}, {"attribute", "substep"}, {"value", 1}},
                            json{{"node", material}, {"attribute", "massDensity"}, {"value", "x"}, {"frame", 1}}})
        CHECK(live.post("change", bad) == 422);
    CHECK(live.post("change", {{"node", solver}}) == 400);
    for (const json& frame : {json(1e300), json(1.5), json("4")})
        CHECK(live.post("change", {{"node", material}, {"attribute", "massDensity"}, {"value", 1}, {"frame", frame}}) ==
              400);
    const std::string deep = R"({"node":"x","attribute":"y","value":)" + std::string(60000, '[');
    CHECK(live.http->Post(live.root + "change", deep + std::string(60000, ']') + "}", "application/json")->status ==
          400);
    CHECK(live.status()["changes"].size() == 3);
    CHECK(live.post("save", {}) == 200);
    const std::string written = read_text(file);
    CHECK(written.find("// mine") != std::string::npos);
    const json now = json::parse(written, nullptr, true, true);
    CHECK(now["nodes"][solver]["inputs"]["substeps"] == 2);
    CHECK(now["nodes"][material]["inputs"]["massDensity"]["keys"].back() == json::parse("[5,2000]"));
    s = live.ended(5);
    CHECK(s["changes"].empty());
    CHECK(s["simulated"] == 0);
    CHECK(live.post("change", {{"node", solver}, {"attribute", "substeps"}, {"value", 3}}) == 200);
    CHECK(live.post("discard", {}) == 200);
    CHECK(live.status()["changes"].empty());
    CHECK(read_text(file) == written);
}

TEST_CASE("live: requests that are wrong are told in words, and those without a body are taken", "[live]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, small_graph());
    const Live live({"live", file, "--no-cache", "--frames", "1"});
    live.ended(1);
    const auto told = [&](const std::string& body) {
        const auto answer = live.http->Post(live.root + "change", body, "application/json");
        CHECK(answer->status == 400);
        CHECK(answer->body.find("json.exception") == std::string::npos);
        return json::parse(answer->body).at("error").get<std::string>();
    };
    CHECK(told("{\"node\":") == "the body is no JSON at its byte 9");
    CHECK(told("") == "the request has no body: send JSON");
    CHECK(told(std::string(100, '[') + std::string(100, ']')) ==
          "nested too deeply: more than 64 brackets in each other");
    for (const char* body : {"[]", "3", R"({"node": "solver"})", R"({"node": 3, "attribute": "substeps", "value": 1})",
                             R"({"node": "solver", "attribute": "substeps"})"})
        CHECK(told(body).find(R"(a change is { "node": "…", "attribute": "…", "value": … })") == 0);
    for (const char* frame : {"1.5", "\"4\"", "1e300", "10000001", "18446744073709551615", "9223372036854775808"})
        CHECK(told(R"({"node": "solver", "attribute": "substeps", "value": 1, "frame": )" + std::string(frame) + "}") ==
              "\"frame\" is a whole number from -10000000 to 10000000");
    // As `curl -X POST` sends it: neither a length nor a type, which the library's own client never leaves out.
    for (const char* what : {"save", "discard"}) CHECK(first_line(live, what) == "HTTP/1.1 200 OK");
}

TEST_CASE("live: a required list is not emptied, as no file could say so", "[live]") {
    const TemporaryFolder folder;
    const std::string file = write_graph(folder, small_graph()), text = read_text(file);
    const Live live({"live", file, "--no-cache", "--frames", "1"});
    live.ended(1);
    const json change{{"node", "solver"}, {"attribute", "bodies"}, {"value", json::array()}};
    const auto answer = live.http->Post(live.root + "change", change.dump(), "application/json");
    CHECK(answer->status == 422);
    const json told = json::parse(answer->body).at("diagnostics");
    REQUIRE(told.size() == 1);
    CHECK(told[0]["code"] == "DG021");
    CHECK(told[0]["node"] == "solver");
    CHECK(told[0]["attribute"] == "bodies");
    CHECK(live.status()["changes"].empty());
    CHECK(live.post("change", {{"node", "solver"}, {"attribute", "attachments"}, {"value", json::array()}}) == 200);
    CHECK(live.post("save", {}) == 200);
    CHECK(json::parse(read_text(file))["nodes"]["solver"]["inputs"].value("attachments", json::array()).empty());
}

TEST_CASE("live: what is written changes nothing else of the file, and nothing is written without changes", "[live]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "mine.json").string();
    const std::string text = R"(// by hand
{ "format": "sinew 1", "timing": { "fps" : 24,"start":1, "end": 3 },
  "nodes": {
    "ball": { "type": "polySphere", "inputs": { "radius": 1.0 } }, // a default, written out
      "flesh" : {"type": "zMaterial",   "inputs": { "massDensity": { "value": 1.060, "unit": "g/cm^3" }, "poissonsRatio": 0.40,
          "youngsModulus": { "keys": [[1, 1.0e1], [3, 30.50]], "unit": "kPa" } // stiffer and stiffer
      } },
    "tissue": { "type": "zTissue", "inputs": { "mesh": { "from": "ball.outMesh" }, "materials": [ { "from": "flesh.outMaterial" } ] } },
    "solver": { "type": "zSolver", "inputs": { "bodies": [ { "from": "tissue.outBody" } ] } } } }
)";
    write(file, text);
    const Live live({"live", file, "--no-cache"});
    live.ended(1);
    const auto before = std::filesystem::last_write_time(file);
    CHECK(live.post("save", {}) == 200);
    CHECK(std::filesystem::last_write_time(file) == before);
    const auto change = [&](json what) { CHECK(live.post("change", what) == 200); };
    change({{"node", "flesh"}, {"attribute", "massDensity"}, {"value", {{"value", 1.1}, {"unit", "g/cm^3"}}}});
    change({{"node", "flesh"}, {"attribute", "youngsModulus"}, {"value", 20100}, {"frame", 2}}); // in Pa
    change({{"node", "solver"}, {"attribute", "substeps"}, {"value", 2}});
    change({{"node", "ball"}, {"attribute", "radius"}, {"value", 1}}); // as it is
    CHECK(live.post("save", {}) == 200);
    std::string wanted = text;
    const auto put = [&](const std::string& from, const std::string& to) {
        wanted.replace(wanted.find(from), from.size(), to);
    };
    put("1.060", "1.1");
    put("[3, 30.50]", "[2, 20.1], [3, 30.50]");
    put(R"({ "from": "tissue.outBody" } ])", R"({ "from": "tissue.outBody" } ], "substeps": 2)");
    CHECK(read_text(file) == wanted);
    CHECK(live.status()["changes"].empty());
}

TEST_CASE("live: a key among others may be a vector or have a unit", "[live]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["flesh"]["inputs"]["youngsModulus"] = {{"keys", {{1, 10}, {4, 40}}}, {"unit", "kPa"}};
    const std::string file = write_graph(folder, graph);
    const Live live({"live", file, "--no-cache", "--frames", "1"});
    live.ended(1);
    const auto change = [&](const char* node, const char* attribute, const json& value, int frame) {
        return live.post("change", {{"node", node}, {"attribute", attribute}, {"value", value}, {"frame", frame}});
    };
    CHECK(change("flesh", "youngsModulus", "30 kPa", 2) == 200);
    CHECK(change("flesh", "youngsModulus", {{"value", 0.035}, {"unit", "MPa"}}, 3) == 200);
    CHECK(change("upperMove", "translate", {0.25, 4.5, 0}, 3) == 200);
    CHECK(change("upperMove", "translate", {0.25, 4.5}, 4) == 422);
    CHECK(change("flesh", "youngsModulus", "30 m", 5) == 422);
    CHECK(change("flesh", "youngsModulus", {{"keys", {{1, 1}}}}, 5) == 422);
    CHECK(live.post("save", {}) == 200);
    const json now = json::parse(read_text(file))["nodes"];
    CHECK(now["flesh"]["inputs"]["youngsModulus"] ==
          json::parse(R"({"keys": [[1, 10], [2, 30], [3, 35], [4, 40]], "unit": "kPa"})"));
    CHECK(now["upperMove"]["inputs"]["translate"]["keys"] ==
          json::parse("[[1, [0, 4.5, 0]], [3, [0.25, 4.5, 0]], [6, [0.5, 4.7, 0]]]"));
}

TEST_CASE("live: a change that no longer fits is told, and what the reader noted is kept beside it", "[live]") {
    const TemporaryFolder folder;
    json graph = small_graph();
    graph["nodes"]["strange"] = {{"type", "zNobodyKnows"}}; // noted
    const std::string file = write_graph(folder, graph);
    const Live live({"live", file, "--no-cache", "--frames", "1"});
    live.ended(1);
    CHECK(live.post("change", {{"node", "flesh"}, {"attribute", "youngsModulus"}, {"value", 5000}}) == 200);
    live.ended(2);
    json without = graph;
    without["nodes"]["meat"] = without["nodes"]["flesh"];
    without["nodes"].erase("flesh");
    without["nodes"]["block"]["inputs"]["materials"][0]["from"] = "meat.outMaterial";
    write(file, without.dump());
    const std::string saved = read_text(file);
    const json wrong = live.ended(3);
    CHECK(wrong["state"] == "wrong");
    const json& told = wrong["diagnostics"].back();
    CHECK(told["code"] == "DG175");
    CHECK(told["node"] == "flesh");
    CHECK(told["attribute"] == "youngsModulus");
    CHECK(told["message"].get<std::string>().find("5000") != std::string::npos);
    CHECK(live.post("save", {}) == 422);
    CHECK(live.post("change", {{"node", "meat"}, {"attribute", "youngsModulus"}, {"value", 6000}}) == 422);
    CHECK(read_text(file) == saved);
    CHECK(live.post("discard", {}) == 200);
    CHECK(live.ended(4)["state"] == "ready");
    // A run that is wrong keeps what was noted of the file.
    without["nodes"]["meat"]["inputs"]["youngsModulus"] = 5000;
    without["nodes"]["plateMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", "none.obj"}}}};
    write(file, without.dump());
    const json broken = live.ended(5);
    CHECK(broken["state"] == "wrong");
    std::set<std::string> codes;
    for (const json& d : broken["diagnostics"]) codes.insert(d["code"].get<std::string>());
    CHECK(codes == std::set<std::string>{"DG010", "IO401"});
}

TEST_CASE("live: with a root nothing outside of it is read, watched or written", "[live]") {
    const TemporaryFolder folder;
    const std::filesystem::path root = folder / "jobs";
    std::filesystem::create_directories(root);
    const std::string outside = write_graph(folder, small_graph(), "outside.json"), file = root / "graph.json";
    const Said refused = run_program({"live", outside, "--root", root.string(), "--no-cache"});
    CHECK(refused.code == 1);
    CHECK(refused.err.find("[IO410]") != std::string::npos);
    std::filesystem::copy_file(outside, file);
    const Live live({"live", file, "--no-cache", "--frames", "1", "--root", root.string()});
    CHECK(live.ended(1)["state"] == "ready");
    // What the page sets is confined, too.
    json graph = small_graph();
    for (const std::filesystem::path& mesh : {folder / "secret.obj", root / "mine.obj"})
        write_text(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    graph["nodes"]["plateMesh"] = {{"type", "meshFile"}, {"inputs", {{"file", "mine.obj"}}}};
    write(file, graph.dump());
    live.ended(2);
    const json out{{"node", "plateMesh"}, {"attribute", "file"}, {"value", "../secret.obj"}};
    const auto answer = live.http->Post(live.root + "change", out.dump(), "application/json");
    CHECK(answer->status == 422);
    INFO(answer->body);
    CHECK(answer->body.find("IO410") != std::string::npos);
    write(file, small_graph().dump());
    CHECK(live.ended(3)["state"] == "ready");
    // A link that leads out in place of the graph file: not read, and nothing is written through it.
    CHECK(live.post("change", {{"node", "flesh"}, {"attribute", "youngsModulus"}, {"value", 5000}}) == 200);
    live.ended(4);
    const std::string before = read_text(outside);
    std::filesystem::create_symlink("../outside.json", root / "link");
    std::filesystem::rename(root / "link", file);
    const json led_out = live.ended(5);
    CHECK(led_out["state"] == "wrong");
    CHECK(led_out["diagnostics"][0]["code"] == "IO410");
    CHECK(live.post("save", {}) == 422);
    CHECK(read_text(outside) == before);
}

TEST_CASE("live: of graphs that cannot be read, those outside of the root are not watched", "[live]") {
    const TemporaryFolder folder;
    const std::filesystem::path root = folder / "jobs", file = root / "graph.json";
    std::filesystem::create_directories(root);
    write_text(folder / "outside.json", "{}");
    write_text(root / "part.json", "{}");
    write_text(file, R"({"includes": {"a": {"file": "part.json"}, "b": {"file": "../outside.json"}}})");
    const auto named = [&](const engine::FileAccess& files) { return live::graphs_named_in(file.string(), files); };
    CHECK(named({}) ==
          std::vector<std::string>{file.string(), (root / "part.json").string(), (folder / "outside.json").string()});
    CHECK(named(engine::FileAccess::within(root)) ==
          std::vector<std::string>{file.string(), (root / "part.json").string()});
}

TEST_CASE("live: who asks for a part of a page gets all of it", "[live]") {
    const TemporaryFolder folder;
    const Live live({"live", write_graph(folder, small_graph()), "--no-cache", "--frames", "1"});
    live.ended(1);
    const std::string whole = live.http->Get(live.root + "page/1")->body;
    REQUIRE(whole.size() > 100);
    const auto part = [&](const std::string& range) {
        return live.http->Get(live.root + "page/1", httplib::Headers{{"Range", "bytes=" + range}});
    };
    const std::string size = std::to_string(whole.size());
    for (const std::string& range :
         {std::string("10-19"), std::string("-0"), std::string("0-0"), size + "-", "5-" + size + "0", size + "0-",
          std::string("-") + size + "0", std::string("0-1,3-4")}) {
        CAPTURE(range);
        const auto answer = part(range);
        REQUIRE(answer);
        CHECK(answer->status == 200);
        CHECK(answer->body == whole);
    }
}

TEST_CASE("live: changes from several pages at once are all kept", "[live]") {
    const TemporaryFolder folder;
    const json graph = small_graph();
    const Live live({"live", write_graph(folder, graph), "--no-cache", "--frames", "1"});
    live.ended(1);
    std::vector<std::jthread> pages;
    std::atomic<int> accepted = 0;
    for (int page = 0; page < 4; ++page)
        pages.emplace_back([&, page] {
            httplib::Client http("127.0.0.1", live.port);
            const json change = {
                {"node", "flesh"}, {"attribute", "massDensity"}, {"value", 1000 + page}, {"frame", page + 1}};
            for (int again = 0; again < 3; ++again)
                if (const auto answer = http.Post(live.root + "change", change.dump(), "application/json"))
                    accepted += answer->status == 200;
        });
    pages.clear();
    CHECK(accepted == 12);
    CHECK(live.status()["changes"].size() == 4);
}

TEST_CASE("live: included graphs are watched, told with their overrides, and may be broken at first", "[live]") {
    const TemporaryFolder folder;
    const json graph = small_graph();
    const std::string part = write_graph(folder, graph, "part.json"), file = (folder / "whole.json").string();
    std::string solver;
    for (const auto& [name, node] : graph["nodes"].items())
        if (node["type"] == "zSolver") solver = name;
    const std::string text = read_text(part);
    write(part, text.substr(1));
    write(file,
          R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 3}, "includes": {"a": {"file": "part.json",
                "overrides": {")" +
              solver + R"(.substeps": 2}}}, "nodes": {}})");
    const Live live({"live", file, "--no-cache"});
    CHECK(live.ended(1)["state"] == "wrong");
    write(part, text);
    const json s = live.ended(2);
    CHECK(s["state"] == "ready");
    CHECK(s["files"] == json({part}));
    CHECK(s["simulated"] == 3);
    for (const json& node : json::parse(live.http->Get(live.root + "nodes")->body))
        if (node["name"] == "a." + solver)
            for (const json& input : node["inputs"])
                if (input["name"] == "substeps") CHECK(input["value"] == 2);
    CHECK(live.post("change", {{"node", "a." + solver}, {"attribute", "substeps"}, {"value", 3}}) == 200);
    CHECK(live.ended(3)["simulated"] == 3);
    CHECK(live.post("save", {}) == 200);
    CHECK(json::parse(read_text(file))["includes"]["a"]["overrides"][solver + ".substeps"] == 3);
    CHECK(read_text(part) == text);
}

TEST_CASE("live: a folder for a graph, a mesh that is missing and a taken port", "[live]") {
    const TemporaryFolder folder;
    const std::string file = (folder / "whole.json").string();
    write(file, R"({"format": "sinew 1", "includes": {"a": {"file": "./"}}, "nodes": {}})");
    Live live({"live", file, "--no-cache", "--frames", "1"});
    CHECK(live.ended(1)["state"] == "wrong");
    json graph = small_graph();
    graph["nodes"]["more"] = {{"type", "meshFile"}, {"inputs", {{"file", "a.obj"}}}};
    write(file, graph.dump());
    live.ended(2);
    Program second({"live", file, "--no-cache", "--port", std::to_string(live.port)});
    CHECK(second.exit_code() == 1);
    CHECK(second.err().find("IO405") != std::string::npos);
    std::filesystem::remove(file);
    CHECK(live.ended(3)["diagnostics"][0]["code"] == "IO401");
    write(file, graph.dump());
    live.ended(4);
}

TEST_CASE("live: files are told once, also when they are replaced, and when they come back", "[live]") {
    const TemporaryFolder folder;
    const std::string a = (folder / "a").string(), b = (folder / "b").string();
    write(a, "1");
    live::WatchedFiles files;
    files.watch({a, b});
    CHECK(files.take_changed().empty());
    write(b, "2");
    CHECK(files.take_changed() == std::vector{b});
    CHECK(files.take_changed().empty());
    write(a + "~", "1");
    std::filesystem::rename(a + "~", a);
    CHECK(files.take_changed() == std::vector{a});
    // Away and back by the same name, size and time.
    std::filesystem::rename(a, a + "~");
    CHECK(files.take_changed() == std::vector{a});
    CHECK(files.take_changed().empty());
    std::filesystem::rename(a + "~", a);
    CHECK(files.take_changed() == std::vector{a});
}
