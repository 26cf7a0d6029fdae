// Structures that begin with their size: the part that both sides know is read or written, the rest left alone.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/embed/session.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace sinew::c {

[[noreturn]] inline void refuse(const std::string& what, const std::string& hint) {
    throw embed::Misuse("DG123", what, hint);
}

template <class T>
void check_size(const T* given, const char* name) {
    if (!given) refuse(std::string(name) + " is null", "give its address");
    if (given->size <= sizeof(given->size) || given->size > (std::size_t{1} << 16))
        refuse(std::string(name) + " says that it has " + std::to_string(given->size) + " bytes",
               "initialise it with SINEW_SIZED");
}

/// What the caller gives, and zero where its header has less.
template <class T>
T read_struct(const T* given, const char* name) {
    check_size(given, name);
    T out{};
    std::memcpy(&out, given, std::min(given->size, sizeof(T)));
    return out;
}

/// As much as the caller's header has.
template <class T>
void write_struct(T* given, T value, const char* name) {
    check_size(given, name);
    value.size = given->size;
    std::memcpy(given, &value, std::min(given->size, sizeof(T)));
}

} // namespace sinew::c
