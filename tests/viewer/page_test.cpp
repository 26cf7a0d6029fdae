// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/viewer/runs.h"
#include "tools/viewer/page.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace sinew;
using namespace sinew::viewer;

namespace {

nlohmann::json header_of(const std::string& html) {
    const std::string mark = "id=\"sinew-scene\">";
    const std::size_t begin = html.find(mark) + mark.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

} // namespace

TEST_CASE("a page is one file that names no address to load from") {
    const Page page = write_page(test::made_scene(200, 3));
    CHECK(page.html.starts_with("<!DOCTYPE html>"));
    CHECK(page.html.find("default-src 'none'") != std::string::npos);
    for (const char* part : {"src=\"http", "src='http", "href=\"http", "@import", "import("})
        CHECK(page.html.find(part) == std::string::npos);
    CHECK(page.asset_bytes > 100000);
    CHECK(page.html.find("three.js authors") != std::string::npos); // the licence note travels along
}

TEST_CASE("names from a scene cannot break out of the page") {
    ViewScene scene = test::made_scene(10, 2);
    scene.title = "</title><script>alert(1)</script>";
    scene.bodies[0].name = "</script><img src=x onerror=alert(1)>";
    scene.notes.push_back({true, "bytes \xff\xfe that are no UTF-8"});
    const Page page = write_page(scene), plain = write_page(test::made_scene(10, 2));
    CHECK(count(page.html, "</script>") == count(plain.html, "</script>"));
    CHECK(page.html.find("<img src=x") == std::string::npos);
    CHECK(header_of(page.html)["bodies"][0]["name"] == scene.bodies[0].name);
}

TEST_CASE("a run that is too long for a page is thinned out in time, and says so") {
    PageOptions options;
    options.most_motion_bytes = 6 * 1000 * 25; // 25 frames of 1000 points
    const Page page = write_page(test::made_scene(1000, 100), options);
    const auto header = header_of(page.html);
    REQUIRE(header["frames"].size() == 25);
    CHECK(header["frames"][1]["frame"] == 5);
    CHECK(page.motion_bytes <= options.most_motion_bytes);
    REQUIRE(page.notes.size() == 1);
    CHECK(page.notes[0].text.find("every 4th is shown") != std::string::npos);
}

TEST_CASE("a million vertices give a page with what fits") {
    PageOptions options;
    options.most_motion_bytes = std::size_t{48} << 20;
    const Page page = write_page(test::made_scene(1000000, 16), options);
    const auto header = header_of(page.html);
    CHECK(header["frames"].size() == 8);
    CHECK(header["bodies"][0]["vertices"] == 1000000);
    CHECK(page.notes.size() == 1);
    CHECK(page.html.size() < 150u << 20);
}

TEST_CASE("a scene without bodies or frames still gives a page with its notes") {
    ViewScene scene;
    scene.title = "nothing";
    scene.notes.push_back({true, "There is nothing here."});
    const auto header = header_of(write_page(scene).html);
    CHECK(header["bodies"].empty());
    CHECK(header["frames"].empty());
    CHECK(header["notes"][0]["text"] == "There is nothing here.");
}

TEST_CASE("numbers that JSON cannot hold become null") {
    ViewScene scene = test::made_scene(10, 1);
    solver::StepRecord record;
    record.residual = std::numeric_limits<double>::quiet_NaN();
    scene.frames[0].step = record;
    CHECK(header_of(write_page(scene).html)["frames"][0]["residual"].is_null());
}
