// What is said while a run goes on.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/cli/long_task.h"
#include "tools/cli/problems.h"
#include "tools/cli/progress.h"

#include "engine/format/graph_file.h"
#include "nodes/register_all.h"

#include <catch2/catch.hpp>
#include <sstream>
#include <thread>

using namespace sinew;
using namespace sinew::cli;

namespace {

struct Said {
    std::ostringstream out, err;
    Progress progress;
    explicit Said(ProgressStyle style)
        : progress(style, engine::read_graph(nodes::make_registry(), test::small_graph().dump(), "small.json").graph, 3,
                   out, err) {}
};

void wait(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

} // namespace

TEST_CASE("a node that takes long is named once while it computes and quick ones are not", "[tools]") {
    Said lines(ProgressStyle::lines), json(ProgressStyle::json), quiet(ProgressStyle::quiet);
    for (Said* s : {&lines, &json, &quiet}) {
        s->progress.begin_frame(1);
        s->progress.begins("plateMesh", 1);
        s->progress.ends("plateMesh", 1);
        s->progress.begins("block", 1);
    }
    wait(1600);
    for (Said* s : {&lines, &json, &quiet}) s->progress.ends("block", 1);
    wait(300);
    CHECK(lines.err.str() == "computing block (zTissue)\n");
    CHECK(lines.out.str().empty());
    CHECK(json.out.str() == "{\"event\":\"computing\",\"node\":\"block\",\"type\":\"zTissue\",\"frame\":1.0}\n");
    CHECK(json.err.str().empty());
    CHECK((quiet.out.str().empty() && quiet.err.str().empty()));
}

TEST_CASE("a step of a simulation that takes long says how far it is", "[tools]") {
    Said lines(ProgressStyle::lines), json(ProgressStyle::json), quiet(ProgressStyle::quiet);
    for (Said* s : {&lines, &json, &quiet}) {
        s->progress.begin_frame(7);
        s->progress.begins("solver", 6);
        s->progress.progress("solver", 0.9, "solving");
        s->progress.ends("solver", 6);
        s->progress.begins("solver", 7); // whose progress begins anew
    }
    wait(800);
    for (Said* s : {&lines, &json, &quiet}) s->progress.progress("solver", 0.25, "solving");
    wait(800);
    for (Said* s : {&lines, &json, &quiet}) s->progress.ends("solver", 7);
    wait(300);
    CHECK(lines.err.str() == "computing solver (zSolver), frame 7: 25 %\n");
    CHECK(json.out.str() ==
          "{\"event\":\"computing\",\"node\":\"solver\",\"type\":\"zSolver\",\"frame\":7.0,\"done\":0.25}\n");
    CHECK((quiet.out.str().empty() && quiet.err.str().empty()));
}

TEST_CASE("a pre-roll says where it is and how long it will take", "[tools]") {
    Said lines(ProgressStyle::lines), quick(ProgressStyle::lines);
    lines.progress.begin_frame(1001);
    lines.progress.stepped("solver", 1, 0.5); // not a second yet
    CHECK(lines.err.str().empty());
    wait(1100);
    lines.progress.stepped("solver", 2, 0.5);
    lines.progress.stepped("solver", 3, 0.5); // said a moment ago
    const std::string text = lines.err.str();
    CHECK(text.starts_with("pre-roll: frame 2 on the way to 1001, "));
    CHECK(text.ends_with(" left\n"));
    CHECK(std::count(text.begin(), text.end(), '\n') == 1);
    // Two steps in 1.1 s: 999 more take about nine minutes.
    const std::size_t at = text.find("1001, ") + 6;
    const int minutes = std::stoi(text.substr(at));
    CHECK((minutes >= 9 && minutes < 20));
}

TEST_CASE("commands without a bar name what takes long, too", "[tools]") {
    std::ostringstream err;
    WarningCollector warnings(
        engine::read_graph(nodes::make_registry(), test::small_graph().dump(), "small.json").graph, 4, false, err);
    warnings.begins("block", 1);
    warnings.stepped("solver", 1, 0.1);
    wait(1300);
    warnings.stepped("solver", 2, 0.1);
    warnings.ends("block", 1);
    CHECK(err.str().starts_with("computing block (zTissue)\npre-roll: frame 2 on the way to 4, "));
}

TEST_CASE("what is no node is named once it takes long", "[tools]") {
    std::ostringstream err, quick, quiet;
    {
        const LongTask slow(err, "reading a.json", false), silent(quiet, "reading a.json", true);
        { const LongTask done(quick, "reading b.json", false); }
        wait(1300);
    }
    CHECK(err.str() == "reading a.json\n");
    CHECK((quick.str().empty() && quiet.str().empty()));
}

TEST_CASE("a graph that takes long to read is named by every command that reads one", "[tools]") {
    const test::TemporaryFolder folder;
    std::string text = R"({"format": "sinew 1", "nodes": {)";
    for (int i = 0; i < 500000; ++i) text += "\"m" + std::to_string(i) + R"(": {"type": "polyCube", "inputs": {}},)";
    const std::string file = (folder / "g.json").string();
    test::write_text(file, text + R"("s": {"type": "polySphere"}}})");
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"check", "--fast", file}, {"fmt", "--check", file}}) {
        CAPTURE(words.front());
        CHECK(test::run_program(words).err.starts_with("reading " + file + "\n"));
    }
}

TEST_CASE("costs are summed by node type", "[tools]") {
    Said s(ProgressStyle::quiet);
    s.progress.computed("lower", 1, 0.25);
    s.progress.computed("upper", 1, 0.5);
    s.progress.computed("block", 1, 1);
    const auto all = s.progress.computed_by_type();
    REQUIRE(all.size() == 2);
    CHECK((all.at("zBone").count == 2 && all.at("zBone").seconds == 0.75));
    CHECK(all.at("zTissue").count == 1);
}
