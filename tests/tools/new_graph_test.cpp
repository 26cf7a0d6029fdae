// `sinew new` on small meshes made here: what it says of bad input, what overrides do, and that each kind of graph
// runs.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/rig/kinds.h"
#include "tools/rig/rig_text.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

using namespace sinew;
using namespace sinew::test;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

struct Place {
    std::array<double, 3> from, to;
};

/// A closed box of `cells` quads along each side.
std::string box(const Place& p, std::array<int, 3> cells, double scale = 1) {
    std::ostringstream out;
    int next = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const int side : {0, 1}) {
            for (int j = 0; j <= cells[v]; ++j)
                for (int i = 0; i <= cells[u]; ++i) {
                    std::array<double, 3> at{};
                    at[axis] = side == 0 ? p.from[axis] : p.to[axis];
                    at[u] = p.from[u] + (p.to[u] - p.from[u]) * i / cells[u];
                    at[v] = p.from[v] + (p.to[v] - p.from[v]) * j / cells[v];
                    out << "v " << at[0] * scale << " " << at[1] * scale << " " << at[2] * scale << "\n";
                }
            const int row = cells[u] + 1;
            for (int j = 0; j < cells[v]; ++j)
                for (int i = 0; i < cells[u]; ++i) {
                    const int a = next + j * row + i;
                    if (side == 1)
                        out << "f " << a << " " << a + 1 << " " << a + row + 1 << " " << a + row << "\n";
                    else
                        out << "f " << a << " " << a + row << " " << a + row + 1 << " " << a + 1 << "\n";
                }
            next += row * (cells[v] + 1);
        }
    }
    return out.str();
}

/// A spindle along x, as a muscle with two thin ends; `open`: one face is missing.
std::string spindle(double from, double to, double radius, double scale = 1, bool open = false, double y = 0) {
    constexpr int along = 24, around = 12;
    std::ostringstream out;
    const auto at = [&](double x, double a, double b) {
        out << "v " << x * scale << " " << (a + y) * scale << " " << b * scale << "\n";
    };
    at(from, 0, 0);
    for (int j = 1; j < along; ++j) {
        const double t = static_cast<double>(j) / along, r = radius * std::sin(std::numbers::pi * t);
        for (int i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * i / around;
            at(from + (to - from) * t, r * std::cos(angle), r * std::sin(angle));
        }
    }
    at(to, 0, 0);
    const auto vertex = [&](int j, int i) { return 2 + (j - 1) * around + i % around; };
    for (int i = 0; i < around; ++i) {
        out << "f 1 " << vertex(1, i + 1) << " " << vertex(1, i) << "\n";
        for (int j = 1; j + 1 < along; ++j)
            if (!open || i != 0 || j != 3)
                out << "f " << vertex(j, i) << " " << vertex(j, i + 1) << " " << vertex(j + 1, i + 1) << " "
                    << vertex(j + 1, i) << "\n";
        out << "f " << vertex(along - 1, i) << " " << vertex(along - 1, i + 1) << " " << 2 + (along - 1) * around
            << "\n";
    }
    return out.str();
}

constexpr Place humerus{{-2, -2, -2}, {1, 2, 30}}, ulna{{29, -2, -2}, {32, 2, 24}};

/// No error, and no warning either.
bool checks_right(const std::string& graph) {
    const Said said = run_program({"check", graph, "--no-cache", "--json"});
    UNSCOPED_INFO(said.out);
    return said.code == 0 && said.lines().size() == 1 && run_program({"fmt", "--check", graph}).code == 0;
}

/// Two bones and a muscle from one to the other, in cm.
struct SmallRig {
    TemporaryFolder folder;
    std::string bones = folder / "bones", muscles = folder / "muscles", graph = folder / "rig.json";
    explicit SmallRig(double scale = 1, bool open = false) {
        fs::create_directory(bones);
        fs::create_directory(muscles);
        write_text(bones + "/humerus.obj", box(humerus, {2, 2, 10}, scale));
        write_text(bones + "/ulna.obj", box(ulna, {2, 2, 10}, scale));
        write_text(muscles + "/biceps.obj", spindle(0.8, 29.2, 2.5, scale, open));
    }
    Said make(std::vector<std::string> more = {}) const {
        std::vector<std::string> words{"new", "rig", bones, muscles, "-o", graph};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words);
    }
    /// No error, no warning, and laid out as `sinew fmt` does it.
    bool is_right() const { return checks_right(graph); }
};

} // namespace

