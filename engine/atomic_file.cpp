// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/atomic_file.h"

#include "engine/diagnostics.h"

#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace sinew::engine {

namespace fs = std::filesystem;

void fail_to_write(const fs::path& path, const std::string& reason) {
    Diagnostic d;
    d.code = "IO405";
    d.message = "cannot write '" + path.string() + "': " + reason;
    d.hint = "check the folder's permissions and the free space";
    throw Failure(d);
}

namespace {

[[noreturn]] void fail(const fs::path& path) { fail_to_write(path, std::strerror(errno)); }

void write_all(int descriptor, std::string_view bytes, const fs::path& path) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path);
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// ".NAME.", before the process that writes NAME.
std::string temporary_prefix(const fs::path& target) { return "." + target.filename().string() + "."; }

constexpr std::string_view temporary_ending = ".tmp";

/// A file that is not yet in place. Closed, and removed where it has a name, unless it was moved into place.
class NewFile {
  public:
    explicit NewFile(const fs::path& target)
        : target_(target) {
        const fs::path folder = folder_of(target);
        // Unique among threads and processes, so that two writers of one file cannot mix their bytes.
        named_ = folder / (temporary_prefix(target) + std::to_string(getpid()) + "-" + std::to_string(gettid()) +
                           std::string(temporary_ending));
        descriptor_ = open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
        if (descriptor_ >= 0) return;
        descriptor_ = open(named_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
        if (descriptor_ < 0) fail(target_);
        has_name_ = true;
    }
    ~NewFile() {
        close(descriptor_);
        if (has_name_) unlink(named_.c_str());
    }
    NewFile(const NewFile&) = delete;

    void write(std::string_view bytes) { write_all(descriptor_, bytes, target_); }

    void move_into_place(bool waits) {
        // The bytes must be on the disk before the name is, or a power cut could leave a name without them.
        if (waits && fsync(descriptor_) != 0 && errno != EINVAL) fail(target_);
        if (!has_name_) {
            const std::string self = "/proc/self/fd/" + std::to_string(descriptor_);
            if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, target_.c_str(), AT_SYMLINK_FOLLOW) == 0) return;
            // A link cannot replace a file. The complete file gets a name of its own first, then takes the
            // older one's place.
            if (errno != EEXIST) fail(target_);
            unlink(named_.c_str());
            if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, named_.c_str(), AT_SYMLINK_FOLLOW) != 0) fail(target_);
            has_name_ = true;
        }
        if (rename(named_.c_str(), target_.c_str()) != 0) fail(target_);
        has_name_ = false;
    }

  private:
    fs::path target_, named_;
    int descriptor_ = -1;
    bool has_name_ = false;
};

/// 1 for /dev/stdout and /dev/fd/1: what this program has open is written on where it stands, whether it is a pipe, a
/// socket or a file. -1 for other paths.
int descriptor_named(const fs::path& path) {
    if (path == "/dev/stdout") return STDOUT_FILENO;
    if (path == "/dev/stderr") return STDERR_FILENO;
    const fs::path folder = path.parent_path();
    if (folder != "/dev/fd" && folder != "/proc/self/fd") return -1;
    const std::string name = path.filename().string();
    int descriptor = -1;
    const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), descriptor);
    return fault == std::errc{} && end == name.data() + name.size() ? descriptor : -1;
}

/// A pipe without a reader would keep the program for ever, deaf to Ctrl-C: one is waited for a while.
int open_device(const fs::path& path) {
    constexpr int waits = 40;             // two seconds
    const timespec moment{0, 50'000'000}; // 50 ms
    for (int i = 0;; ++i) {
        const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
        if (descriptor >= 0) {
            fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
            return descriptor;
        }
        struct stat about {};
        if (errno != ENXIO || ::stat(path.c_str(), &about) != 0) return -1;
        if (!S_ISFIFO(about.st_mode)) {
            errno = ENXIO; // of a device, or a socket, that nobody is behind
            return -1;
        }
        if (i == waits) fail_to_write(path, "nothing reads from this pipe");
        nanosleep(&moment, nullptr);
    }
}

/// Devices and pipes (/dev/null, /dev/stdout, a FIFO) are written to, never replaced by a file.
class Device {
  public:
    /// \param descriptor under which it is open already, or -1
    Device(const fs::path& path, int descriptor)
        : path_(path)
        , descriptor_(descriptor >= 0 ? fcntl(descriptor, F_DUPFD_CLOEXEC, 0) : open_device(path)) {
        if (descriptor_ < 0) fail(path_);
    }
    ~Device() { close(descriptor_); }
    Device(const Device&) = delete;
    void write(std::string_view bytes) { write_all(descriptor_, bytes, path_); }

