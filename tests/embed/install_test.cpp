// The installed package: a host finds it, compiles against its headers, links it and runs, and nothing in it names the
// machine that built it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>

using sinew::test::read_text;
using sinew::test::TemporaryFolder;
using sinew::test::write_text;

namespace {

/// Runs a line of shell and gives what it said; the test fails if it does.
std::string run(const TemporaryFolder& folder, const std::string& command) {
    const std::string log = (folder / "log").string();
    const int code = std::system(("(" + command + ") > '" + log + "' 2>&1").c_str());
    const std::string said = read_text(log);
    INFO(command << "\n" << said);
    REQUIRE(code == 0);
    return said;
}

std::string install(const TemporaryFolder& folder) {
    const std::string prefix = (folder / "prefix").string();
    run(folder,
        std::string("cmake --install '") + SINEW_BUILD_DIR + "' --component development --prefix '" + prefix + "'");
    return prefix;
}

/// A cube of eight vertices between nothing and nothing.
const char* const cube = R"({"format": "sinew 1", "timing": {"fps": 24, "start": 1, "end": 2}, "nodes": {
    "mesh": {"type": "polyCube"}, "flesh": {"type": "zMaterial"},
    "block": {"type": "zTissue", "inputs": {"mesh": {"from": "mesh.outMesh"},
              "materials": [{"from": "flesh.outMaterial"}]}},
    "solver": {"type": "zSolver", "inputs": {"bodies": [{"from": "block.outBody"}]}}}})";

} // namespace

TEST_CASE("a host builds against an installed Sinew and runs", "[embed]") {
    const TemporaryFolder folder;
    const std::string prefix = install(folder), source = SINEW_SOURCE_DIR, build = (folder / "b").string();
    write_text(folder / "cube.json", cube);
    run(folder, "cmake -S '" + source + "/tests/support/installed_host' -B '" + build + "' -DCMAKE_PREFIX_PATH='" +
                    prefix + "' -DHOST_SOURCE='" + source + "/tests/support/host/main.cpp' && cmake --build '" + build +
                    "'");
    CHECK(run(folder, "'" + build + "/host' '" + (folder / "cube.json").string() + "' block") == "8\n");
}

TEST_CASE("the C++ program of the README builds against an installed Sinew and runs", "[embed]") {
    const TemporaryFolder folder;
    const std::string prefix = install(folder), source = SINEW_SOURCE_DIR, build = (folder / "b").string();
    const std::string page = read_text(source + "/README.md"), fence = "```cpp\n";
    const std::size_t begin = page.find(fence);
    REQUIRE(begin != std::string::npos);
    write_text(folder / "host.cpp",
               page.substr(begin + fence.size(), page.find("```", begin + 1) - begin - fence.size()));
    run(folder, "cmake -S '" + source + "/tests/support/installed_host' -B '" + build + "' -DCMAKE_PREFIX_PATH='" +
                    prefix + "' -DHOST_LIBRARY=sinew::embed -DHOST_SOURCE='" + (folder / "host.cpp").string() +
                    "' && cmake --build '" + build + "'");
    CHECK(run(folder, "cd '" + source + "' && '" + build + "/host'") == "274 points\n");
    // How to install it stands beside it.
    CHECK(page.find("cmake --install build/release --prefix DIR") != std::string::npos);
}

TEST_CASE("a host with a node type of its own builds against an installed Sinew and runs", "[embed]") {
    const TemporaryFolder folder;
    const std::string prefix = install(folder), source = SINEW_SOURCE_DIR, build = (folder / "b").string();
    const std::string page = read_text(source + "/docs/embedding.md");
    const std::size_t begin = page.find("// twist.cpp\n");
    REQUIRE(begin != std::string::npos);
    write_text(folder / "host.cpp", page.substr(begin, page.find("```", begin) - begin));
    run(folder, "cmake -S '" + source + "/tests/support/installed_host' -B '" + build + "' -DCMAKE_PREFIX_PATH='" +
                    prefix + "' -DHOST_LIBRARY=sinew::embed -DHOST_SOURCE='" + (folder / "host.cpp").string() +
                    "' && cmake --build '" + build + "'");
    CHECK(run(folder, "'" + build + "/host'") == "-0.500 -0.500 0.500\n-0.707 -0.500 0.000\n");
}

TEST_CASE("a host in C builds against an installed libsinew with pkg-config alone", "[embed]") {
    const TemporaryFolder folder;
    const std::string prefix = install(folder), source = SINEW_SOURCE_DIR;
    const std::string libraries = "$(dirname \"$(find '" + prefix + "' -name libsinew.so)\")";
    CHECK(run(folder, "export PKG_CONFIG_PATH=" + libraries + "/pkgconfig LD_LIBRARY_PATH=" + libraries +
                          " && cc -std=c99 '" + source + "/tests/embed/c_host.c' -o '" + (folder / "host").string() +
                          "' $(pkg-config --cflags --libs sinew) -lm && '" + (folder / "host").string() + "'") ==
          "all well\n");
}

TEST_CASE("the installed package names no path of the machine that built it", "[embed]") {
    const TemporaryFolder folder;
    const std::string prefix = install(folder);
    const std::string found =
        run(folder, "grep -rlE '" + std::string(SINEW_SOURCE_DIR) + "|" + SINEW_BUILD_DIR + "|/usr/lib' '" + prefix +
                        "/lib' --include='*.cmake' --include='*.pc' || true");
    CHECK(found == "");
}

TEST_CASE("a host that asks an installed Sinew for another version is told so", "[embed]") {
    const TemporaryFolder folder;
    const std::string prefix = install(folder);
    const auto fits = [&](const std::string& wanted) {
        write_text(folder / "ask.cmake", "set(CMAKE_SIZEOF_VOID_P 8)\nset(PACKAGE_FIND_VERSION " + wanted +
                                             ")\nstring(REPLACE . \";\" parts " + wanted +
                                             ")\nlist(GET parts 0 PACKAGE_FIND_VERSION_MAJOR)\n"
                                             "list(GET parts 1 PACKAGE_FIND_VERSION_MINOR)\n"
                                             "file(GLOB_RECURSE version " +
                                             prefix +
                                             "/*/sinewConfigVersion.cmake)\ninclude(${version})\n"
                                             "message(\"${PACKAGE_VERSION_COMPATIBLE}\")\n");
        return run(folder, "cmake -P '" + (folder / "ask.cmake").string() + "'");
    };
    CHECK(fits("0.1") == "TRUE\n");
    CHECK(fits("0.2") == "FALSE\n");
    CHECK(fits("1.0") == "FALSE\n");
}
