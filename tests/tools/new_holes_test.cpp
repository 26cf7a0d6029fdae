// `sinew new` on meshes that are open: holes narrow and wide, sheets, and what encloses nothing.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/program.h"
#include "tools/rig/rig_text.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>

using namespace sinew;
using namespace sinew::test;
namespace fs = std::filesystem;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

using Place = std::function<solver::Vec3(double u, double v)>;
using Which = std::function<bool(int i, int j)>;

/// Quads of a map of the unit square; those in `left_out` are missing, those in `turned` face the other way.
std::string patch(const Place& place, int n, const Which& left_out = {}, const Which& turned = {}) {
    std::ostringstream out;
    out.precision(17);
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
            const solver::Vec3 p = place(static_cast<double>(i % n) / n + (i == n ? 1 : 0), static_cast<double>(j) / n);
            out << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            if (left_out && left_out(i, j)) continue;
            const int a = 1 + j * (n + 1) + i;
            if (turned && turned(i, j))
                out << "f " << a << " " << a + n + 1 << " " << a + n + 2 << " " << a + 1 << "\n";
            else
                out << "f " << a << " " << a + 1 << " " << a + n + 2 << " " << a + n + 1 << "\n";
        }
    return out.str();
}

/// An egg 4 thick and 16 long around (0, 20, 0), as far as `cut` from its ends (in shares of half a turn). It is split
/// along a meridian, whose two sides differ by what cosines differ by.
Place egg(double cut) {
    return [cut](double u, double v) {
        const double t = std::numbers::pi * (cut + (1 - 2 * cut) * v), a = 2 * std::numbers::pi * u;
        return solver::Vec3(2 * std::sin(t) * std::cos(a), 20 + 8 * std::cos(t), 2 * std::sin(t) * std::sin(a));
    };
}

/// Of the egg between its cuts, as smooth as it is meant.
double volume_of_egg(double cut) {
    const double c = std::cos(std::numbers::pi * cut);
    return std::numbers::pi * 4 * 8 * 2 * (c - c * c * c / 3);
}

std::string cube(double y) {
    std::ostringstream out;
    for (const double z : {-2.0, 2.0})
        for (const double h : {y - 2, y + 2}) out << "v -2 " << h << " " << z << "\nv 2 " << h << " " << z << "\n";
    out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    return out.str();
}

/// A muscle between two blocks.
struct OpenRig {
    TemporaryFolder folder;
    std::string bones = folder / "bones", muscle = folder / "m.obj", graph = folder / "rig.json";
    /// \param end how far the muscle goes up and down from its middle
    explicit OpenRig(const std::string& mesh, double end = 8) {
        fs::create_directory(bones);
        write_text(bones + "/a.obj", cube(20 - end - 1.5));
        write_text(bones + "/b.obj", cube(20 + end + 1.5));
        write_text(muscle, mesh);
    }
    rig::Rig guessed() const {
        rig::GuessOptions options;
        options.unit = "cm";
        return rig::guess_rig({bones}, {muscle}, options);
    }
    Said make() const { return run_program({"new", "rig", bones, muscle, "-o", graph, "--unit", "cm", "--force"}); }
};

double volume(const rig::Part& part) { return solver::enclosed_volume(part.points, part.triangles); }

} // namespace

TEST_CASE("new rig: holes are closed however wide they are, and the muscle is as thick as without them",
          "[tools][rig]") {
    const double cut = GENERATE(1 / 16.0, 2 / 16.0, 3 / 16.0, 4 / 16.0);
    CAPTURE(cut);
    const OpenRig rig(patch(egg(cut), 24), 8 * std::cos(std::numbers::pi * cut));
    const rig::Rig made = rig.guessed();
    const rig::Part& part = made.parts.back();
    CHECK(part.is_wrapped);
    CHECK_FALSE(part.is_hollow);
    CHECK(part.lids.count == 2);
    const double across = 4 * std::sin(std::numbers::pi * cut);
    CHECK(part.lids.widest > 0.85 * across);
    CHECK(part.lids.widest < 1.05 * across);
    CHECK(part.wrap < 0.04); // 0.6 cells of 256
    CHECK(volume(part) > 0.97 * volume_of_egg(cut));
    CHECK(volume(part) < 1.05 * volume_of_egg(cut));
    CHECK(made.muscles[0].shape.thickness > 3.6); // was 0.6 to 0.43: a shell
    CHECK(made.muscles[0].shape.thickness < 4.2);
    const Said said = rig.make();
    CHECK(said.code == 0);
    CHECK(has(said.err, "warning [DG163] m: '" + rig.muscle + "' has 2 wide holes, the widest about "));
    CHECK_FALSE(has(said.err, "DG178"));
    // The graph makes the same body of it.
    const Said eval = run_program({"eval", rig.graph, "mMesh.outMesh", "--no-cache", "--json"});
    INFO(eval.out);
    CHECK(eval.lines().back().at("value").at("vertices") == part.points.size());
    CHECK(has(run_program({"check", rig.graph, "--no-cache"}).out, "right"));
}