  private:
    fs::path path_;
    int descriptor_;
};

constexpr std::size_t most_buffered = std::size_t{1} << 20;

} // namespace

struct AtomicFile::Impl {
    std::optional<NewFile> file;
    std::optional<Device> device;
    std::string buffer;
    void flush() {
        file ? file->write(buffer) : device->write(buffer);
        buffer.clear();
    }
};

AtomicFile::AtomicFile(const fs::path& path_or_link, const FileAccess& files)
    : impl_(std::make_unique<Impl>()) {
    if (const auto fault = files.refusal(path_or_link)) {
        Diagnostic d;
        d.code = fault->code;
        d.message = "cannot write: " + fault->message;
        d.hint = fault->hint;
        throw Failure(d);
    }
    std::error_code error;
    // A link to a pipe leads to a name that no file has, so it is asked for before links are followed.
    const fs::file_status there = fs::status(path_or_link, error);
    const int open_already = descriptor_named(path_or_link);
    if (open_already >= 0 || (fs::exists(there) && !fs::is_regular_file(there) && !fs::is_directory(there))) {
        impl_->device.emplace(path_or_link, open_already);
        return;
    }
    // A symbolic link stays; the file that it names is replaced.
    fs::path path = path_or_link;
    if (fs::is_symlink(fs::symlink_status(path_or_link, error))) {
        error.clear();
        path = fs::weakly_canonical(path_or_link, error);
        if (error) fail_to_write(path_or_link, error.message());
    }
    error.clear();
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
    if (error) fail_to_write(path, error.message());
    impl_->file.emplace(path);
}

AtomicFile::~AtomicFile() = default;

void AtomicFile::write(std::string_view bytes) {
    if (impl_->buffer.size() + bytes.size() > most_buffered) impl_->flush();
    if (bytes.size() < most_buffered)
        impl_->buffer += bytes;
    else
        impl_->file ? impl_->file->write(bytes) : impl_->device->write(bytes);
}

void AtomicFile::flush() { impl_->flush(); }

void AtomicFile::commit(bool waits) {
    impl_->flush();
    if (impl_->file) impl_->file->move_into_place(waits);
}

bool names_open_file(const fs::path& path) { return descriptor_named(path) >= 0; }

void write_file(const fs::path& path, std::string_view bytes, const FileAccess& files) {
    AtomicFile file(path, files);
    file.write(bytes);
    file.commit();
}

void write_file_soon(const fs::path& path, std::string_view bytes, const FileAccess& files) {
    AtomicFile file(path, files);
    file.write(bytes);
    file.commit(false);
}

namespace {

/// ".NAME.PROCESS-THREAD.tmp"
struct TemporaryName {
    std::string finished;
    pid_t process = 0;
};
std::optional<TemporaryName> read_temporary(std::string_view name) {
    if (!name.starts_with('.') || !name.ends_with(temporary_ending)) return {};
    name.remove_prefix(1), name.remove_suffix(temporary_ending.size());
    const std::size_t dot = name.rfind('.');
    if (dot == 0 || dot == std::string_view::npos) return {};
    TemporaryName out{std::string(name.substr(0, dot)), 0};
    const std::string_view who = name.substr(dot + 1);
    const auto [end, fault] = std::from_chars(who.data(), who.data() + who.size(), out.process);
    if (fault != std::errc{} || end == who.data() + who.size() || *end != '-' || out.process <= 0) return {};
    return out;
}

} // namespace

std::optional<fs::path> finished_name(const fs::path& temporary) {
    const auto name = read_temporary(temporary.filename().string());
    return name ? std::optional<fs::path>(name->finished) : std::nullopt;
}

bool is_abandoned(const fs::path& temporary) {
    const auto name = read_temporary(temporary.filename().string());
    if (!name || kill(name->process, 0) == 0 || errno == EPERM) return false;
    std::error_code error;
    const auto age = fs::file_time_type::clock::now() - fs::last_write_time(temporary, error);
    return !error && age > std::chrono::hours(1);
}

void remove_abandoned(const fs::path& path) {
    std::error_code error;
    std::vector<fs::path> abandoned;
    for (const auto& entry : fs::directory_iterator(folder_of(path), error))
        if (finished_name(entry.path()) == path.filename() && is_abandoned(entry.path()))
            abandoned.push_back(entry.path());
    for (const fs::path& file : abandoned) fs::remove(file, error);
}

} // namespace sinew::engine
