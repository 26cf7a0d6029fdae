// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace sinew::bench {

namespace {

/// Characters, not bytes: every UTF-8 character has one byte that does not begin with the bits 10.
std::size_t width(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

} // namespace

std::string as_text(const Table& table) {
    std::vector<std::size_t> widths;
    for (const std::string& c : table.columns) widths.push_back(width(c));
    for (const auto& row : table.rows)
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width(row[i]));
    std::string out;
    const auto line = [&](const std::vector<std::string>& cells) {
        for (std::size_t i = 0; i < cells.size(); ++i) {
            out += cells[i];
            if (i + 1 < cells.size()) out += std::string(widths[i] - width(cells[i]) + 2, ' ');
        }
        out += '\n';
    };
    line(table.columns);
    for (const auto& row : table.rows) line(row);
    return out;
}

std::string as_markdown(const Table& table) {
    std::string out;
    const auto line = [&](const std::vector<std::string>& cells) {
        out += '|';
        for (const std::string& cell : cells) {
            out += ' ';
            for (const char c : cell) out += c == '|' ? std::string("\\|") : std::string(1, c);
            out += " |";
        }
        out += '\n';
    };
    line(table.columns);
    line(std::vector<std::string>(table.columns.size(), "---"));
    for (const auto& row : table.rows) line(row);
    return out;
}

std::string as_csv(const nlohmann::ordered_json& rows) {
    std::string out;
    for (const nlohmann::ordered_json& row : rows) {
        std::string names, cells;
        for (const auto& [key, value] : row.items()) {
            const std::string comma = names.empty() ? "" : ",";
            const bool unknown = value.is_number_float() && !std::isfinite(value.get<double>());
            names += comma + key;
            cells += comma + (unknown             ? std::string()
                              : value.is_string() ? "\"" + value.get<std::string>() + "\""
                                                  : value.dump());
        }
        if (out.empty()) out = names + "\n";
        out += cells + "\n";
    }
    return out;
}

nlohmann::ordered_json or_null(const std::optional<double>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

std::string number(double value, int digits) {
    if (!std::isfinite(value)) return "-";
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

} // namespace sinew::bench
