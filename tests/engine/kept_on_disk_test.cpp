// Outputs on disk: what a later process finds, what it is told, and which declarations are refused.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/frame_store.h"
#include "engine/registry.h"
#include "tests/support/engine_toys.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace toys;
namespace fs = std::filesystem;

namespace {

struct Folder {
    fs::path path = fs::temp_directory_path() / ("sinew-kept-" + std::to_string(getpid()));
    Folder() { fs::remove_all(path); }
    ~Folder() { fs::remove_all(path); }
};

const Input<bool> keep{.name = "keep", .def = false, .doc = "On disk.", .keyable = false, .affects = Affects::nothing};
const Input<double> value{.name = "value", .def = 1, .doc = "A number."};
const Output<double> out{.name = "out", .doc = "The number."};

void write(const double& v, ByteWriter& w) { w.put(v); }
double read(ByteReader& r) { return r.get<double>(); }
double read_wrongly(ByteReader& r) { return r.get<double>() + 1; }

NodeType keeper(int* computes) {
    return {.name = "keeper",
            .doc = "Passes on, and warns.",
            .inputs = {describe(keep), describe(value)},
            .outputs = {describe(out)},
            .kept_when = keep.name,
            .compute = [computes](const Reads& in, Writes& w) {
                ++*computes;
                in.warn(value.name, "FE208", "look at this", "or not");
                w.set(out, in[value]);
            }};
}

struct Visit {
    int computes = 0;
    double result = 0;
    Watcher watcher;
    Visit(const fs::path& folder, const std::string& name, double given,
          Codec codec = make_codec<double>(1, write, read), bool kept = true) {
        auto r = std::make_shared<Registry>();
        r->add(std::move(codec));
        r->add(keeper(&computes));
        const auto g = graph(r, "\"" + name + R"(": {"type": "keeper", "inputs": {"keep": )" +
                                    (kept ? "true" : "false") + R"(, "value": )" + std::to_string(given) + "}}");
        StorePolicy policy;
        policy.disk_folder = folder.string();
        Evaluator e(policy, 1, &watcher);
        result = number(e, g, {name, "out"}, 1);
    }
    std::string codes() const {
        std::string all;
        for (const Diagnostic& d : watcher.warnings) all += (all.empty() ? "" : " ") + d.code + "@" + d.node;
        return all;
    }
};

} // namespace

TEST_CASE("what was kept is found under its key alone, with its warnings, under today's name") {
    const Folder folder;
    const Visit first(folder.path, "a", 2.5);
    CHECK((first.computes == 1 && first.codes() == "FE208@a"));
    const Visit second(folder.path, "b", 2.5);
    CHECK((second.computes == 0 && second.result == 2.5));
    CHECK(second.codes() == "FE208@b");
    CHECK(second.watcher.warnings[0].hint == "or not");
    CHECK(second.watcher.reused_count == 1);
    CHECK(Visit(folder.path, "a", 3).computes == 1);
    CHECK(Visit(folder.path, "a", 2.5, make_codec<double>(1, write, read), false).computes ==
          1); // off looks at nothing
}

TEST_CASE("values of another codec version, or that come back different, are made anew") {
    const Folder folder;
    CHECK(Visit(folder.path, "a", 2.5).computes == 1);
    const Visit newer(folder.path, "a", 2.5, make_codec<double>(2, write, read));
    CHECK((newer.computes == 1 && newer.codes() == "IO406@a FE208@a"));
    const Visit wrong(folder.path, "a", 2.5, make_codec<double>(2, write, read_wrongly));
    CHECK((wrong.computes == 1 && wrong.result == 2.5 && wrong.codes() == "IO406@a FE208@a"));
}

TEST_CASE("what was kept with a damaged byte is made anew, wherever the byte is") {
    const Folder folder;
    CHECK(Visit(folder.path, "a", 2.5).computes == 1);
    const fs::path file = fs::directory_iterator(folder.path)->path();
    std::string good;
    {
        std::ifstream in(file, std::ios::binary);
        good.assign(std::istreambuf_iterator<char>(in), {});
    }
    // The last byte belongs to the text of a warning, of which no digest is kept.
    for (const std::size_t at : {std::size_t{0}, good.size() / 2, good.size() - 1}) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ 1);
        std::ofstream(file, std::ios::binary) << bad;
        const Visit visit(folder.path, "a", 2.5);
        INFO("byte " << at);
        CHECK((visit.computes == 1 && visit.codes() == "IO406@a FE208@a"));
        CHECK(visit.watcher.warnings[1].hint == "or not");
    }
}

