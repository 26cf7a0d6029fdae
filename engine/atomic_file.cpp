// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/atomic_file.h"

#include "engine/diagnostics.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

namespace sinew::engine {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
    Diagnostic d;
    d.code = "IO405";
    d.message = "cannot write '" + path.string() + "': " + reason;
    d.hint = "check the folder's permissions and the free space";
    throw Failure(d);
}

/// A file that is not yet in place. Closed, and removed where it has a name, unless it was moved into place.
class NewFile {
  public:
    explicit NewFile(const fs::path& target)
        : target_(target) {
        const fs::path folder = target.parent_path().empty() ? fs::path(".") : target.parent_path();
        // Unique among threads and processes, so that two writers of one file cannot mix their bytes.
        named_ = folder / ("." + target.filename().string() + "." + std::to_string(getpid()) + "-" +
                           std::to_string(gettid()) + ".tmp");
        descriptor_ = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
        if (descriptor_ >= 0) return;
        descriptor_ = open(named_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
        if (descriptor_ < 0) fail(target_, std::strerror(errno));
        has_name_ = true;
    }
    ~NewFile() {
        close(descriptor_);
        if (has_name_) unlink(named_.c_str());
    }
    NewFile(const NewFile&) = delete;

    void write(std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
            if (count < 0 && errno == EINTR) continue;
            if (count < 0) fail(target_, std::strerror(errno));
            bytes.remove_prefix(static_cast<std::size_t>(count));
        }
        // The bytes must be on the disk before the name is, or a power cut could leave a name without them.
        if (fsync(descriptor_) != 0 && errno != EINVAL) fail(target_, std::strerror(errno));
    }

    void move_into_place() {
        if (!has_name_) {
            const std::string self = "/proc/self/fd/" + std::to_string(descriptor_);
            if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, target_.c_str(), AT_SYMLINK_FOLLOW) == 0) return;
            // A link cannot replace a file. The complete file gets a name of its own first, then takes the
            // older one's place.
            if (errno != EEXIST) fail(target_, std::strerror(errno));
            unlink(named_.c_str());
            if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, named_.c_str(), AT_SYMLINK_FOLLOW) != 0)
                fail(target_, std::strerror(errno));
            has_name_ = true;
        }
        if (rename(named_.c_str(), target_.c_str()) != 0) fail(target_, std::strerror(errno));
        has_name_ = false;
    }

  private:
    fs::path target_, named_;
    int descriptor_ = -1;
    bool has_name_ = false;
};

} // namespace

namespace {

/// Devices and pipes (/dev/null, /dev/stdout, a FIFO) are written to, never replaced by a file.
void write_through(const fs::path& path, std::string_view bytes) {
    const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) fail(path, std::strerror(errno));
    while (!bytes.empty()) {
        const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            const int reason = errno;
            close(descriptor);
            fail(path, std::strerror(reason));
        }
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    close(descriptor);
}

} // namespace

void write_file(const fs::path& path_or_link, std::string_view bytes) {
    std::error_code error;
    // A symbolic link stays; the file that it names is replaced.
    fs::path path = path_or_link;
    if (fs::is_symlink(fs::symlink_status(path_or_link, error))) {
        error.clear();
        path = fs::weakly_canonical(path_or_link, error);
        if (error) fail(path_or_link, error.message());
    }
    const fs::file_status there = fs::status(path, error);
    if (fs::exists(there) && !fs::is_regular_file(there) && !fs::is_directory(there)) return write_through(path, bytes);
    error.clear();
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
    if (error) fail(path, error.message());
    NewFile file(path);
    file.write(bytes);
    file.move_into_place();
}

} // namespace sinew::engine
