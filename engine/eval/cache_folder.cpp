// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/cache_folder.h"

#include "engine/atomic_file.h"
#include "engine/eval/disk_store.h"

#include <algorithm>
#include <vector>

namespace sinew::engine {

namespace fs = std::filesystem;

namespace {

/// A key and one of the endings; rows have the key of the build and one of the process.
bool is_our_name(const fs::path& name) {
    const std::string ending = name.extension().string(), stem = name.stem().string();
    if (ending == frames_ending || ending == outputs_ending || ending == warnings_ending)
        return key_of(stem).has_value();
    const std::size_t dash = stem.find('-');
    return ending == rows_ending && dash != std::string::npos && key_of(stem.substr(0, dash)) &&
           key_of(stem.substr(dash + 1));
}

/// Links are none of ours, and may lead anywhere. What stands in a file's place is told where it cannot be removed.
bool is_no_link(const fs::directory_entry& entry) {
    std::error_code gone;
    return entry.symlink_status(gone).type() != fs::file_type::symlink;
}

struct Ours {
    std::vector<fs::directory_entry> files;      ///< whole
    std::vector<fs::directory_entry> unfinished; ///< being written, or left by a program that was killed
    std::error_code error;                       ///< the folder cannot be listed
};
Ours ours_in(const fs::path& folder) {
    Ours out;
    for (const auto& entry : fs::directory_iterator(folder, out.error)) {
        const fs::path name = entry.path().filename();
        if (is_our_name(name) && is_no_link(entry)) out.files.push_back(entry);
        if (const auto whole = finished_name(name); whole && is_our_name(*whole) && is_no_link(entry))
            out.unfinished.push_back(entry);
    }
    return out;
}

DiskUse use_of(const fs::directory_entry& file) {
    DiskUse out;
    out.files = 1;
    out.frames = file.path().extension() == frames_ending;
    out.outputs = file.path().extension() == outputs_ending;
    std::error_code gone;
    if (const auto size = file.file_size(gone); !gone) out.bytes = size;
    return out;
}

void add_to(DiskUse& all, const DiskUse& one) {
    all.files += one.files, all.frames += one.frames, all.outputs += one.outputs, all.bytes += one.bytes;
}

} // namespace

DiskUse disk_use(const fs::path& folder) {
    DiskUse out;
    const Ours ours = ours_in(folder);
    for (const auto& file : ours.files) add_to(out, use_of(file));
    for (const auto& file : ours.unfinished) add_to(out, use_of(file));
    return out;
}

Removal remove_kept(const fs::path& folder) {
    Removal out;
    const auto is_left = [&](const fs::path& what, const std::error_code& why) {
        if (out.why.empty()) out.first = what, out.why = why.message();
    };
    Ours ours = ours_in(folder);
    if (ours.error && ours.error != std::errc::no_such_file_or_directory) is_left(folder, ours.error);
    for (const auto& file : ours.unfinished)
        if (is_abandoned(file.path())) ours.files.push_back(file);
    std::error_code error;
    for (const auto& file : ours.files) {
        const DiskUse use = use_of(file);
        if (fs::remove(file.path(), error)) {
            add_to(out.removed, use);
        } else if (error) { // else another process was quicker
            ++out.left;
            is_left(file.path(), error);
        }
    }
    if (!ours.files.empty()) fs::remove(folder, error); // only if it is empty now
    return out;
}

void make_room(const fs::path& folder, std::uintmax_t most, const std::set<fs::path>& spared) {
    struct File {
        fs::file_time_type used;
        std::uintmax_t size;
        fs::path path;
    };
    std::vector<File> all;
    std::uintmax_t sum = 0;
    std::error_code error;
    const Ours ours = ours_in(folder);
    for (const auto& entry : ours.files) {
        std::error_code gone;
        const File file{entry.last_write_time(gone), entry.file_size(gone), entry.path()};
        if (gone) continue;
        sum += file.size;
        all.push_back(file);
    }
    for (const auto& file : ours.unfinished)
        if (is_abandoned(file.path())) fs::remove(file.path(), error);
    std::sort(all.begin(), all.end(), [](const File& a, const File& b) { return a.used < b.used; });
    for (const File& file : all) {
        if (sum <= most) break;
        if (spared.contains(file.path) || !fs::remove(file.path, error)) continue;
        sum -= file.size;
    }
}

} // namespace sinew::engine
