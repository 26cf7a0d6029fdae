// Plain values to bytes and back, for what is saved: little-endian, as the machines are that Sinew runs on.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sinew::engine {

static_assert(std::endian::native == std::endian::little);

/// Bytes that are not what they should be.
class BadBytes : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

class ByteWriter {
  public:
    template <class T>
    void put(const T& v) {
        static_assert(std::is_trivially_copyable_v<T>);
        append(&v, sizeof(T));
    }
    template <class T>
    void put_list(std::span<const T> list) {
        static_assert(std::is_trivially_copyable_v<T>);
        put<std::uint64_t>(list.size());
        append(list.data(), list.size_bytes());
    }
    template <class T>
    void put_list(const std::vector<T>& list) {
        put_list(std::span<const T>(list));
    }
    void put_text(std::string_view text) { put_list(std::span<const char>(text)); }
    std::vector<std::byte> bytes;

  private:
    void append(const void* from, std::size_t count) {
        const auto* p = static_cast<const std::byte*>(from);
        bytes.insert(bytes.end(), p, p + count);
    }
};

/// Throws BadBytes where the bytes end too early.
class ByteReader {
  public:
    explicit ByteReader(std::span<const std::byte> bytes)
        : rest(bytes) {}
    template <class T>
    T get() {
        static_assert(std::is_trivially_copyable_v<T>);
        if constexpr (std::is_same_v<T, bool>) { // another byte than 0 and 1 is no bool
            const auto byte = get<std::uint8_t>();
            if (byte > 1) throw BadBytes("a switch in it is neither on nor off");
            return byte == 1;
        } else {
            T v;
            std::memcpy(&v, take(sizeof(T)).data(), sizeof(T));
            return v;
        }
    }
    template <class T>
    std::vector<T> get_list() {
        const std::span<const std::byte> bytes = get_bytes_of_list<T>();
        std::vector<T> out(bytes.size() / sizeof(T));
        if (!out.empty()) std::memcpy(static_cast<void*>(out.data()), bytes.data(), bytes.size());
        return out;
    }
    /// Of the items, without their number.
    template <class T>
    std::span<const std::byte> get_bytes_of_list() {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto n = get<std::uint64_t>();
        if (n > rest.size() / sizeof(T)) throw BadBytes("it ends too early");
        return take(n * sizeof(T));
    }
    std::string get_text() {
        const std::vector<char> text = get_list<char>();
        return {text.begin(), text.end()};
    }
    std::span<const std::byte> rest;

  private:
    std::span<const std::byte> take(std::size_t count) {
        if (rest.size() < count) throw BadBytes("it ends too early");
        const auto out = rest.first(count);
        rest = rest.subspan(count);
        return out;
    }
};

} // namespace sinew::engine
