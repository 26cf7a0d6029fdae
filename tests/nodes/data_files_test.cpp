// JSON data files beyond what may be read: refused before they cost memory or the stack.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "nodes/curve_file.h"
#include "nodes/json_file.h"
#include "nodes/mesh_formats.h"
#include "nodes/motion_track.h"
#include "nodes/painted_maps.h"
#include "solver/error.h"
#include "tests/tools/temporary_folder.h"

using namespace bench;

namespace {

std::string code(const std::function<void()>& read) {
    try {
        read();
        return "";
    } catch (const solver::Error& e) {
        return e.code;
    }
}

std::string nested(int depth) {
    return std::string(static_cast<std::size_t>(depth), '[') + "1" + std::string(static_cast<std::size_t>(depth), ']');
}

} // namespace

TEST_CASE("brackets in very many brackets are refused in every JSON data file", "[nodes]") {
    CHECK(nodes::parse_curve(nested(nodes::most_json_depth), "a.json", "") == engine::NumberList{1});
    // Enough to run through the stack where each bracket is a call.
    for (const int depth : {nodes::most_json_depth + 1, 1'000'000}) {
        const std::string text = nested(depth);
        CHECK(code([&] { nodes::parse_curve(text, "a.json", ""); }) == "IO403");
        CHECK(code([&] { nodes::parse_map(text, "a.json", ""); }) == "IO403");
        CHECK(code([&] { nodes::parse_matrix_track(text, "a.json", "ulna"); }) == "IO403");
        CHECK(code([&] { nodes::parse_number_track(text, "a.json", "ulna"); }) == "IO403");
    }
    CHECK_FALSE(nodes::is_too_deep("\"" + std::string(1000, '[') + "\""));
    CHECK_FALSE(nodes::is_too_deep("\"\\\"" + std::string(1000, '{') + "\""));
    CHECK(nodes::is_too_deep("\"\\\\\"" + std::string(1000, '{')));
}

TEST_CASE("what is no number in a data file is told of with its place", "[nodes]") {
    const auto said = [](auto call) -> std::string {
        try {
            call();
            return "";
        } catch (const solver::Error& e) {
            return e.code + " " + e.what();
        }
    };
    CHECK(said([] { nodes::parse_curve("[[1, 2, 3], [4, null, 6]]", "a.json", ""); }) ==
          "IO403 'a.json': the curve holds null at \"/1/1\", which is not a number");
    const auto track = [](const char* entry) {
        return std::string(R"({"frames": [{"frame": 7.5, "bones": {"ulna": [[1,0,0,0],[0,1,0,)") + entry +
               R"(],[0,0,1,0],[0,0,0,1]]}}]})";
    };
    CHECK(said([&] { nodes::parse_matrix_track(track("\"2\""), "m.json", "ulna"); }) ==
          "IO403 'm.json': the matrix of 'ulna' at frame 7.5 holds \"2\" at \"/1/3\", which is not a number");
    CHECK(said([&] { nodes::parse_matrix_track(track("2, 2"), "m.json", "ulna"); }) ==
          "IO403 'm.json': the matrix of 'ulna' at frame 7.5 has 17 numbers");
    CHECK(nodes::parse_curve("1 2 3\n# by hand\n+4 5e-400 6\n", "c.txt", "") == engine::NumberList{1, 2, 3, 4, 0, 6});
    CHECK(said([] { nodes::parse_curve("1 2 3\n4 1e999 6\n", "c.txt", ""); }) ==
          "IO403 c.txt:2: a coordinate is '1e999', which is not finite");
    CHECK(said([] { nodes::parse_curve("1 2 3\n4, 5, 6\n", "c.txt", ""); }) ==
          "IO403 c.txt:2: '4,' is not a number; a coordinate was expected");
}

TEST_CASE("JSON data files and graphs have a size beyond which they are not read", "[nodes]") {
    const test::TemporaryFolder folder;
    const auto hole = [&](const char* name, std::uintmax_t size) {
        const std::string path = (folder / name).string();
        test::write_text(path, "");
        std::filesystem::resize_file(path, size);
        return path;
    };
    const std::string data = hole("data.json", (std::uintmax_t{512} << 20) + 1);
    CHECK(code([&] { nodes::read_json({}, data); }) == "IO412");
    CHECK(code([&] { nodes::read_matrix_track({}, data, "ulna"); }) == "IO412");
    CHECK(code([&] { nodes::file_map({}, data, ""); }) == "IO412");
    try {
        engine::load_graph(nodes::make_registry(), hole("graph.json", (std::uintmax_t{256} << 20) + 1));
        FAIL("it was read");
    } catch (const engine::Failure& f) {
        CHECK(f.diagnostics()[0].code == "IO412");
        CHECK(f.diagnostics()[0].message.find("is larger than 256 MB") != std::string::npos);
    }
}

TEST_CASE("a name of numbered files where one mesh is meant is told as that", "[nodes]") {
    const sinew::test::TemporaryFolder folder;
    for (const char* name : {"c.0001.obj", "c.0002.obj"}) sinew::test::write_text(folder / name, "v 0 0 0\n");
    try {
        nodes::read_mesh({}, folder / "c.####.obj");
        FAIL("it was read");
    } catch (const solver::Error& e) {
        CHECK(e.code == "IO401");
        CHECK(std::string(e.what()) ==
              "'" + std::string(folder / "c.####.obj") + "' stands for numbered files, and one mesh is meant here");
        CHECK(e.hint == "Name one of them; meshSequence gives that of each frame.");
    }
}
