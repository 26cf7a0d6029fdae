// Attribute declarations: plain data, written once per attribute, read by the loader, the checks, the keys,
// the JSON Schema, the reference page and the tests.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"

#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <typeindex>
#include <vector>

namespace sinew::engine {

/// What a change of an attribute can change.
enum class Affects {
    result,        ///< part of every key of the node
    initial_state, ///< simulations only: part of the first frame's key, not read by later frames
    nothing        ///< display and editor: never part of a key, not readable in compute
};

/// A default that the graph's own timing gives, so that one number is not written twice.
enum class FromTiming { nothing, start, fps };

struct Limits {
    double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
    bool open_min = false, open_max = false; ///< the limit itself is not allowed
};

/// A value by name: `"youngsModulus": {"preset": "fat"}`.
struct Preset {
    std::string_view name;
    double value;
};

/// An attribute that a graph file can write as a literal, {value, unit}, {preset}, {keys, interp} or {from}.
/// T: bool, std::int64_t, double, std::string, Vec3, Matrix4, NumberList or File.
template <class T>
struct Input {
    std::string_view name;      ///< exactly as it stands in the graph file
    T def{};                    ///< the default; for File an empty path means "none"
    std::string_view unit = ""; ///< "Pa", "m", "kg/m^3", "1"; "" = no unit
    Limits limits = {};         ///< numbers, each component of a Vec3, each entry of a NumberList
    std::string_view doc = "";
    bool required = false; ///< a graph without it is wrong
    bool keyable =
        true; ///< may carry {keys}; bool, integer and option keys are stepped, other text and files never keyable
    bool list_keys = false; ///< T = NumberList, which is not keyable otherwise: keys of as many numbers each
    Affects affects = Affects::result;
    std::vector<std::string_view> options = {}; ///< T = std::string: the allowed words
    std::vector<Preset> presets = {};           ///< T = double
    /// T = double: the graph's timing is the default instead of `def`. Another literal is warned about (DG031).
    FromTiming from_timing = FromTiming::nothing;
    /// An Input<bool> of the same node. At times where that is off this one must not be read, and is part of no frame's
    /// key.
    std::string_view when = "";
    /// T = bool: compute may ask whether it is on at any time (Reads::is_ever_on), so a switch that is off now and has
    /// keys that put it on has another digest than one that stays off.
    bool looks_ahead = false;
    /// T = std::string, no options: the name of a node of the list that the output connected at this Wire has one entry
    /// for (Output::entries_of). Compute reads its place (Reads::entry); only that is part of keys, and the name
    /// follows a renamed node. Empty text names none.
    std::string_view names_entry_of = "";
};

/// An attribute that only a connection can feed (mesh, body, material …).
template <class T>
struct Wire {
    std::string_view name;
    std::string_view doc = "";
    bool required = true;
    Affects affects = Affects::result;
    /// Read at the whole frames around the time instead of at the time (Reads::around): a simulation has no others.
    bool whole_frames = false;
};

/// A list of connections, in order.
template <class T>
struct WireList {
    std::string_view name;
    std::string_view doc = "";
    std::size_t min_count = 0;
    Affects affects = Affects::result;
    /// An Input<bool> of the same node. What the values hold aside (ValueTraits::hash_aside) must not be read at times
    /// where that is off, and is part of no frame's key then. Types that hold nothing aside cannot have it; who wants
    /// a whole input to come and go takes Input::when.
    std::string_view aside_when = "";
    /// Read at the graph's first frame as well (Reads::at_start).
    bool with_start = false;
};

template <class T>
struct Output {
    std::string_view name;
    std::string_view doc = "";
    std::string_view unit = "";
    /// A WireList of the same node: the value has one entry for each of its connections, in their order.
    std::string_view entries_of = "";
};

enum class AttributeKind { literal, wire, wire_list, output };

/// Type-erased declaration, as the registry keeps it.
struct AttributeInfo {
    AttributeKind kind = AttributeKind::literal;
    std::string_view name, type_name, unit, doc;
    std::type_index type = std::type_index(typeid(void));
    Value def; ///< literals only
    Limits limits;
    bool required = false, keyable = false;
    std::size_t min_count = 0;
    Affects affects = Affects::result;
    std::vector<std::string_view> options;
    std::vector<Preset> presets;
    FromTiming from_timing = FromTiming::nothing;
    std::string_view when, aside_when; ///< names of switches; empty: always
    bool looks_ahead = false, whole_frames = false, with_start = false;
    std::string_view names_entry_of, entries_of;
    /// Values between two keys are that of the first; options are keyed by their number.
    bool is_stepped() const {
        return kind == AttributeKind::literal && (def.is<bool>() || def.is<std::int64_t>() || def.is<std::string>());
    }
};

template <class T>
AttributeInfo describe(const Input<T>& a) {
    AttributeInfo i;
    i.kind = AttributeKind::literal;
    i.name = a.name, i.unit = a.unit, i.doc = a.doc, i.limits = a.limits;
    i.type_name = ValueTraits<T>::name, i.type = std::type_index(typeid(T));
    i.def = Value::of<T>(a.def);
    i.required = a.required, i.affects = a.affects, i.options = a.options, i.presets = a.presets;
    i.from_timing = a.from_timing, i.when = a.when;
    i.looks_ahead = a.looks_ahead, i.names_entry_of = a.names_entry_of;
    i.keyable = a.keyable && !(std::is_same_v<T, std::string> && a.options.empty()) && !std::is_same_v<T, File> &&
                (!std::is_same_v<T, NumberList> || a.list_keys);
    return i;
}
template <class T>
AttributeInfo describe(const Wire<T>& a) {
    AttributeInfo i;
    i.kind = AttributeKind::wire;
    i.name = a.name, i.doc = a.doc, i.required = a.required, i.affects = a.affects, i.whole_frames = a.whole_frames;
    i.type_name = ValueTraits<T>::name, i.type = std::type_index(typeid(T));
    return i;
}
template <class T>
AttributeInfo describe(const WireList<T>& a) {
    AttributeInfo i;
    i.kind = AttributeKind::wire_list;
    i.name = a.name, i.doc = a.doc, i.min_count = a.min_count, i.required = a.min_count > 0, i.affects = a.affects;
    if constexpr (!requires(Hasher & h, const T& v) { ValueTraits<T>::hash_aside(h, v); })
        if (!a.aside_when.empty()) throw std::logic_error(std::string(a.name) + ": its values hold nothing aside");
    i.aside_when = a.aside_when, i.with_start = a.with_start;
    i.type_name = ValueTraits<T>::name, i.type = std::type_index(typeid(T));
    return i;
}
template <class T>
AttributeInfo describe(const Output<T>& a) {
    AttributeInfo i;
    i.kind = AttributeKind::output;
    i.name = a.name, i.doc = a.doc, i.unit = a.unit, i.entries_of = a.entries_of;
    i.type_name = ValueTraits<T>::name, i.type = std::type_index(typeid(T));
    return i;
}

} // namespace sinew::engine
