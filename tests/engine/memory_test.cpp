// Budgets of memory: where the default comes from, that they hold at every moment, and that nothing is simulated twice
// however small they are.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/store.h"
#include "engine/memory_limit.h"
#include "tests/support/engine_toys.h"
#include "tests/tools/temporary_folder.h"

#include <bit>
#include <catch2/catch.hpp>
#include <unistd.h>

using namespace toys;
namespace fs = std::filesystem;

namespace {

/// A file system with a control group, made of path and text.
std::size_t limit_with(std::initializer_list<std::pair<std::string, std::string>> files) {
    const sinew::test::TemporaryFolder root;
    for (const auto& [path, text] : files) {
        fs::create_directories((root.path() / path).parent_path());
        sinew::test::write_text(root.path() / path, text);
    }
    return memory_limit(root.path());
}

/// The most that an evaluator held whenever something ended.
struct Gauge : Observer {
    Evaluator* evaluator = nullptr;
    std::size_t most = 0;
    int steps = 0;
    void look() { most = std::max(most, evaluator->stored_bytes()); }
    void computed(const std::string&, double, double) override { look(); }
    void stepped(const std::string&, double, double) override { look(), ++steps; }
    void ends(const std::string&, double) override { look(); }
};

constexpr const char* two_simulations =
    R"("first": {"type": "sim", "inputs": {"stiffness": {"keys": [[1, 1], [90, 5]]}}},
       "second": {"type": "sim", "inputs": {"target": {"from": "first.out"}}},
       "third": {"type": "sim", "inputs": {"target": {"from": "second.out"}}})";

} // namespace

TEST_CASE("memory is what the machine has or what the control groups leave, whichever is less") {
    const auto machine =
        static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
    const std::string v2 = "proc/self/cgroup", group = "sys/fs/cgroup/a/b/memory.max";
    CHECK(limit_with({}) == machine);
    CHECK(limit_with({{v2, "0::/a/b\n"}, {group, "max\n"}}) == machine);
    CHECK(limit_with({{v2, "0::/a/b\n"}, {group, "3000000\n"}}) == 3000000);
    CHECK(limit_with({{v2, "0::/a/b\n"}, {"sys/fs/cgroup/a/memory.max", "2000000\n"}, {group, "3000000\n"}}) ==
          2000000);
    CHECK(limit_with({{v2, "0::/a/b\n"}, {"sys/fs/cgroup/a/b/memory.high", "1500000\n"}, {group, "3000000\n"}}) ==
          1500000);
    CHECK(limit_with({{v2, "0::/\n"}, {"sys/fs/cgroup/memory.max", "4000000\n"}}) == 4000000); // in a container
    CHECK(limit_with({{v2, "0::/../..\n"}, {"sys/fs/cgroup/memory.max", "4000000\n"}}) == 4000000);
    CHECK(limit_with({{v2, "9:cpu,cpuacct:/x\n7:hugetlb,memory:/docker/c\n0::/\n"},
                      {"sys/fs/cgroup/memory/docker/c/memory.limit_in_bytes", "5000000\n"}}) == 5000000);
    CHECK(limit_with({{v2, "7:memory:/docker/not-visible\n"},
                      {"sys/fs/cgroup/memory/memory.limit_in_bytes", "6000000\n"}}) == 6000000);
    CHECK(limit_with({{v2, "7:memory:/\n"}, // no limit, as v1 writes it
                      {"sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"}}) == machine);
}

TEST_CASE("the budgets are a quarter of the memory unless they are set, two thirds of it for states") {
    CHECK(StorePolicy::default_bytes() == memory_limit() / 4);
    const StorePolicy usual, set = StorePolicy::within(3'000'001);
    CHECK(usual.value_bytes + usual.state_bytes == memory_limit() / 4);
    CHECK(set.value_bytes == 1'000'000);
    CHECK(set.state_bytes == 2'000'001);
}

