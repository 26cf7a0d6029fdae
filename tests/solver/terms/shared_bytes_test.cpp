// What terms keep from frame to frame: shared by the frames that do not change it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/shared_bytes.h"

#include <catch2/catch.hpp>

using sinew::solver::SharedBytes;

TEST_CASE("copies share bytes until one is rewritten, and the other keeps its own") {
    SharedBytes first(std::vector{std::byte{1}, std::byte{2}});
    CHECK_FALSE(first.shared());
    SharedBytes second = first;
    CHECK(second.shared());
    CHECK(second.data() == first.data());
    CHECK(second == first);
    second.rewrite(1)[0] = std::byte{7};
    CHECK_FALSE(first.shared());
    CHECK(first.size() == 2);
    CHECK(first.data()[1] == std::byte{2});
    CHECK(second == SharedBytes(std::vector{std::byte{7}}));
    CHECK_FALSE(second == first);
    const std::byte* place = second.data();
    second.rewrite(1); // its own: no new memory
    CHECK(second.data() == place);
    second.clear();
    CHECK(second.empty());
    CHECK(second == SharedBytes());
    CHECK(second == SharedBytes(std::vector<std::byte>()));
}
