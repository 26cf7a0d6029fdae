// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/file_digests.h"

#include "engine/file_sequence.h"

#include <filesystem>
#include <fstream>
#include <vector>

namespace sinew::engine {

std::variant<Digest, FileFault> FileDigests::of(const std::string& path) {
    return names_sequence(path) ? of_sequence(path) : of_file(path);
}

std::variant<Digest, FileFault> FileDigests::of_sequence(const std::string& path) {
    const auto files = find_sequence(path);
    if (files.empty()) return FileFault{"IO401", "there is no file like " + path};
    Hasher h;
    for (const auto& [number, file] : files) {
        const auto content = of_file(file);
        if (const auto* fault = std::get_if<FileFault>(&content)) return *fault;
        h.add(static_cast<std::uint64_t>(number)).add(std::get<Digest>(content));
    }
    return h.finish();
}

std::variant<Digest, FileFault> FileDigests::of_file(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code ec;
    const auto status = fs::status(path, ec);
    if (!fs::exists(status)) return FileFault{"IO401", "there is no file " + path};
    if (fs::is_directory(status)) return FileFault{"IO402", path + " is a folder"};
    if (!fs::is_regular_file(status)) return FileFault{"IO402", path + " is a pipe or a device, not a file"};
    const FileFault unreadable{"IO402", path + " cannot be read"};
    const std::uintmax_t size = fs::file_size(path, ec);
    if (ec) return unreadable;
    const std::int64_t changed = fs::last_write_time(path, ec).time_since_epoch().count();
    if (ec) return unreadable;
    {
        const std::lock_guard lock(mutex_);
        const auto it = rows_.find(path);
        if (it != rows_.end() && it->second.size == size && it->second.changed == changed) return it->second.content;
    }
    std::ifstream in(path, std::ios::binary);
    if (!in) return unreadable;
    Hasher h;
    std::vector<char> block(std::size_t{1}
                            << 20); // the block size is part of the digest: each block has its length first
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0)
        h.add_bytes(std::as_bytes(std::span(block.data(), static_cast<std::size_t>(in.gcount()))));
    if (in.bad()) return unreadable;
    const Digest content = h.finish();
    const std::lock_guard lock(mutex_);
    rows_[path] = Row{size, changed, content};
    return content;
}

} // namespace sinew::engine
