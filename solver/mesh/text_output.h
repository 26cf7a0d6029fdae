// Numbers as text: the shortest that read back to the same bits.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <charconv>
#include <string>

namespace sinew::solver {

template <class Number>
void put(std::string& out, Number value) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    (void)error; // 32 characters hold every number
    out.append(digits, end);
}

inline void put(std::string& out, const Vec3& p) {
    put(out, p[0]), out += ' ', put(out, p[1]), out += ' ', put(out, p[2]);
}

} // namespace sinew::solver