TEST_CASE("new rig: a hole in the side is closed, also where faces are turned against each other", "[tools][rig]") {
    const bool is_turned = GENERATE(false, true);
    const Which hole = [](int i, int j) { return 8 <= j && j < 14 && 3 <= i && i < 8; };
    const Which turned = [&](int i, int j) { return is_turned && (i * 7 + j * 5) % 3 == 0; };
    const OpenRig rig(patch(egg(0.02), 24, hole, turned));
    const rig::Part part = rig.guessed().parts.back();
    CHECK_FALSE(part.is_hollow);
    CHECK(part.lids.count == 3);
    CHECK(part.lids.widest > 2);
    CHECK(volume(part) > 0.9 * volume_of_egg(0.02));
    CHECK(volume(part) < 1.05 * volume_of_egg(0.02));
}

TEST_CASE("new rig: holes that a narrow wrap closes get no lids and no warning", "[tools][rig]") {
    const OpenRig rig(patch(egg(0.001), 24)); // 0.01 across
    const rig::Rig made = rig.guessed();
    CHECK(made.parts.back().is_wrapped);
    CHECK(made.parts.back().lids.count == 0);
    for (const engine::Diagnostic& d : made.notes) CHECK(d.code != "DG163");
}

TEST_CASE("new rig: what no surface makes a solid of is told to stay hollow, and not to be closed", "[tools][rig]") {
    const Place sheet = [](double u, double v) { return solver::Vec3(4 * u - 2, 12 + 16 * v, 0); };
    const Place bowl = [](double u, double v) {
        return solver::Vec3(2 * std::cos(std::numbers::pi * u), 12 + 16 * v, 2 * std::sin(std::numbers::pi * u));
    };
    const std::string mesh = GENERATE_REF(patch(sheet, 12), patch(bowl, 24),
                                          patch(egg(0.02), 48, [](int i, int j) { return (i / 6 + j / 6) % 2 == 0; }));
    const OpenRig rig(mesh);
    const Said said = rig.make();
    INFO(said.err);
    CHECK(said.code == 0);
    CHECK(has(said.err, "warning [DG178] m: '" + rig.muscle + "' stays hollow: it has "));
    CHECK(has(said.err, "around it encloses a solid; it becomes a shell 0."));
    CHECK(has(said.err, "Close its holes"));
    CHECK_FALSE(has(said.err, "DG163"));
    CHECK(has(read_text(rig.graph), "stays hollow"));
}

TEST_CASE("new rig: a closed muscle that encloses nothing gets a thickness, which is told, and its graph runs",
          "[tools][rig]") {
    const OpenRig rig("v 0 14 -1.25\nv 0 14 1.25\nv 0 26 -1.25\nv 0 26 1.25\n"
                      "f 1 2 4 3\nf 3 4 2 1\n",
                      6);
    const Said said = rig.make();
    INFO(said.err);
    CHECK(said.code == 0);
    CHECK(has(said.out, "m: wrapped at 0.225, because it encloses nothing"));
    CHECK(has(said.err, "warning [DG178] m: '" + rig.muscle + "' stays hollow: it encloses nothing"));
    CHECK(run_program({"check", rig.graph, "--no-cache"}).code == 0); // was FE223
    // A bone may be a plate.
    const OpenRig plate(patch(egg(0.001), 24));
    write_text(plate.bones + "/a.obj",
               "v -2 12 -2\nv 2 12 -2\nv 2 12 2\nv -2 12 2\nf 1 2 3\nf 1 3 4\nf 4 2 1\nf 4 3 2\n");
    for (const engine::Diagnostic& d : plate.guessed().notes) CHECK(d.code != "DG178");
}

TEST_CASE("new layers: a skin that is open stays as it is", "[tools][rig]") {
    const OpenRig rig(patch(egg(0.25), 24), 5.6);
    const std::string skin = rig.folder / "skin.obj";
    const Place around = [](double u, double v) {
        const double a = 2 * std::numbers::pi * u;
        return solver::Vec3(6 * std::cos(a), 5 + 30 * v, 6 * std::sin(a));
    };
    write_text(skin, patch(around, 24));
    const Said said = run_program(
        {"new", "layers", rig.muscle, "--bones", rig.bones, "--skin", skin, "--unit", "cm", "-o", rig.graph});
    INFO(said.out << said.err);
    CHECK(said.code == 0);
    CHECK_FALSE(has(said.out, "skin: wrapped"));
    CHECK_FALSE(has(said.err, "skin.obj"));
    CHECK(has(said.out, "m: wrapped"));
}
