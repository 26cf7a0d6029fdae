// `sinew new`: what the program would refuse is told before it is written, options before meshes; bones that touch a
// muscle between its vertices; bones within a muscle; reaches that help.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <sstream>

using namespace sinew;
using namespace sinew::test;
namespace fs = std::filesystem;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A closed box.
std::string block(double x0, double y0, double z0, double x1, double y1, double z1) {
    std::ostringstream out;
    for (const double z : {z0, z1})
        for (const double y : {y0, y1})
            for (const double x : {x0, x1}) out << "v " << x << " " << y << " " << z << "\n";
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    return out.str();
}

/// Along y from -6 to 6 at `x`, with a radius of 2. Its caps are one polygon each: no vertex lies in their middle.
std::string prism(int sides, double x = 0) {
    std::ostringstream out;
    for (int ring = 0; ring <= 12; ++ring)
        for (int i = 0; i < sides; ++i)
            out << "v " << x + 2 * std::cos(2 * M_PI * i / sides) << " " << ring - 6 << " "
                << 2 * std::sin(2 * M_PI * i / sides) << "\n";
    for (int ring = 0; ring < 12; ++ring)
        for (int i = 0; i < sides; ++i) {
            const int a = 1 + ring * sides + i, b = 1 + ring * sides + (i + 1) % sides;
            out << "f " << a << " " << a + sides << " " << b + sides << " " << b << "\n";
        }
    out << "f";
    for (int i = 0; i < sides; ++i) out << " " << i + 1;
    out << "\nf";
    for (int i = sides; i > 0; --i) out << " " << 12 * sides + i;
    out << "\n";
    return out.str();
}

/// A muscle that stands on a broad bone, and under another.
struct Column {
    TemporaryFolder folder;
    std::string low = folder / "low.obj", high = folder / "high.obj", muscle = folder / "column.obj",
                graph = folder / "a.json";
    Column() {
        write_text(low, block(-3, -8, -3, 3, -6, 3));
        write_text(high, block(-3, 6, -3, 3, 8, 3));
        write_text(muscle, prism(24));
    }
    Said around(const std::vector<std::string>& bones, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words{"new", "muscle"};
        words.insert(words.end(), bones.begin(), bones.end());
        words.insert(words.end(), {muscle, "-o", graph, "--force"});
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words);
    }
    Said make(const std::vector<std::string>& more) const { return around({low, high}, more); }
};

} // namespace

TEST_CASE("new: no graph is written that could not be opened", "[tools][rig]") {
    const Column column;
    const Said late = column.make({"--unit", "cm", "--end", "1000001"});
    CHECK(late.code == 2);
    CHECK(has(late.err, "--end needs a whole number from 2 to 1000000, not '1000001'"));
    CHECK_FALSE(fs::exists(column.graph));
    REQUIRE(column.make({"--unit", "cm", "--end", "1000000"}).code == 0);
    CHECK(run_program({"check", column.graph, "--no-cache"}).code == 0);
    fs::remove(column.graph);

    const auto refused = [&](const std::vector<std::string>& more, const std::string& what, const std::string& cure) {
        const Said said = column.make(more);
        INFO(said.err);
        CHECK(said.code == 1);
        CHECK(has(said.err, "error [FE210] column: " + what));
        CHECK(has(said.err, cure));
        CHECK_FALSE(fs::exists(column.graph));
    };
    refused({"--unit", "cm", "--set", "*:tetSize=1e-9"}, "the lattice would have 12000000000 cubes along the longest ",
            "hint: Choose a larger one by --set 'column:tetSize=…', or leave that away.");
    refused({"--unit", "cm", "--tet-scale", "1e-5"}, "the lattice would have ",
            "hint: Choose a larger one by --tet-scale, or leave that away.");
    refused({"--unit", "cm", "--set", "*:tetSize=1e9"}, "the tet size of 1e+09 is too large for this mesh",
            "hint: choose a tet size of ");
    REQUIRE(column.make({"--unit", "cm", "--set", "*:tetSize=4"}).code == 0);
    CHECK(run_program({"check", column.graph, "--no-cache"}).code == 0);
    // A limit is named as it is.
    CHECK(has(column.make({"--set", "*:youngsModulus=1e14"}).err, "'1e14' is no number above 0 to 1e+13."));
}

TEST_CASE("new layers: tets that would be refused are told by the scale that asks for them", "[tools][rig]") {
    const Column column;
    const Said said = run_program({"new", "layers", column.muscle, "--bones", column.low, "-o", column.graph, "--unit",
                                   "cm", "--tet-scale", "0.001"});
    INFO(said.err);
    CHECK(said.code == 1);
    CHECK(has(said.err, "error [FE210] column: the lattice would have "));
    CHECK_FALSE(fs::exists(column.graph));
}

TEST_CASE("new: options are told before what is wrong with meshes", "[tools][rig]") {
    const Column column;
    const auto first = [&](const std::vector<std::string>& more, const std::string& what) {
        const Said said = column.around({column.folder / "none.obj"}, more);
        INFO(said.err);
        CHECK(said.code == 2);
        CHECK(has(said.err, what));
        CHECK_FALSE(has(said.err, "IO401"));
    };
    first({"--unit", "parsec"}, "--unit parsec: mm, cm, dm, m, in or ft is meant.");
    first({"--end", "0"}, "--end needs a whole number");
    first({"--set", "*:foo=1"}, "there is no 'foo'");
    CHECK(has(column.around({column.folder / "none.obj"}, {}).err, "IO401"));
}

