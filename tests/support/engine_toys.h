// Small node types for tests of the engine: numbers that can be added, a simulation of ten lines, nodes that
// fail.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "engine/format/graph_file.h"

#include <atomic>
#include <memory>
#include <string>

namespace toys {

using namespace sinew::engine;

/// How often the functions of the toy types ran.
struct Counts {
    std::atomic<int> computes = 0, initials = 0, advances = 0, rehearsals = 0, publishes = 0;
    std::vector<double> stages; ///< times within sub-steps at which simulations read; one simulation at a time
    std::vector<std::int64_t> rehearsed_steps;         ///< after each rehearsal
    std::function<void(double frame)> on_advance = {}; ///< called at the begin of each step
    std::function<void()> on_compute = {};
};

/// Complete: what the next step reads is all here (a scheme with two levels of history).
struct ToyState {
    double x = 0, x_before = 0, v = 0;
    std::int64_t steps = 0;
};

/// Types: number, relay, sum, clock, drift, decade, place, curveSource, fileSize, warner, failer, crasher, undeclared,
/// peek, sim.
std::shared_ptr<const Registry> registry(std::shared_ptr<Counts> counts = std::make_shared<Counts>());

std::shared_ptr<const Graph> graph(const std::shared_ptr<const Registry>& r, const std::string& nodes);

/// Counts events and keeps warnings.
struct Watcher : Observer {
    std::atomic<int> computed_count = 0, stepped_count = 0, reused_count = 0, progress_count = 0;
    std::vector<Diagnostic> warnings;
    void computed(const std::string&, double, double) override { ++computed_count; }
    void stepped(const std::string&, double, double) override { ++stepped_count; }
    void reused(const std::string&, double) override { ++reused_count; }
    void warning(const Diagnostic& d) override { warnings.push_back(d); }
    void progress(const std::string&, double, std::string_view) override { ++progress_count; }
};

/// The codes of the diagnostics that a call throws, in order, blank-separated; "" if it throws nothing.
template <class F>
std::string codes_of(F&& f) {
    try {
        f();
    } catch (const Failure& e) {
        std::string out;
        for (const Diagnostic& d : e.diagnostics()) out += (out.empty() ? "" : " ") + d.code;
        return out;
    }
    return {};
}

inline double number(Evaluator& e, const std::shared_ptr<const Graph>& g, const Plug& plug, double frame) {
    return e.pull({g, plug, frame, {}}).as<double>();
}

} // namespace toys

template <>
struct sinew::engine::ValueTraits<toys::ToyState> {
    static constexpr std::string_view name = "toyState";
    static void hash(Hasher& h, const toys::ToyState& s) { h.add(s.x).add(s.x_before).add(s.v).add(s.steps); }
    static std::size_t bytes(const toys::ToyState&) { return 0; }
};