TEST_CASE("new rig: a small rig in mm, cm and m: the unit is told from the bones, and the graph runs", "[tools][rig]") {
    const auto [scale, unit] = GENERATE(table<double, std::string>({{10, "mm"}, {1, "cm"}, {0.01, "m"}}));
    const SmallRig rig(scale);
    const Said said = rig.make();
    INFO(said.out << said.err);
    REQUIRE(said.code == 0);
    CHECK(said.out.starts_with("unit " + unit + " "));
    const std::string text = read_text(rig.graph);
    CHECK(has(text, "\"bicepsToHumerus\""));
    CHECK(has(text, "\"bicepsToUlna\""));
    CHECK(has(text, "// Unit: " + unit));
    CHECK(rig.is_right());
    CHECK(run_program({"run", rig.graph, "--frames", "1-3", "--no-cache"}).code == 0);
}

TEST_CASE("new rig: a mesh with a hole is wrapped, as narrow as closes it, and that is said", "[tools][rig]") {
    const SmallRig rig(1, true);
    const rig::Rig made = rig::guess_rig({rig.bones}, {rig.muscles}, {});
    const rig::Part& biceps = made.parts.back();
    REQUIRE(biceps.name == "biceps");
    CHECK(biceps.is_wrapped);
    CHECK(solver::is_closed(biceps.triangles));
    // The hole is 0.5 wide: a wrap closes it from 0.25 on, with a lid over it a narrow one does. A shell would have no
    // volume to speak of.
    CHECK(biceps.wrap < 0.07);
    CHECK(biceps.lids.count == 1);
    const double length = 28.4, radius = 2.5, modelled = std::numbers::pi / 2 * radius * radius * length;
    const double volume = solver::enclosed_volume(biceps.points, biceps.triangles);
    CHECK(volume > modelled * 0.95);
    CHECK(volume < modelled * 1.1);
    CHECK(std::any_of(made.notes.begin(), made.notes.end(), [](const auto& d) { return d.code == "DG163"; }));
    const std::string text = rig::rig_text(made, {});
    CHECK(has(text, "\"bicepsMesh\": { \"type\": \"zIsoMesh\""));
    CHECK(has(text, "\"bicepsLids\": { \"type\": \"hostMesh\""));
}

TEST_CASE("new rig: a mesh turned inside out is made anew, one that is only split along its edges is not",
          "[tools][rig]") {
    SmallRig rig;
    std::string turned;
    std::istringstream lines(box(ulna, {1, 1, 6}));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string f, a, b, c, d;
        words >> f >> a >> b >> c >> d;
        turned += f == "f" ? "f " + d + " " + c + " " + b + " " + a + "\n" : line + "\n";
    }
    write_text(rig.bones + "/ulna.obj", turned);
    const Said said = rig.make();
    INFO(said.out << said.err);
    CHECK(said.code == 0);
    CHECK(has(said.out, "ulna: wrapped, because its faces look inwards"));
    CHECK_FALSE(has(said.out, "humerus: wrapped"));
    CHECK(rig.is_right());
}

TEST_CASE("new rig: overrides take units", "[tools][rig]") {
    const SmallRig rig;
    const Said said = rig.make(
        {"--set", "biceps:strength=60kPa", "--set", "biceps:massDensity=1.1 g/cm3", "--set", "b*:youngsModulus=2e4"});
    INFO(said.err);
    REQUIRE(said.code == 0);
    const auto nodes = json::parse(read_text(rig.graph), nullptr, true, true).at("nodes");
    CHECK(nodes.at("bicepsFibre").at("inputs").at("strength") == 60000);
    CHECK(nodes.at("bicepsFlesh").at("inputs").at("massDensity") == 1100);
    CHECK(nodes.at("bicepsFlesh").at("inputs").at("youngsModulus") == 20000);
}