TEST_CASE("new muscle: a bone within a muscle does not lie away from it, and --unit says that all is in one",
          "[tools][rig]") {
    const Column column;
    const std::string small = column.folder / "small.obj";
    write_text(small, block(0, 0, 0, 1, 1, 1));
    const Said doubted = column.around({small}, {});
    INFO(doubted.err);
    CHECK(doubted.code == 1);
    CHECK(
        has(doubted.err, "error [DG152] column: '" + column.muscle +
                             "' is 7.66 times as large as the other meshes together, among which it would be 10 "
                             "times smaller, too: it seems to be in another unit\n  hint: Save all meshes in one unit "
                             "and one space; or say which one they all are in: --unit.\n"));
    CHECK_FALSE(has(doubted.err, "lies away"));
    const Said said = column.around({small}, {"--unit", "cm", "--set", "*:attachTo=small"});
    INFO(said.err);
    CHECK(said.code == 0);
    CHECK(has(said.err, "warning [DG152] column: "));
    CHECK(has(said.err, "If it is in another unit than --unit says"));
}

TEST_CASE("new muscle: a bone that rests on a face of a muscle, between its vertices, holds it", "[tools][rig]") {
    const Column column;
    write_text(column.high, block(-0.5, 6, -0.5, 0.5, 7, 0.5)); // in the middle of the cap
    const Said said = column.make({"--unit", "cm"});
    INFO(said.out << said.err);
    REQUIRE(said.code == 0);
    CHECK(has(said.out, "high (20) – low (24)"));
    CHECK(has(said.err, " touches high between its vertices, of which the nearest are 1.29 away; those are attached to "
                        "it\n"));
    const Said check = run_program({"check", column.graph, "--no-cache"});
    INFO(check.err);
    CHECK(check.code == 0);
    CHECK(check.beside_work().empty());
    // Above the cap it touches nothing.
    write_text(column.high, block(-0.5, 6.5, -0.5, 0.5, 7.5, 0.5));
    CHECK(has(column.make({"--unit", "cm"}).err, "reaches no bone and no muscle"));
}

TEST_CASE("new rig: of a muscle away from all bones a reach is named that is enough for both ends", "[tools][rig]") {
    const Column column;
    const std::string bones = column.folder / "bones", muscles = column.folder / "muscles";
    for (const std::string& folder : {bones, muscles}) fs::create_directory(folder);
    for (const std::string& bone : {column.low, column.high})
        fs::rename(bone, fs::path(bones) / fs::path(bone).filename());
    fs::rename(column.muscle, muscles + "/column.obj");
    write_text(muscles + "/floater.obj", prism(24, 8));
    const auto make = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"new", "rig", bones, muscles, "-o", column.graph, "--force", "--unit", "cm"};
        words.insert(words.end(), more.begin(), more.end());
        const Said said = run_program(words);
        CHECK(said.code == 0);
        return said.err;
    };
    const std::string told = make({});
    INFO(told);
    const std::string hint =
        "\n  hint: If it shall: --set 'floater:reach=3.7', or --set 'floater:attachTo=high,low'.\n";
    CHECK(has(told, " reaches no bone and no muscle: high, the nearest that could hold it, is 3 away" + hint));
    CHECK(has(told, " reaches no bone and no muscle: low, the nearest other one that could hold it, is 3 away" + hint));
    CHECK_FALSE(has(make({"--set", "floater:reach=3.7"}), "DG155"));
}

TEST_CASE("new muscle: an end with nothing near is told what helps, by what is out of reach", "[tools][rig]") {
    const Column column;
    write_text(column.high, block(-3, 8, -3, 3, 10, 3));
    const std::string near = column.make({"--unit", "cm"}).err;
    INFO(near);
    CHECK(has(near, " reaches no bone and no muscle: high, the nearest other one that could hold it, is 2 away\n"
                    "  hint: If it shall: --set 'column:reach=2.4', or --set 'column:attachTo=high,low'.\n"));
    CHECK_FALSE(has(column.make({"--unit", "cm", "--set", "column:reach=2.4"}).err, "DG155"));
    // Where one end's bone is said, no reach gives the other end one.
    CHECK(has(column.make({"--unit", "cm", "--set", "column:attachTo=low"}).err,
              "\n  hint: If it shall, name a bone for each end: --set 'column:attachTo=high,low'.\n"));
    // Over more than half of the muscle's length, a reach would take in all of it.
    write_text(column.high, block(-3, 14, -3, 3, 16, 3));
    CHECK(has(column.make({"--unit", "cm"}).err,
              " reaches no bone and no muscle: high, the nearest other one that could hold it, is 8 away\n"
              "  hint: Is it in the bones' pose, unit and place? If it shall hold on over such a gap: --set "
              "'column:attachTo=high,low'.\n"));
}

TEST_CASE("new muscle: an end with too few vertices within reach is told the reach that has enough", "[tools][rig]") {
    const Column column;
    write_text(column.high, block(1.95, 6, -0.05, 3, 8, 0.05)); // under one vertex of the cap's rim
    const std::string told = column.make({"--unit", "cm"}).err;
    INFO(told);
    CHECK(has(told, " has only 1 vertex within reach of high\n"
                    "  hint: If it shall hold it, a larger reach: --set 'column:reach=0.57'; if another, --set "
                    "'column:attachTo=BONE,BONE'.\n"));
    const std::vector<std::string> both{"--unit", "cm", "--set", "column:attachTo=high,low"};
    CHECK(has(column.make(both).err, " has only 1 vertex within reach of high\n"
                                     "  hint: What helps is a larger reach: --set 'column:reach=0.57'.\n"));
    std::vector<std::string> larger = both;
    larger.insert(larger.end(), {"--set", "column:reach=0.57"});
    CHECK_FALSE(has(column.make(larger).err, "DG155"));
}
