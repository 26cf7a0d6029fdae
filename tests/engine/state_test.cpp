// State: complete, saved and loaded bit for bit, independent of scratch.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <bit>
#include <catch2/catch.hpp>

using namespace toys;

namespace {
constexpr const char* scene =
    R"("sim": {"type": "sim", "inputs": {"substeps": 3, "stiffness": {"keys": [[1, 1], [40, 9]], "interp": "smooth"}}})";
const Plug plug{"sim", "out"};
} // namespace

TEST_CASE("save, load, advance equals a straight run bit for bit at three frames") {
    const auto g = graph(registry(), scene);
    Evaluator straight;
    const double expected = number(straight, g, plug, 40);
    for (int frame : {1, 13, 39}) {
        Evaluator saver;
        const auto bytes = saver.save_state({g, plug, static_cast<double>(frame), {}});
        auto counts = std::make_shared<Counts>();
        const auto same = graph(registry(counts), scene);
        Evaluator loader;
        loader.load_state({same, plug, static_cast<double>(frame), {}}, bytes);
        const double continued = number(loader, same, plug, 40);
        CHECK(std::bit_cast<std::uint64_t>(continued) == std::bit_cast<std::uint64_t>(expected));
        CHECK(counts->advances == 40 - frame);
        CHECK(counts->initials == 0);
    }
}

TEST_CASE("a saved state that does not fit is refused") {
    const auto g = graph(registry(), scene);
    Evaluator e;
    auto bytes = e.save_state({g, plug, 10, {}});
    const auto load = [&](const std::shared_ptr<const Graph>& into, double frame, std::span<const std::byte> data) {
        return codes_of([&] { e.load_state({into, plug, frame, {}}, data); });
    };
    CHECK(load(g, 10, bytes).empty());
    CHECK(load(g, 11, bytes) == "DG105");
    CHECK(load(Edit(g).set_json({"sim", "height"}, "7").commit().graph, 10, bytes) == "DG105");
    CHECK(load(g, 10, std::span(bytes).first(20)) == "DG105");
    bytes.back() ^= std::byte{1};
    CHECK(load(g, 10, bytes) == "DG105");
    const auto numbers = graph(registry(), R"("n": {"type": "number"})");
    CHECK(codes_of([&] { e.save_state({numbers, {"n", "out"}, 10, {}}); }) == "DG102");
}

TEST_CASE("dropping scratch each frame changes no bit") {
    const auto g = graph(registry(), scene);
    Evaluator keeps, drops;
    for (int f = 1; f <= 20; ++f) {
        drops.drop_scratch();
        CHECK(number(keeps, g, plug, f) == number(drops, g, plug, f));
    }
}

TEST_CASE("results do not depend on the number of threads") {
    const auto g = graph(registry(), scene);
    Evaluator one({}, 1), two({}, 2);
    CHECK(one.threads() == 1);
    CHECK(two.threads() == 2);
    CHECK(one.save_state({g, plug, 30, {}}) == two.save_state({g, plug, 30, {}}));
}