TEST_CASE("a run forwards keeps its budget at every moment, and simulations that feed each other step once a frame") {
    const auto types = registry();
    const auto g = graph(types, two_simulations);
    Evaluator plenty;
    for (const int every : {1, 5}) {
        Gauge gauge;
        StorePolicy policy = StorePolicy::within(6000);
        policy.state_every = every;
        Evaluator tight(policy, 1, &gauge);
        gauge.evaluator = &tight;
        for (int f = 1; f <= 90; ++f) {
            const double a = number(tight, g, {"third", "out"}, f), b = number(plenty, g, {"third", "out"}, f);
            CHECK(std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b));
            number(tight, g, {"first", "out"}, f);
        }
        INFO("every " << every);
        CHECK(gauge.steps == 3 * 90 - 1); // the start counts as one, and two of them start alike
        CHECK(gauge.most <= 6000);
        CHECK(tight.most_stored_bytes() <= 6000);
        CHECK(tight.most_stored_bytes() > 3000);
        CHECK(tight.made_again() == 0);
    }
}

TEST_CASE("without any room the newest state of each simulation stays, and what is computed again is counted") {
    const auto g = graph(registry(), two_simulations);
    Gauge gauge;
    Evaluator none(StorePolicy{.value_bytes = 0, .state_bytes = 0}, 1, &gauge), plenty;
    gauge.evaluator = &none;
    for (int f = 1; f <= 30; ++f) CHECK(number(none, g, {"third", "out"}, f) == number(plenty, g, {"third", "out"}, f));
    CHECK(gauge.steps == 3 * 30 - 1);
    const std::size_t before = none.made_again();
    CHECK(number(none, g, {"third", "out"}, 30) == number(plenty, g, {"third", "out"}, 30));
    CHECK(none.made_again() > before);
    CHECK(gauge.steps == 3 * 30 - 1);
}

TEST_CASE("of states alike in spacing the one that was not used for longest gives way") {
    const Digest root = Hasher().add("root").finish();
    const auto key = [](int offset) { return Hasher().add(offset).finish(); };
    const auto put = [&](StateStore& store, int offset) {
        store.put(key(offset), root, offset, {Value::of(1.0 * offset), {}}, std::nullopt, {});
    };
    StateStore one(1 << 20, 1);
    put(one, 0);
    StateStore store(3 * one.bytes(), 1);
    for (const int offset : {0, 1, 2}) put(store, offset);
    CHECK(store.find(key(0)));
    put(store, 3); // the steps lost are two for each; used last at 4, 2 and 3
    CHECK((store.contains(key(0)) && !store.contains(key(1)) && store.contains(key(2)) && store.contains(key(3))));
    CHECK(store.bytes() == 3 * one.bytes());
    put(store, 4); // now 0 costs three steps of age 3, 2 three of age 4 and 3 two of age 2
    CHECK((store.contains(key(0)) && !store.contains(key(2)) && store.contains(key(3)) && store.contains(key(4))));
}

TEST_CASE("a host that sends values frame by frame has each simulation step once a frame in any budget") {
    auto g = graph(registry(), R"("first": {"type": "sim", "inputs": {"stiffness": 1}},
                                  "second": {"type": "sim", "inputs": {"stiffness": 2}})");
    Gauge gauge;
    Evaluator e(StorePolicy{.value_bytes = 2000, .state_bytes = 300}, 1, &gauge);
    gauge.evaluator = &e;
    for (int f = 1; f <= 40; ++f) {
        g = Edit(g).set_input({"first", "stiffness"}, f, Value::of(1.0 + f)).commit().graph;
        g = Edit(g).set_input({"second", "stiffness"}, f, Value::of(2.0 + f)).commit().graph;
        number(e, g, {"first", "out"}, f);
        number(e, g, {"second", "out"}, f);
    }
    CHECK(gauge.steps == 2 * 40);
}

TEST_CASE("states of simulations of an older graph give way") {
    const auto types = registry();
    auto g = graph(types, R"("sim": {"type": "sim"})");
    Evaluator e(StorePolicy{.value_bytes = 0, .state_bytes = 3000});
    for (int i = 1; i <= 200; ++i) {
        g = Edit(g).set_json({"sim", "startFrame"}, std::to_string(i)).commit().graph; // another chain
        number(e, g, {"sim", "out"}, i + 1);
        CHECK(e.stored_bytes() <= 3000);
    }
}
