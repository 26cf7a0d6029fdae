// explain and valid_frames: the truth about what would run, without running it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

using namespace toys;

namespace {
constexpr const char* scene =
    R"("stiff": {"type": "number", "inputs": {"value": {"keys": [[1, 1], [79, 1], [100, 5]]}}},
    "sim": {"type": "sim", "inputs": {"stiffness": {"from": "stiff.out"}}},
    "r": {"type": "relay", "inputs": {"in": {"from": "sim.out"}}})";
using Ranges = std::vector<std::pair<int, int>>;
} // namespace

TEST_CASE("explain says ready, would_run or undecided and computes nothing") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), scene);
    Evaluator e;
    const Request request{g, {"sim", "out"}, 100, {}};
    const Verdict before = e.explain(request);
    // Nothing was simulated yet, so no frame can be there, whatever the inputs are.
    CHECK(before.readiness == Readiness::would_run);
    CHECK((before.first_frame == 1 && before.last_frame == 100));
    CHECK(before.first_plug == "stiff.out");
    CHECK(before.because.find("first stiff.out at frame 1 (number) must be evaluated") != std::string::npos);
    CHECK(counts->computes + counts->advances + counts->initials == 0);
    e.pull(request);
    CHECK(e.explain(request).readiness == Readiness::ready);
    CHECK(e.explain({g, {"r", "out"}, 100, {}}).readiness == Readiness::would_run);
    CHECK(e.explain({g, {"stiff", "out"}, 50, {}}).readiness == Readiness::ready);
}

TEST_CASE("explain names the plug that changed and the frames that would be stepped") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), scene);
    Evaluator e;
    e.pull({g, {"sim", "out"}, 100, {}});
    const auto edited = Edit(g)
                            .set_key({"sim", "gain"}, 1, 0)
                            .set_key({"sim", "gain"}, 79, 0)
                            .set_key({"sim", "gain"}, 80, 1)
                            .commit()
                            .graph;
    const int ran = counts->computes + counts->advances;
    const Verdict v = e.explain({edited, {"sim", "out"}, 100, {}});
    CHECK(v.readiness == Readiness::would_run);
    CHECK(v.first_frame == 80);
    CHECK(v.last_frame == 100);
    CHECK(v.changed_plugs == std::vector<std::string>{"sim.gain"});
    CHECK(v.because.find("from frame 80 on (sim.gain)") != std::string::npos);
    CHECK(v.because.find("frames 80 to 100 would be simulated") != std::string::npos);
    CHECK(e.explain({edited, {"sim", "out"}, 79, {}}).readiness == Readiness::ready);
    CHECK(counts->computes + counts->advances == ran);
}

TEST_CASE("explain looks upstream for the cause") {
    const auto types = registry();
    const auto g = graph(types, scene);
    Evaluator e;
    e.pull({g, {"sim", "out"}, 100, {}});
    const auto edited = Edit(g).set_key({"stiff", "value"}, 90, 5).commit().graph;
    // The values of the edited node are not known yet: whether the chain moves cannot be told.
    const Verdict open = e.explain({edited, {"sim", "out"}, 100, {}});
    CHECK(open.readiness == Readiness::undecided);
    CHECK(open.first_plug == "stiff.out");
    CHECK(open.changed_plugs == std::vector<std::string>{"stiff.value"});
    CHECK(open.because.find("differ from those before the edit in stiff.value") != std::string::npos);
    e.pull({edited, {"sim", "out"}, 85, {}});
    const auto further = Edit(edited).set_key({"sim", "gain"}, 1, 2).commit().graph;
    const Verdict v = e.explain({further, {"r", "out"}, 85, {}});
    CHECK(v.readiness == Readiness::would_run);
    CHECK(v.changed_plugs == std::vector<std::string>{"sim.gain"});
    CHECK(v.because.find("sim: ") == 0);
}

TEST_CASE("valid_frames gives the ranges that are there") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), scene);
    Evaluator e;
    const Request request{g, {"sim", "out"}, 1, {}};
    CHECK(e.valid_frames(request, 1, 100).empty());
    e.pull({g, {"sim", "out"}, 40, {}});
    CHECK(e.valid_frames(request, -3, 100) == Ranges{{-3, 40}});
    e.drop_values();
    e.pull({g, {"sim", "out"}, 7, {}});
    e.pull({g, {"sim", "out"}, 8, {}});
    e.pull({g, {"sim", "out"}, 20, {}});
    CHECK(e.valid_frames(request, 1, 100) == Ranges{{7, 8}, {20, 20}});
    CHECK(counts->advances == 39);
    const auto edited = Edit(g)
                            .set_key({"sim", "gain"}, 1, 0)
                            .set_key({"sim", "gain"}, 10, 0)
                            .set_key({"sim", "gain"}, 11, 1)
                            .commit()
                            .graph;
    CHECK(e.valid_frames({edited, {"sim", "out"}, 1, {}}, 1, 100) == Ranges{{7, 8}});
}

TEST_CASE("explain and valid_frames know what stages within a sub-step read") {
    const auto g =
        graph(registry(), R"("sim": {"type": "sim", "inputs": {"scheme": {"keys": [[1, "plain"], [10, "staged"]]},
        "stiffness": {"keys": [[1, 1], [100, 1]], "interp": "linear"}}})");
    Evaluator e;
    e.pull({g, {"sim", "out"}, 20, {}});
    for (const double at : {5.25, 12.25, 12.75}) {
        const auto edited = Edit(g)
                                .set_key({"sim", "stiffness"}, at - 0.2, 1)
                                .set_key({"sim", "stiffness"}, at, 2)
                                .set_key({"sim", "stiffness"}, at + 0.2, 1)
                                .commit()
                                .graph;
        const bool read = at == 12.25;
        const Verdict v = e.explain({edited, {"sim", "out"}, 20, {}});
        INFO(at << ": " << v.because);
        CHECK(v.readiness == (read ? Readiness::would_run : Readiness::ready));
        CHECK(v.changed_plugs == (read ? std::vector<std::string>{"sim.stiffness"} : std::vector<std::string>{}));
        CHECK(v.first_frame == (read ? 13 : 0));
        CHECK(e.valid_frames({edited, {"sim", "out"}, 1, {}}, 1, 20) == Ranges{{1, read ? 12 : 20}});
    }
}
