// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/disk_store.h"

#include "engine/atomic_file.h"
#include "engine/byte_stream.h"

#include <fstream>

namespace sinew::engine {

namespace {

constexpr std::string_view mark = "sinew kept 1\n";

/// Everything before the payload: mark, key, checksum, length.
constexpr std::size_t header_size = mark.size() + 2 * sizeof(Digest) + sizeof(std::uint64_t);

Digest checksum(std::span<const std::byte> payload) { return Hasher().add_bytes(payload).finish(); }

} // namespace

std::filesystem::path DiskStore::file_of(const Digest& key) const { return folder_ / (key.hex() + ".kept"); }

DiskStore::Found DiskStore::read(const Digest& key) const {
    std::error_code error;
    if (std::filesystem::is_directory(file_of(key), error)) return {{}, "a folder is in its place"};
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

void DiskStore::write(const Digest& key, std::span<const std::byte> payload) const {
    std::string text(mark);
    ByteWriter header;
    header.put(key);
    header.put(checksum(payload));
    header.put<std::uint64_t>(payload.size());
    text.append(reinterpret_cast<const char*>(header.bytes.data()), header.bytes.size());
    text.append(reinterpret_cast<const char*>(payload.data()), payload.size());
    write_file(file_of(key), text);
}

} // namespace sinew::engine
