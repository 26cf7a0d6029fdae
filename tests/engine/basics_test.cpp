// Digests, values, curves, units, diagnostics, declarations.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/limits.h"
#include "engine/text.h"
#include "engine/units.h"
#include "tests/support/engine_toys.h"

#include <bit>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

using namespace toys;

TEST_CASE("digests are stable over processes and platforms") {
    Hasher h;
    h.add("sinew").add(std::uint64_t{42}).add(0.5).add(true).add(-7);
    // By xxhsum -H2: of nothing; then of what that gave (two words, the upper one first) and a word, or the count and
    // the hash of a text's or list's bytes; and so on.
    CHECK(h.finish().hex() == "43fa82ba2de829a7ce3fb12c5dde9703");
    CHECK(Hasher().finish().hex() == "99aa06d3014798d86001c324468d497f");
    std::vector<double> eighths(10000);
    std::vector<int> squares(10000);
    for (int i = 0; i < 10000; ++i) {
        eighths[static_cast<std::size_t>(i)] = i / 8.0;
        squares[static_cast<std::size_t>(i)] = i * i - 5;
    }
    CHECK(Hasher().add_doubles(eighths).finish().hex() == "7e73c27512cdb1aa27b1d7788624d631");
    CHECK(Hasher().add_ints(squares).finish().hex() == "e5078a30a55f73d361c4ddca894e025e");
    CHECK(Hasher().add(Digest{1, 2}).finish().hex() == "725449454959ed158dafd081e6c682ab");
    CHECK(Hasher().add(0.0).finish() == Hasher().add(-0.0).finish());
    CHECK(Hasher().add(std::nan("1")).finish() == Hasher().add(-std::nan("2")).finish());
    CHECK(Hasher().add("ab").add("c").finish() != Hasher().add("a").add("bc").finish());
    CHECK(Hasher().add("").finish() != Hasher().finish());
    const double d[] = {1, 2};
    CHECK(Hasher().add_doubles(d).finish() != Hasher().add(1.0).add(2.0).finish());
    const int odd[] = {1, 2, 3}, even[] = {1, 2, 3, 0};
    CHECK(Hasher().add_ints(odd).finish() != Hasher().add_ints(even).finish());
}

TEST_CASE("digests of similar inputs differ in half of their bits") {
    std::set<Digest> seen;
    double flipped = 0;
    int count = 0;
    for (std::uint64_t i = 0; i < 2000; ++i)
        for (int bit = 0; bit < 64; bit += 9) {
            const Digest a = Hasher().add(i).add(i).finish(),
                         b = Hasher().add(i ^ (std::uint64_t{1} << bit)).add(i).finish();
            flipped += std::popcount(a.hi ^ b.hi) + std::popcount(a.lo ^ b.lo);
            ++count;
            seen.insert(a);
        }
    CHECK(seen.size() == 2000);
    CHECK(flipped / count == Approx(64).margin(0.5));
    std::set<std::uint64_t> high, low; // each half alone keeps a million inputs apart
    for (std::uint64_t i = 0; i < 100000; ++i) {
        const Digest d = Hasher().add(static_cast<double>(i)).finish();
        high.insert(d.hi), low.insert(d.lo);
    }
    CHECK(high.size() == 100000);
    CHECK(low.size() == 100000);
}

TEST_CASE("a value knows its type, digest and bytes, and refuses to be read as another type") {
    const Value v = Value::of<double>(2.5);
    CHECK(v.as<double>() == 2.5);
    CHECK(v.digest() == Value::of<double>(2.5).digest());
    CHECK(v.digest() != Value::of<std::string>("2.5").digest());
    CHECK(Value::of<double>(1).digest() != Value::of<std::int64_t>(1).digest());
    CHECK(Value::of<NumberList>(NumberList(1000, 1.0)).bytes() >= 8000);
    CHECK_THROWS_WITH(v.as<std::string>(), "a value that holds number was read as text");
    CHECK_THROWS_AS(Value().as<double>(), std::logic_error);
    CHECK(Value().digest() == Digest{});
    const Digest content = Hasher().add("x").finish();
    CHECK(Value::of<File>({"/a/b.OBJ", content}).digest() == Value::of<File>({"c.obj", content}).digest());
    CHECK(Value::of<File>({"a.ply", content}).digest() != Value::of<File>({"a.obj", content}).digest());
}

TEST_CASE("curves hold their keys, are constant outside and exact on flat spans") {
    for (Interpolation i : {Interpolation::step, Interpolation::linear, Interpolation::smooth}) {
        const Curve c{i, {{1, {0.1}}, {7, {0.1}}, {9, {0.7}}, {12, {0.3}}, {13, {0.3}}}};
        for (const Key& k : c.keys) CHECK(c.at(k.frame) == k.value.list());
        for (double f : {-100.0, 0.0, 1.0, 1.0001, 2.3, 6.9999, 7.0}) CHECK(c.at(f)[0] == 0.1);
        for (double f : {12.0, 12.4, 13.0, 500.0}) CHECK(c.at(f)[0] == 0.3);
    }
}

