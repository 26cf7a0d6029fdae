// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/curve_file.h"

#include "nodes/json_file.h"
#include "solver/error.h"
#include "solver/mesh/text_scanner.h"

namespace sinew::nodes {

engine::NumberList parse_curve(std::string_view text, const std::string& path, const std::string& pointer) {
    if (path.ends_with(".json")) {
        const nlohmann::json json = parse_json(text, path);
        return numbers_of(part_of(json, pointer, path), "the curve", path);
    }
    engine::NumberList out;
    try {
        for (solver::TextScanner numbers(text, path); !numbers.at_end();) out.push_back(numbers.number("a coordinate"));
    } catch (const solver::Error& e) {
        throw solver::Error("IO403", e.what(), "Write three numbers a line.");
    }
    return out;
}

} // namespace sinew::nodes
