// `sinew new rig` on the two arms whose attachments were made by hand: what each muscle reaches, where it is painted,
// and that the graphs run.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/rig/reach.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

using namespace sinew;
using namespace sinew::test;
using nlohmann::json;

namespace {

const std::string scenes = std::string(SINEW_SOURCE_DIR) + "/graphs/scenes/";

rig::Rig guessed(const std::string& arm) {
    return rig::guess_rig({scenes + arm + "/bones"}, {scenes + arm + "/muscles"}, {});
}

/// Muscle → names of all that its ends hold on to.
std::map<std::string, std::set<std::string>> reached(const rig::Rig& r) {
    std::map<std::string, std::set<std::string>> out;
    for (const rig::Muscle& m : r.muscles)
        for (const rig::End& end : m.ends)
            for (const rig::Hold& hold : end.holds) out[r.parts[m.part].stem].insert(r.parts[hold.target].stem);
    return out;
}

/// Of one attachment made by hand: how the guess compares.
struct Compared {
    std::string muscle, target;
    std::size_t by_hand = 0, guessed = 0, both = 0;
    double centres_apart = 0; ///< in scene units
};

std::vector<Compared> compare(const std::string& arm, const rig::Rig& r) {
    std::ifstream in(scenes + arm + "/attachments.json");
    const json file = json::parse(in);
    std::vector<Compared> out;
    for (const json& by_hand : file.at("attachments")) {
        Compared c{by_hand.at("muscle"), by_hand.at("target")};
        const std::set<std::size_t> theirs = by_hand.at("vertices");
        c.by_hand = theirs.size();
        for (const rig::Muscle& m : r.muscles)
            for (std::size_t e = 0; e < 2; ++e)
                for (const rig::Hold& hold : m.ends[e].holds) {
                    const rig::Part& part = r.parts[m.part];
                    if (part.stem != c.muscle || r.parts[hold.target].stem != c.target) continue;
                    const auto to = rig::distances(part, rig::Surface(r.parts[hold.target]), 6 * m.reach);
                    const auto ours = rig::painted(m, e, hold, part, to);
                    solver::Vec3 a = solver::Vec3::Zero(), b = a;
                    for (const std::size_t v : ours) a += part.points[v] / static_cast<double>(ours.size());
                    for (const std::size_t v : theirs) b += part.points[v] / static_cast<double>(theirs.size());
                    c.guessed = ours.size();
                    c.both = static_cast<std::size_t>(
                        std::count_if(ours.begin(), ours.end(), [&](std::size_t v) { return theirs.contains(v); }));
                    c.centres_apart = (a - b).norm();
                }
        out.push_back(c);
    }
    return out;
}

/// Vertices that one of both paints has, and the share of them that both have, over a whole arm.
double agreement(const std::vector<Compared>& all) {
    double both = 0, either = 0;
    for (const Compared& c : all) {
        UNSCOPED_INFO(c.muscle << " to " << c.target << ": " << c.by_hand << " by hand, " << c.guessed << " guessed, "
                               << c.both << " of both, centres " << c.centres_apart << " apart");
        both += static_cast<double>(c.both);
        either += static_cast<double>(c.by_hand + c.guessed - c.both);
    }
    return both / either;
}

} // namespace

TEST_CASE("new rig: an artist's arm: each muscle reaches the bones that it does by hand", "[tools][rig]") {
    const rig::Rig r = guessed("arm_ziva");
    CHECK(r.unit.name == "cm");
    CHECK(r.up.axis == 'y');
    CHECK(reached(r) ==
          std::map<std::string, std::set<std::string>>{{"biceps", {"scapula", "radius"}},
                                                       {"brachialis", {"humerus", "ulna"}},
                                                       {"coracobrachialis", {"scapula", "humerus"}},
                                                       {"triceps_long", {"scapula", "triceps_tendon"}},
                                                       {"triceps_lateral", {"humerus", "ulna", "triceps_tendon"}},
                                                       {"triceps_medial", {"humerus", "ulna", "triceps_tendon"}},
                                                       {"triceps_tendon", {"ulna"}}});
    for (const rig::Part& part : r.parts) CHECK_FALSE(part.is_wrapped);
    const auto all = compare("arm_ziva", r);
    CHECK(all.size() == 15);
    CHECK(agreement(all) > 0.6);
    for (const Compared& c : all) CHECK(c.both > 0);
}

TEST_CASE("new rig: a scanned arm: each muscle reaches the bones that it does by hand", "[tools][rig]") {
    const rig::Rig r = guessed("arm_bodyparts3d");
    CHECK(r.unit.name == "mm");
    CHECK(r.up.axis == 'z');
    CHECK(reached(r) ==
          std::map<std::string, std::set<std::string>>{{"biceps_long_head", {"scapula", "radius"}},
                                                       {"biceps_short_head", {"scapula", "biceps_long_head"}},
                                                       {"brachialis", {"humerus", "ulna"}},
                                                       {"coracobrachialis", {"scapula", "humerus"}},
                                                       {"deltoid_acromial", {"scapula", "humerus"}},
                                                       {"deltoid_clavicular", {"clavicle", "humerus"}},
                                                       {"deltoid_spinal", {"scapula", "humerus"}},
                                                       {"triceps_lateral_head", {"humerus", "ulna"}},
                                                       {"triceps_long_head", {"scapula", "ulna"}},
                                                       {"triceps_medial_head", {"humerus", "ulna"}}});
    const auto all = compare("arm_bodyparts3d", r);
    CHECK(all.size() == 20);
    CHECK(agreement(all) > 0.6);
    for (const Compared& c : all) CHECK(c.both > 0);
}

TEST_CASE("new rig: the graph of an arm is right and runs, its bones moved by a recorded motion", "[tools][rig]") {
    const TemporaryFolder folder;
    const std::string graph = folder / "arm.json", report = folder / "report.json";
    const Said made = run_program({"new", "rig", scenes + "arm_ziva/bones", scenes + "arm_ziva/muscles", "-o", graph,
                                   "--motion", scenes + "arm_ziva/motion/elbow_flexion_real_ik.json", "--tet-scale",
                                   "2", "--set", "triceps_medial:tetSize=1.2"}); // too thin for twice as large ones
    INFO(made.err);
    REQUIRE(made.code == 0);
    CHECK(made.out.find("biceps") != std::string::npos);
    // Nothing that it is not sure of; on a busy machine it says what takes so long.
    CHECK((made.err.empty() || made.err == "looking at the meshes\n"));
    const Said checked = run_program({"check", graph, "--no-cache", "--json"});
    CHECK(checked.code == 0);
    CHECK(checked.lines().size() == 1); // no warnings
    CHECK(run_program({"run", graph, "--frames", "1-3", "--no-cache", "--report", report}).code == 0);
    std::ifstream in(report);
    const json frames = json::parse(in).at("frames");
    CHECK(frames.size() == 3);
    for (const json& f : frames) {
        CHECK(f.at("converged") == true);
        CHECK(f.at("inverted") == 0);
    }
    // The motion's tracks are connected, at its own rate.
    const auto moved = [&](const std::string& plug, const char* frame) {
        return run_program({"eval", graph, plug, "--frame", frame, "--no-cache", "--json"}).lines().back().at("value");
    };
    CHECK(moved("ulnaMove.outMatrix", "1") != moved("ulnaMove.outMatrix", "25"));
    CHECK(moved("ulnaMove.outMatrix", "25") == moved("ulnaMove.outMatrix", "26")); // 121 frames at 120 a second
    CHECK(moved("scapulaMove.outMatrix", "1") == moved("scapulaMove.outMatrix", "25"));
}