TEST_CASE("step holds, linear is straight, smooth eases") {
    const auto at = [](Interpolation i, double f) { return Curve{i, {{0, {0}}, {10, {1}}}}.at(f)[0]; };
    CHECK(at(Interpolation::step, 9.999) == 0);
    CHECK(at(Interpolation::linear, 2.5) == 0.25);
    CHECK(at(Interpolation::smooth, 5) == 0.5);
    CHECK(at(Interpolation::smooth, 2.5) == Approx(0.15625).epsilon(1e-15)); // 3t^2 - 2t^3
    const Curve vector{Interpolation::linear, {{0, {0, 1, 2}}, {2, {2, 1, 0}}}};
    CHECK(vector.at(1) == std::vector<double>{1, 1, 1});
    CHECK(Curve{}.at(3).empty());
}

TEST_CASE("smooth curves never leave the range of their neighbours and are continuous") {
    const Curve c{Interpolation::smooth,
                  {{0, {0}}, {1, {0.1}}, {2, {5}}, {8, {5.1}}, {9, {-3}}, {9.5, {-3}}, {20, {100}}}};
    for (std::size_t k = 0; k + 1 < c.keys.size(); ++k) {
        const double a = c.keys[k].value[0], b = c.keys[k + 1].value[0];
        double before = a;
        for (int i = 0; i <= 200; ++i) {
            const double v = c.at(std::lerp(c.keys[k].frame, c.keys[k + 1].frame, i / 200.0))[0];
            CHECK(v >= std::min(a, b));
            CHECK(v <= std::max(a, b));
            CHECK((b >= a ? v >= before - 1e-12 : v <= before + 1e-12)); // monotone between keys
            before = v;
        }
    }
    // One slope on both sides of a key: no corner.
    const double h = 1e-6;
    const double left = (c.at(2)[0] - c.at(2 - h)[0]) / h, right = (c.at(2 + h)[0] - c.at(2)[0]) / h;
    CHECK(left == Approx(right).margin(1e-4));
}

TEST_CASE("smooth curves through unevenly spaced keys are those of Fritsch and Butland") {
    // By hand: the slopes at frame 1 are 1 and 1/3 over spans of 1 and 3, so its tangent is 12 / (7 / 1 + 5 / (1/3)).
    const Curve c{Interpolation::smooth, {{0, {0}}, {1, {1}}, {4, {2}}}};
    CHECK(c.at(0.5)[0] == Approx(19.0 / 44).epsilon(1e-14));
    CHECK(c.at(2)[0] == Approx(1 + 7.0 / 27 + 8.0 / 33).epsilon(1e-14));
    CHECK(c.at(3.25)[0] == Approx(1 + 27.0 / 32 + 27.0 / 352).epsilon(1e-14));
}

TEST_CASE("given tangents are followed and may overshoot") {
    const Curve c{Interpolation::smooth, {{0, {0}, {}, {2}}, {4, {0}, {-2}, {}}}};
    CHECK(c.at(2)[0] == Approx(2).epsilon(1e-14)); // Hermite: h/8 (m0 - m1)
    const double h = 1e-7;
    CHECK(c.at(h)[0] / h == Approx(2).epsilon(1e-5));
    CHECK(c.at(0)[0] == 0);
}

TEST_CASE("units convert between names of one dimension") {
    CHECK(unit_factor("kPa", "Pa") == 1000.0);
    CHECK(unit_factor("MPa", "kPa") == 1000.0);
    CHECK(unit_factor("N/m^2", "Pa") == 1.0);
    // Powers of ten leave no rounding: 0.92 g/cm^3 is 920 kg/m^3 by meaning, too.
    CHECK(*unit_factor("g/cm^3", "kg/m^3") == 1000);
    CHECK(*unit_factor("N/cm^3", "N/m^3") == 1e6);
    CHECK(*unit_factor("in", "mm") == 25.4);
    CHECK(*unit_factor("mL", "m^3") == 1e-6);
    CHECK(*unit_factor("deg", "rad") == Approx(0.017453292519943295).epsilon(1e-16));
    CHECK(unit_factor("Hz", "1/s") == 1.0);
    CHECK(unit_factor("N*s/m^3", "Pa*s/m") == 1.0);
    CHECK(unit_factor("kg/(m*s^2)", "Pa") == 1.0);
    CHECK(unit_factor("%", "1") == 0.01);
    CHECK(unit_factor("ms", "s") == 1e-3);
    CHECK_FALSE(unit_factor("m", "s"));
    CHECK_FALSE(unit_factor("deg", "1"));
    for (const char* wrong : {"", "m^", "m^^2", "(m", "m)", "m/", "/m", "kmm", "m 2", "m**s"})
        CHECK_FALSE(parse_unit(wrong));
}

