// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/file_digests.h"

#include "engine/file_sequence.h"

#include <filesystem>
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
    namespace fs = std::filesystem;
    if (auto fault = files.refusal(path)) return *fault; // a row may be another graph's, which may open more
    std::error_code ec;
    const std::uintmax_t size = fs::file_size(path, ec);
    const std::int64_t changed = ec ? 0 : fs::last_write_time(path, ec).time_since_epoch().count();
    if (!ec) {
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
    if (ec) return content;
    const std::lock_guard lock(mutex_);
    rows_[path] = Row{size, changed, content};
    return content;
}

} // namespace sinew::engine
