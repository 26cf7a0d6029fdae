// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/graph_rows.h"

#include "engine/text.h"
#include "nodes/rest_shapes.h"
#include "nodes/values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <typeindex>

namespace sinew::viewer {

using engine::Binding;
using engine::Plug;

namespace {

constexpr double head_height = 38, row_height = 17, foot_height = 7;
constexpr double letter_width = 6.3, least_width = 130, most_width = 340;
constexpr std::size_t longest_text = 26;

std::size_t letters(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string shortened(const std::string& text) {
    if (letters(text) <= longest_text) return text;
    std::string out;
    std::size_t count = 0;
    for (std::size_t i = 0; i < text.size() && count < longest_text - 1; ++count) {
        const std::size_t length = std::max<std::size_t>(1, engine::utf8_length(text, i));
        out += text.substr(i, length);
        i += length;
    }
    return out + "…";
}

/// Four digits are enough to read.
std::string short_number(double v) {
    if (v == 0 || !std::isfinite(v)) return engine::number_text(v);
    const double unit = std::pow(10.0, 3 - std::floor(std::log10(std::abs(v))));
    const double rounded = std::isfinite(unit) && unit > 0 ? std::round(v * unit) / unit : v;
    return engine::number_text(std::abs(rounded) >= 1e4 && std::abs(rounded) < 1e15 ? std::round(v) : rounded);
}

/// "18.4 kPa" for 18400 Pa; other units as they are.
std::string with_unit(double v, std::string_view unit) {
    if (unit.empty() || unit == "1") return short_number(v);
    if (unit == "Pa" && std::abs(v) >= 1e6) return short_number(v / 1e6) + " MPa";
    if (unit == "Pa" && std::abs(v) >= 1e3) return short_number(v / 1e3) + " kPa";
    return short_number(v) + " " + std::string(unit);
}

std::string value_text(const engine::Value& v, std::string_view unit) {
    if (v.is<bool>()) return v.as<bool>() ? "on" : "off";
    if (v.is<std::int64_t>()) return engine::number_text(v.as<std::int64_t>());
    if (v.is<double>()) return with_unit(v.as<double>(), unit);
    if (v.is<std::string>()) return v.as<std::string>();
    if (v.is<engine::File>()) return std::filesystem::path(v.as<engine::File>().path).filename().string();
    if (v.is<engine::Vec3>()) {
        const engine::Vec3& p = v.as<engine::Vec3>();
        return short_number(p[0]) + " " + short_number(p[1]) + " " + short_number(p[2]);
    }
    if (v.is<engine::NumberList>()) {
        const engine::NumberList& list = v.as<engine::NumberList>();
        if (list.size() == 1) return short_number(list.front());
        return std::to_string(list.size()) + " numbers";
    }
    if (v.is<engine::Matrix4>()) return "4 × 4";
    return std::string(v.type_name());
}

std::string curve_text(const engine::Curve& curve) {
    const std::string count = std::to_string(curve.keys.size()) + (curve.keys.size() == 1 ? " key" : " keys");
    if (curve.width() != 1) return count;
    const auto [least, most] =
        std::minmax_element(curve.keys.begin(), curve.keys.end(),
                            [](const engine::Key& a, const engine::Key& b) { return a.value[0] < b.value[0]; });
    return count + ", " + short_number(least->value[0]) + " … " + short_number(most->value[0]);
}

std::vector<Plug> sources(const Binding& binding) {
    if (const auto* plug = std::get_if<Plug>(&binding)) return {*plug};
    if (const auto* list = std::get_if<std::vector<Plug>>(&binding)) return *list;
    return {};
}

/// Attributes in the order in which the file lists them; those of an edit follow.
std::vector<std::string> attributes_of(const engine::Node& node) {
    std::vector<std::string> out;
    for (const std::string& name : node.input_order)
        if (node.inputs.contains(name)) out.push_back(name);
    for (const auto& [name, binding] : node.inputs)
        if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
    return out;
}

GraphRow row_of(const engine::Node& node, const std::string& attribute) {
    GraphRow row;
    row.attribute = attribute;
    const engine::AttributeInfo* info = node.type ? node.type->find_input(attribute) : nullptr;
    const Binding& binding = node.inputs.find(attribute)->second;
    if (const auto* value = std::get_if<engine::Value>(&binding))
        row.text = value_text(*value, info ? info->unit : std::string_view());
    else if (const auto* curve = std::get_if<engine::Curve>(&binding))
        row.text = curve_text(*curve);
    else if (const auto* list = std::get_if<std::vector<Plug>>(&binding))
        row.text = "[" + std::to_string(list->size()) + "]";
    row.text = shortened(row.text);
    return row;
}

void measure(GraphBox& box) {
    std::size_t widest = letters(box.type) + 2;
    for (const GraphRow& row : box.rows)
        widest = std::max(widest, letters(row.attribute) + letters(row.text) + (row.text.empty() ? 2 : 4));
    const double title = 8.1 * static_cast<double>(letters(box.name)) + 20; // bold and larger
    box.width = std::clamp(std::max(title, letter_width * static_cast<double>(widest) + 16), least_width, most_width);
    box.height = head_height + row_height * static_cast<double>(box.rows.size()) + foot_height;
}

} // namespace

std::string family_of(const engine::NodeType* type) {
    if (!type) return "unknown";
    const std::type_index gives = type->outputs.empty() ? std::type_index(typeid(void)) : type->outputs.front().type;
    const auto is_one_of = [gives](std::initializer_list<std::type_index> types) {
        return std::find(types.begin(), types.end(), gives) != types.end();
    };
    if (is_one_of({typeid(nodes::MeshList)})) return "solver";
    if (is_one_of({typeid(nodes::Body)})) return "body";
    if (is_one_of({typeid(nodes::Material), typeid(nodes::Fiber), typeid(nodes::LineOfAction),
                   typeid(nodes::RestShapeTarget)}))
        return "matter";
    if (is_one_of({typeid(nodes::Attachment), typeid(nodes::Force)})) return "attachment";
    if (is_one_of({typeid(engine::NumberList)})) return "paint";
    if (is_one_of({typeid(double), typeid(engine::Matrix4), typeid(nodes::CurvePoints)})) return "value";
    return "geometry";
}

GraphDrawing graph_boxes(const engine::Graph& graph) {
    GraphDrawing out;
    std::map<std::string, int> index;
    for (const std::string& name : graph.node_names()) {
        const engine::Node& node = *graph.find(name);
        GraphBox box;
        box.name = name, box.type = node.type_name;
        box.family = family_of(node.type);
        for (const std::string& attribute : attributes_of(node)) box.rows.push_back(row_of(node, attribute));
        index[name] = static_cast<int>(out.boxes.size());
        out.boxes.push_back(std::move(box));
    }
    for (const std::string& name : graph.node_names()) {
        const engine::Node& node = *graph.find(name);
        const int to = index[name];
        for (const auto& [attribute, binding] : node.inputs)
            for (const Plug& plug : sources(binding)) {
                const auto from = index.find(plug.node);
                if (from == index.end()) continue;
                auto& to_rows = out.boxes[static_cast<std::size_t>(to)].rows;
                auto& from_rows = out.boxes[static_cast<std::size_t>(from->second)].rows;
                const auto row = [](std::vector<GraphRow>& rows, const std::string& wanted, bool is_output) {
                    const auto it = std::find_if(rows.begin(), rows.end(), [&](const GraphRow& r) {
                        return r.attribute == wanted && r.is_output == is_output;
                    });
                    if (it != rows.end()) return static_cast<std::size_t>(it - rows.begin());
                    rows.push_back({wanted, "", is_output});
                    return rows.size() - 1;
                };
                const std::size_t from_row = row(from_rows, plug.attribute, true);
                const std::size_t to_row = row(to_rows, attribute, false);
                out.wires.push_back({from->second, to, from_row, to_row});
            }
    }
    for (GraphBox& box : out.boxes) measure(box);
    return out;
}

} // namespace sinew::viewer
