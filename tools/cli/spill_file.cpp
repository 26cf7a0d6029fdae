// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/spill_file.h"

#include "engine/diagnostics.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <unistd.h>

namespace sinew::cli {

namespace {

[[noreturn]] void fail(std::string_view code, const std::string& what, const std::filesystem::path& folder) {
    engine::Diagnostic d;
    d.code = code;
    d.message = "cannot " + what + " a temporary file in '" + folder.string() + "': " + std::strerror(errno);
    d.hint = "positions wait there until the animation is complete; check the free space";
    throw engine::Failure(d);
}

} // namespace

SpillFile::SpillFile(const std::filesystem::path& folder)
    : folder_(folder) {
    descriptor_ = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (descriptor_ >= 0) return;
    std::string name = (folder / ".positions.XXXXXX").string();
    descriptor_ = mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ < 0) fail("IO405", "make", folder_);
    unlink(name.c_str());
}

SpillFile::~SpillFile() { close(descriptor_); }

std::uint64_t SpillFile::append(std::span<const std::byte> bytes) {
    const std::uint64_t place = size_;
    std::uint64_t end = place;
    while (!bytes.empty()) {
        const ssize_t count = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(end));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            // A part of a pose is of no use, and the file that the others go into needs the room.
            const int why = errno;
            [[maybe_unused]] const int cut = ftruncate(descriptor_, static_cast<off_t>(place));
            errno = why;
            fail("IO405", "write", folder_);
        }
        end += static_cast<std::uint64_t>(count);
        bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    size_ = end;
    return place;
}

void SpillFile::read(std::uint64_t place, std::span<std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t count = pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(place));
        if (count < 0 && errno == EINTR) continue;
        if (count == 0) errno = EIO;
        if (count <= 0) fail("IO402", "read", folder_);
        place += static_cast<std::uint64_t>(count);
        bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
}

} // namespace sinew::cli
