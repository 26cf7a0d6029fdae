// JSON data files: what is said of a pointer that leads nowhere.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/json_file.h"
#include "solver/error.h"

#include <catch2/catch.hpp>

using namespace sinew;
using nlohmann::json;

TEST_CASE("a pointer to nothing is answered with the one that is meant, or with where pointers may begin", "[nodes]") {
    const json file = json::parse(R"({"vertices": [1, 2], "biceps": {"weights": [3]}})");
    CHECK(nodes::part_of(file, "/biceps/weights", "paint.json") == json{3});
    CHECK(nodes::part_of(file, "", "paint.json") == file);
    const auto hint = [](const json& in, const std::string& pointer) {
        try {
            nodes::part_of(in, pointer, "paint.json");
        } catch (const solver::Error& e) {
            CHECK(e.code == "IO403");
            CHECK(std::string(e.what()) == "'paint.json' has nothing at \"" + pointer + "\"");
            return e.hint;
        }
        return std::string("found");
    };
    const std::string meant = "Write a JSON pointer into the file, for example /attachments/0/vertices.";
    CHECK(hint(file, "vertices") == "Write \"/vertices\".");
    CHECK(hint(file, "/weights") == meant + " It begins with /biceps, /vertices.");
    CHECK(hint(json::array({1, 2}), "/weights") == meant);
    json many;
    for (const char* name : {"a", "b", "c", "d", "e", "f"}) many[name] = 1;
    CHECK(hint(many, "/x") == meant + " It begins with /a, /b, /c, /d, /e, ….");
}
