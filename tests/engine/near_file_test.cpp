// The file that is meant by a name that is not there, and numbers with few digits.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/near_file.h"
#include "engine/text.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <limits>

using namespace sinew::engine;
namespace fs = std::filesystem;

TEST_CASE("the file that is near is that of the same letters, then a misspelt one, then one of another ending",
          "[engine]") {
    const fs::path folder = fs::temp_directory_path() / "sinew_near_file_test";
    fs::remove_all(folder);
    fs::create_directories(folder / "femur.png"); // a folder is no file
    for (const char* name : {"femur.blend", "femur.mtl", "femur.obj", "tibia.OBJ", "arm_1.json", "arm_2.html"})
        std::ofstream(folder / name) << "x";
    constexpr std::string_view endings[] = {".obj", ".ply"};
    CHECK(near_file(folder / "Femur.OBJ", endings) == "femur.obj");
    CHECK(near_file(folder / "femur.stl", endings) == "femur.obj"); // not the first of that name
    CHECK(near_file(folder / "femur.stl", {}).empty());
    CHECK(near_file(folder / "tibla.obj", endings) == "tibia.OBJ");
    CHECK(near_file(folder / "arm_2.json", {}) == "arm_1.json"); // not the page beside it
    CHECK(near_file(folder / "femur.png", {}).empty());
    CHECK(near_file(folder / "scapula.obj", endings).empty());
    CHECK(near_file(folder / "none" / "femur.obj", endings).empty());
    fs::remove_all(folder);
}

TEST_CASE("numbers in messages have as many digits as are asked for", "[engine]") {
    CHECK(rough_text(1.2345, 2) == "1.2");
    CHECK(rough_text(-0.00012345, 3) == "-0.000123");
    CHECK(rough_text(123456, 2) == "120000");
    CHECK(rough_text(1e6, 2) == "1000000");
    CHECK(rough_text(2.04e5, 2) == "200000");
    CHECK(rough_text(0, 2) == "0");
    CHECK(rough_text(std::numeric_limits<double>::max(), 2) == number_text(std::numeric_limits<double>::max()));
    CHECK(rough_text(std::numeric_limits<double>::infinity(), 2) == "inf");
}
