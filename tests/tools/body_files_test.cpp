// Names of mesh sequences, and what their first lines say of a body.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/body_files.h"
#include "tools/cli/open_graph.h"

#include "solver/mesh/primitives.h"
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>

using namespace sinew;
using namespace sinew::test;

TEST_CASE("files of a sequence carry their frame with its sign, four digits at least", "[tools]") {
    CHECK(cli::file_name("arm/biceps 2") == "arm_biceps_2");
    // Long ones are cut and stay apart.
    CHECK(cli::file_name(std::string(200, 'b')) == std::string(200, 'b'));
    const std::string one = cli::file_name(std::string(300, 'b')), other = cli::file_name(std::string(300, 'b') + 'c');
    CHECK((one.size() == 200 && other.size() == 200 && one != other));
    CHECK(one.substr(182, 2) == "b_");
    CHECK(cli::frame_file_name("biceps", 7, "obj") == "biceps.0007.obj");
    CHECK(cli::frame_file_name("biceps", 0, "ply") == "biceps.0000.ply");
    CHECK(cli::frame_file_name("biceps", 12345, "obj") == "biceps.12345.obj");
    CHECK(cli::frame_file_name("biceps", -7, "obj") == "biceps.-0007.obj");
}

TEST_CASE("a sequence tells the axis that is up, its bodies and its frames", "[tools]") {
    for (const char up : {'y', 'z'}) {
        const TemporaryFolder folder;
        std::filesystem::create_directories(folder / "obj");
        const nodes::Mesh cube = nodes::Mesh::from(solver::make_cube(1, 1, 1, 1, 1, 1));
        cli::SceneAxes axes;
        axes.up = up, axes.units_per_metre = 100;
        for (const int frame : {-2, 3})
            for (const auto& [name, kind] :
                 {std::pair{"flesh", render::BodyKind::tissue}, {"stone", render::BodyKind::bone}}) {
                cli::BodyLabel label;
                label.name = name, label.kind = kind;
                cli::write_body(folder.path(), "obj", label, cube, frame, axes);
            }
        const cli::SequenceFolder found = cli::find_sequences(folder.path());
        CHECK(found.up == up);
        CHECK(found.frames == std::set<int>{-2, 3});
        REQUIRE(found.bodies.size() == 2);
        CHECK((found.bodies[0].label.name == "flesh" && found.bodies[0].label.kind == render::BodyKind::tissue));
        CHECK((found.bodies[1].label.name == "stone" && found.bodies[1].label.kind == render::BodyKind::bone));
        CHECK(found.bodies[0].files.at(-2).filename() == "flesh.-0002.obj");
    }
}