TEST_CASE("declarations of kept outputs that cannot work are refused") {
    int computes = 0;
    const auto refused = [&](NodeType type, bool with_codec, const std::string& why) {
        Registry r;
        if (with_codec) r.add(make_codec<double>(1, write, read));
        CHECK_THROWS_WITH(r.add(std::move(type)), Catch::Contains(why));
    };
    refused(keeper(&computes), false, "no codec");
    NodeType nameless = keeper(&computes);
    nameless.kept_when = "nothing";
    refused(nameless, true, "Input<bool>");
    NodeType in_key = keeper(&computes);
    in_key.inputs[0].affects = Affects::result;
    refused(in_key, true, "affects nothing");
    Registry r;
    r.add(make_codec<double>(1, write, read));
    CHECK_THROWS_WITH(r.add(make_codec<double>(1, write, read)), Catch::Contains("second codec"));
}

TEST_CASE("the switch that keeps outputs takes a plain value alone") {
    int computes = 0;
    auto r = std::make_shared<Registry>();
    r->add(make_codec<double>(1, write, read));
    r->add(keeper(&computes));
    static const Output<bool> yes{.name = "yes", .doc = "True."};
    r->add({.name = "truth", .doc = "True.", .outputs = {describe(yes)}, .compute = [](const Reads&, Writes& w) {
                w.set(yes, true);
            }});
    CHECK(codes_of([&] {
              graph(r, R"("t": {"type": "truth"}, "k": {"type": "keeper", "inputs": {"keep": {"from": "t.yes"}}})");
          }) == "DG029");
}

TEST_CASE("a frame on disk holds the blocks that differ from the start's, whatever changes its length before them") {
    const Folder folder;
    Registry registry;
    registry.add(make_codec<double>(1, write, read));
    int computes = 0;
    NodeType type = keeper(&computes);
    Entry entry;
    entry.outputs = {Value::of(2.5)};
    const auto frame = [&](int number, std::size_t length, int first) {
        KeptFrame f;
        f.made_from.node = "a";
        f.frame = number;
        f.entry = std::make_shared<const Entry>(entry);
        f.state.assign(length, std::byte{7});
        f.state.front() = std::byte(first);
        return f;
    };
    // With its length before it the start's state ends at a block's edge. The next frame's is a byte longer, and its
    // first byte is another one.
    constexpr std::size_t block = 4096, length = 50 * block - sizeof(std::uint64_t);
    const Digest start{1, 1}, next{2, 2};
    FrameStore store(folder.path, 1 << 30, "build");
    store.write(registry, type, start, start, frame(1, length, 1));
    store.write(registry, type, next, start, frame(2, length + 1, 2));
    // Of each file: its header, the start's key; of what is told and of the state how long it is, where its sections
    // begin, three and one, and which blocks follow.
    constexpr std::uintmax_t sum = 16, header = 13 + sum + 2 * (sum + 8), before = sum + 2 * (8 + 8 + 8) + 4 * 4;
    // What it was made from, the state's first block, and its last byte, which stands in one that ends with it.
    CHECK(fs::file_size(store.file_of(next)) == header + before + 2 * (4 + block) + (4 + 1));
    CHECK(fs::file_size(store.file_of(start)) > 50 * block);
    for (const auto& [key, number] : {std::pair{start, 1}, {next, 2}}) {
        const FrameStore::Found found = FrameStore(folder.path, 1 << 30, "build").read(registry, type, key, true);
        REQUIRE(found.frame);
        CHECK(found.frame->frame == number);
        CHECK(found.frame->state == frame(number, length + std::size_t(number) - 1, number).state);
        CHECK(found.frame->entry->outputs.at(0).as<double>() == 2.5);
    }
}
