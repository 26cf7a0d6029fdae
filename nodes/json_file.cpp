// Reads JSON data files; nlohmann's exceptions end here.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/json_file.h"

#include "solver/error.h"

#include <algorithm>
#include <cmath>

namespace sinew::nodes {

using Json = nlohmann::json;
using solver::Error;

std::string read_text(const engine::FileAccess& files, const std::string& path, std::uintmax_t most) {
    auto read = files.read(path, most);
    if (auto* fault = std::get_if<engine::FileFault>(&read)) throw Error(fault->code, fault->message, fault->hint);
    return std::move(std::get<std::string>(read));
}

std::string fault_of(const Json::exception& e) {
    const std::string says = e.what();
    const std::size_t after = says.find("] ");
    return after == says.npos ? says : says.substr(after + 2);
}

namespace {

/// The next place from `i` on that is not in quotes; text.size() if there is none. `i` is not in quotes itself.
std::size_t next_unquoted(std::string_view text, std::size_t i) {
    while (i < text.size() && text[i] == '"') {
        for (++i; i < text.size() && text[i] != '"'; ++i)
            if (text[i] == '\\') ++i;
        ++i;
    }
    return std::min(i, text.size());
}

} // namespace

bool is_too_deep(std::string_view text) {
    int depth = 0;
    for (std::size_t i = next_unquoted(text, 0); i < text.size(); i = next_unquoted(text, i + 1)) {
        const char c = text[i];
        if (c == '[' || c == '{') {
            if (++depth > most_json_depth) return true;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return false;
}

namespace {

/// Of what a file holds, in a message.
constexpr std::size_t longest_shown = 40;

std::string shortened(std::string text) {
    return text.size() > longest_shown ? text.substr(0, longest_shown) + " …" : text;
}

/// The line, from 1, where a number stands first: as a whole, and not in quotes.
std::ptrdiff_t line_of_number(std::string_view text, std::string_view number) {
    constexpr std::string_view of_numbers = "+-.0123456789Ee";
    std::size_t begin = 0;
    for (std::size_t i = next_unquoted(text, 0); i < text.size(); i = next_unquoted(text, i + 1)) {
        if (of_numbers.find(text[i]) == of_numbers.npos) continue;
        const std::size_t end = std::min(text.find_first_not_of(of_numbers, i), text.size());
        if (text.substr(i, end - i) == number) {
            begin = i;
            break;
        }
        i = end - 1;
    }
    return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n');
}

} // namespace

Json parse_json(std::string_view text, const std::string& path) {
    if (is_too_deep(text))
        throw Error("IO403",
                    "'" + path + "' has more than " + std::to_string(most_json_depth) + " brackets in brackets",
                    "Write plain lists of numbers.");
    try {
        return Json::parse(text);
    } catch (const Json::out_of_range& e) { // it names the number, and not the place
        const std::string says = e.what();
        const std::size_t first = says.find('\''), last = says.rfind('\'');
        if (first == says.npos || last <= first + 1)
            throw Error("IO403", "'" + path + "': " + fault_of(e), "Correct the file.");
        const std::string number = says.substr(first + 1, last - first - 1);
        throw Error("IO403",
                    "'" + path + "' line " + std::to_string(line_of_number(text, number)) + ": " + shortened(number) +
                        " is too large for a number",
                    "Correct the file at that place.");
    } catch (const Json::exception& e) {
        throw Error("IO403", "'" + path + "' is not JSON: " + fault_of(e), "Correct the file at that place.");
    }
}

Json read_json(const engine::FileAccess& files, const std::string& path) {
    return parse_json(read_text(files, path, most_json_bytes), path);
}

namespace {

/// What a pointer to nothing should have been.
std::string pointer_meant(const Json& json, const std::string& pointer) {
    if (json.is_object() && json.contains(pointer)) return "Write \"/" + pointer + "\".";
    std::string out = "Write a JSON pointer into the file, for example /attachments/0/vertices.";
    if (!json.is_object() || json.empty()) return out;
    constexpr std::size_t shown = 5;
    std::size_t count = 0;
    out += " It begins with";
    for (const auto& [key, value] : json.items()) {
        if (++count > shown) {
            out += ", …";
            break;
        }
        out += (count > 1 ? ", /" : " /") + shortened(key);
    }
    return out + ".";
}

} // namespace

const Json& part_of(const Json& json, const std::string& pointer, const std::string& path) {
    try {
        return json.at(Json::json_pointer(pointer));
    } catch (const Json::exception&) {
        throw Error("IO403", "'" + path + "' has nothing at \"" + pointer + "\"", pointer_meant(json, pointer));
    }
}

namespace {

/// `place`: of the list, as a JSON pointer from the outermost one on.
void collect(const Json& json, engine::NumberList& out, const std::string& place, const std::string& what,
             const std::string& path) {
    for (std::size_t i = 0; i < json.size(); ++i) {
        const Json& entry = json[i];
        if (entry.is_array()) {
            collect(entry, out, place + "/" + std::to_string(i), what, path);
        } else if (entry.is_number() && std::isfinite(entry.get<double>())) {
            out.push_back(entry.get<double>());
        } else {
            const std::string shown = shortened(entry.dump(-1, ' ', true)); // in ASCII, so that it can be cut anywhere
            throw Error("IO403", "'" + path + "': " + what + " holds " + shown + " at \"" + place + "/" +
                                     std::to_string(i) + "\", which is not a number");
        }
    }
}

} // namespace

engine::NumberList numbers_of(const Json& json, const std::string& what, const std::string& path) {
    if (!json.is_array()) throw Error("IO403", "'" + path + "': " + what + " is not a list of numbers");
    engine::NumberList out;
    collect(json, out, "", what, path);
    return out;
}

} // namespace sinew::nodes
