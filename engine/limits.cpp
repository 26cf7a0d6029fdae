// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/limits.h"

#include "engine/text.h"

#include <cmath>
#include <span>

namespace sinew::engine {

bool inside(const Limits& l, double v) {
    const bool above = l.open_min ? v > l.min : v >= l.min;
    const bool below = l.open_max ? v < l.max : v <= l.max;
    return above && below && std::isfinite(v);
}

std::optional<Outside> outside(const Limits& limits, const Value& v) {
    const auto single = [&](double x) -> std::optional<Outside> {
        if (inside(limits, x)) return {};
        return Outside{x, -1, std::isfinite(x)};
    };
    const auto many = [&](std::span<const double> all) -> std::optional<Outside> {
        for (std::size_t i = 0; i < all.size(); ++i)
            if (!inside(limits, all[i])) return Outside{all[i], static_cast<int>(i), std::isfinite(all[i])};
        return {};
    };
    if (v.is<double>()) return single(v.as<double>());
    if (v.is<std::int64_t>()) return single(static_cast<double>(v.as<std::int64_t>()));
    if (v.is<Vec3>()) return many(v.as<Vec3>());
    if (v.is<Matrix4>()) return many(v.as<Matrix4>());
    if (v.is<NumberList>()) return many(v.as<NumberList>());
    return {};
}

std::string limits_text(const Limits& l, std::string_view unit) {
    const bool no_min = std::isinf(l.min), no_max = std::isinf(l.max);
    std::string out(1, l.open_min || no_min ? '(' : '[');
    out += number_text(l.min);
    out += ", ";
    out += number_text(l.max);
    out += l.open_max || no_max ? ')' : ']';
    if (!unit.empty() && unit != "1") out += " " + std::string(unit);
    return out;
}

} // namespace sinew::engine
