// Values that are plain numbers with a name and a unit. A struct lists them once, in `fields()`; comparing, checking,
// mixing between two times, saving and digesting all go through that list, so that none can forget a number.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace sinew::solver {

template <class T>
struct Field {
    const char* name; ///< as users see it
    const char* unit;
    double T::*at;
};

template <class T>
bool same_fields(const T& a, const T& b) {
    for (const auto& f : T::fields())
        if (a.*f.at != b.*f.at) return false;
    return true;
}

/// The first field that is not a finite number; null if all are.
template <class T>
const Field<T>* not_finite(const T& values) {
    static constexpr auto fields = T::fields();
    for (const auto& f : fields)
        if (!std::isfinite(values.*f.at)) return &f;
    return nullptr;
}

/// The value at `share` of the way; what does not change keeps its bits.
inline void mix(double from, double& to, double share) {
    if (from != to) to = std::lerp(from, to, share);
}

template <class T>
void mix_fields(const T& from, T& to, double share) {
    for (const auto& f : T::fields()) mix(from.*f.at, to.*f.at, share);
}

/// Name and unit without the type, for lists over many types.
struct FieldName {
    const char *name, *unit;
};

template <class T>
constexpr auto field_names() {
    constexpr auto fields = T::fields();
    std::array<FieldName, fields.size()> out{};
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {fields[i].name, fields[i].unit};
    return out;
}

/// The numbers of `values` in the order of its fields, into `out`, which has room for them.
template <class T>
void put_fields(const T& values, std::span<double> out) {
    std::size_t i = 0;
    for (const auto& f : T::fields()) out[i++] = values.*f.at;
}

/// The inverse of put_fields.
template <class T>
T get_fields(std::span<const double> numbers) {
    T out;
    std::size_t i = 0;
    for (const auto& f : T::fields()) out.*f.at = numbers[i++];
    return out;
}

} // namespace sinew::solver
