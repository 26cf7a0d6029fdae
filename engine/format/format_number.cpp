// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/format/format_number.h"

#include "engine/format/key_meant.h"
#include "engine/format/migrate.h"
#include "engine/text.h"

#include <charconv>

namespace sinew::engine {

FormatNumber format_number(const Json& root) {
    const std::string wanted = "write \"format\": \"sinew " + std::to_string(current_format) + "\"";
    if (!root.as<Json::Object>())
        return {0, "DG004", root.begin, "", "a graph file is one JSON object, found " + std::string(root.kind()), ""};
    const Json* format = root.find("format");
    if (!format) {
        if (const JsonMember* meant = meant_as(root, "format", Level::document))
            return {0,
                    "DG004",
                    meant->key_begin,
                    pointer_token(meant->key),
                    "the key \"format\" is missing; there is " + json_quoted(meant->key),
                    wanted + " in its place"};
        return {0, "DG004", root.begin, "", "the key \"format\" is missing", wanted};
    }
    const auto* text = format->as<std::string>();
    const std::string_view digits = text && text->rfind("sinew ", 0) == 0 ? std::string_view(*text).substr(6) : "";
    int number = 0;
    const auto [end, ec] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (digits.empty() || ec != std::errc() || end != digits.data() + digits.size())
        return {number,
                "DG004",
                format->begin,
                "/format",
                (text ? json_quoted(*text) : std::string(format->kind())) + " is not a Sinew format",
                wanted};
    if (number > current_format)
        return {number,
                "DG005",
                format->begin,
                "/format",
                "the file has format " + std::to_string(number) + ", this program reads up to " +
                    std::to_string(current_format),
                "use a newer program"};
    if (number < current_format && !migration_from(number))
        return {number,
                "DG006",
                format->begin,
                "/format",
                "there is no way from format " + std::to_string(number) + " to " + std::to_string(current_format),
                wanted};
    return {number};
}

} // namespace sinew::engine
