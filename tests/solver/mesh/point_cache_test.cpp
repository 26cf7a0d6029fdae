// Point caches, byte by byte as their formats say, and spoiled.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/point_cache.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>

using namespace sinew::solver;

namespace {

template <class T>
void put(std::string& out, T v, bool swapped) {
    std::string raw(sizeof v, ' ');
    std::memcpy(raw.data(), &v, sizeof v);
    if (swapped) std::reverse(raw.begin(), raw.end());
    out += raw;
}

/// Two points, three samples: point p of sample s at (s, p, 0.5).
void put_samples(std::string& out, bool swapped) {
    for (int s = 0; s < 3; ++s)
        for (int p = 0; p < 2; ++p)
            for (const float c : {static_cast<float>(s), static_cast<float>(p), 0.5f}) put(out, c, swapped);
}

std::string pc2() {
    std::string out("POINTCACHE2\0", 12);
    put(out, std::int32_t{1}, false), put(out, std::int32_t{2}, false);
    put(out, 5.0f, false), put(out, 0.5f, false), put(out, std::int32_t{3}, false);
    put_samples(out, false);
    return out;
}

std::string mdd() {
    std::string out;
    put(out, std::int32_t{3}, true), put(out, std::int32_t{2}, true);
    for (const float t : {0.0f, 0.04f, 0.08f}) put(out, t, true);
    put_samples(out, true);
    return out;
}

std::string code(const std::string& bytes, const std::string& path, std::string* text = nullptr) {
    try {
        PointCache::parse(bytes, path);
    } catch (const Error& e) {
        if (text) *text = e.what();
        return e.code;
    }
    return "";
}

} // namespace

TEST_CASE("PC2 and MDD give the same points, each at its frames", "[mesh]") {
    const PointCache a = PointCache::parse(pc2(), "a.pc2"), b = PointCache::parse(mdd(), "b.MDD");
    for (const PointCache* c : {&a, &b}) {
        CHECK(c->points == 2);
        CHECK(c->samples == 3);
        CHECK(c->at(2) == Points{{2, 0, 0.5}, {2, 1, 0.5}});
    }
    CHECK(a.frame_of(0, 24) == 5);
    CHECK(a.frame_of(2, 24) == 6);
    CHECK(b.frame_of(0, 25) == 1);
    CHECK(b.frame_of(2, 25) == Approx(3).epsilon(1e-6));
}

TEST_CASE("point caches that are cut, too long or of another kind are refused with the reason", "[mesh]") {
    std::string text;
    for (const auto& [bytes, path] : {std::pair(pc2(), "a.pc2"), {mdd(), "a.mdd"}}) {
        for (std::size_t length = 0; length < bytes.size(); ++length)
            CHECK(code(bytes.substr(0, length), path) == "IO403");
        CHECK(code(bytes.substr(0, bytes.size() - 4), path, &text) == "IO403");
        CHECK(text.find("3 samples of 2 points take " + std::to_string(bytes.size()) + " bytes") != std::string::npos);
        CHECK(code(bytes + "x", path) == "IO403");
    }
    CHECK(code(mdd(), "a.pc2") == "IO403");
    CHECK(code(pc2(), "a.obj") == "IO404");
    std::string none = pc2();
    std::memset(none.data() + 16, 0, 4); // no points
    CHECK(code(none, "a.pc2", &text) == "IO403");
    CHECK(text.find("byte 16") != std::string::npos);
    // 12 x 1076074802 x 1428551872 is 2^64 + 512: in 64 bits the file looks whole.
    std::string many = pc2();
    const std::int32_t points = 1076074802, samples = 1428551872;
    std::memcpy(many.data() + 16, &points, 4), std::memcpy(many.data() + 28, &samples, 4);
    many.resize(32 + 512);
    CHECK(code(many, "a.pc2", &text) == "IO403");
    CHECK(text.find("take far more bytes, and it has 544") != std::string::npos);
    std::string back = mdd();
    std::swap_ranges(back.begin() + 8, back.begin() + 12, back.begin() + 12); // times fall
    CHECK(code(back, "a.mdd") == "IO403");
    std::string nan = pc2();
    std::memset(nan.data() + 32, 0xff, 4);
    const PointCache c = PointCache::parse(nan, "a.pc2");
    CHECK_THROWS_WITH(c.at(0), Catch::Contains("vertex 0 of sample 1"));
    CHECK(c.at(1).size() == 2);
}
