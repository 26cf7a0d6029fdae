// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/curve_file.h"

#include "nodes/json_file.h"
#include "solver/error.h"

#include <locale>
#include <sstream>

namespace sinew::nodes {

engine::NumberList parse_curve(std::string_view text, const std::string& path, const std::string& pointer) {
    if (path.ends_with(".json")) {
        const nlohmann::json json = parse_json(text, path);
        return numbers_of(part_of(json, pointer, path), "the curve", path);
    }
    std::istringstream numbers{std::string(text)};
    numbers.imbue(std::locale::classic());
    engine::NumberList out;
    for (double number = 0; numbers >> number;) out.push_back(number);
    if (!numbers.eof())
        throw solver::Error("IO403", "'" + path + "' holds more than numbers", "Write three numbers a line.");
    return out;
}

} // namespace sinew::nodes
