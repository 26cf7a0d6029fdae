// Results as rows of text, for a terminal and for a page.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sinew::bench {

struct Table {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows; ///< as many cells as columns
};

/// Columns as wide as their longest cell.
std::string as_text(const Table& table);
std::string as_markdown(const Table& table);

/// Objects with the same keys as comma-separated values under a line of keys. Words stand in quotes; what is not a
/// number stays empty.
std::string as_csv(const nlohmann::ordered_json& rows);

/// A value of a row, null where there is none.
nlohmann::ordered_json or_null(const std::optional<double>& value);

/// `digits` significant digits, the shortest way; "-" for what is not a number.
std::string number(double value, int digits = 4);

} // namespace sinew::bench
