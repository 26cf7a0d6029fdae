// What CMake makes of the tree: alone, in an empty folder; and as a part of another build, where its targets keep to
// their own names and nothing of how it is compiled reaches the host.
// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace fs = std::filesystem;

TEST_CASE("a host configures with Sinew inside and compiles by its own flags", "[house]") {
    std::string folder = (fs::temp_directory_path() / "sinew-host-XXXXXX").string();
    REQUIRE(mkdtemp(folder.data()));
    const std::string source = SINEW_SOURCE_DIR, log = folder + "/log";
    const std::string command = "cmake -S '" + source + "/tests/support/host' -B '" + folder +
                                "/b' -DSINEW_SOURCE_DIR='" + source + "' > '" + log + "' 2>&1";
    const int code = std::system(command.c_str());
    std::ifstream said(log);
    INFO(std::string(std::istreambuf_iterator<char>(said), {}));
    REQUIRE(code == 0);
    std::ifstream in(folder + "/b/compile_commands.json");
    const auto commands = nlohmann::json::parse(in);
    int own = 0, hosts = 0;
    for (const auto& entry : commands) {
        const auto line = entry.at("command").get<std::string>();
        const bool is_host = entry.at("file").get<std::string>().ends_with("host/main.cpp");
        INFO(line);
        (is_host ? hosts : own)++;
        for (const char* flag : {" -march=", " -Wall", " -ffp-contract", " -fno-math-errno", " -O3", " -DNDEBUG"})
            if (is_host) CHECK(line.find(flag) == std::string::npos);
        // The host has no build type, and a simulator without optimisation is of no use to it.
        for (const char* flag : {" -ffp-contract=off", " -O3"})
            if (!is_host) CHECK(line.find(flag) != std::string::npos);
    }
    CHECK(hosts == 1);
    CHECK(own > 200);
    fs::remove_all(folder);
}

TEST_CASE("presets configure in an empty folder", "[house]") {
    for (const std::string preset : {"release", "debug", "asan"}) {
        std::string folder = (fs::temp_directory_path() / "sinew-preset-XXXXXX").string();
        REQUIRE(mkdtemp(folder.data()));
        const std::string log = folder + "/log", command = "cd '" + std::string(SINEW_SOURCE_DIR) +
                                                           "' && cmake --preset " + preset + " -B '" + folder +
                                                           "/b' > '" + log + "' 2>&1";
        const int code = std::system(command.c_str());
        std::ifstream said(log);
        INFO(std::string(std::istreambuf_iterator<char>(said), {}));
        CHECK(code == 0);
        CHECK(fs::exists(folder + "/b/build.ninja"));
        fs::remove_all(folder);
    }
}