TEST_CASE("every unit is what the tables say") {
    struct Row {
        const char *unit, *si;
        double factor;
    };
    constexpr double pi = 3.14159265358979323846;
    // The International System of Units (BIPM, 9th edition), tables 2, 4, 7 and 8; inch and foot of 1959.
    const Row rows[] = {{"1", "1", 1},
                        {"%", "1", 0.01},
                        {"m", "m", 1},
                        {"dm", "m", 0.1},
                        {"cm", "m", 0.01},
                        {"mm", "m", 0.001},
                        {"um", "m", 1e-6},
                        {"\u00b5m", "m", 1e-6},
                        {"km", "m", 1000},
                        {"in", "m", 0.0254},
                        {"ft", "m", 0.3048},
                        {"L", "m^3", 1e-3},
                        {"mL", "m^3", 1e-6},
                        {"kg", "kg", 1},
                        {"g", "kg", 1e-3},
                        {"mg", "kg", 1e-6},
                        {"t", "kg", 1000},
                        {"s", "s", 1},
                        {"ms", "s", 1e-3},
                        {"us", "s", 1e-6},
                        {"min", "s", 60},
                        {"Hz", "1/s", 1},
                        {"kHz", "1/s", 1000},
                        {"N", "kg*m/s^2", 1},
                        {"mN", "kg*m/s^2", 1e-3},
                        {"rad", "rad", 1},
                        {"frame", "frame", 1}};
    for (const Row& r : rows) {
        INFO(r.unit);
        CHECK(unit_factor(r.unit, r.si).value_or(0) == Approx(r.factor).epsilon(1e-15));
    }
    const Row derived[] = {{"kN", "kg*m/s^2", 1000},    {"J", "kg*m^2/s^2", 1},
                           {"mJ", "kg*m^2/s^2", 1e-3},  {"kJ", "kg*m^2/s^2", 1000},
                           {"W", "kg*m^2/s^3", 1},      {"Pa", "kg/(m*s^2)", 1},
                           {"hPa", "kg/(m*s^2)", 100},  {"kPa", "kg/(m*s^2)", 1e3},
                           {"MPa", "kg/(m*s^2)", 1e6},  {"GPa", "kg/(m*s^2)", 1e9},
                           {"bar", "kg/(m*s^2)", 1e5},  {"deg", "rad", pi / 180},
                           {"\u00b0", "rad", pi / 180}, {"turn", "rad", 2 * pi},
                           {"frames", "frame", 1},      {"ms^-1", "Hz", 1000},
                           {"cm^-2", "m^-2", 1e4},      {"g*mm^-3", "kg*m^-3", 1e6},
                           {"min^-1", "Hz", 1 / 60.0},  {"in^-2", "m^-2", 1550.003100006200012400024800050}};
    for (const Row& r : derived) {
        INFO(r.unit);
        CHECK(unit_factor(r.unit, r.si).value_or(0) == Approx(r.factor).epsilon(1e-15));
    }
}

TEST_CASE("an open end of limits is outside, a closed one inside") {
    const Limits closed{.min = -1, .max = 0.5}, open{.min = -1, .max = 0.5, .open_min = true, .open_max = true};
    for (const double v : {-1.0, 0.5}) {
        CHECK(inside(closed, v));
        CHECK_FALSE(inside(open, v));
    }
    for (const double v : {std::nextafter(-1.0, 0.0), std::nextafter(0.5, 0.0)}) CHECK(inside(open, v));
    for (const double v : {std::nextafter(-1.0, -2.0), std::nextafter(0.5, 1.0)}) CHECK_FALSE(inside(closed, v));
}

TEST_CASE("the nearest name forgives a third of the letters") {
    const std::vector<std::string> names = {"youngsModulus", "poissonsRatio", "density"};
    CHECK(nearest_name("youngModulus", names) == "youngsModulus");
    CHECK(nearest_name("Density", names) == "density");
    CHECK(nearest_name("dnesity", names) == "density");
    CHECK(nearest_name("colour", names).empty());
    CHECK(nearest_name("", names).empty());
}

