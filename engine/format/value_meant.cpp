// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/value_meant.h"

#include "engine/format/typed_text.h"
#include "engine/text.h"
#include "engine/units.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
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

bool begins_as_number(std::string_view text) {
    text.remove_prefix(std::min(text.size(), text.find_first_not_of(" \t+-.")));
    return !text.empty() && text.front() >= '0' && text.front() <= '9';
}

bool is_rounded_to_zero(std::string_view number) {
    double read = 0;
    const std::string_view digits = number.substr(0, number.find_first_of("eE"));
    if (number.empty() || digits.find_first_of("123456789") == std::string_view::npos ||
        digits.find_first_not_of("+-.0123456789") != std::string_view::npos)
        return false;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), read);
    return error == std::errc::result_out_of_range;
}

std::string rounded_to_zero(const std::string& number, const std::string& wrong) {
    return number + " is too small for a number, so it is 0, and " + wrong;
}

std::string include_form(const Json& json, const Json* nodes, const std::string& prefix) {
    const auto* list = json.as<Json::List>();
    if (!prefix.empty() && list && list->size() != 1) return {};
    std::string out;
    std::vector<std::string> taken;
    const auto is_taken = [&](const std::string& name) {
        return (nodes && nodes->find(name)) || std::find(taken.begin(), taken.end(), name) != taken.end();
    };
    for (const Json& one : list ? std::span<const Json>(*list) : std::span(&json, 1)) {
        const Json* file = one.find("file");
        const auto* path = (file ? *file : one).as<std::string>();
        if (!path || path->empty()) return {};
        std::string name = prefix.empty() ? std::filesystem::path(*path).stem().string() : prefix;
        std::replace(name.begin(), name.end(), '.', '_');
        while (is_taken(name)) name += "_";
        taken.push_back(name);
        out += (out.empty() ? "" : ", ") + json_quoted(name) + ": { \"file\": " + json_quoted(*path) + " }";
    }
    if (out.empty()) return out;
    return "write " + (prefix.empty() ? "{ " + out + " }" : out);
}

std::string text_form(const Json& json) {
    const auto* list = json.as<Json::List>();
    std::string out;
    for (const Json& one : list ? std::span<const Json>(*list) : std::span(&json, 1)) {
        const auto number = number_of(one);
        const auto* text = one.as<std::string>();
        if (!number && !text) return {};
        out += (out.empty() ? "" : " ") + (number ? number_text(*number) : *text);
    }
    return out.empty() ? out : "write " + json_quoted(out);
}

std::string grouped_form(const std::string& text) {
    constexpr std::string_view separators[] = {" ", ",", "'", "_", "\u2019", "\u00a0", "\u202f"};
    constexpr std::string_view digits = "0123456789";
    std::size_t at = std::min(text.size(), text.find_first_of(digits));
    std::string plain = text.substr(0, at);
    const auto digits_from = [&](std::size_t from) {
        return std::min(text.size(), text.find_first_not_of(digits, from)) - from;
    };
    const std::size_t first = digits_from(at);
    if (first == 0 || first > 3) return {};
    plain += text.substr(at, first), at += first;
    const auto separator = std::find_if(std::begin(separators), std::end(separators), [&](std::string_view s) {
        return std::string_view(text).substr(at).starts_with(s);
    });
    if (separator == std::end(separators)) return {};
    std::size_t groups = 0;
    while (std::string_view(text).substr(at).starts_with(*separator) && digits_from(at + separator->size()) == 3) {
        plain += text.substr(at + separator->size(), 3);
        at += separator->size() + 3, ++groups;
    }
    plain += text.substr(at);
    const auto q = groups > 0 ? parse_quantity(plain) : std::nullopt;
    if (!q || !(q->unit.empty() || parse_unit(q->unit))) return {};
    const auto form = [](double number, const std::string& unit) {
        return unit.empty() ? number_text(number) : json_quoted(number_text(number) + " " + unit);
    };
    const auto decimal = *separator == "," && groups == 1
                             ? parse_quantity(std::string(text).replace(first + text.find_first_of(digits), 1, "."))
                             : std::nullopt;
    return "write " + form(q->number, q->unit) +
           (decimal ? ", or " + form(decimal->number, decimal->unit) + " if the comma stands for a dot" : "");
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

namespace {

/// What is typed where three numbers are expected, in the unit of the input; empty if there is no number in it.
NumberList numbers_typed(const AttributeInfo& input, const Json& json) {
    NumberList out;
    if (const auto one = number_of(json)) return {*one};
    const auto* list = json.as<Json::List>();
    for (std::size_t i = 0; list && i < list->size(); ++i)
        if (const NumberList one = numbers_typed(input, (*list)[i]); one.size() == 1) out.push_back(one.front());
    const auto* text = json.as<std::string>();
    if (!text) return out;
    out = numbers_in(*text);
    const auto q = out.empty() ? parse_quantity(*text) : std::nullopt;
    if (!q) return out;
    const std::string meant = unit_meant(q->unit, input.unit);
    const auto factor = q->unit.empty() ? std::optional(1.0) : unit_factor(meant.empty() ? q->unit : meant, input.unit);
    if (factor) out.push_back(q->number * *factor);
    return out;
}

} // namespace

std::string vector_form(const AttributeInfo& input, const Json& json) {
    const Vec3& usual = input.def.as<Vec3>();
    const auto zeros = std::count(usual.begin(), usual.end(), 0.0);
    const bool is_colour = input.limits.min == 0 && input.limits.max == 1;
    const auto* text = json.as<std::string>();
    if (const auto colour = text && is_colour ? colour_meant(*text) : std::nullopt)
        return "write " + list_text(*colour);
    if (const std::string word = text ? lower_case(*text) : ""; zeros > 1 && (word == "off" || word == "none"))
        return "write [0, 0, 0]";
    NumberList typed = numbers_typed(input, json);
    if (typed.size() > 3) typed.resize(3); // a fourth is the opacity, or a weight
    if (is_colour) typed = colour_of_bytes(typed).value_or(typed);
    if (typed.empty()) return "write three numbers: [x, y, z]";
    if (typed.size() > 1) {
        for (std::size_t i = typed.size(); i < 3; ++i) typed.push_back(usual[i]);
        return "write " + list_text(typed);
    }
    const double v = typed.front();
    const std::string all = list_text(NumberList{v, v, v}) + " if all of them are " + number_text(v);
    if (zeros == 2 && v != 0) { // gravity has one part that is not zero, and a length alone is meant for that
        NumberList along(usual.begin(), usual.end());
        for (double& part : along) part = part == 0 ? 0 : std::copysign(std::abs(v), part);
        return "write three numbers: " + list_text(along);
    }
    return "write three numbers: " +
           (zeros == 3 && !is_colour && v != 0 ? list_text(NumberList{v, 0, 0}) + " if it is the first, " : "") + all;
}

std::optional<NumberList> colour_of_bytes(std::span<const double> numbers) {
    bool any = false;
    for (const double v : numbers) {
        if (!(v >= 0 && v <= 255)) return {};
        any = any || v > 1;
    }
    if (!any || numbers.size() != 3) return {};
    NumberList out;
    for (const double v : numbers) out.push_back(std::round(1000 * v / 255) / 1000);
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
