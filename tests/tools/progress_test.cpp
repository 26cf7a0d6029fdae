// What is said while a run goes on.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
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
        s->progress.begins("solver", 1); // frames of simulations have lines of their own
        s->progress.begins("block", 1);
    }
    wait(1600);
    for (Said* s : {&lines, &json, &quiet}) {
        s->progress.ends("block", 1);
        s->progress.ends("solver", 1);
    }
    wait(300);
    CHECK(lines.err.str() == "computing block (zTissue)\n");
    CHECK(lines.out.str().empty());
    CHECK(json.out.str() == "{\"event\":\"computing\",\"node\":\"block\",\"type\":\"zTissue\",\"frame\":1.0}\n");
    CHECK(json.err.str().empty());
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
