// The door to files: what is confined to a folder stays there, by whatever way a path leads out.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/file_digests.h"
#include "engine/file_access.h"
#include "tests/support/engine_toys.h"
#include "tests/tools/temporary_folder.h"

#include <catch2/catch.hpp>
#include <sys/stat.h>

using namespace toys;
namespace fs = std::filesystem;
using sinew::test::TemporaryFolder;
using sinew::test::write_text;

namespace {

/// in/a.txt, in/deep/b.txt and out/secret.txt, and the root in.
struct House {
    TemporaryFolder folder;
    fs::path in = folder / "in", out = folder / "out";
    FileAccess files;
    House() {
        fs::create_directories(in / "deep");
        fs::create_directories(out);
        write_text(in / "a.txt", "a");
        write_text(in / "deep/b.txt", "b");
        write_text(out / "secret.txt", "secret");
        files = FileAccess::within(in);
    }
    /// What is in the file, or the code.
    std::string read(const fs::path& path) const {
        auto found = files.read(path.string());
        if (const auto* fault = std::get_if<FileFault>(&found)) return fault->code;
        return std::get<std::string>(found);
    }
};

} // namespace

TEST_CASE("files within the root are read, by whatever way") {
    const House h;
    CHECK(h.files.root() == fs::canonical(h.in));
    CHECK(h.read(h.in / "a.txt") == "a");
    CHECK(h.read(h.in / "deep/../a.txt") == "a");
    CHECK(h.read(h.in / "deep/./b.txt") == "b");
    CHECK(h.read(h.out / "../in/a.txt") == "a");
    fs::create_symlink("deep/b.txt", h.in / "near");
    fs::create_symlink(fs::canonical(h.in) / "a.txt", h.in / "far");
    fs::create_symlink(h.in, h.out / "back");
    CHECK(h.read(h.in / "near") == "b");
    CHECK(h.read(h.in / "far") == "a");
    CHECK(h.read(h.out / "back/a.txt") == "a");
    CHECK(h.read(h.in / "none.txt") == "IO401");
    CHECK(h.read(h.in / "deep") == "IO402");
    CHECK_FALSE(h.files.refusal(h.in));
    CHECK_FALSE(h.files.refusal(h.in / "new/folder/file"));
}

TEST_CASE("neither .., nor absolute paths, nor links lead out of the root") {
    const House h;
    fs::create_symlink(h.out / "secret.txt", h.in / "link");
    fs::create_symlink("../out", h.in / "door");
    fs::create_symlink("door", h.in / "door_to_door");
    fs::create_symlink(h.out / "not_there_yet", h.in / "dangling");
    fs::create_symlink("round", h.in / "round");
    write_text(h.folder / "inside.txt", "its name begins as the root's does");
    for (const fs::path& path :
         {h.in / "../out/secret.txt", h.in / "deep/../../out/secret.txt", h.out / "secret.txt", h.in / "link",
          h.in / "door/secret.txt", h.in / "door_to_door/secret.txt", h.in / "dangling", h.in / "dangling/below",
          h.in / "round", h.in / "..", h.folder / "inside.txt", h.in / "none/../../out/secret.txt", fs::path("/"),
          fs::path("/etc/passwd"), h.out / "not_there_yet"}) {
        INFO(path);
        CHECK(h.read(path) == "IO410");
        const auto fault = h.files.refusal(path);
        REQUIRE(fault);
        CHECK(fault->message == "'" + path.string() + "' leads out of the root '" + fs::canonical(h.in).string() + "'");
        CHECK(fault->hint == "Name a file within the root, or choose a root that holds it.");
    }
    CHECK_THROWS_AS(h.files.check(h.out, "--out"), Failure);
    CHECK_NOTHROW(h.files.check(h.in / "out", "--out"));
    CHECK_FALSE(FileAccess().refusal(h.in / "link"));
}

TEST_CASE("a root is a folder") {
    const House h;
    for (const fs::path& path : {h.in / "a.txt", h.in / "none"}) {
        try {
            FileAccess::within(path);
            FAIL("a root that is no folder");
        } catch (const Failure& f) {
            CHECK(f.diagnostics()[0].code == "IO411");
        }
    }
    CHECK_FALSE(FileAccess::within("/").refusal("/etc/passwd"));
}

TEST_CASE("files that are too large are refused before they are read") {
    const House h;
    const fs::path huge = h.in / "huge";
    write_text(huge, "");
    fs::resize_file(huge, FileAccess::most_bytes + 1); // a hole, which takes no room on the disk
    CHECK(h.read(huge) == "IO412");
    CHECK(std::get<FileFault>(FileAccess().read(huge.string())).message ==
          "'" + huge.string() + "' is larger than 8 GB");
    const auto shortened = h.files.read((h.in / "deep/b.txt").string(), 0);
    CHECK(std::get<FileFault>(shortened).code == "IO412");
    CHECK(std::get<std::string>(h.files.read((h.in / "deep/b.txt").string(), 1)) == "b");
}

TEST_CASE("what one graph may open, another one that shares the digests may not") {
    const House h;
    FileDigests digests;
    const std::string secret = (h.out / "secret.txt").string();
    CHECK(std::holds_alternative<Digest>(digests.of(secret)));
    CHECK(std::get<FileFault>(digests.of(secret, h.files)).code == "IO410");
    write_text(h.in / "s.1.txt", "1");
    fs::create_symlink(h.out / "secret.txt", h.in / "s.2.txt");
    const std::string numbered = (h.in / "s.#.txt").string();
    CHECK(std::holds_alternative<Digest>(digests.of(numbered)));
    CHECK(std::get<FileFault>(digests.of(numbered, h.files)).code == "IO410");
    fs::remove(h.in / "s.2.txt");
    CHECK(std::holds_alternative<Digest>(digests.of(numbered, h.files)));
}
