// `sinew new` on what is easily overlooked: inches, folders within folders, pieces that hang on nothing, paths.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"

#include <catch2/catch.hpp>

#include <array>
#include <sstream>

using namespace sinew;
using namespace sinew::test;
namespace fs = std::filesystem;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A closed box; `first`: number of its first vertex.
std::string block(const std::array<double, 3>& from, const std::array<double, 3>& to, double scale = 1, int first = 1) {
    std::ostringstream out;
    for (const double z : {from[2], to[2]})
        for (const double y : {from[1], to[1]})
            for (const double x : {from[0], to[0]})
                out << "v " << x * scale << " " << y * scale << " " << z * scale << "\n";
    for (const auto& face : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                             std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
        out << "f";
        for (const int v : face) out << " " << v + first;
        out << "\n";
    }
    return out.str();
}

/// A humerus of 32 cm and an ulna of 26 cm with a muscle between them.
struct BlockRig {
    TemporaryFolder folder;
    std::string bones = folder / "bones", muscles = folder / "muscles", graph = folder / "rig.json";
    explicit BlockRig(double scale = 1) {
        fs::create_directory(bones);
        fs::create_directory(muscles);
        write_text(bones + "/humerus.obj", block({-2, -2, -2}, {1, 2, 30}, scale));
        write_text(bones + "/ulna.obj", block({29, -2, -2}, {32, 2, 24}, scale));
        write_text(muscles + "/biceps.obj", block({0.8, -1.2, -1.2}, {29.2, 1.2, 1.2}, scale));
    }
    Said make(std::vector<std::string> more = {}) const {
        std::vector<std::string> words{"new", "rig", bones, muscles, "-o", graph, "--force"};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words);
    }
};

} // namespace

TEST_CASE("new rig: inches are not taken for centimetres in silence", "[tools][rig]") {
    const Said said = BlockRig(1.1 / 2.54).make();
    INFO(said.out << said.err);
    CHECK(said.code == 0);
    CHECK(has(said.out, "unit cm (guessed: humerus is 14 units long, in cm 14 cm)"));
    CHECK(has(said.err, "warning [DG179] humerus: the unit is not sure: it is 14 units long, in cm, as was guessed, "
                        "14 cm, and in inches 35.6 cm, which fits such bones as well or better\n"
                        "  hint: Say it: --unit in, or --unit cm if the guess is right.\n"));
    CHECK_FALSE(has(BlockRig(1.1 / 2.54).make({"--unit", "in"}).err, "DG17"));
    // A plain arm, in its three usual units and of a child of ten, is not doubted.
    for (const double scale : {10.0, 1.0, 0.01, 0.75, 1.2}) {
        const Said plain = BlockRig(scale).make();
        INFO(scale << plain.err);
        CHECK(plain.code == 0);
        CHECK_FALSE(has(plain.err, "DG179"));
    }
    CHECK(has(BlockRig(0.5).make().err, "DG179"));
}

TEST_CASE("new rig: a unit that is never guessed is named where it alone fits", "[tools][rig]") {
    const auto said = [](double scale) { return BlockRig(scale).make().err; };
    CHECK(has(said(1 / 30.48), "error [DG151] humerus: the unit cannot be told: humerus is 1.06 units long, which is "
                               "neither in mm nor in cm nor in m the size of such a bone, but is in feet 32.4 cm\n"
                               "  hint: Say it: --unit ft, if that is meant.\n"));
    CHECK(has(said(0.1), "but is in dm 32.4 cm\n  hint: Say it: --unit dm, if that is meant."));
    CHECK(has(said(1e5), "hint: Say it: --unit mm, cm, dm, m, in or ft."));
}

TEST_CASE("new rig: a piece of a muscle that nothing holds is told, with its place", "[tools][rig]") {
    const BlockRig rig;
    const std::string biceps = rig.muscles + "/biceps.obj";
    const std::string whole = read_text(biceps);
    write_text(biceps, whole + block({10, 12, -1}, {20, 14, 1}, 1, 9));
    const Said said = rig.make();
    INFO(said.err);
    CHECK(said.code == 0);
    CHECK(has(said.err, "warning [DG158] biceps: '" + biceps +
                            "' is 2 pieces, and nothing holds the one that is 10 long, around (15, 13, 0), so it would "
                            "fall\n"));
    CHECK(has(run_program({"check", rig.graph, "--no-cache"}).err,
              "[FE260] solver.bodies: a piece of biceps falls, 10 long, around (15, 13, 0)"));
    // Two of three.
    write_text(biceps, whole + block({10, 12, -1}, {20, 14, 1}, 1, 9) + block({14, -14, -1}, {16, -12, 1}, 1, 17));
    CHECK(has(rig.make().err, "is 3 pieces, and nothing holds 2 of them, so they would fall; the largest is 10 long"));
    // Within a tet of what is held, or at a bone itself.
    write_text(biceps, whole + block({10, 1.3, -1}, {20, 3, 1}, 1, 9));
    CHECK_FALSE(has(rig.make().err, "DG158"));
    write_text(biceps, whole + block({0.8, -1.2, 10}, {29.2, 1.2, 12.4}, 1, 9));
    CHECK_FALSE(has(rig.make().err, "DG158"));
}

TEST_CASE("new rig: paths are relative to the graph, whether its folder is there or not", "[tools][rig]") {
    const BlockRig rig;
    const fs::path before = fs::current_path();
    fs::current_path(fs::path(rig.bones).parent_path());
    const Said said = run_program({"new", "rig", "bones", "muscles", "-o", "deep/er/x.json"});
    const std::string text = said.code == 0 ? read_text("deep/er/x.json") : said.err;
    fs::current_path(before);
    INFO(text);
    CHECK(has(text, R"("file": "../../bones/humerus.obj")"));
    CHECK(has(text, R"("file": "../../muscles/biceps.obj")"));
}

TEST_CASE("new rig: folders within folders are passed over, which is said", "[tools][rig]") {
    const BlockRig rig;
    CHECK_FALSE(has(rig.make().err, "DG180"));
    const std::string old = rig.bones + "/old";
    fs::create_directory(old);
    fs::create_directory(rig.bones + "/.hidden");
    write_text(old + "/scapula.obj", block({-4, -2, 28}, {-2, 2, 32}));
    const Said said = rig.make();
    INFO(said.err);
    CHECK(said.code == 0);
    CHECK(has(said.err, "note [DG180] the folder '" + old + "' is not looked into\n"));
    CHECK_FALSE(has(said.out, "scapula"));
    fs::remove(rig.muscles + "/biceps.obj");
    fs::create_directory(rig.muscles + "/left");
    CHECK(has(rig.make().err, "' has no mesh in it; the folder '" + rig.muscles + "/left' is not looked into\n"));
}

TEST_CASE("new rig: no name is no file to write, which is said before anything is read", "[tools][rig]") {
    const BlockRig rig;
    const Said said = run_program({"new", "rig", rig.bones, rig.muscles, "-o", ""});
    CHECK(said.code == 2);
    CHECK(has(said.err, "say where the graph goes: -o FILE."));
}
