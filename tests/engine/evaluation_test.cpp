// Pulls: what runs, how often, on how many threads, and what is thrown.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/state_file.h"
#include "tests/support/engine_toys.h"

#include <barrier>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <thread>
#include <unistd.h>

using namespace toys;

namespace {

std::string chain_of_relays(int length) {
    std::string nodes = R"("n0": {"type": "number", "inputs": {"value": 1}})";
    for (int i = 1; i <= length; ++i)
        nodes += ",\"n" + std::to_string(i) + R"(": {"type": "relay", "inputs": {"in": {"from": "n)" +
                 std::to_string(i - 1) + ".out\"}}}";
    return nodes;
}

struct TemporaryFile {
    std::filesystem::path path;
    explicit TemporaryFile(const std::string& name)
        : path(std::filesystem::temp_directory_path() / ("sinew_engine_" + std::to_string(::getpid()) + "_" + name)) {}
    ~TemporaryFile() { std::filesystem::remove(path); }
    void write(const std::string& text) const { std::ofstream(path, std::ios::binary) << text; }
};

} // namespace

TEST_CASE("a value is computed once and then found") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(
        registry(counts),
        R"("a": {"type": "number", "inputs": {"value": 4}}, "b": {"type": "relay", "inputs": {"in": {"from": "a.out"}}})");
    Evaluator e;
    CHECK(number(e, g, {"b", "out"}, 1) == 5);
    CHECK(number(e, g, {"b", "out"}, 77) == 5); // nothing here changes over time
    CHECK(counts->computes == 2);
}

TEST_CASE("nodes that are alike but for their names run once") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(
        registry(counts),
        R"("a": {"type": "number", "inputs": {"value": 4}}, "b": {"type": "number", "inputs": {"value": 4, "show": false}},
        "s": {"type": "sum", "inputs": {"terms": [{"from": "a.out"}, {"from": "b.out"}]}})");
    Evaluator e;
    CHECK(number(e, g, {"s", "out"}, 1) == 8);
    CHECK(counts->computes == 2);
}

TEST_CASE("the order of a list of connections matters, names do not") {
    auto counts = std::make_shared<Counts>();
    const auto types = registry(counts);
    const auto text = [](const char* first, const char* second) {
        return std::string(
                   R"("a": {"type": "number", "inputs": {"value": 4}}, "b": {"type": "clock"}, "s": {"type": "sum", "inputs": {"terms": [{"from": ")") +
               first + R"("}, {"from": ")" + second + R"("}]}})";
    };
    Evaluator e;
    number(e, graph(types, text("a.out", "b.out")), {"s", "out"}, 24);
    const int before = counts->computes;
    number(e, graph(types, text("b.out", "a.out")), {"s", "out"}, 24);
    CHECK(counts->computes == before + 1);
}

TEST_CASE("only nodes that say so depend on the frame and on the frame rate") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("c": {"type": "clock"})");
    Evaluator e;
    CHECK(number(e, g, {"c", "out"}, 12) == 0.5);
    CHECK(number(e, g, {"c", "out"}, 12.5) == 12.5 / 24);
    const auto fast = Edit(g).set_timing({48, 1, 10}).commit().graph;
    CHECK(number(e, fast, {"c", "out"}, 12) == 0.25);
    CHECK(counts->computes == 3);
}

TEST_CASE("five consumers of one frame run it once") {
    auto counts = std::make_shared<Counts>();
    std::string nodes = R"("sim": {"type": "sim"})", terms;
    for (int i = 0; i < 5; ++i) {
        nodes += ",\"c" + std::to_string(i) + R"(": {"type": "relay", "inputs": {"in": {"from": "sim.out"}}})";
        terms += std::string(i ? "," : "") + R"({"from": "c)" + std::to_string(i) + ".out\"}";
    }
    const auto g = graph(registry(counts), nodes + R"(, "s": {"type": "sum", "inputs": {"terms": [)" + terms + "]}}");
    Evaluator e;
    number(e, g, {"s", "out"}, 20);
    CHECK(counts->advances == 19);
    CHECK(counts->publishes == 20);
}