TEST_CASE("new rig: muscles in cm on bones in mm, which they lie within, are doubted", "[tools][rig]") {
    const SmallRig rig(10);
    write_text(rig.bones + "/ulna.obj", box({{1.2, -2, -2}, {4.2, 2, 24}}, {2, 2, 10}, 10));
    CHECK_FALSE(has(rig.make().err, "DG152"));
    write_text(rig.muscles + "/biceps.obj", spindle(0.8, 29.2, 2.5));
    const Said said = rig.make({"--force"});
    INFO(said.err);
    CHECK(
        has(said.err,
            "warning [DG152] biceps: the muscles are 8.91 % as large as the bones, among which they would be 10 times "
            "larger, too"));
}

TEST_CASE("new rig: what stands in the way is said, and no file is written", "[tools][rig]") {
    SmallRig rig;
    const auto fails = [&](const char* code, const std::string& words, std::vector<std::string> more = {}) {
        const Said said = rig.make(std::move(more));
        INFO(said.out << said.err);
        CHECK(said.code == 1);
        CHECK(has(said.err, code));
        CHECK(has(said.err, words));
        CHECK_FALSE(fs::exists(rig.graph));
    };
    SECTION("an empty folder") {
        fs::remove(rig.muscles + "/biceps.obj");
        write_text(rig.muscles + "/readme.txt", "no mesh");
        fails("DG150", rig.muscles);
    }
    SECTION("a folder that is not there") {
        fs::remove_all(rig.bones);
        fails("IO401", rig.bones);
        fs::remove_all(rig.muscles); // both at once
        fails("IO401", rig.bones);
        fails("IO401", rig.muscles);
    }
    SECTION("unreadable meshes, all at once") {
        write_text(rig.muscles + "/broken.obj", "v 0 0 nonsense\n");
        write_text(rig.bones + "/empty.obj", "");
        fails("IO403", "broken.obj");
        fails("FE201", "empty.obj");
    }
    SECTION("a muscle that is a bone, too") {
        fs::copy_file(rig.bones + "/ulna.obj", rig.muscles + "/ulna.obj");
        fails("DG153", "ulna.obj");
    }
    SECTION("sizes that no unit explains") {
        for (const double scale : {1e-4, 1e5}) {
            SmallRig odd(scale);
            const Said said = odd.make();
            CHECK(said.code == 1);
            CHECK(has(said.err, "DG151"));
            CHECK(has(said.err, "--unit"));
            CHECK(odd.make({"--unit", "m"}).code == 0);
        }
    }
    SECTION("one mesh in another unit") {
        write_text(rig.muscles + "/triceps.obj", spindle(0.8, 29.2, 2, 10));
        fails("DG152", "triceps.obj");
    }
    SECTION("a file that a graph cannot name") {
        fs::rename(rig.bones + "/ulna.obj", rig.bones + "/ell\xe9.obj");
        fails("DG164", "cannot name 'bones/ell\xEF\xBF\xBD.obj'");
        write_text(rig.graph, "of before");
        CHECK(rig.make({"--force"}).code == 1);
        CHECK(read_text(rig.graph) == "of before");
        fs::remove(rig.graph);
    }
    SECTION("muscles of the other side") {
        write_text(rig.bones + "/humerus.obj", box({{98, -2, -2}, {101, 2, 30}}, {2, 2, 10}));
        write_text(rig.bones + "/ulna.obj", box({{129, -2, -2}, {132, 2, 24}}, {2, 2, 10}));
        write_text(rig.muscles + "/biceps.obj", spindle(-129.2, -100.8, 2.5));
        fails("DG157", "mirrored along x");
    }
    SECTION("no muscle reaches a bone") {
        write_text(rig.muscles + "/biceps.obj", spindle(8, 20, 1, 1, false, 9));
        fails("DG158", "no muscle reaches any bone");
    }
    SECTION("a motion of other bones") {
        const std::string motion = rig.folder / "motion.json";
        write_text(motion, R"({"frames": [{"frame": 1, "bones": {"femur": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}]})");
        fails("DG159", "femur", {"--motion", motion});
        write_text(motion, "[1, 2]");
        fails("IO403", "motion.json", {"--motion", motion});
    }
    SECTION("overrides that mean nothing") {
        for (const char* word : {"biceps:tetSize=0", "biceps:tetSize=x", "biceps:colour=red", "biceps",
                                 "triceps:tetSize=1", "biceps:law=Hooke", "biceps:strength=60kg", "biceps:tetSize=1cm",
                                 "biceps:attachTo=femur", "biceps:attachTo=a,b,c"}) {
            const Said said = rig.make({"--set", word});
            INFO(word << ": " << said.err);
            CHECK(said.code == 2);
            CHECK_FALSE(fs::exists(rig.graph));
        }
    }
}

