// What a host sends frame by frame: earlier frames stay as they are, and the result is that of the same motion as keys.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>

using namespace toys;

namespace {

const Plug plug{"sim", "out"};

std::uint64_t bits(double v) { return std::bit_cast<std::uint64_t>(v); }

Matrix4 place_at(double frame) {
    return {1, 0, 0, 0.1 * frame, 0, 1, 0, 0.01 * frame * frame, 0, 0, 1, -0.3, 0, 0, 0, 1};
}

std::string matrix_text(const Matrix4& m) {
    std::string out = "[";
    char number[40];
    for (std::size_t i = 0; i < m.size(); ++i) {
        std::snprintf(number, sizeof number, "%s%.17g", i ? ", " : "", m[i]);
        out += number;
    }
    return out + "]";
}

std::string scene(const std::string& matrix, const std::string& sim = "\"substeps\": 3") {
    return R"("p": {"type": "place", "inputs": {"matrix": )" + matrix +
           R"(}}, "sim": {"type": "sim", "inputs": {"target": {"from": "p.out"}, )" + sim + "}}";
}

} // namespace

TEST_CASE("a matrix sent frame by frame costs one step a frame and gives the bits of the same keys") {
    for (const char* sim : {"\"substeps\": 1", "\"substeps\": 3", "\"substeps\": 2, \"scheme\": \"staged\""}) {
        INFO(sim);
        auto counts = std::make_shared<Counts>();
        const auto types = registry(counts);
        auto g = graph(types, scene(matrix_text(place_at(1)), sim));
        Evaluator e({}, 2);
        number(e, g, plug, 1);
        std::vector<std::uint64_t> live;
        std::string keys;
        for (int f = 1; f <= 20; ++f) {
            g = Edit(g).set_input({"p", "matrix"}, f, Value::of<Matrix4>(place_at(f))).commit().graph;
            const int before = counts->advances;
            live.push_back(bits(number(e, g, plug, f)));
            CHECK(counts->advances - before == (f == 1 ? 0 : 1));
            keys += (f > 1 ? ", [" : "[") + std::to_string(f) + ", " + matrix_text(place_at(f)) + "]";
        }
        CHECK(counts->initials == 1);
        // Keys in a file, in another evaluator.
        const auto keyed = graph(types, scene("{\"keys\": [" + keys + "]}", sim));
        Evaluator fresh({}, 1);
        for (int f = 1; f <= 20; ++f)
            CHECK(bits(number(fresh, keyed, plug, f)) == live[static_cast<std::size_t>(f - 1)]);
        // The file that is written of the live graph says the same, and the live evaluator knows all frames of it.
        const auto again = read_graph(types, write_graph(*g), "toy.json").graph;
        const int before = counts->advances;
        for (int f = 1; f <= 20; ++f) CHECK(bits(number(e, again, plug, f)) == live[static_cast<std::size_t>(f - 1)]);
        CHECK(counts->advances == before);
    }
}

TEST_CASE("translations sent as matrices are the keyed translations, to the bit") {
    const auto types = registry();
    auto g = graph(types, scene("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]"));
    auto moved = g;
    for (int f = 1; f <= 10; ++f) {
        const Matrix4 m = place_at(f);
        g = Edit(g).set_input({"p", "matrix"}, f, Value::of<Matrix4>(m)).commit().graph;
        moved = Edit(moved).set_input({"p", "translate"}, f, Value::of<Vec3>({m[3], m[7], m[11]})).commit().graph;
    }
    Evaluator e({}, 1);
    for (int f = 1; f <= 10; ++f) CHECK(bits(number(e, g, plug, f)) == bits(number(e, moved, plug, f)));
}

