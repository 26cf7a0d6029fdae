// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/graph_scale.h"

#include "engine/evaluator.h"
#include "engine/format/graph_file.h"
#include "nodes/register_all.h"
#include "solver/error.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

namespace fs = std::filesystem;

constexpr int frames = 12, parts = 100;

struct Text {
    std::string top, part; ///< the graph file, and what it includes
    engine::Plug plug, edited;
    std::string edited_value;
};

std::string document(const std::string& nodes, const std::string& includes = {}) {
    return "{\n  \"format\": \"sinew 1\",\n  \"timing\": { \"start\": 1, \"end\": 1000 },\n" +
           (includes.empty() ? "" : "  \"includes\": {\n" + includes + "\n  },\n") + "  \"nodes\": {\n" + nodes +
           "\n  }\n}\n";
}

/// Transforms, each of which carries the next.
Text chain(int count) {
    std::string nodes;
    for (int i = 0; i < count; ++i) {
        const std::string name = "t" + std::to_string(i);
        nodes += (i > 0 ? ",\n" : "") + std::string("    \"") + name +
                 "\": { \"type\": \"transform\", \"inputs\": { \"translate\": ";
        nodes += i == 0 ? "{ \"keys\": [[1, [0, 0, 0]], [1000, [1, 2, 3]]], \"interp\": \"linear\" }"
                        : "[0, 0.001, 0], \"offsetParentMatrix\": { \"from\": \"t" + std::to_string(i - 1) +
                              ".outMatrix\" }";
        nodes += " } }";
    }
    const std::string last = "t" + std::to_string(count - 1);
    return {document(nodes), {}, {last, "outMatrix"}, {"t" + std::to_string(count / 2), "translate"}, "[0, 0.002, 0]"};
}

/// Painted maps of a box that grows, and what they are together.
std::string maps(int count) {
    std::string list, nodes = "    \"box\": { \"type\": \"polyCube\", \"inputs\": { \"width\": { \"keys\": [[1, 1], "
                              "[1000, 2]], \"interp\": \"linear\" } } }";
    for (int i = 0; i < count; ++i) {
        const std::string name = "w" + std::to_string(i);
        nodes += ",\n    \"" + name +
                 "\": { \"type\": \"weights\", \"inputs\": { \"mesh\": { \"from\": \"box.outMesh\" }, \"mode\": "
                 "\"ramp\", \"start\": -" +
                 std::to_string(1 + i) + " } }";
        list += (i > 0 ? ", " : "") + std::string("{ \"from\": \"") + name + ".outWeights\" }";
    }
    return nodes + ",\n    \"sum\": { \"type\": \"combineWeights\", \"inputs\": { \"weights\": [ " + list + " ] } }";
}

Text wide(int count) { return {document(maps(count - 2)), {}, {"sum", "outWeights"}, {"w1", "end"}, "0.25"}; }

Text included(int count) {
    std::string includes, list;
    for (int i = 0; i < parts; ++i) {
        const std::string prefix = "p" + std::to_string(i);
        includes += (i > 0 ? ",\n" : "") + std::string("    \"") + prefix +
                    "\": { \"file\": \"part.json\", \"overrides\": { \"w0.end\": " + std::to_string(2 + i) + " } }";
        list += (i > 0 ? ", " : "") + std::string("{ \"from\": \"") + prefix + ".sum.outWeights\" }";
    }
    return {document("    \"sum\": { \"type\": \"combineWeights\", \"inputs\": { \"weights\": [ " + list + " ] } }",
                     includes),
            document(maps(count / parts - 2)),
            {"sum", "outWeights"},
            {"p7.w1", "end"},
            "0.25"};
}

double median(std::vector<double> of) {
    std::sort(of.begin(), of.end());
    return of[of.size() / 2];
}

template <class F>
double seconds(const F& f) {
    const auto begin = std::chrono::steady_clock::now();
    f();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

class Folder {
  public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "sinew-bench-XXXXXX").string();
        if (!mkdtemp(name.data())) throw solver::Error("IO405", "a temporary folder cannot be made", {});
        path_ = name;
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    void put(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
    }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  private:
    fs::path path_;
};

GraphRow measure(const std::string& shape, const Text& text, const RunOptions& options) {
    GraphRow row;
    row.shape = shape;
    row.megabytes = static_cast<double>(text.top.size() + text.part.size()) / 1e6;
    const Folder folder;
    folder.put("part.json", text.part);
    const auto registry = nodes::make_registry();
    std::vector<double> times;
    std::shared_ptr<const engine::Graph> graph;
    for (int i = 0; i < 3; ++i)
        times.push_back(seconds([&] { graph = engine::read_graph(registry, text.top, folder / "graph.json").graph; }));
    row.load = median(times);
    row.nodes = static_cast<int>(graph->node_names().size());
    engine::Evaluator evaluator;
    const auto pull = [&](int frame) {
        if (options.stop.stop_requested()) throw solver::Stopped();
        return seconds([&] { row.digest = evaluator.pull({graph, text.plug, double(frame), {}}).digest().hex(); });
    };
    row.first = pull(1);
    std::vector<double> anew, again, edits;
    for (int frame = 2; frame < 2 + frames; ++frame) anew.push_back(pull(frame));
    for (int frame = 2; frame < 2 + frames; ++frame) again.push_back(pull(frame));
    row.frame = median(anew), row.plan = median(again);
    for (int i = 0; i < 5; ++i)
        edits.push_back(seconds([&] {
            engine::Edit edit(graph);
            edit.set_json(text.edited, text.edited_value).commit();
        }));
    row.edit = median(edits);
    return row;
}

} // namespace

GraphScale run_graph_scale(const RunOptions& options) {
    GraphScale out;
    const std::pair<const char*, Text (*)(int)> shapes[] = {{"chain", chain}, {"wide", wide}, {"included", included}};
    const std::vector<int> sizes = options.quick ? std::vector<int>{1000} : std::vector<int>{1000, 10000, 40000};
    for (const auto& [name, make] : shapes)
        for (const int count : sizes) {
            if (!options.wants(name)) continue;
            options.tell(std::string(name) + ", " + std::to_string(count) + " nodes");
            out.rows.push_back(measure(name, make(count), options));
        }
    return out;
}

Table graph_scale_table(const GraphScale& result) {
    Table t{{"shape", "nodes", "MB of text", "load s", "first frame ms", "frame ms", "plan ms", "edit ms"}, {}};
    for (const GraphRow& r : result.rows)
        t.rows.push_back({r.shape, std::to_string(r.nodes), number(r.megabytes, 2), number(r.load, 2),
                          number(1e3 * r.first, 2), number(1e3 * r.frame, 2), number(1e3 * r.plan, 2),
                          number(1e3 * r.edit, 2)});
    return t;
}

nlohmann::ordered_json graph_scale_json(const GraphScale& result) {
    auto out = nlohmann::ordered_json::array();
    for (const GraphRow& r : result.rows)
        out.push_back({{"shape", r.shape},
                       {"nodes", r.nodes},
                       {"megabytes", r.megabytes},
                       {"load_s", r.load},
                       {"first_frame_s", r.first},
                       {"frame_s", r.frame},
                       {"plan_s", r.plan},
                       {"edit_s", r.edit},
                       {"digest", r.digest}});
    return out;
}

} // namespace sinew::bench