TEST_CASE("new rig: a file that is there is kept unless told otherwise", "[tools][rig]") {
    const SmallRig rig;
    write_text(rig.graph, "mine");
    const Said said = rig.make();
    CHECK(said.code == 1);
    CHECK(has(said.err, "DG160"));
    CHECK(read_text(rig.graph) == "mine");
    CHECK(rig.make({"--force"}).code == 0);
    CHECK(has(read_text(rig.graph), "zSolver"));
}

TEST_CASE("new rig: a muscle that is called as an attachment would be gives way, and links to nowhere are no meshes",
          "[tools][rig]") {
    const SmallRig rig;
    for (const auto& entry : fs::directory_iterator(rig.bones))
        write_text(
            rig.muscles + "/biceps_to_" + entry.path().stem().string() + ".obj",
            spindle(0.8, 29.2 - 0.5 * static_cast<double>(entry.path().stem().string().size()), 1.5, 1, false, 1));
    fs::create_symlink("loop.obj", rig.muscles + "/loop.obj");
    const Said said = rig.make();
    INFO(said.out << said.err);
    REQUIRE(said.code == 0);
    CHECK(has(said.err, "DG154"));
    const Said checked = run_program({"check", rig.graph});
    CHECK_FALSE(has(checked.out + checked.err, "DG002"));
}

TEST_CASE("new rig: what is odd is named, in the graph, too, and left out or made two", "[tools][rig]") {
    const SmallRig rig;
    // The same mesh twice; a muscle far from all bones; names that are in use.
    fs::copy_file(rig.muscles + "/biceps.obj", rig.muscles + "/copy_of_biceps.obj");
    write_text(rig.muscles + "/stray.obj", spindle(8, 20, 1, 1, false, 9));
    write_text(rig.muscles + "/ulna.obj", spindle(0.8, 29.2, 1.5, 1, false, 1));
    write_text(rig.muscles + "/solver.ply", "ply");
    CHECK(has(rig.make().err, "solver.ply"));
    fs::remove(rig.muscles + "/solver.ply");
    const Said said = rig.make();
    INFO(said.out << said.err);
    REQUIRE(said.code == 0);
    CHECK(has(said.err, "DG153"));
    CHECK(has(said.err, "DG154"));
    CHECK(has(said.err, "DG155"));
    CHECK(has(said.err, "DG158"));
    const std::string text = read_text(rig.graph);
    CHECK_FALSE(has(text, "\"copyOfBiceps\""));
    CHECK(has(text, "\"ulnaMuscle\""));
    CHECK(has(text, "\"stray\": { \"type\": \"zTissue\", \"inputs\": {\n        \"enable\": false"));
    CHECK_FALSE(has(text, "strayTo"));
    CHECK(has(text, "// Not sure: stray: "));
    // The muscle that lies all along another is tied to it all over: check doubts that, and nothing else.
    const Said checked = run_program({"check", rig.graph, "--json"});
    CHECK(checked.code == 0);
    CHECK(has(checked.out + checked.err, "\"code\":\"FE264\",\"node\":\"ulnaMuscleOverBiceps\""));
    CHECK(has(checked.out + checked.err, "\"warnings\":1}"));
    CHECK(run_program({"run", rig.graph, "--frames", "1-2", "--no-cache"}).code == 0);
}