TEST_CASE("a value sent at a frame leaves the past alone, also frames that were skipped") {
    auto counts = std::make_shared<Counts>();
    auto g = graph(registry(counts), scene(matrix_text(place_at(1))));
    Evaluator e({}, 1);
    std::vector<std::uint64_t> before;
    for (int f = 1; f <= 9; ++f) before.push_back(bits(number(e, g, plug, f)));
    const auto sent = Edit(g).set_input({"p", "matrix"}, 10, Value::of<Matrix4>(place_at(40))).commit().graph;
    int steps = counts->advances;
    for (int f = 1; f <= 9; ++f) CHECK(bits(number(e, sent, plug, f)) == before[static_cast<std::size_t>(f - 1)]);
    CHECK(counts->advances == steps);
    number(e, sent, plug, 12);
    CHECK(counts->advances == steps + 3);
    CHECK(number(e, sent, {"p", "out"}, 500) == number(e, sent, {"p", "out"}, 10)); // held until told otherwise
    // Sent again: the same frames. Sent anew: from there on.
    steps = counts->advances;
    const auto same = Edit(sent).set_input({"p", "matrix"}, 10, Value::of<Matrix4>(place_at(40))).commit().graph;
    number(e, same, plug, 12);
    CHECK(counts->advances == steps);
    const auto other = Edit(sent).set_input({"p", "matrix"}, 11, Value::of<Matrix4>(place_at(2))).commit().graph;
    number(e, other, plug, 12);
    CHECK(counts->advances == steps + 2);
    const auto back = Edit(other).set_input({"p", "matrix"}, 11, Value::of<Matrix4>(place_at(40))).commit().graph;
    number(e, back, plug, 12);
    CHECK(counts->advances == steps + 2);
}

TEST_CASE("frames that are sent in any order give the same curve, and each holds until the next") {
    const auto g = graph(registry(), R"("n": {"type": "number", "inputs": {"value": 9}})");
    const auto read = [](const std::shared_ptr<const Graph>& sent) {
        Evaluator e({}, 1);
        std::vector<double> out;
        for (const double f : {0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0})
            out.push_back(number(e, sent, {"n", "out"}, f));
        return out;
    };
    const auto send = [](std::shared_ptr<const Graph> sent, double frame, double value) {
        return Edit(sent).set_input({"n", "value"}, frame, Value::of<double>(value)).commit().graph;
    };
    std::vector<double> frames{1, 3, 5, 6};
    do {
        auto sent = g;
        for (const double f : frames) sent = send(sent, f, 10 * f);
        CHECK(read(sent) == std::vector<double>{9, 10, 10, 20, 30, 30, 40, 50, 60, 60, 60});
        // Again and anew: until the next one that was sent.
        CHECK(write_graph(*send(sent, 3, 30)) == write_graph(*sent));
        CHECK(read(send(sent, 3, 100)) == std::vector<double>{9, 10, 10, 55, 100, 100, 75, 50, 60, 60, 60});
        // Next to another one, and where only something was kept.
        CHECK(read(send(sent, 4, 40)) == std::vector<double>{9, 10, 10, 20, 30, 40, 45, 50, 60, 60, 60});
        CHECK(read(send(sent, 2, 20)) == std::vector<double>{9, 10, 20, 25, 30, 30, 40, 50, 60, 60, 60});
        CHECK(read(send(sent, 0, 1)) == std::vector<double>{1, 10, 10, 20, 30, 30, 40, 50, 60, 60, 60});
    } while (std::next_permutation(frames.begin(), frames.end()));
    // Time is scrubbed.
    auto sent = g;
    for (const double f : {1.0, 10.0, 5.0, 3.0, 4.0, 7.0}) sent = send(sent, f, f);
    CHECK(read(sent) == std::vector<double>{9, 1, 1, 2, 3, 4, 4.5, 5, 5, 7, 7});
    // A key that someone sets there is a key.
    sent = send(g, 5, 50);
    sent = Edit(sent).set_key({"n", "value"}, 4, 7).commit().graph;
    CHECK(number(*std::make_unique<Evaluator>(StorePolicy{}, 1), send(sent, 1, 1), {"n", "out"}, 4) == 7);
}