TEST_CASE("the same frames asked by five threads at once run once") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("a": {"type": "number", "inputs": {"value": {"keys": [[1, 1], [40, 3]]}}},
        "sim": {"type": "sim", "inputs": {"target": {"from": "a.out"}}}, "r": {"type": "relay", "inputs": {"in": {"from": "sim.out"}}})");
    Evaluator e({}, 2);
    std::barrier gate(5);
    std::vector<std::thread> threads;
    std::vector<double> results(5);
    for (std::size_t i = 0; i < 5; ++i)
        threads.emplace_back([&, i] {
            gate.arrive_and_wait();
            for (int f = 10; f <= 40; f += 10) results[i] = number(e, g, {"r", "out"}, f);
        });
    for (auto& t : threads) t.join();
    CHECK(counts->advances == 39);
    CHECK(counts->initials == 1);
    CHECK(counts->publishes == 40);
    CHECK(counts->computes == 40 + 4);
    for (double r : results) CHECK(r == results[0]);
}

TEST_CASE("many threads pull overlapping parts of a wide graph, each node runs once") {
    auto counts = std::make_shared<Counts>();
    std::string nodes = R"("n": {"type": "number", "inputs": {"value": 2}})";
    const int width = 40;
    for (int i = 0; i < width; ++i)
        for (int level = 0; level < 5; ++level) {
            const std::string name = "m" + std::to_string(i) + "_" + std::to_string(level);
            const std::string below = level == 0 ? "n" : "m" + std::to_string(i) + "_" + std::to_string(level - 1);
            const std::string beside =
                level == 0 ? "n" : "m" + std::to_string((i + 1) % width) + "_" + std::to_string(level - 1);
            nodes += ", \"" + name + R"(": {"type": "sum", "inputs": {"terms": [{"from": ")" + below +
                     R"(.out"}, {"from": ")" + beside + ".out\"}";
            for (int k = 0; k < i; ++k) nodes += R"(, {"from": "n.out"})"; // makes the columns differ
            nodes += "]}}";
        }
    const auto g = graph(registry(counts), nodes);
    for (int round = 0; round < 3; ++round) {
        counts->computes = 0;
        Evaluator e({}, 2);
        std::barrier gate(4);
        std::vector<std::thread> threads;
        for (int t = 0; t < 4; ++t)
            threads.emplace_back([&, t] {
                gate.arrive_and_wait();
                for (int i = 0; i < width; ++i)
                    number(e, g, {"m" + std::to_string((i * 7 + t * 11) % width) + "_4", "out"}, 1);
            });
        for (auto& t : threads) t.join();
        CHECK(counts->computes == 1 + 5 * width);
    }
}

TEST_CASE("a chain of 100000 nodes is loaded, pulled and edited") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), chain_of_relays(100000));
    Evaluator e;
    CHECK(number(e, g, {"n100000", "out"}, 1) == 100001);
    CHECK(counts->computes == 100001);
    const auto edited = Edit(g).set_json({"n99999", "in"}, R"({"from": "n10.out"})").commit().graph;
    CHECK(number(e, edited, {"n100000", "out"}, 1) == 13);
    CHECK(counts->computes == 100001 + 0); // relays of equal depth have equal keys: both were computed before
    CHECK(find_cycle(*g).empty());
}

TEST_CASE("a chain of 100000 nodes that changes over time is pulled") {
    auto counts = std::make_shared<Counts>();
    const auto g = Edit(graph(registry(counts), chain_of_relays(100000)))
                       .set_key({"n0", "value"}, 1, 5)
                       .set_key({"n0", "value"}, 3, 7)
                       .commit()
                       .graph;
    Evaluator e;
    CHECK(number(e, g, {"n100000", "out"}, 2) == 100006);
}

TEST_CASE("with no budget at all every pull computes and is right") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("a": {"type": "number", "inputs": {"value": {"keys": [[1, 1], [9, 5]]}}},
        "sim": {"type": "sim", "inputs": {"target": {"from": "a.out"}}}, "r": {"type": "relay", "inputs": {"in": {"from": "sim.out"}}})");
    Evaluator none({.value_bytes = 0, .state_bytes = 0}), plenty;
    for (int f : {3, 9, 5}) CHECK(number(none, g, {"r", "out"}, f) == number(plenty, g, {"r", "out"}, f));
}

