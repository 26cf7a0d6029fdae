// Every graph in graphs/broken is wrong in one way and gives exactly the diagnostics that stand beside it:
// NAME.expected.txt holds one line each, "CODE node.attribute line:column", in the order in which they are
// printed. A part that a diagnostic does not have is written "-", and behind warnings stands " warning". Graphs with
// nothing but warnings run.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <sstream>

using namespace sinew::test;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

const fs::path folder_of_graphs = fs::path(SINEW_SOURCE_DIR) / "graphs/broken";

std::vector<fs::path> broken_graphs() {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder_of_graphs))
        if (entry.path().extension() == ".json" &&
            fs::exists(fs::path(entry.path()).replace_extension(".expected.txt")))
            out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
}

std::string place_of(const json& d) {
    const std::string node = d.value("node", ""), attribute = d.value("attribute", "");
    if (node.empty()) return attribute.empty() ? "-" : attribute;
    return attribute.empty() ? node : node + "." + attribute;
}

std::string diagnostics_of(const Said& said) {
    std::string out;
    for (const json& d : said.lines()) {
        if (d.at("event") != "diagnostic") continue;
        out += d.at("code").get<std::string>() + " " + place_of(d) + " ";
        out += d.contains("line")
                   ? std::to_string(d.at("line").get<int>()) + ":" + std::to_string(d.at("column").get<int>())
                   : "-";
        out += d.at("severity") == "warning" ? " warning\n" : "\n";
    }
    return out;
}

std::string expected_of(const fs::path& graph) {
    std::string text = read_text(fs::path(graph).replace_extension(".expected.txt"));
    if (!text.empty() && text.back() != '\n') text += '\n';
    return text;
}

bool only_warns(const fs::path& graph) {
    std::istringstream lines(expected_of(graph));
    for (std::string line; std::getline(lines, line);)
        if (!line.ends_with(" warning")) return false;
    return true;
}

} // namespace

TEST_CASE("every broken graph gives exactly its diagnostics and exit code 1", "[tools]") {
    for (const fs::path& graph : broken_graphs()) {
        INFO(graph.filename());
        const Said said = run_program({"check", graph.string(), "--json"});
        CHECK(diagnostics_of(said) == expected_of(graph));
        CHECK(said.code == (only_warns(graph) ? 0 : 1));
        CHECK(said.err.empty());
    }
}

TEST_CASE("every broken graph is refused by run before anything is written", "[tools]") {
    for (const fs::path& graph : broken_graphs()) {
        if (only_warns(graph)) continue;
        INFO(graph.filename());
        const TemporaryFolder folder;
        const Said said = run_program({"run", graph.string(), "--out", (folder / "out").string(), "--format", "glb,obj",
                                       "--report", (folder / "r.json").string()});
        CHECK(said.code == 1);
        CHECK(said.err.find("error [") != std::string::npos);
        CHECK(fs::is_empty(folder.path()));
    }
}

TEST_CASE("every graph in graphs/broken has its diagnostics beside it", "[tools]") {
    // Graphs that others include or read have no diagnostics of their own and live in folders below.
    for (const auto& entry : fs::directory_iterator(folder_of_graphs))
        if (entry.path().extension() == ".json") {
            INFO(entry.path());
            CHECK(fs::exists(fs::path(entry.path()).replace_extension(".expected.txt")));
        }
}