TEST_CASE("numbers, words, switches and whole numbers can be sent too, and each has an inverse") {
    const auto g = graph(registry(), R"("n": {"type": "number", "inputs": {"value": 3}}, "c": {"type": "clock"},
        "r": {"type": "relay", "inputs": {"in": {"from": "n.out"}}})");
    const auto sent = [&](const char* attribute, Value v) {
        const Edit::Done done = Edit(g).set_input({"n", attribute}, 5, std::move(v)).commit();
        CHECK(write_graph(*done.inverse->commit().graph) == write_graph(*g));
        Evaluator e({}, 1);
        std::vector<double> out;
        for (const double f : {1.0, 4.0, 4.5, 5.0, 9.0}) out.push_back(number(e, done.graph, {"n", "out"}, f));
        return out;
    };
    CHECK(sent("value", Value::of<double>(7)) == std::vector<double>{3, 3, 5, 7, 7});
    CHECK(sent("value", Value::of<std::int64_t>(7)) == std::vector<double>{3, 3, 5, 7, 7});
    CHECK(sent("mode", Value::of<std::string>("double")) == std::vector<double>{3, 3, 3, 6, 6});
    CHECK(sent("negate", Value::of<bool>(true)) == std::vector<double>{3, 3, 3, -3, -3});
    CHECK(sent("times", Value::of<std::int64_t>(4)) == std::vector<double>{3, 3, 3, 12, 12});
    const auto codes = [&](const Edit& e) { return codes_of([&] { e.commit(); }); };
    CHECK(codes(Edit(g).set_input({"n", "value"}, 5, Value::of<bool>(true))) == "DG012");
    CHECK(codes(Edit(g).set_input({"n", "value"}, 5, Value())) == "DG012");
    CHECK(codes(Edit(g).set_input({"n", "value"}, 5, Value::of<double>(-1))) == "DG013");
    CHECK(codes(Edit(g).set_input({"n", "mode"}, 5, Value::of<std::string>("duoble"))) == "DG014");
    CHECK(codes(Edit(g).set_input({"n", "weights"}, 5, Value::of<NumberList>({1}))) == "DG018");
    CHECK(codes(Edit(g).set_input({"r", "in"}, 5, Value::of<double>(1))) == "DG026");
    CHECK(codes(Edit(g).set_input({"n", "valeu"}, 5, Value::of<double>(1))) == "DG011");
    CHECK(codes(Edit(g).set_input({"n", "value"}, std::numeric_limits<double>::infinity(), Value::of<double>(1)))
              .starts_with("DG027"));
    CHECK(codes(Edit(g).set({"n", "value"}, Plug{"c", "out"}).set_input({"n", "value"}, 5, Value::of<double>(1))) ==
          "DG042");
}

TEST_CASE("a text sent for a number is read as in a file: a quantity, a preset, or the form that is right") {
    const auto g = graph(registry(), R"("n": {"type": "number", "inputs": {"value": 3}})");
    const auto sent = [&](const std::string& text) {
        const auto done = Edit(g).set_input({"n", "value"}, 5, Value::of<std::string>(text)).commit().graph;
        Evaluator e({}, 1);
        return std::vector<double>{number(e, done, {"n", "out"}, 4), number(e, done, {"n", "out"}, 5)};
    };
    CHECK(sent("12 kPa") == std::vector<double>{3, 12000});
    CHECK(sent("fat") == std::vector<double>{3, 500});
    const auto hint = [&](const std::string& text) -> std::string {
        try {
            sent(text);
        } catch (const Failure& f) {
            return f.diagnostics().size() == 1 ? f.diagnostics().front().code + " " + f.diagnostics().front().hint : "";
        }
        return "taken";
    };
    CHECK(hint("12 kpa") == "DG015 write \"12 kPa\"");
    CHECK(hint("12") == "DG012 write 12 without quotes");
    CHECK(hint("fatt") == "DG016 did you mean \"fat\"?");
}