TEST_CASE("diagnostics read well and their JSON parses") {
    Diagnostic d;
    d.code = "DG011", d.node = "biceps", d.attribute = "youngModulus";
    d.spot = SourceSpot{"arm.json", "/nodes/biceps/inputs/youngModulus", 7, 25};
    d.message = "no such input on \"zMaterial\"", d.hint = "did you mean \"youngsModulus\"?", d.frame = 12.5;
    CHECK(to_text(d) ==
          "arm.json:7:25: error [DG011] biceps.youngModulus: no such input on \"zMaterial\" (frame 12.5)\n"
          "  hint: did you mean \"youngsModulus\"?\n  at /nodes/biceps/inputs/youngModulus");
    const auto j = nlohmann::json::parse(to_json(d));
    CHECK(j["severity"] == "error");
    CHECK(j["code"] == "DG011");
    CHECK(j["line"] == 7);
    CHECK(j["column"] == 25);
    CHECK(j["frame"] == 12.5);
    CHECK(j["message"] == d.message);
    CHECK(Failure(std::vector<Diagnostic>{d, d}).what() == to_text(d) + "\n" + to_text(d));
    // Names and messages come from graphs of strangers: a terminal shows them and does not obey them.
    d.node = "\x1b[2Jx\n",
    d.attribute = "a\xc2\x9b"
                  "31m",
    d.message = "one\ntwo\x7f\t\xc3\xa9";
    d.spot->file = "\x07.json", d.spot->pointer = "/\r", d.hint = "\x1b]0;", d.frame.reset();
    CHECK(to_text(d) == "\\u0007.json:7:25: error [DG011] \\u001b[2Jx\\u000a.a\\u009b31m: one\ntwo\\u007f\t\xc3\xa9\n"
                        "  hint: \\u001b]0;\n  at /\\u000d");
    CHECK(nlohmann::json::parse(json_quoted("a\x01\"\\\n\xff\xc3\xa9")) == "a\x01\"\\\n\xef\xbf\xbd\xc3\xa9");
}

TEST_CASE("codes are unique, sorted and documented") {
    std::string before;
    for (const CodeInfo& c : all_codes()) {
        CHECK(c.code.size() == 5);
        CHECK_FALSE(c.title.empty());
        CHECK_FALSE(c.remedy.empty());
        const std::string order = (c.code[0] == 'D' ? "0" : c.code[0] == 'F' ? "1" : "2") + std::string(c.code);
        CHECK(before < order);
        before = order;
    }
}

TEST_CASE("declarations that contradict themselves are refused") {
    const Output<double> out{.name = "out", .doc = "Result."};
    const auto refuses = [&](AttributeInfo a, const std::string& why, bool uses_output = true) {
        NodeType t{.name = "t", .doc = "A type.", .inputs = {std::move(a)}, .compute = [](const Reads&, Writes&) {}};
        if (uses_output) t.outputs = {describe(out)};
        Registry r;
        CHECK_THROWS_WITH(r.add(std::move(t)), Catch::Contains(why));
    };
    const Limits unit_interval{.min = 0, .max = 1};
    refuses(describe(Input<double>{.name = "a", .def = 2, .limits = unit_interval, .doc = "x"}),
            "default is outside the limits");
    refuses(describe(Input<double>{.name = "a", .def = 0, .limits = {.min = 0, .open_min = true}, .doc = "x"}),
            "default is outside the limits");
    refuses(describe(Input<double>{.name = "a", .def = 0}), "has no doc");
    refuses(describe(Input<double>{.name = "a.b", .def = 0, .doc = "x"}), "without a dot");
    refuses(describe(Input<double>{.name = "a", .def = 0, .unit = "furlong", .doc = "x"}), "is no unit");
    refuses(
        describe(Input<double>{.name = "a", .def = 0, .limits = unit_interval, .doc = "x", .presets = {{"big", 2}}}),
        "preset \"big\"");
    refuses(describe(Input<std::string>{.name = "a", .def = "x", .doc = "x", .options = {"y"}}),
            "not among the options");
    refuses(describe(Input<double>{.name = "a", .def = 0, .doc = "x", .affects = Affects::initial_state}),
            "initial state");
    refuses(describe(Input<double>{.name = "a", .def = 0, .doc = "x"}), "has no output", false);
    Registry r;
    const NodeType good{
        .name = "t", .doc = "A type.", .outputs = {describe(out)}, .compute = [](const Reads&, Writes&) {}};
    r.add(good);
    CHECK_THROWS_WITH(r.add(good), Catch::Contains("registered twice"));
    NodeType twice = good;
    twice.name = "u";
    twice.inputs = {describe(Input<double>{.name = "a", .def = 0, .doc = "x"}),
                    describe(Wire<double>{.name = "a", .doc = "x"})};
    CHECK_THROWS_WITH(r.add(twice), Catch::Contains("declared twice"));
    twice.inputs.pop_back(), twice.doc = "";
    CHECK_THROWS_WITH(r.add(twice), Catch::Contains("has no doc"));
    CHECK(r.names() == std::vector<std::string>{"t"});
    CHECK(r.find("u") == nullptr);
}
