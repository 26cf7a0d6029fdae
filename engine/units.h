// Units in graph files: "kPa", "kg/m^3", "N*s/m^3", "deg". A unit is a factor to SI and a dimension.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace sinew::engine {

struct Unit {
    double factor = 1;
    std::array<int, 5> dimension{}; ///< powers of m, kg, s, rad, frame
    friend bool operator==(const Unit&, const Unit&) = default;
};

/// Products and quotients of named units with whole powers, left to right, brackets allowed: "kg/m^3",
/// "N/(m*s)", "1/s", "%". Empty if the text is not a unit.
std::optional<Unit> parse_unit(std::string_view text);

/// The factor that takes a number in `from` to a number in `to`; empty if either is no unit or they differ in
/// dimension.
std::optional<double> unit_factor(std::string_view from, std::string_view to);

/// The unit that somebody meant who wrote `text` where `unit` fits: "kpa" is kPa, "kg/m3" is kg/m^3, "degrees" is deg.
/// Empty if that cannot be told.
std::string unit_meant(std::string_view text, std::string_view unit);

/// A few usual units of the same dimension, for hints: "Pa, kPa or MPa". Empty if there are none.
std::string usual_units(std::string_view unit);

} // namespace sinew::engine