TEST_CASE("the value budget holds and evicts what was used longest ago") {
    auto counts = std::make_shared<Counts>();
    const auto types = registry(counts);
    const auto g = graph(types, R"("a": {"type": "number", "inputs": {"value": {"keys": [[1, 1], [100, 100]]}}})");
    Evaluator e({.value_bytes = 4000});
    for (int f = 1; f <= 100; ++f) {
        number(e, g, {"a", "out"}, f);
        CHECK(e.stored_bytes() <= 4000);
    }
    CHECK(counts->computes == 100);
    number(e, g, {"a", "out"}, 99);
    CHECK(counts->computes == 100);
    number(e, g, {"a", "out"}, 2);
    CHECK(counts->computes == 101);
}

TEST_CASE("a failure names node, attribute, place and frame, independent failures come together") {
    const auto g = graph(registry(), R"(
        "f1": {"type": "failer", "inputs": {"value": 3}},
        "f2": {"type": "failer", "inputs": {"value": {"keys": [[1, 1], [9, 5]]}}},
        "s": {"type": "sum", "inputs": {"terms": [{"from": "f1.out"}, {"from": "f2.out"}, {"from": "f1.out"}]}})");
    Evaluator e;
    try {
        e.pull({g, {"s", "out"}, 3, {}});
        FAIL("must throw");
    } catch (const SolveFailure&) {
        FAIL("not a failed solve");
    } catch (const Failure& f) {
        REQUIRE(f.diagnostics().size() == 2);
        const Diagnostic &a = f.diagnostics()[0], &b = f.diagnostics()[1];
        CHECK(a.code == "FE201");
        CHECK(a.node == "f1");
        CHECK(a.attribute == "value");
        CHECK_FALSE(a.frame);
        REQUIRE(a.spot);
        CHECK(a.spot->line == 2);
        CHECK(a.spot->pointer == "/nodes/f1/inputs/value");
        CHECK(b.node == "f2");
        CHECK(b.frame == 3.0);
        CHECK(b.spot->line == 3);
        CHECK(std::string(f.what()).find("toy.json:2:") == 0);
    }
}

TEST_CASE("a failed step is a SolveFailure and the frames before it stay") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("sim": {"type": "sim", "inputs": {"failAt": 30}})");
    Evaluator e;
    CHECK_THROWS_AS(e.pull({g, {"sim", "out"}, 40, {}}), SolveFailure);
    CHECK(counts->advances == 29);
    number(e, g, {"sim", "out"}, 29);
    CHECK(counts->advances == 29);
    CHECK_THROWS_AS(e.pull({g, {"sim", "out"}, 40, {}}), SolveFailure);
    CHECK(counts->advances == 30);
}

TEST_CASE("a bug in a node passes through as it is") {
    const auto types = registry();
    Evaluator e;
    const auto pull = [&](const char* type) {
        return e.pull({graph(types, std::string(R"("x": {"type": ")") + type +
                                        R"("}, "s": {"type": "sum", "inputs": {"terms": [{"from": "x.out"}]}})"),
                       {"s", "out"},
                       1,
                       {}});
    };
    CHECK_THROWS_AS(pull("crasher"), std::out_of_range);
    CHECK_THROWS_WITH(pull("undeclared"), Catch::Contains("undeclared read \"other\", which it did not declare"));
    CHECK_THROWS_WITH(pull("peek"), Catch::Contains("affects nothing"));
    CHECK_THROWS_WITH(pull("timeThief"), Catch::Contains("without declaring uses_time"));
    CHECK_THROWS_WITH(pull("forgetful"), Catch::Contains("did not write output \"out\""));
}

