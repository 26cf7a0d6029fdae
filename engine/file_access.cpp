// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/file_access.h"

#include "engine/diagnostics.h"
#include "engine/text.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sinew::engine {

namespace fs = std::filesystem;

namespace {

/// As many as the system follows.
constexpr int most_links = 40;

/// Where a path leads, with every link on the way followed, also one to what is not there; nothing where links go
/// round.
std::optional<fs::path> real_place(const fs::path& path) {
    std::error_code ec;
    const fs::path whole = fs::absolute(path, ec);
    if (ec) return {};
    std::deque<fs::path> rest(whole.begin(), whole.end());
    fs::path done;
    for (int links = 0; !rest.empty();) {
        const fs::path part = rest.front();
        rest.pop_front();
        if (part.empty() || part == ".") continue;
        if (part == "..") {
            done = done.parent_path();
            continue;
        }
        const fs::path next = done / part;
        if (!fs::is_symlink(fs::symlink_status(next, ec))) {
            done = next;
            continue;
        }
        const fs::path target = fs::read_symlink(next, ec);
        if (ec || ++links > most_links) return {};
        rest.insert(rest.begin(), target.begin(), target.end()); // an absolute one begins with "/", which starts anew
    }
    return done;
}

bool lies_in(const fs::path& place, const fs::path& root) {
    return std::mismatch(root.begin(), root.end(), place.begin(), place.end()).first == root.end();
}

std::string size_text(std::uintmax_t bytes) {
    const bool small = bytes < (std::uintmax_t{1} << 30);
    return number_text(static_cast<double>(bytes >> (small ? 20 : 30))) + (small ? " MB" : " GB");
}

FileFault too_large(const std::string& path, std::uintmax_t most) {
    return {"IO412", "'" + path + "' is larger than " + size_text(most), "Split it, or leave out what is not needed."};
}

FileFault unreadable(const std::string& path) {
    return {"IO402", "'" + path + "' cannot be read: " + std::strerror(errno), "Check its permissions."};
}

FileFault leads_out(const fs::path& path, const fs::path& root) {
    return {"IO410", "'" + path.string() + "' leads out of the root '" + root.string() + "'",
            "Name a file within the root, or choose a root that holds it."};
}

} // namespace

OpenFile::~OpenFile() {
    if (descriptor_ >= 0) close(descriptor_);
}

std::ptrdiff_t OpenFile::read(std::span<char> into) const {
    while (true) {
        const ssize_t count = ::read(descriptor_, into.data(), into.size());
        if (count >= 0 || errno != EINTR) return count;
    }
}

std::uintmax_t OpenFile::size() const {
    struct stat status {};
    return fstat(descriptor_, &status) == 0 ? static_cast<std::uintmax_t>(status.st_size) : 0;
}

FileAccess FileAccess::within(const fs::path& folder) {
    std::error_code ec;
    FileAccess out;
    if (fs::is_directory(folder, ec)) out.root_ = fs::canonical(folder, ec);
    if (!ec && out.is_confined()) return out;
    Diagnostic d;
    d.code = "IO411";
    d.message = "the root '" + folder.string() + "' is no folder";
    d.hint = "Name the folder that holds the graph and its files.";
    throw Failure(std::move(d));
}

std::optional<FileFault> FileAccess::refusal(const fs::path& path) const {
    if (!is_confined()) return {};
    const auto place = real_place(path);
    if (place && lies_in(*place, root_)) return {};
    return leads_out(path, root_);
}

void FileAccess::check(const fs::path& path, std::string_view what) const {
    const auto fault = refusal(path);
    if (!fault) return;
    Diagnostic d;
    d.code = fault->code;
    d.message = std::string(what) + ": " + fault->message;
    d.hint = fault->hint;
    throw Failure(std::move(d));
}

std::variant<OpenFile, FileFault> FileAccess::open(const std::string& path) const {
    if (auto fault = refusal(path)) return *fault;
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    if (!fs::exists(status))
        return FileFault{"IO401", "there is no file '" + path + "'",
                         "Correct the path; relative paths start at the graph's folder."};
    if (fs::is_directory(status)) return FileFault{"IO402", "'" + path + "' is a folder", "Name a file in it."};
    // A pipe that nobody writes to would be waited for without end.
    const FileFault no_file{"IO402", "'" + path + "' is a pipe or a device, not a file", "Name a file."};
    if (!fs::is_regular_file(status)) return no_file;
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) return unreadable(path);
    OpenFile file(descriptor);
    struct stat now {};
    if (fstat(descriptor, &now) != 0) return unreadable(path);
    if (!S_ISREG(now.st_mode)) return no_file;
    if (is_confined()) {
        const fs::path opened = fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor), ec);
        if (ec || !lies_in(opened, root_)) return leads_out(path, root_);
    }
    if (static_cast<std::uintmax_t>(now.st_size) > most_bytes) return too_large(path, most_bytes);
    return file;
}

std::variant<std::string, FileFault> FileAccess::read(const std::string& path, std::uintmax_t most) const {
    auto opened = open(path);
    if (auto* fault = std::get_if<FileFault>(&opened)) return std::move(*fault);
    const OpenFile& file = std::get<OpenFile>(opened);
    const std::uintmax_t size = file.size();
    if (size > most) return too_large(path, most);
    std::string out;
    out.reserve(static_cast<std::size_t>(size));
    char block[1 << 16];
    while (true) { // it may grow meanwhile
        const std::ptrdiff_t count = file.read(block);
        if (count < 0) return unreadable(path);
        if (count == 0) return out;
        if (out.size() + static_cast<std::size_t>(count) > most) return too_large(path, most);
        out.append(block, static_cast<std::size_t>(count));
    }
}

} // namespace sinew::engine
