// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/viewer/runs.h"
#include "tools/viewer/block.h"
#include "tools/viewer/page_data.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

using namespace sinew;
using namespace sinew::viewer;

namespace {

template <class T>
std::vector<T> noise(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<T> out(count);
    for (T& v : out) v = static_cast<T>(random());
    return out;
}

template <class T>
std::span<const T> all(const std::vector<T>& v) {
    return v;
}

} // namespace

TEST_CASE("what a block holds comes back bit for bit, whatever differences were taken") {
    const auto order = GENERATE(0, 1, 2);
    const auto stride = GENERATE(std::size_t{1}, std::size_t{3}, std::size_t{1000});
    for (const std::size_t count : {0, 1, 2, 7, 999, 5000}) {
        CHECK(unpack_u16(pack(all(noise<std::uint16_t>(count, 1)), order, stride)) == noise<std::uint16_t>(count, 1));
        CHECK(unpack_u32(pack(all(noise<std::uint32_t>(count, 2)), order, stride)) == noise<std::uint32_t>(count, 2));
    }
}

TEST_CASE("single precision numbers come back bit for bit, infinities too") {
    const std::vector<float> values{0.0f, -0.0f, 1.5f, -3e-39f, std::numeric_limits<float>::infinity(), 3.14159274f};
    const std::vector<float> back = unpack_f32(pack(all(values)));
    REQUIRE(back.size() == values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        CHECK(std::bit_cast<std::uint32_t>(back[i]) == std::bit_cast<std::uint32_t>(values[i]));
}

TEST_CASE("a damaged block is refused") {
    Block block = pack(all(noise<std::uint16_t>(100, 3)));
    block.deflated.resize(block.deflated.size() / 2);
    CHECK_THROWS_AS(unpack_u16(block), std::runtime_error);
    Block longer = pack(all(noise<std::uint16_t>(100, 3)));
    longer.length = 101;
    CHECK_THROWS_AS(unpack_u16(longer), std::runtime_error);
}

TEST_CASE("a point on the grid is off by less than 1e-5 of the box's diagonal") {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> anywhere(-70, 130);
    std::vector<std::vector<float>> frames(5, std::vector<float>(3000));
    for (auto& frame : frames)
        for (float& v : frame) v = anywhere(random);
    std::vector<const std::vector<float>*> list;
    for (const auto& frame : frames) list.push_back(&frame);
    const Grid grid = grid_around(list);
    double worst = 0;
    for (const auto& frame : frames)
        for (std::size_t i = 0; i < frame.size(); i += 3) {
            double squared = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double off = static_cast<double>(grid.from_grid(grid.to_grid(frame[i + c], c), c)) -
                                   static_cast<double>(frame[i + c]);
                squared += off * off;
            }
            worst = std::max(worst, std::sqrt(squared));
        }
    CHECK(worst < 1e-5 * 200 * std::sqrt(3.0));
    CHECK(worst > 0);
}

TEST_CASE("the grid copes with flat, empty and broken data") {
    const std::vector<float> flat{1, 2, 3, 5, 2, 3}, broken{NAN, 0, 0, 1, INFINITY, 2}, none;
    const Grid g = grid_around(std::vector<const std::vector<float>*>{&flat});
    CHECK(g.from_grid(g.to_grid(2, 1), 1) == 2);
    CHECK(g.from_grid(g.to_grid(5, 0), 0) == Approx(5).epsilon(1e-6));
    const Grid b = grid_around(std::vector<const std::vector<float>*>{&broken, &none});
    CHECK(b.to_grid(NAN, 0) == 0);
    CHECK(b.to_grid(1e30f, 2) == 65535);
    CHECK(b.to_grid(-1e30f, 2) == 0);
    CHECK(std::isfinite(b.from_grid(65535, 1)));
}

TEST_CASE("base64 follows RFC 4648") {
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");
    CHECK(base64("fo") == "Zm8=");
    CHECK(base64("foo") == "Zm9v");
    CHECK(base64("foobar") == "Zm9vYmFy");
    CHECK(base64(std::string("\xff\xfe\x00", 3)) == "//4A");
}

TEST_CASE("smooth motion packs to less than half of its 16 bits, and long motion is cut into blocks") {
    const ViewScene scene = test::made_scene(3000, 60);
    const PageData data = page_data(scene);
    const auto header = nlohmann::json::parse(data.header);
    const auto& chunks = header["bodies"][0]["motion"]["chunks"];
    std::size_t bytes = 0;
    for (const auto& chunk : chunks) bytes += data.blocks[chunk["block"].get<std::size_t>()].deflated.size();
    CHECK(chunks.size() == 1);
    CHECK(bytes < 3000u * 3 * 60 * 2 / 2);

    const PageData longer = page_data(test::made_scene(100000, 60));
    const auto cut = nlohmann::json::parse(longer.header)["bodies"][0]["motion"]["chunks"];
    REQUIRE(cut.size() == 2);
    CHECK(cut[0]["count"].get<int>() + cut[1]["count"].get<int>() == 60);
    CHECK(cut[1]["first"] == cut[0]["count"]);
}
