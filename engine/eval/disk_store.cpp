// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/disk_store.h"

#include "engine/atomic_file.h"
#include "engine/byte_stream.h"

#include <algorithm>
#include <array>
#include <fstream>

namespace sinew::engine {

namespace {

constexpr std::string_view mark = "sinew kept 6\n";

struct Part {
    Digest sum;
    std::uint64_t size = 0;
};
/// Everything before the payload: mark, key, payload, tail.
constexpr std::size_t header_size = mark.size() + sizeof(Digest) + 2 * (sizeof(Digest) + sizeof(std::uint64_t));

void put_part(ByteWriter& out, std::span<const std::byte> bytes) {
    out.put(Hasher().add_bytes(bytes).finish());
    out.put<std::uint64_t>(bytes.size());
}
Part get_part(ByteReader& in) {
    Part out;
    out.sum = in.get<Digest>();
    out.size = in.get<std::uint64_t>();
    return out;
}

/// Empty where it cannot be had, or is damaged.
std::optional<std::vector<std::byte>> read_part(std::istream& file, const Part& part, std::vector<std::byte> out = {}) {
    out.resize(part.size);
    file.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(out.size()));
    if (!file || Hasher().add_bytes(out).finish() != part.sum) return {};
    return out;
}

} // namespace

std::optional<Digest> key_of(std::string_view hex) {
    if (hex.size() != 32 || hex.find_first_not_of("0123456789abcdef") != std::string_view::npos) return {};
    const auto half = [&](std::size_t at) { return std::stoull(std::string(hex.substr(at, 16)), nullptr, 16); };
    return Digest{half(0), half(16)};
}

FileFault why_not_kept(const std::filesystem::path& folder, const Failure& failure) {
    constexpr std::size_t longest = 255; // of a name, in bytes, on the file systems there are
    const std::string hint = "name a folder by --cache";
    std::error_code error;
    for (std::filesystem::path at = folder; !at.empty() && at != at.root_path(); at = at.parent_path()) {
        if (std::filesystem::is_regular_file(at, error))
            return {"IO407", "'" + at.string() + "' is a file, but a folder is needed", hint};
        if (at.filename().native().size() > longest)
            return {"IO407", "the name of the folder '" + at.string() + "' is longer than 255 bytes", hint};
    }
    const Diagnostic& first = failure.diagnostics().front();
    return {"IO407", first.message, first.hint};
}

std::uintmax_t DiskStore::file_size(std::size_t payload, std::size_t tail) { return header_size + payload + tail; }

std::filesystem::path DiskStore::file_of(const Digest& key) const { return folder_ / (key.hex() + ending_); }

DiskStore::Found DiskStore::read(const Digest& key, bool with_tail, std::vector<std::byte> room) const {
    const auto useless = [](std::string why) { return Found{{}, {}, std::move(why)}; };
    const std::filesystem::path path = file_of(key);
    std::error_code error;
    const auto kind = std::filesystem::status(path, error).type();
    if (kind == std::filesystem::file_type::not_found) return {};
    if (kind == std::filesystem::file_type::directory) return useless("a folder is in its place");
    // Whoever opens a pipe that nobody writes to waits for ever.
    if (kind != std::filesystem::file_type::regular) return useless("what is in its place is no file");
    if (files_.refusal(path)) return useless("it is a link out of the root");
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::filesystem::exists(path, error) ? useless("it cannot be opened") : Found();
    std::array<std::byte, header_size> header_bytes{};
    file.read(reinterpret_cast<char*>(header_bytes.data()), header_size);
    if (!file || std::memcmp(header_bytes.data(), mark.data(), mark.size()) != 0)
        return useless("it was not written by this version of Sinew, or not whole");
    ByteReader header(std::span<const std::byte>(header_bytes).subspan(mark.size()));
    if (header.get<Digest>() != key) return useless("it belongs to other inputs");
    const Part payload = get_part(header), tail = get_part(header);
    const std::uintmax_t rest = std::filesystem::file_size(path, error) - header_size;
    if (error || payload.size > rest || tail.size != rest - payload.size) return useless("its length is wrong");
    Found out;
    out.payload = read_part(file, payload, std::move(room));
    if (!out.payload) return useless("its bytes are damaged");
    if (!with_tail) return out;
    auto read = read_part(file, tail);
    if (!read) return useless("its bytes are damaged");
    out.tail = std::move(*read);
    return out;
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

void DiskStore::touch(const Digest& key, std::filesystem::file_time_type when) const {
    std::error_code error;
    std::filesystem::last_write_time(file_of(key), when, error);
}

void DiskStore::write(const Digest& key, std::span<const std::byte> payload, bool waits,
                      std::span<const std::byte> tail) const {
    ByteWriter header;
    header.put(key);
    put_part(header, payload);
    put_part(header, tail);
    std::string text(mark);
    text.reserve(header_size + payload.size() + tail.size());
    for (const std::span<const std::byte> part : {std::span<const std::byte>(header.bytes), payload, tail})
        text.append(reinterpret_cast<const char*>(part.data()), part.size());
    waits ? write_file(file_of(key), text, files_) : write_file_soon(file_of(key), text, files_);
}

} // namespace sinew::engine
