// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/state_file.h"

#include "engine/eval/keys.h"

#include <cstring>

namespace sinew::engine {

namespace {

constexpr std::string_view magic = "sinew state 2\n";
constexpr std::size_t header_size = magic.size() + 3 * 16;

void put_number(std::vector<std::byte>& out, std::uint64_t v) {
    for (int i = 0; i < 8; ++i) out.push_back(static_cast<std::byte>(v >> (8 * i)));
}

std::uint64_t number_at(std::span<const std::byte> bytes, std::size_t at) {
    std::uint64_t v = 0;
    for (std::size_t i = 0; i < 8; ++i) v |= static_cast<std::uint64_t>(bytes[at + i]) << (8 * i);
    return v;
}

Digest type_digest(const NodeType& t) { return identity(t).finish(); }
Digest payload_digest(std::span<const std::byte> payload) { return Hasher().add_bytes(payload).finish(); }

} // namespace

std::vector<std::byte> wrap_state(const NodeType& type, const Digest& key, std::span<const std::byte> payload) {
    std::vector<std::byte> out;
    out.reserve(header_size + payload.size());
    for (char c : magic) out.push_back(static_cast<std::byte>(c));
    for (const Digest& d : {type_digest(type), key, payload_digest(payload)})
        put_number(out, d.hi), put_number(out, d.lo);
    out.insert(out.end(), payload.begin(), payload.end());
    return out;
}

UnwrappedState unwrap_state(const NodeType& type, const Digest& key, std::span<const std::byte> bytes) {
    if (bytes.size() < header_size || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
        return {{}, "these bytes are not a saved state"};
    const auto digest = [&](std::size_t i) {
        const std::size_t at = magic.size() + 16 * i;
        return Digest{number_at(bytes, at), number_at(bytes, at + 8)};
    };
    if (digest(0) != type_digest(type))
        return {{},
                "the state was saved by another type, or by another version of " + std::string(type.name) +
                    ", or with the kernels of another processor"};
    if (digest(1) != key) return {{}, "the state belongs to another graph or another frame"};
    const auto payload = bytes.subspan(header_size);
    if (digest(2) != payload_digest(payload)) return {{}, "the bytes are damaged"};
    return {payload, {}};
}

} // namespace sinew::engine
