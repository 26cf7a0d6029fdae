// --cache and --no-cache, as several processes meet them.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <memory>

using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::string graph_with_kept_tets(const TemporaryFolder& folder) {
    json graph = small_graph();
    graph["nodes"]["tets"] = {
        {"type", "zTet"},
        {"inputs", {{"mesh", {{"from", "blockMesh.outMesh"}}}, {"tetSize", 0.8}, {"cacheTetMesh", true}}}};
    graph["nodes"]["block"]["inputs"]["tets"] = {{"from", "tets.outTets"}};
    return write_graph(folder, graph);
}

std::size_t files_in(const fs::path& folder) {
    if (!fs::exists(folder)) return 0;
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string digest_of(const Said& said) {
    REQUIRE(said.lines().size() == 1);
    return said.lines()[0].at("digest");
}

} // namespace

TEST_CASE("tets are kept beside the graph, or where --cache says, or nowhere", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = graph_with_kept_tets(folder);
    const auto eval = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"eval", graph, "tets.outTets", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words);
    };
    const std::string made = digest_of(eval({"--no-cache"}));
    CHECK(files_in(folder / "small.sinew-cache") == 0);
    CHECK(digest_of(eval({})) == made);
    CHECK(files_in(folder / "small.sinew-cache") == 1);
    CHECK(digest_of(eval({"--cache", (folder / "other/deep").string()})) == made);
    CHECK(files_in(folder / "other/deep") == 1);
    CHECK(eval({"--cache", "x", "--no-cache"}).code == 2);
    const Said nameless = eval({"--cache", ""});
    CHECK(nameless.code == 2);
    CHECK(has(nameless.err, "--cache needs the name of a folder"));

    const fs::path file = fs::directory_iterator(folder / "small.sinew-cache")->path();
    std::ofstream(file, std::ios::trunc) << "something else";
    const Said told = run_program({"run", graph, "--frames", "1-2"});
    CHECK(told.code == 0);
    CHECK(told.err.find("IO406") != std::string::npos);
    CHECK(run_program({"run", graph, "--frames", "1-2"}).beside_work().empty());
    CHECK(digest_of(eval({})) == made);

    fs::remove(file);
    fs::create_directory(file);
    const Said blocked = eval({});
    CHECK(blocked.code == 0);
    CHECK(has(blocked.out + blocked.err, "a folder is in its place"));
}

TEST_CASE("cache says of a file that is no graph that it is none", "[tools]") {
    const TemporaryFolder folder;
    const std::string mesh = folder / "c.obj", graph = folder / "g.json";
    write_text(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (const char* what : {"info", "clean"}) {
        const Said said = run_program({"cache", what, mesh});
        CHECK(said.code == 2);
        CHECK(said.err.find("'" + mesh + "' is no graph; one is meant, or a folder with what was kept of it.") !=
              std::string::npos);
    }
    for (const char* begin : {"{", " \n\t{", "// a comment\n{", "\xEF\xBB\xBF{"}) {
        write_text(graph, std::string(begin) + "\"format\": \"sinew 1\"}");
        const Said said = run_program({"cache", "info", graph});
        CHECK(said.code == 0);
        CHECK(said.out.find("nothing is kept") != std::string::npos);
    }
}

TEST_CASE("processes that keep the same tets at once do each other no harm", "[tools]") {
    const TemporaryFolder folder;
    const std::string graph = graph_with_kept_tets(folder);
    for (int round = 0; round < 3; ++round) {
        fs::remove_all(folder / "small.sinew-cache");
        std::vector<std::unique_ptr<Program>> all;
        for (int i = 0; i < 4; ++i)
            all.push_back(std::make_unique<Program>(std::vector<std::string>{"eval", graph, "tets.outTets", "--json"}));
        std::string first;
        for (const auto& p : all) {
            CHECK(p->exit_code() == 0);
            CHECK(p->err().empty());
            if (first.empty()) first = p->out();
            CHECK(p->out() == first);
        }
        CHECK(files_in(folder / "small.sinew-cache") == 1);
    }
}
