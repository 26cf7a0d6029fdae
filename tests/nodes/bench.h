// What the tests of nodes share: graphs from JSON text, pulls, codes of failures, counts of computes and
// steps, files.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/evaluator.h"
#include "engine/format/graph_file.h"
#include "engine/text.h"
#include "nodes/register_all.h"
#include "nodes/values.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <unistd.h>
#include <vector>

namespace bench {

using namespace sinew;

/// Counts what ran and keeps the warnings; a test that expects none asserts that there are none.
class Counter : public engine::Observer {
  public:
    void computed(const std::string& node, double, double) override { ++computes[node]; }
    void stepped(const std::string& node, double, double) override { ++steps[node]; }
    void warning(const engine::Diagnostic& d) override { warnings.push_back(d); }
    std::map<std::string, int> computes, steps;
    std::vector<engine::Diagnostic> warnings;
};

/// `nodes` is the inside of "nodes": { … }.
inline std::shared_ptr<const engine::Graph> graph(const std::string& nodes) {
    const std::string text =
        R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 20}, "nodes": {)" + nodes + "}}";
    return engine::read_graph(nodes::make_registry(), text, "test.json").graph;
}

/// A graph with an evaluator of its own.
struct Session {
    std::shared_ptr<const engine::Graph> graph;
    Counter counter;
    engine::Evaluator evaluator;
    explicit Session(const std::string& nodes, int threads = 1)
        : graph(bench::graph(nodes))
        , evaluator({}, threads, &counter) {}
    engine::Value pull(const std::string& node, const std::string& output, double frame = 1) {
        return evaluator.pull({graph, {node, output}, frame});
    }
    template <class T>
    T get(const std::string& node, const std::string& output, double frame = 1) {
        return pull(node, output, frame).as<T>();
    }
    void set(const std::string& node, const std::string& attribute, const std::string& json) {
        graph = engine::Edit(graph).set_json({node, attribute}, json).commit().graph;
    }
};

/// The codes of all problems that `run` throws, in order; empty if it throws nothing.
inline std::vector<std::string> codes(const std::function<void()>& run, std::string* text = nullptr) {
    std::vector<std::string> out;
    try {
        run();
    } catch (const engine::Failure& f) {
        for (const engine::Diagnostic& d : f.diagnostics()) out.push_back(d.code);
        if (text) *text = f.what();
    }
    return out;
}

/// The codes that reading and pulling a graph gives.
inline std::vector<std::string> codes(const std::string& nodes, const std::string& node, const std::string& output,
                                      std::string* text = nullptr, double frame = 1) {
    return codes([&] { Session(nodes).pull(node, output, frame); }, text);
}

using Codes = std::vector<std::string>;

/// As graphs have it, with all of its digits.
inline std::string number(double v) { return engine::number_text(v); }

/// A folder that goes away with the test.
class Folder {
  public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "sinew-nodes-XXXXXX").string();
        REQUIRE(mkdtemp(name.data()));
        path_ = name;
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
        return (path_ / name).string();
    }
    std::string path(const std::string& name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

inline double largest_difference(const solver::Points& a, const solver::Points& b) {
    REQUIRE(a.size() == b.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).cwiseAbs().maxCoeff());
    return worst;
}

} // namespace bench
