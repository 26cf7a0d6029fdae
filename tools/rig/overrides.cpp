// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/overrides.h"

#include "engine/format/typed_text.h"
#include "engine/text.h"
#include "engine/units.h"
#include "solver/material/law.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace sinew::rig {

namespace {

[[noreturn]] void refuse(const Override& o, const std::string& what) {
    throw std::invalid_argument("--set " + o.pattern + ":" + o.name + "=" + o.value + ": " + what);
}

/// With or without a unit, if it has one: "60000", "60kPa".
double number(const Override& o, double least, bool may_be_least, double most = 1e60, std::string_view unit = {}) {
    const auto read = engine::parse_quantity(o.value);
    double out = read ? read->number : 0;
    const bool has_unit = read && !unit.empty() && !read->unit.empty();
    if (has_unit) {
        const std::string meant = engine::unit_meant(read->unit, unit);
        const auto factor = engine::unit_factor(meant.empty() ? read->unit : meant, unit);
        if (!factor)
            refuse(o, "'" + read->unit + "' is no unit of it: write " + engine::usual_units(unit) +
                          ", or a number in " + std::string(unit) + ".");
        out *= *factor;
    }
    const bool is_number = read && (has_unit || read->unit.empty());
    if (!is_number || !(out > least || (may_be_least && out == least)) || out > most)
        refuse(o, "'" + o.value + "' is no number " + (may_be_least ? "from " : "above ") + engine::number_text(least) +
                      " to " + engine::number_text(most) + ".");
    return out;
}

std::string one_of(const Override& o, const std::vector<std::string>& words) {
    if (std::find(words.begin(), words.end(), o.value) != words.end()) return o.value;
    std::string all;
    for (const std::string& w : words) all += (all.empty() ? "" : ", ") + w;
    refuse(o, "the value is one of " + all + ".");
}

std::vector<std::string> laws() {
    std::vector<std::string> out;
    for (const auto& law : solver::elastic_laws) out.emplace_back(law.name);
    return out;
}

std::vector<std::string> names_in(const Override& o) {
    std::vector<std::string> out{""};
    for (const char c : o.value)
        if (c == ',')
            out.emplace_back();
        else
            out.back() += c;
    if (out.size() > 2 || std::count(out.begin(), out.end(), "") > 0)
        refuse(o, "one or two names are meant, as scapula,radius.");
    return out;
}

struct Setting {
    const char *name, *meaning;
    void (*set)(MuscleOptions&, const Override&);
};
constexpr Setting settings[] = {
    {"tetSize", "side of the lattice's cubes, in scene units",
     [](MuscleOptions& m, const Override& o) { m.tet_size = number(o, 0, false); }},
    {"reach", "how far a muscle's end may be from what it holds on to, in scene units",
     [](MuscleOptions& m, const Override& o) { m.reach = number(o, 0, false); }},
    {"attachTo", "what the two ends reach: one or two names of bones or muscles",
     [](MuscleOptions& m, const Override& o) { m.attach_to = names_in(o); }},
    {"overlaps", "tie, slide or none: how it goes with those that it touches",
     [](MuscleOptions& m, const Override& o) {
         m.overlaps = one_of(o, {"tie", "slide", "none"});
     }},
    {"preset", "muscle, tendon or fat",
     [](MuscleOptions& m, const Override& o) {
         m.preset = one_of(o, {"muscle", "tendon", "fat"});
     }},
    {"law", "the elastic law, zTissue.material",
     [](MuscleOptions& m, const Override& o) { m.law = one_of(o, laws()); }},
    {"youngsModulus", "stiffness [Pa]",
     [](MuscleOptions& m, const Override& o) { m.youngs_modulus = number(o, 0, false, 1e13, "Pa"); }},
    {"tendonModulus", "stiffness where the muscle gets thin towards its ends [Pa]",
     [](MuscleOptions& m, const Override& o) { m.tendon_modulus = number(o, 0, false, 1e13, "Pa"); }},
    {"massDensity", "mass per volume [kg/m^3]",
     [](MuscleOptions& m, const Override& o) { m.density = number(o, 0, false, 1e13, "kg/m^3"); }},
    {"strength", "pull of the fibres [Pa]; 0: no fibres",
     [](MuscleOptions& m, const Override& o) { m.strength = number(o, 0, true, 1e13, "Pa"); }},
    {"excitation", "of the fibres, 0 to 1",
     [](MuscleOptions& m, const Override& o) { m.excitation = number(o, 0, true, 1); }},
};

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

} // namespace

std::string override_names() {
    std::string out;
    for (const Setting& s : settings) out += (out.empty() ? "" : "; ") + std::string(s.name) + " (" + s.meaning + ")";
    return out;
}

Override parse_override(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::size_t equals = text.find('=', colon == text.npos ? 0 : colon);
    if (colon == text.npos || equals == text.npos || colon == 0)
        throw std::invalid_argument("--set " + text + ": PATTERN:NAME=VALUE is meant, as 'triceps*:tetSize=1.2'.");
    return {text.substr(0, colon), text.substr(colon + 1, equals - colon - 1), text.substr(equals + 1)};
}

bool matches(std::string_view pattern, std::string_view name) {
    // Back to the last '*' where letters differ.
    std::size_t p = 0, n = 0, star = pattern.npos, from = 0;
    while (n < name.size()) {
        if (p < pattern.size() && (pattern[p] == '?' || lower(pattern[p]) == lower(name[n]))) {
            ++p, ++n;
        } else if (p < pattern.size() && pattern[p] == '*') {
            star = p++, from = n;
        } else if (star != pattern.npos) {
            p = star + 1, n = ++from;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

MuscleOptions options_of(const Part& muscle, const std::vector<Override>& overrides) {
    MuscleOptions out;
    for (const Override& o : overrides) {
        const auto* const setting =
            std::find_if(std::begin(settings), std::end(settings), [&](const Setting& s) { return o.name == s.name; });
        if (setting == std::end(settings)) refuse(o, "there is no '" + o.name + "'. There are: " + override_names());
        MuscleOptions tried; // wrong values are refused even where nothing matches
        setting->set(tried, o);
        if (matches(o.pattern, muscle.name) || matches(o.pattern, muscle.stem)) setting->set(out, o);
    }
    return out;
}

std::optional<std::string> unmatched(const std::vector<Override>& overrides, const std::vector<Part>& parts) {
    for (const Override& o : overrides)
        if (std::none_of(parts.begin(), parts.end(), [&](const Part& p) {
                return p.kind == Kind::muscle && (matches(o.pattern, p.name) || matches(o.pattern, p.stem));
            }))
            return o.pattern;
    return {};
}

} // namespace sinew::rig