TEST_CASE("new rig: overrides by pattern arrive in the graph, the last one counts", "[tools][rig]") {
    const SmallRig rig;
    write_text(rig.muscles + "/triceps.obj", spindle(0.8, 29.2, 2, 1, false, 1.5));
    const Said said = rig.make({"--set", "*:tetSize=2.5", "--set", "TRI*:tetSize=3", "--set", "biceps:attachTo=ulna",
                                "--set", "triceps:preset=tendon", "--set", "biceps:youngsModulus=20000", "--set",
                                "bic?ps:strength=7000", "--overlaps", "slide"});
    INFO(said.out << said.err);
    REQUIRE(said.code == 0);
    const std::string text = read_text(rig.graph);
    CHECK(has(text, R"("bicepsMesh.outMesh" }, "tetSize": 2.5 })"));
    CHECK(has(text, R"("tricepsMesh.outMesh" }, "tetSize": 3 })"));
    CHECK(has(text, "\"bicepsToUlna\""));
    CHECK_FALSE(has(text, "\"bicepsToHumerus\""));
    CHECK(has(text, R"("youngsModulus": 20000)"));
    CHECK(has(text, R"("strength": 7000)"));
    CHECK(has(text, R"("appearance": "tendon")"));
    CHECK_FALSE(has(text, "tricepsFibre"));
    CHECK(has(text, R"("attachmentMode": "sliding")"));
    CHECK(rig.is_right());
}

TEST_CASE("patterns and units of new graphs", "[tools][rig]") {
    CHECK(rig::matches("triceps*", "tricepsLong"));
    CHECK(rig::matches("*LONG*", "triceps_long_head"));
    CHECK(rig::matches("?iceps", "biceps"));
    CHECK(rig::matches("*", ""));
    CHECK_FALSE(rig::matches("triceps", "tricepsLong"));
    CHECK_FALSE(rig::matches("*x*y", "xz"));
    CHECK(rig::unit_of("CM")->per_metre == 100);
    CHECK(rig::unit_of("in")->per_metre * 0.0254 == Approx(1));
    CHECK_FALSE(rig::unit_of("furlong"));
    CHECK(rig::camel_case("biceps_long_head") == "bicepsLongHead");
    CHECK(rig::camel_case("L Femur-01") == "lFemur01");
    CHECK(rig::camel_case("12") == "mesh12");
    CHECK(rig::camel_case("Äöü") == "mesh");
}

TEST_CASE("new rig: folders that are swapped, and a unit that cannot be meant, are told", "[tools][rig]") {
    const SmallRig rig(10); // in mm
    const auto new_rig = [&](const std::string& bones, const std::string& muscles, const std::string& unit) {
        return run_program({"new", "rig", bones, muscles, "--unit", unit, "-o", rig.graph, "--force"}).err;
    };
    CHECK_FALSE(has(new_rig(rig.bones, rig.muscles, "mm"), "DG17"));
    const std::string swapped = new_rig(rig.muscles, rig.bones, "mm");
    CHECK(has(swapped, "DG177"));
    CHECK(has(swapped, "biceps.obj' was given as a bone"));
    const std::string in_metres = new_rig(rig.bones, rig.muscles, "m");
    CHECK(has(in_metres, "DG176"));
    CHECK(has(in_metres, "in mm it would be"));
    CHECK_FALSE(has(new_rig(rig.bones, rig.muscles, "cm"), "DG177"));

    using rig::Kind;
    using rig::kind_told_by;
    for (const char* bone : {"humerus", "Ulna_L", "leftFemur01", "R_Scapula", "bones", "ribs", "first_metacarpal"})
        CHECK(kind_told_by(bone) == Kind::bone);
    for (const char* muscle : {"extensor_carpi_ulnaris", "tibialis_anterior", "Biceps", "subscapularis",
                               "fibularisLongus", "muscles", "brachioradialis", "rectus_femoris", "triceps_tendon"})
        CHECK(kind_told_by(muscle) == Kind::muscle);
    for (const char* neither : {"mesh1", "ulnaris", "left", "", "muscle_on_bone"}) CHECK_FALSE(kind_told_by(neither));
}