TEST_CASE("wrong requests are refused with a suggestion") {
    const auto g = graph(
        registry(),
        R"("number1": {"type": "number"}, "x": {"type": "mystery"}, "r": {"type": "relay", "inputs": {"in": {"from": "x.out"}}})");
    Evaluator e;
    const auto codes = [&](const Plug& p, double frame) { return codes_of([&] { e.pull({g, p, frame, {}}); }); };
    CHECK(codes({"numbr1", "out"}, 1) == "DG102");
    CHECK(codes({"number1", "outt"}, 1) == "DG102");
    CHECK(codes({"number1", "out"}, std::numeric_limits<double>::quiet_NaN()) == "DG104");
    CHECK(codes({"x", "out"}, 1) == "DG101");
    CHECK(codes({"r", "out"}, 1) == "DG101");
    CHECK(codes({"number1", "out"}, 1).empty());
}

TEST_CASE("a graph under construction fails when it is pulled, with what is missing") {
    const auto types = registry();
    const auto g =
        Edit(std::make_shared<const Graph>(types)).add_node("r", "relay").add_node("s", "sum").commit().graph;
    Evaluator e;
    CHECK(codes_of([&] { e.pull({g, {"r", "out"}, 1, {}}); }) == "DG019");
    CHECK(codes_of([&] { e.pull({g, {"s", "out"}, 1, {}}); }) == "DG019");
}

TEST_CASE("a warning reaches the observer once for each snapshot, also when the value is reused") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("w": {"type": "warner"})");
    Watcher watcher;
    Evaluator e({}, 0, &watcher);
    for (int i = 0; i < 3; ++i) number(e, g, {"w", "out"}, i);
    REQUIRE(watcher.warnings.size() == 1);
    CHECK(watcher.warnings[0].node == "w");
    CHECK(watcher.warnings[0].severity == Severity::warning);
    CHECK(watcher.reused_count == 2);
    const auto renamed = Edit(g).rename_node("w", "warner1").commit().graph;
    number(e, renamed, {"warner1", "out"}, 1);
    CHECK(counts->computes == 1);
    REQUIRE(watcher.warnings.size() == 2);
    CHECK(watcher.warnings[1].node == "warner1");
    CHECK(watcher.warnings[1].message == "mind the gap");
}

TEST_CASE("the observer hears of computes, steps, progress and reuse") {
    const auto g = graph(
        registry(),
        R"("sim": {"type": "sim", "inputs": {"substeps": 2}}, "r": {"type": "relay", "inputs": {"in": {"from": "sim.out"}}})");
    Watcher watcher;
    Evaluator e({}, 2, &watcher);
    number(e, g, {"r", "out"}, 5);
    CHECK(watcher.stepped_count == 5); // the start counts
    CHECK(watcher.computed_count == 6);
    CHECK(watcher.progress_count == 8);
    CHECK(watcher.reused_count == 0);
    number(e, g, {"sim", "out"}, 3);
    CHECK(watcher.reused_count == 1);
}

TEST_CASE("a file enters by its content: a copy elsewhere is found, a change is seen") {
    auto counts = std::make_shared<Counts>();
    const auto types = registry(counts);
    const TemporaryFile a("a.txt"), b("b.txt"), other("c.obj");
    a.write("12345"), b.write("12345"), other.write("12345");
    const auto with = [&](const TemporaryFile& f) {
        return graph(types, R"("f": {"type": "fileSize", "inputs": {"file": ")" + f.path.string() + "\"}}");
    };
    const auto g = with(a);
    Evaluator e;
    CHECK(number(e, g, {"f", "out"}, 1) == 5);
    CHECK(number(e, with(b), {"f", "out"}, 1) == 5);
    CHECK(counts->computes == 1);
    number(e, with(other), {"f", "out"}, 1); // another extension may mean another reader
    CHECK(counts->computes == 2);
    a.write("1234567");
    CHECK(number(e, g, {"f", "out"}, 1) == 7);
    CHECK(counts->computes == 3);
    std::filesystem::remove(a.path);
    CHECK(codes_of([&] { e.pull({g, {"f", "out"}, 1, {}}); }) == "IO401");
}

