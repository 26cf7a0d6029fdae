// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/file_digests.h"

#include "engine/file_sequence.h"

#include <sys/stat.h>
#include <vector>

namespace sinew::engine {

std::variant<Digest, FileFault> FileDigests::of(const std::string& path, const FileAccess& files) {
    if (auto fault = files.refusal(path)) return *fault; // before the disk is asked for numbered ones
    return names_sequence(path) ? of_sequence(path, files) : of_file(path, files);
}

std::variant<Digest, FileFault> FileDigests::of_sequence(const std::string& path, const FileAccess& files) {
    const auto found = find_sequence(path);
    if (found.empty()) return FileFault{"IO401", "there is no file like " + path};
    Hasher h;
    for (const auto& [number, file] : found) {
        const auto content = of_file(file, files);
        if (const auto* fault = std::get_if<FileFault>(&content)) return *fault;
        h.add(static_cast<std::uint64_t>(number)).add(std::get<Digest>(content));
    }
    return h.finish();
}

std::variant<Digest, FileFault> FileDigests::of_file(const std::string& path, const FileAccess& files) {
    if (auto fault = files.refusal(path)) return *fault; // a row may be another graph's, which may open more
    // Asked of every file at every pull: one call each.
    struct stat now {};
    const bool is_file = ::stat(path.c_str(), &now) == 0 && S_ISREG(now.st_mode);
    const auto size = static_cast<std::uintmax_t>(now.st_size);
    const std::int64_t changed = now.st_mtim.tv_sec * std::int64_t{1'000'000'000} + now.st_mtim.tv_nsec;
    if (is_file) {
        const std::lock_guard lock(mutex_);
        const auto it = rows_.find(path);
        if (it != rows_.end() && it->second.size == size && it->second.changed == changed) return it->second.content;
    }
    const auto opened = files.open(path);
    if (const auto* fault = std::get_if<FileFault>(&opened)) return *fault;
    const OpenFile& in = std::get<OpenFile>(opened);
    Hasher h;
    // The block size is part of the digest: each block has its length first.
    std::vector<char> block(std::size_t{1} << 20);
    while (true) {
        std::size_t filled = 0;
        for (std::ptrdiff_t count = 1; count != 0 && filled < block.size(); filled += static_cast<std::size_t>(count)) {
            count = in.read(std::span(block).subspan(filled));
            if (count < 0) return FileFault{"IO402", "'" + path + "' cannot be read to its end"};
        }
        if (filled == 0) break;
        h.add_bytes(std::as_bytes(std::span(block.data(), filled)));
    }
    const Digest content = h.finish();
    if (!is_file) return content;
    const std::lock_guard lock(mutex_);
    rows_[path] = Row{size, changed, content};
    return content;
}

} // namespace sinew::engine