TEST_CASE("new layers: a tissue that lies along its bone all over is held by its nearer half", "[tools][rig]") {
    const TemporaryFolder folder;
    const std::string bone = folder / "femur.obj", fat = folder / "fat.obj", graph = folder / "layers.json";
    write_text(bone, box({{-2, 0, -2}, {2, 40, 2}}, {2, 10, 2}));
    write_text(fat, box({{2, 12, -2}, {2.4, 24, 2}}, {2, 12, 4})); // thinner than what counts as touching
    const Said said = run_program({"new", "layers", fat, "--bones", bone, "--unit", "cm", "-o", graph});
    INFO(said.out << said.err);
    REQUIRE(said.code == 0);
    CHECK(checks_right(graph)); // no FE264: a tissue all of whose surface is attached
}

TEST_CASE("new muscle: one muscle and its bones", "[tools][rig]") {
    const SmallRig rig;
    const std::string bones = rig.bones;
    const Said said = run_program(
        {"new", "muscle", bones + "/humerus.obj", bones + "/ulna.obj", rig.muscles + "/biceps.obj", "-o", rig.graph});
    INFO(said.err);
    REQUIRE(said.code == 0);
    CHECK(rig.is_right());
    CHECK(run_program({"run", rig.graph, "--frames", "1-4", "--no-cache"}).code == 0);
    CHECK(run_program({"new", "muscle", rig.muscles + "/biceps.obj", "-o", rig.folder / "x.json"}).code == 2);
    CHECK(run_program({"new", "muscle", bones, rig.muscles, "-o", rig.folder / "x.json"}).code == 2);
    CHECK(has(run_program({"new", "muscle", rig.muscles + "/biceps.obj", "-o", rig.folder / "x.json"}).err,
              "`sinew new muscle BONE… MUSCLE -o FILE`"));
}

TEST_CASE("new muscle: both ends at one of two bones are told, with how far the other one is", "[tools][rig]") {
    const SmallRig rig;
    const std::string humerus = rig.bones + "/humerus.obj", ulna = rig.bones + "/ulna.obj",
                      biceps = rig.muscles + "/biceps.obj";
    // Half of the muscle lies in its bone, from tip to tip.
    write_text(humerus, box({{-2, -3, -2}, {32, 0, 2}}, {10, 2, 2}));
    const auto said = [&](std::vector<std::string> words) {
        words.insert(words.end(), {"-o", rig.graph, "--force"});
        words.insert(words.begin(), "new");
        const Said all = run_program(words);
        CHECK(all.code == 0);
        return all.err;
    };
    const auto put_ulna = [&](double at) { write_text(ulna, box({{at, -2, -2}, {at + 3, 2, 24}}, {2, 2, 10})); };
    put_ulna(35);
    const std::string told = said({"muscle", humerus, ulna, biceps});
    INFO(told);
    CHECK(has(told, "warning [DG155] biceps: both ends are attached to humerus, none to ulna: the end near "
                    "(29.2, 0, 0) is 5.8 from it\n  hint: If it shall hold one: --set "
                    "'biceps:attachTo=humerus,ulna'.\n"));
    CHECK(has(read_text(rig.graph), "// Not sure: biceps: both ends are attached to humerus"));
    const std::string said_so = said({"muscle", humerus, ulna, biceps, "--set", "biceps:attachTo=humerus,ulna"});
    CHECK_FALSE(has(said_so, "both ends"));
    CHECK(has(read_text(rig.graph), "\"bicepsToUlna\""));
    CHECK_FALSE(has(said({"muscle", humerus, biceps}), "DG155"));
    // Of more bones, and in a rig, one may be out of reach; what is hardly missed is told there, too.
    CHECK_FALSE(has(said({"rig", rig.bones, rig.muscles}), "DG155"));
    put_ulna(29.2 + 0.5);
    CHECK(has(said({"rig", rig.bones, rig.muscles}), "the end near (29.2, 0, 0) is 0.5 from it"));
    put_ulna(29.2 + 0.8);
    CHECK_FALSE(has(said({"rig", rig.bones, rig.muscles}), "DG155"));
    write_text(rig.folder / "radius.obj", box({{-8, -2, -2}, {-5, 2, 24}}, {2, 2, 10}));
    CHECK_FALSE(has(said({"muscle", humerus, ulna, rig.folder / "radius.obj", biceps}), "DG155"));
}