TEST_CASE("a file is read again if its size or its time has changed, and only then") {
    namespace fs = std::filesystem;
    auto counts = std::make_shared<Counts>();
    const TemporaryFile a("a.txt");
    a.write("12345");
    const auto written = fs::last_write_time(a.path);
    const auto g =
        graph(registry(counts), R"("f": {"type": "fileSize", "inputs": {"file": ")" + a.path.string() + "\"}}");
    Evaluator e;
    CHECK(number(e, g, {"f", "out"}, 1) == 5);
    a.write("54321"); // of the same size
    fs::last_write_time(a.path, written + std::chrono::seconds(3));
    number(e, g, {"f", "out"}, 1);
    CHECK(counts->computes == 2);
    a.write("1234567"); // at the same time
    fs::last_write_time(a.path, written + std::chrono::seconds(3));
    CHECK(number(e, g, {"f", "out"}, 1) == 7);
    CHECK(counts->computes == 3);
}

TEST_CASE("two outputs of one type on one node are not taken for each other") {
    Registry r;
    static const Output<double> low{.name = "low", .doc = "One."}, high{.name = "high", .doc = "Two."},
        out{.name = "out", .doc = "The same."};
    static const Wire<double> in_wire{.name = "in", .doc = "What to pass on."};
    r.add({.name = "pair",
           .doc = "A pair.",
           .outputs = {describe(low), describe(high)},
           .compute = [](const Reads&, Writes& w) { w.set(low, 1.0), w.set(high, 2.0); }});
    r.add({.name = "pass",
           .doc = "Passes on.",
           .inputs = {describe(in_wire)},
           .outputs = {describe(out)},
           .compute = [](const Reads& in, Writes& w) { w.set(out, in[in_wire]); }});
    const auto g = graph(std::make_shared<const Registry>(std::move(r)), R"("p": {"type": "pair"},
        "a": {"type": "pass", "inputs": {"in": {"from": "p.low"}}}, "b": {"type": "pass", "inputs": {"in": {"from": "p.high"}}})");
    Evaluator e;
    CHECK(number(e, g, {"a", "out"}, 1) == 1);
    CHECK(number(e, g, {"b", "out"}, 1) == 2);
}

TEST_CASE("another version or numerics of a type is computed anew") {
    int computes = 0;
    static const Output<double> out{.name = "out", .doc = "The number."};
    const auto with = [&](int version, int numerics) {
        Registry r;
        r.add({.name = "t",
               .version = version,
               .numerics = numerics,
               .doc = "A type.",
               .outputs = {describe(out)},
               .compute = [&computes](const Reads&, Writes& w) { w.set(out, static_cast<double>(++computes)); }});
        return graph(std::make_shared<const Registry>(std::move(r)), R"("t": {"type": "t"})");
    };
    Evaluator e;
    CHECK(number(e, with(1, 1), {"t", "out"}, 1) == 1);
    CHECK(number(e, with(1, 2), {"t", "out"}, 1) == 2);
    CHECK(number(e, with(2, 1), {"t", "out"}, 1) == 3);
    CHECK(number(e, with(1, 1), {"t", "out"}, 1) == 1);
}

