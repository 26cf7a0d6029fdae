// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/value_meant.h"

#include "engine/format/typed_text.h"
#include "engine/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

namespace sinew::engine {

namespace {

std::optional<double> number_of(const Json& json) {
    if (const auto* i = json.as<std::int64_t>()) return static_cast<double>(*i);
    if (const auto* d = json.as<double>()) return *d;
    return {};
}

} // namespace

std::string other_word(std::string_view key) {
    constexpr std::pair<std::string_view, std::string_view> others[] = {
        {"interpolation", "interp"}, {"keyframes", "keys"},  {"frames", "keys"}, {"animation", "keys"},
        {"connect", "from"},         {"connection", "from"}, {"source", "from"}, {"plug", "from"},
        {"number", "value"},         {"default", "value"},   {"units", "unit"},  {"note", "comment"}};
    const std::string small = lower_case(key);
    for (const auto& [written, meant] : others)
        if (written == small) return std::string(meant);
    return {};
}

bool is_by_axis(const Json::Object& object) {
    return !object.empty() && std::all_of(object.begin(), object.end(), [](const JsonMember& m) {
        const std::string key = lower_case(m.key);
        return key == "x" || key == "y" || key == "z";
    });
}

std::string axes_form(const Json& json, const Vec3& otherwise) {
    NumberList out(otherwise.begin(), otherwise.end());
    for (const JsonMember& m : *json.as<Json::Object>()) {
        const auto v = number_of(m.value);
        if (!v) return "three numbers: [x, y, z]";
        out[static_cast<std::size_t>(lower_case(m.key).front() - 'x')] = *v;
    }
    return list_text(out);
}

std::string bool_form(const Json& json) {
    const std::string word = json.as<std::string>() ? lower_case(*json.as<std::string>()) : std::string();
    const auto* number = json.as<std::int64_t>();
    if (word == "true" || word == "yes" || word == "on" || word == "1" || (number && *number == 1)) return "write true";
    if (word == "false" || word == "no" || word == "off" || word == "0" || (number && *number == 0))
        return "write false";
    return {};
}

std::string plain_form(const Json& json) {
    if (const auto number = number_of(json)) return "write " + number_text(*number);
    if (const auto* text = json.as<std::string>()) return "write " + json_quoted(*text);
    if (const auto* b = json.as<bool>()) return *b ? "write true" : "write false";
    return {};
}

std::string flat_form(const Json::List& list) {
    constexpr std::size_t most = 12; // beyond that it shows the form only
    NumberList first;
    bool any = false, more = false;
    for (const Json& row : list) {
        const auto* inner = row.as<Json::List>();
        any = any || inner;
        const std::span<const Json> numbers = inner ? std::span<const Json>(*inner) : std::span(&row, 1);
        for (const Json& one : numbers) {
            const auto number = number_of(one);
            if (!number) return any ? "write all numbers in one list" : "";
            more = first.size() == most;
            if (!more) first.push_back(*number);
        }
    }
    if (!any) return {};
    std::string out = list_text(first);
    if (more) out.replace(out.size() - 1, 1, ", …]");
    return "write " + out;
}

std::string decimal_form(std::string text) {
    std::replace(text.begin(), text.end(), ',', '.');
    const auto q = parse_quantity(text);
    if (!q || q->unit.starts_with('.')) return "write decimals behind a dot, lists in brackets";
    if (q->unit.empty()) return "write " + number_text(q->number);
    return "write " + json_quoted(number_text(q->number) + " " + q->unit);
}

std::string interpolation_form(const std::string& word) {
    const std::string small = lower_case(word);
    for (const char* known : {"step", "linear", "smooth"})
        if (small == known) return std::string("write \"") + known + "\"";
    if (small == "stepped" || small == "hold" || small == "constant") return "write \"step\"";
    if (small == "spline" || small == "bezier" || small == "cubic" || small == "auto") return "write \"smooth\"";
    return "use step, linear or smooth";
}

std::string keys_form(const Json& keys) {
    std::vector<std::pair<double, double>> pairs;
    if (const auto* object = keys.as<Json::Object>())
        for (const JsonMember& m : *object) {
            const auto frame = parse_quantity(m.key);
            const auto value = number_of(m.value);
            if (!frame || !frame->unit.empty() || !value) return "write [ [frame, value], … ]";
            pairs.emplace_back(frame->number, *value);
        }
    const auto* list = keys.as<Json::List>();
    for (std::size_t i = 0; list && list->size() % 2 == 0 && i < list->size(); i += 2) {
        const auto frame = number_of((*list)[i]), value = number_of((*list)[i + 1]);
        if (!frame || !value) return {};
        pairs.emplace_back(*frame, *value);
    }
    constexpr std::size_t most = 8; // beyond that it shows the form only
    std::string out;
    for (std::size_t i = 0; i < std::min(pairs.size(), most); ++i)
        out += (out.empty() ? "write [" : ", ") + list_text(NumberList{pairs[i].first, pairs[i].second});
    return out.empty() ? out : out + (pairs.size() > most ? ", …]" : "]");
}

std::string pairs_form(const Json& json) {
    const auto* list = json.as<Json::List>();
    if (!list || list->empty()) return {};
    std::string out;
    for (const Json& one : *list) {
        const auto* pair = one.as<Json::List>();
        if (!pair || pair->size() != 2 || !number_of(pair->front())) return {};
        const auto value = number_of(pair->back());
        if (!value || list->size() > 8) return "[[frame, value], …]";
        out += (out.empty() ? "[" : ", ") + list_text(NumberList{*number_of(pair->front()), *value});
    }
    return out + "]";
}

std::optional<NumberList> colour_meant(std::string_view text) {
    struct Named {
        std::string_view name;
        int rgb;
    };
    constexpr Named named[] = {{"black", 0x000000}, {"white", 0xffffff},   {"grey", 0x808080},   {"gray", 0x808080},
                               {"red", 0xff0000},   {"green", 0x008000},   {"blue", 0x0000ff},   {"yellow", 0xffff00},
                               {"cyan", 0x00ffff},  {"magenta", 0xff00ff}, {"orange", 0xffa500}, {"brown", 0xa52a2a},
                               {"pink", 0xffc0cb},  {"purple", 0x800080}};
    int rgb = -1;
    for (const Named& n : named)
        if (lower_case(text) == n.name) rgb = n.rgb;
    if (text.starts_with('#') && (text.size() == 7 || text.size() == 4)) {
        const std::string_view digits = text.substr(1);
        std::string all;
        for (const char c : digits) all += digits.size() == 3 ? std::string(2, c) : std::string(1, c);
        const auto end = std::from_chars(all.data(), all.data() + all.size(), rgb, 16).ptr;
        if (end != all.data() + all.size()) return {};
    }
    if (rgb < 0) return {};
    NumberList out;
    for (const int shift : {16, 8, 0}) out.push_back(std::round(1000 * ((rgb >> shift) & 255) / 255.0) / 1000);
    return out;
}

std::string preset_elsewhere(const NodeType& type, const AttributeInfo& input, const Json& json) {
    const auto* text = json.as<std::string>();
    if (!text || !input.presets.empty() || !(input.def.is<double>() || input.def.is<NumberList>())) return {};
    std::vector<std::string> holders;
    for (const AttributeInfo& a : type.inputs)
        for (const Preset& p : a.presets)
            if (p.name == *text) holders.emplace_back(a.name);
    if (holders.empty()) return {};
    return "write a number; " + json_quoted(*text) + " is a preset of " + listed(holders) + " alone";
}

std::string wires_hint(const NodeType& type, const AttributeInfo& input, const Json& json) {
    const auto* list = json.as<Json::List>();
    const auto is_connection = [](const Json& one) { return one.find("from") != nullptr; };
    if (input.kind != AttributeKind::literal || !list || list->empty() ||
        !std::all_of(list->begin(), list->end(), is_connection))
        return {};
    std::vector<std::string> wires;
    for (const AttributeInfo& a : type.inputs)
        if (a.kind == AttributeKind::wire_list) wires.emplace_back(a.name);
    const std::string near = nearest_name(input.name, wires);
    return near.empty() ? near : "did you mean \"" + near + "\"?";
}

} // namespace sinew::engine