TEST_CASE("new muscle: meshes in another order than their names tell are doubted", "[tools][rig]") {
    const SmallRig rig;
    const std::string humerus = rig.bones + "/humerus.obj", ulna = rig.bones + "/ulna.obj",
                      biceps = rig.muscles + "/biceps.obj";
    const auto said = [&](std::vector<std::string> meshes) {
        meshes.insert(meshes.begin(), {"new", "muscle", "-o", rig.graph, "--force"});
        return run_program(meshes).err;
    };
    write_text(humerus, box({{-2, -3, -2}, {32, 0, 2}}, {10, 2, 2})); // both its ends reach the biceps alone
    write_text(ulna, box({{35, -2, -2}, {38, 2, 24}}, {2, 2, 10}));
    const std::string told = said({biceps, ulna, humerus});
    INFO(told);
    CHECK(has(told, "warning [DG177] '" + humerus + "' was given as the muscle and '" + biceps +
                        "' as a bone, but their names tell otherwise: the order seems to be mixed up\n"
                        "  hint: Name the bones first and the muscle last: sinew new muscle … " +
                        humerus + " " + biceps + ".\n"));
    CHECK_FALSE(has(told, "both ends"));
    CHECK(has(said({biceps, humerus}), "sinew new muscle " + humerus + " " + biceps + "."));
    CHECK_FALSE(has(said({humerus, ulna, biceps}), "DG177"));
    // A muscle may hold on to another one, and one whose name tells nothing may be anything.
    const std::string triceps = rig.muscles + "/triceps.obj", part = rig.folder / "part.obj";
    write_text(triceps, spindle(0.8, 29.2, 2, 1, false, 1.5));
    CHECK_FALSE(has(said({humerus, triceps, biceps}), "DG177"));
    fs::copy_file(humerus, part);
    CHECK_FALSE(has(said({biceps, ulna, part}), "DG177"));
}

TEST_CASE("new: the help says for which kinds a flag is", "[tools][rig]") {
    const std::string help = run_program({"new", "--help"}).out;
    CHECK(has(help, "--set PATTERN:NAME=VALUE  rig, muscle: of the muscles whose names match"));
    CHECK(has(help, "--overlaps HOW            rig, muscle: tie (default)"));
}

TEST_CASE("new cloth: a cloth falls on a body and stays above it", "[tools][rig]") {
    const TemporaryFolder folder;
    const std::string body = folder / "table.obj", cloth = folder / "cloth.obj", graph = folder / "cloth.json";
    write_text(body, box({{-20, 0, -20}, {20, 10, 20}}, {4, 1, 4}));
    std::ostringstream sheet;
    constexpr int n = 8;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) sheet << "v " << -30 + 60.0 * i / n << " 10.5 " << -30 + 60.0 * j / n << "\n";
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = 1 + j * (n + 1) + i;
            sheet << "f " << a << " " << a + n + 1 << " " << a + n + 2 << " " << a + 1 << "\n";
        }
    write_text(cloth, sheet.str());
    const Said said = run_program({"new", "cloth", body, cloth, "--unit", "cm", "-o", graph});
    INFO(said.err);
    REQUIRE(said.code == 0);
    CHECK(said.beside_work().empty());
    CHECK(checks_right(graph));
    const json box_then = run_program({"eval", graph, "solver.outMeshes", "--frame", "8", "--no-cache", "--json"})
                              .lines()
                              .back()
                              .at("value")
                              .at("cloth")
                              .at("box");
    CHECK(box_then.at("min").at(1) < 10.4); // its corners hang down
    CHECK(box_then.at("max").at(1) > 10.0); // and its middle lies on the table
    CHECK(box_then.at("max").at(1) < 11.5);

    write_text(cloth, sheet.str() + "f 11 12 40\n"); // a third triangle at an edge
    CHECK(has(run_program({"new", "cloth", body, cloth, "-o", graph, "--force"}).err, "DG161"));
    write_text(body, box({{-20, 0, -20}, {20, 30, 20}}, {4, 1, 4}));
    write_text(cloth, sheet.str());
    CHECK(has(run_program({"new", "cloth", body, cloth, "-o", graph, "--force"}).err, "DG162"));
    // Only the last mesh is the cloth.
    const std::string first = folder / "first.obj";
    write_text(first, sheet.str());
    write_text(body, box({{-20, 0, -20}, {20, 10, 20}}, {4, 1, 4}));
    write_text(cloth, sheet.str() + "v 0 10.5 31\nf 73 82 74\n");
    const std::string two = run_program({"new", "cloth", body, first, cloth, "-o", graph, "--force"}).err;
    CHECK(has(two, "If first is a cloth, too: only the last mesh is made one"));
    CHECK(run_program({"new", "cloth", body, cloth, "-o", graph, "--force", "--set", "a:b=1"}).code == 2);
    // A name that the graph has taken already.
    const std::string skin = folder / "skin.obj";
    write_text(skin, sheet.str());
    CHECK(has(run_program({"new", "cloth", body, skin, "-o", graph, "--force"}).err, "is called skinCloth"));
}

