// Files of frames that nobody wrote who means well: their checksums are right, what they say is not.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/byte_stream.h"
#include "engine/eval/frame_store.h"
#include "tests/support/engine_toys.h"
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <sys/stat.h>

using namespace toys;

namespace {

struct Kept {
    sinew::test::TemporaryFolder folder;
    mutable FrameStore store{folder.path(), std::uintmax_t{1} << 30, "build"};
    Digest name(const Digest& key) const {
        const std::string hex = store.file_of(key).stem().string();
        return {std::stoull(hex.substr(0, 16), nullptr, 16), std::stoull(hex.substr(16), nullptr, 16)};
    }
    void put(const Digest& key, const Digest& start, std::uint64_t size, const std::vector<std::uint32_t>& blocks,
             std::size_t bytes) const {
        ByteWriter out;
        out.put(name(start));
        out.put(size);
        out.put_list(std::vector<std::uint32_t>{0}); // one part
        out.put_list(blocks);
        out.bytes.resize(out.bytes.size() + bytes);
        DiskStore(folder.path(), ".frame").write(name(key), out.bytes);
    }
    std::string fault(const Digest& key) const { return store.read(*registry(), NodeType{}, key, true).fault; }
};

constexpr Digest a{1, 1}, b{2, 2};

} // namespace

TEST_CASE("frames that differ from each other in a circle are refused") {
    const Kept kept;
    kept.put(a, b, 0, {}, 0);
    kept.put(b, a, 0, {}, 0);
    CHECK(kept.fault(a) == "the start frame that it differs from is gone");
}

TEST_CASE("a frame is not longer than the blocks that it brings and the frame that it starts from") {
    const Kept kept;
    kept.put(a, a, std::uint64_t{1} << 34, {}, 0);
    CHECK(kept.fault(a) == "it is longer than its blocks");
    kept.put(a, a, 4097, {0}, 4096);
    CHECK(kept.fault(a) == "it is longer than its blocks");
    kept.put(b, a, 4096, {0}, 4096); // its start cannot be used
    CHECK(kept.fault(b) == "the start frame that it differs from is gone");
    kept.put(a, a, 4096, {1}, 4096);
    CHECK(kept.fault(a) == "its blocks lie beyond its end");
}

TEST_CASE("the second part of a kept file is read for those who ask for it, and hides no fault of the first") {
    const sinew::test::TemporaryFolder folder;
    const DiskStore disk(folder.path());
    const std::vector<std::byte> first(5000, std::byte{1}), second(7000, std::byte{2});
    disk.write(a, first, false, second);
    std::vector<std::byte> room(9000, std::byte{3});
    const auto found = disk.read(a, false, std::move(room));
    CHECK((found.payload == first && found.tail.empty() && found.fault.empty()));
    CHECK((disk.read(a, true).payload == first && disk.read(a, true).tail == second));
    const auto spoil = [&](std::uintmax_t from_end) {
        std::fstream file(disk.file_of(a), std::ios::binary | std::ios::in | std::ios::out);
        file.seekp(-static_cast<std::streamoff>(from_end), std::ios::end);
        file.put(char{9});
    };
    spoil(1);
    CHECK(disk.read(a).payload == first);
    CHECK(disk.read(a, true).fault == "its bytes are damaged");
    spoil(second.size() + 1);
    CHECK(disk.read(a).fault == "its bytes are damaged");
    disk.write(a, first, false, second);
    std::filesystem::resize_file(disk.file_of(a), std::filesystem::file_size(disk.file_of(a)) - 1);
    CHECK(disk.read(a).fault == "its length is wrong");
    std::filesystem::remove(disk.file_of(a));
    REQUIRE(mkfifo(disk.file_of(a).c_str(), 0600) == 0);
    CHECK(disk.read(a).fault == "what is in its place is no file");
    CHECK(disk.read(b).fault.empty());
}

TEST_CASE("what a frame leaves in memory is not taken for a part of the next one") {
    Kept kept;
    KeptFrame frame;
    frame.entry = std::make_shared<const Entry>();
    kept.store.write(*registry(), NodeType{}, a, a, frame);
    CHECK(kept.fault(a).empty());
    // Brings its second section twice and its first, where the other frame says what made it, not at all.
    ByteWriter out;
    out.put(kept.name(b));
    out.put(std::uint64_t{2 * 4096});
    out.put_list(std::vector<std::uint32_t>{0, 1}), out.put_list(std::vector<std::uint32_t>{1, 1});
    std::vector<std::byte> no_warnings(4096);
    no_warnings.front() = std::byte{16};
    for (int i = 0; i < 2; ++i) out.bytes.insert(out.bytes.end(), no_warnings.begin(), no_warnings.end());
    DiskStore(kept.folder.path(), ".frame").write(kept.name(b), out.bytes);
    const auto found = kept.store.read(*registry(), NodeType{}, b, false);
    CHECK(found.fault == "it ends too early");
}

TEST_CASE("rows are not read through a link") {
    const Kept kept;
    kept.store.add_rows(std::vector<PlugContent>{{a, b}});
    const auto count = [&] {
        std::size_t rows = 0;
        FrameStore(kept.folder.path(), std::uintmax_t{1} << 30, "build").read_rows([&](const PlugContent&) { ++rows; });
        return rows;
    };
    CHECK(count() == 1);
    const sinew::test::TemporaryFolder elsewhere;
    for (const auto& entry : std::filesystem::directory_iterator(kept.folder.path())) {
        const std::filesystem::path file = entry.path(), there = elsewhere / "rows";
        std::filesystem::rename(file, there);
        std::filesystem::create_symlink(there, file);
    }
    CHECK(count() == 0);
}

TEST_CASE("a switch that is neither on nor off is no bool") {
    ByteWriter out;
    for (const std::uint8_t byte : {0, 1, 2, 255}) out.put(byte);
    ByteReader in(out.bytes);
    CHECK_FALSE(in.get<bool>());
    CHECK(in.get<bool>());
    CHECK_THROWS_AS(in.get<bool>(), BadBytes);
    CHECK_THROWS_AS(in.get<bool>(), BadBytes);
}
