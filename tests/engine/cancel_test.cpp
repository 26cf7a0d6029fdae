// Cancelling: frames that are done stay, nothing half-done is kept, others that waited go on.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>
#include <latch>
#include <thread>

using namespace toys;

TEST_CASE("a cancel keeps the finished frames") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("sim": {"type": "sim"})");
    std::stop_source stop;
    counts->on_advance = [&](double frame) {
        if (frame == 31) stop.request_stop();
    };
    Evaluator e;
    CHECK_THROWS_AS(e.pull({g, {"sim", "out"}, 100, stop.get_token()}), Cancelled);
    CHECK(counts->advances == 30); // frame 31 was begun and given up
    number(e, g, {"sim", "out"}, 30);
    CHECK(counts->advances == 30);
    counts->on_advance = {};
    const double resumed = number(e, g, {"sim", "out"}, 100);
    CHECK(counts->advances == 100);
    Evaluator fresh;
    CHECK(resumed == number(fresh, g, {"sim", "out"}, 100));
}

TEST_CASE("a pull that is cancelled before it begins computes nothing") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("n": {"type": "number"})");
    std::stop_source stop;
    stop.request_stop();
    Evaluator e;
    CHECK_THROWS_AS(e.pull({g, {"n", "out"}, 1, stop.get_token()}), Cancelled);
    CHECK(counts->computes == 0);
}

TEST_CASE("a cancel between nodes stops the rest of a chain") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts),
                         R"("n": {"type": "number"}, "a": {"type": "relay", "inputs": {"in": {"from": "n.out"}}},
        "b": {"type": "relay", "inputs": {"in": {"from": "a.out"}}})");
    std::stop_source stop;
    counts->on_compute = [&] { stop.request_stop(); };
    Evaluator e;
    CHECK_THROWS_AS(e.pull({g, {"b", "out"}, 1, stop.get_token()}), Cancelled);
    CHECK(counts->computes == 1);
    CHECK(number(e, g, {"b", "out"}, 1) == 3);
    CHECK(counts->computes == 3);
}

TEST_CASE("a pull that waits for a cancelled one takes the work over") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("sim": {"type": "sim"})");
    std::stop_source stop;
    std::latch stepping(1), waiting(1);
    std::atomic<bool> first = true;
    counts->on_advance = [&](double frame) {
        if (frame != 5 || !first.exchange(false)) return;
        stepping.count_down();
        waiting.wait();
        stop.request_stop();
    };
    Evaluator e({}, 2);
    std::thread cancelled([&] { CHECK_THROWS_AS(e.pull({g, {"sim", "out"}, 20, stop.get_token()}), Cancelled); });
    stepping.wait();
    double value = 0;
    std::thread other([&] {
        waiting.count_down();
        value = number(e, g, {"sim", "out"}, 20);
    });
    cancelled.join();
    other.join();
    Evaluator fresh;
    CHECK(counts->advances == 20); // frame 5 was begun twice
    CHECK(value == number(fresh, g, {"sim", "out"}, 20));
}

TEST_CASE("a pull that waits can itself be cancelled") {
    auto counts = std::make_shared<Counts>();
    const auto g = graph(registry(counts), R"("sim": {"type": "sim"})");
    std::stop_source stop;
    std::latch stepping(1), cancelled(1);
    counts->on_advance = [&](double frame) {
        if (frame != 3) return;
        stepping.count_down();
        cancelled.wait();
    };
    Evaluator e({}, 2);
    std::thread worker([&] { CHECK(number(e, g, {"sim", "out"}, 3) != 0); });
    stepping.wait();
    std::thread waiter([&] {
        CHECK_THROWS_AS(e.pull({g, {"sim", "out"}, 3, stop.get_token()}), Cancelled);
        cancelled.count_down();
    });
    stop.request_stop();
    waiter.join();
    worker.join();
    CHECK(counts->advances == 2);
}
