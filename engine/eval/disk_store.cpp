// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/disk_store.h"

#include "engine/atomic_file.h"
#include "engine/byte_stream.h"

#include <algorithm>
#include <fstream>

namespace sinew::engine {

namespace {

constexpr std::string_view mark = "sinew kept 4\n";

/// Everything before the payload: mark, key, checksum, length.
constexpr std::size_t header_size = mark.size() + 2 * sizeof(Digest) + sizeof(std::uint64_t);

std::optional<Digest> key_of(const std::string& hex) {
    if (hex.size() != 32 || hex.find_first_not_of("0123456789abcdef") != std::string::npos) return {};
    return Digest{std::stoull(hex.substr(0, 16), nullptr, 16), std::stoull(hex.substr(16), nullptr, 16)};
}

Digest checksum(std::span<const std::byte> payload) { return Hasher().add_bytes(payload).finish(); }

} // namespace

FileFault why_not_kept(const std::filesystem::path& folder, const Failure& failure) {
    std::error_code error;
    for (std::filesystem::path at = folder; !at.empty() && at != at.root_path(); at = at.parent_path())
        if (std::filesystem::is_regular_file(at, error))
            return {"IO407", "'" + at.string() + "' is a file, but a folder is needed", "name a folder by --cache"};
    const Diagnostic& first = failure.diagnostics().front();
    return {"IO407", first.message, first.hint};
}

std::filesystem::path DiskStore::file_of(const Digest& key) const { return folder_ / (key.hex() + ending_); }

DiskStore::Found DiskStore::read(const Digest& key) const {
    std::error_code error;
    if (std::filesystem::is_directory(file_of(key), error)) return {{}, "a folder is in its place"};
    if (files_.refusal(file_of(key))) return {{}, "it is a link out of the root"};
    std::ifstream file(file_of(key), std::ios::binary);
    if (!file) {
        return {{}, std::filesystem::exists(file_of(key), error) ? "it cannot be opened" : ""};
    }
    std::vector<std::byte> bytes;
    char block[1 << 16];
    while (file.read(block, sizeof block) || file.gcount() > 0) {
        const auto* p = reinterpret_cast<const std::byte*>(block);
        bytes.insert(bytes.end(), p, p + file.gcount());
    }
    if (bytes.size() < header_size || std::memcmp(bytes.data(), mark.data(), mark.size()) != 0)
        return {{}, "it was not written by this version of Sinew, or not whole"};
    ByteReader header(std::span<const std::byte>(bytes).subspan(mark.size()));
    if (header.get<Digest>() != key) return {{}, "it belongs to other inputs"};
    const auto sum = header.get<Digest>();
    if (header.get<std::uint64_t>() != header.rest.size()) return {{}, "its length is wrong"};
    if (checksum(header.rest) != sum) return {{}, "its bytes are damaged"};
    bytes.erase(bytes.begin(), bytes.begin() + header_size);
    return {std::move(bytes), {}};
}

std::vector<Digest> DiskStore::newest_first() const {
    std::vector<std::pair<std::filesystem::file_time_type, Digest>> found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
        const std::filesystem::path& path = entry.path();
        const auto key = path.extension() == ending_ ? key_of(path.stem().string()) : std::nullopt;
        const auto time = entry.last_write_time(error);
        if (key && !error) found.emplace_back(time, *key);
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return b < a; });
    std::vector<Digest> out;
    for (const auto& [time, key] : found) out.push_back(key);
    return out;
}

bool DiskStore::contains(const Digest& key) const {
    std::error_code error;
    return std::filesystem::is_regular_file(file_of(key), error);
}

void DiskStore::touch(const Digest& key) const {
    std::error_code error;
    std::filesystem::last_write_time(file_of(key), std::filesystem::file_time_type::clock::now(), error);
}

void DiskStore::write(const Digest& key, std::span<const std::byte> payload, bool waits) const {
    std::string text(mark);
    ByteWriter header;
    header.put(key);
    header.put(checksum(payload));
    header.put<std::uint64_t>(payload.size());
    text.append(reinterpret_cast<const char*>(header.bytes.data()), header.bytes.size());
    text.append(reinterpret_cast<const char*>(payload.data()), payload.size());
    waits ? write_file(file_of(key), text, files_) : write_file_soon(file_of(key), text, files_);
}

} // namespace sinew::engine