TEST_CASE("what is wrong with a matrix that is sent is told once, and where else to send") {
    const auto g = graph(registry(), R"("p": {"type": "place"}, "q": {"type": "place"},
        "n": {"type": "number"}, "r": {"type": "number", "inputs": {"value": {"from": "n.out"}}})");
    const auto problems = [](const Edit& e) -> std::vector<Diagnostic> {
        try {
            e.commit();
        } catch (const Failure& f) {
            return {f.diagnostics().begin(), f.diagnostics().end()};
        }
        return {};
    };
    Matrix4 broken;
    broken.fill(std::nan(""));
    const auto told = problems(Edit(g).set_input({"p", "matrix"}, 5, Value::of<Matrix4>(broken)));
    REQUIRE(told.size() == 1);
    CHECK(told[0].code == "DG027");
    const auto connected = problems(Edit(g).set_input({"r", "value"}, 5, Value::of<double>(1)));
    REQUIRE(connected.size() == 1);
    CHECK(connected[0].hint == "give it a plain value first, or send to an input of \"n\", which it follows");
}

TEST_CASE("an animated curve is not cut where its earlier frames would change") {
    const auto with = [](const char* keys) {
        return graph(registry(), std::string(R"("n": {"type": "number", "inputs": {"value": )") + keys + "}}");
    };
    const auto codes = [](const std::shared_ptr<const Graph>& g, double frame) {
        return codes_of([&] { Edit(g).set_input({"n", "value"}, frame, Value::of<double>(9)).commit(); });
    };
    const auto linear = with(R"({"keys": [[1, 1], [10, 2], [20, 2], [30, 4]], "interp": "linear"})");
    CHECK(codes(linear, 5) == "DG043");
    CHECK(codes(linear, 2) == ""); // frame 1 is a key
    CHECK(codes(linear, 10) == "DG043");
    CHECK(codes(linear, 15) == "");
    CHECK(codes(linear, 31) == "");
    CHECK(codes(linear, -5) == "");
    CHECK(codes(with(R"({"keys": [[1, 1], [10, 2]], "interp": "smooth"})"), 15) == "DG043");
    CHECK(codes(with(R"({"keys": [[1, 1], [10, 2]], "interp": "step"})"), 5) == "");
    Evaluator e({}, 1);
    const auto sent = Edit(linear).set_input({"n", "value"}, 15, Value::of<double>(9)).commit().graph;
    for (int f = 1; f <= 14; ++f) CHECK(number(e, sent, {"n", "out"}, f) == number(e, linear, {"n", "out"}, f));
    CHECK(number(e, sent, {"n", "out"}, 15) == 9);
    CHECK(number(e, sent, {"n", "out"}, 25) == 3); // the later keys stay
}

TEST_CASE("matrices may be keyed in files, linear or stepped, 16 numbers each") {
    const auto types = registry();
    const auto codes = [&](const std::string& matrix) {
        return codes_of([&] { graph(types, R"("p": {"type": "place", "inputs": {"matrix": )" + matrix + "}}"); });
    };
    const std::string a = matrix_text(place_at(1)), b = matrix_text(place_at(2));
    CHECK(codes("{\"keys\": [[1, " + a + "], [2, " + b + "]]}").empty());
    CHECK(codes("{\"keys\": [[1, " + a + "], [2, " + b + "]], \"interp\": \"step\"}").empty());
    CHECK(codes("{\"keys\": [[1, [[1,0,0,2],[0,1,0,0],[0,0,1,0],[0,0,0,1]]]]}").empty());
    CHECK(codes("{\"keys\": [[1, " + a + "], [2, " + b + "]], \"interp\": \"smooth\"}") == "DG017");
    CHECK(codes("{\"keys\": [[1, [1, 2, 3]]]}") == "DG017");
}
