// Lists in a term's memory: a count, then the items' bytes as they lie.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/error.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace sinew::solver {

/// Bytes that a list takes.
template <class T>
std::size_t size_in_memory(const std::vector<T>& items) {
    return sizeof(std::uint64_t) + items.size() * sizeof(T);
}

/// Writes it and moves `to` behind it. T has no padding.
template <class T>
void put_in_memory(const std::vector<T>& items, std::byte*& to) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t count = items.size();
    std::memcpy(to, &count, sizeof count);
    to += sizeof count;
    if (count > 0) std::memcpy(to, static_cast<const void*>(items.data()), count * sizeof(T));
    to += count * sizeof(T);
}

/// Reads it and moves `bytes` behind it. Throws Error IO403, naming `what` is read, where they end too early.
template <class T>
void take_from_memory(std::span<const std::byte>& bytes, std::vector<T>& items, const char* what) {
    std::uint64_t count = 0;
    if (bytes.size() >= sizeof count) std::memcpy(&count, bytes.data(), sizeof count);
    if (bytes.size() < sizeof count || count > (bytes.size() - sizeof count) / sizeof(T))
        throw Error("IO403", std::string("the ") + what + " of a saved simulation state end too early");
    bytes = bytes.subspan(sizeof count);
    items.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(items.data()), bytes.data(), count * sizeof(T));
    bytes = bytes.subspan(count * sizeof(T));
}

} // namespace sinew::solver