TEST_CASE("new layers: tissue, fascia and skin, the outer two made around the first", "[tools][rig]") {
    const SmallRig rig;
    const Said said =
        run_program({"new", "layers", rig.muscles, "--bones", rig.bones, "-o", rig.graph, "--tet-scale", "1.5"});
    INFO(said.out << said.err);
    REQUIRE(said.code == 0);
    CHECK(rig.is_right());
    const std::string report = rig.folder / "report.json";
    CHECK(run_program(
              {"run", rig.graph, "--pull", "skinSolver.outMeshes", "--frames", "1-2", "--no-cache", "--report", report})
              .code == 0);
    std::ifstream in(report);
    const json all = json::parse(in);
    for (const json& frame : all.at("frames")) CHECK(frame.at("converged") == true);
    CHECK(has(run_program({"new", "layers", rig.muscles, "-o", rig.graph, "--force"}).err, "DG156"));
    CHECK(has(run_program({"new", "layers", "--bones", rig.bones, "-o", rig.graph, "--force"}).err, "DG156"));
}

TEST_CASE("new: kinds, files and flags that are none", "[tools][rig]") {
    const SmallRig rig;
    CHECK(run_program({"new", "rigg", rig.bones, rig.muscles, "-o", rig.graph}).code == 2);
    CHECK(has(run_program({"new", "rigg", rig.bones, rig.muscles, "-o", rig.graph}).err, "Did you mean 'rig'?"));
    CHECK(run_program({"new", "rig", rig.bones, rig.muscles}).code == 2);
    CHECK(run_program({"new", "rig", rig.bones, "-o", rig.graph}).code == 2);
    CHECK(run_program({"new", "rig", rig.bones, rig.muscles, "-o", rig.bones}).code == 2);
    CHECK(rig.make({"--unit", "parsec"}).code == 2);
    CHECK(rig.make({"--up", "x"}).code == 2);
    CHECK(rig.make({"--overlaps", "glue"}).code == 2);
    CHECK(rig.make({"--tet-scale", "0"}).code == 2);
    CHECK(rig.make({"--skin", "x.obj"}).code == 2);
    CHECK_FALSE(fs::exists(rig.graph));
}

TEST_CASE("new: no mesh that the graph is made around is written over", "[tools][rig]") {
    const SmallRig rig;
    const std::string bone = rig.bones + "/humerus.obj", muscle = rig.muscles + "/biceps.obj", before = read_text(bone);
    for (const std::vector<std::string>& words : {std::vector<std::string>{"rig", rig.bones, rig.muscles},
                                                  {"muscle", bone, muscle},
                                                  {"cloth", bone, muscle},
                                                  {"layers", rig.muscles, "--bones", rig.bones},
                                                  {"layers", rig.muscles, "--bones", rig.bones, "--skin", bone}})
        for (const bool is_forced : {true, false}) {
            std::vector<std::string> all{"new"};
            all.insert(all.end(), words.begin(), words.end());
            all.insert(all.end(), {"-o", bone});
            if (is_forced) all.emplace_back("--force");
            const Said said = run_program(all);
            INFO(words[0] << " " << said.err);
            CHECK(said.code == 1);
            CHECK(has(said.err, "[IO420]"));
            CHECK(read_text(bone) == before);
        }
}