TEST_CASE("what was computed with the kernels of another machine is computed anew, and its states are refused") {
    int computes = 0;
    static const Output<double> out{.name = "out", .doc = "The number."};
    const auto on = [&](const std::string& machine) {
        Registry r;
        r.add({.name = "t",
               .machine = machine,
               .doc = "A type.",
               .outputs = {describe(out)},
               .compute = [&computes](const Reads&, Writes& w) { w.set(out, static_cast<double>(++computes)); }});
        return graph(std::make_shared<const Registry>(std::move(r)), R"("t": {"type": "t"})");
    };
    Evaluator e;
    CHECK(number(e, on(""), {"t", "out"}, 1) == 1);
    CHECK(number(e, on("Haswell"), {"t", "out"}, 1) == 2);
    CHECK(number(e, on("SkylakeX"), {"t", "out"}, 1) == 3);
    CHECK(number(e, on("Haswell"), {"t", "out"}, 1) == 2);
    NodeType type{.name = "t", .machine = "Haswell", .doc = "A type."};
    const std::vector<std::byte> payload(3, std::byte{7});
    const auto bytes = wrap_state(type, {1, 2}, payload);
    CHECK(unwrap_state(type, {1, 2}, bytes).fault.empty());
    type.machine = "SkylakeX";
    CHECK(unwrap_state(type, {1, 2}, bytes).fault.find("kernels of another processor") != std::string::npos);
}

TEST_CASE("a curve that leaves the limits between its keys is refused where it does") {
    const auto g = graph(registry(), R"("n": {"type": "number", "inputs": {"value": {"interp": "smooth",
        "keys": [[1, 1, {"out": -8}], [5, 1, {"in": 8}]]}}})");
    Evaluator e;
    CHECK(number(e, g, {"n", "out"}, 1) == 1);
    CHECK(number(e, g, {"n", "out"}, 5) == 1);
    CHECK(codes_of([&] { number(e, g, {"n", "out"}, 3); }) == "DG013"); // 1 + h/8 (m0 - m1) = -7
}

TEST_CASE("what failed in a command is not computed again in it, and fails alike") {
    auto counts = std::make_shared<Counts>();
    const auto types = registry(counts);
    const std::string nodes =
        R"("bad": {"type": "failer"}, "after": {"type": "relay", "inputs": {"in": {"from": "bad.out"}}})";
    const auto g = graph(types, nodes), other = graph(types, nodes);
    Evaluator e;
    const auto failure = [&](const std::shared_ptr<const Graph>& in, const char* node,
                             std::shared_ptr<Failures> failures) {
        try {
            e.pull({in, {node, "out"}, 1, {}, std::move(failures)});
        } catch (const Failure& f) {
            return f.diagnostics()[0].node + " " + f.diagnostics()[0].code;
        }
        return std::string("none");
    };
    const auto command = remember_failures();
    CHECK(failure(g, "bad", command) == "bad FE201");
    CHECK(failure(g, "after", command) == "bad FE201");
    CHECK(failure(g, "bad", command) == "bad FE201");
    CHECK(counts->computes == 1);
    CHECK(failure(g, "bad", remember_failures()) == "bad FE201"); // the next command tries again
    CHECK(counts->computes == 2);
    CHECK(failure(g, "bad", nullptr) == "bad FE201"); // as does a host that asks for nothing to be remembered
    CHECK(counts->computes == 3);
    CHECK(failure(other, "bad", command) == "bad FE201"); // its diagnostics name places in another graph
    CHECK(counts->computes == 4);
}

TEST_CASE("a step that failed in a command is not taken again in it") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("s": {"type": "sim", "inputs": {"failAt": 3}},
        "after": {"type": "relay", "inputs": {"in": {"from": "s.out"}}})");
    Evaluator e;
    const auto command = remember_failures();
    CHECK_THROWS_AS(e.pull({g, {"s", "out"}, 3, {}, command}), Failure);
    const int advances = counts->advances;
    CHECK_THROWS_AS(e.pull({g, {"after", "out"}, 3, {}, command}), Failure);
    CHECK(counts->advances == advances);
    CHECK_THROWS_AS(e.pull({g, {"after", "out"}, 3}), Failure);
    CHECK(counts->advances == advances + 1);
}
