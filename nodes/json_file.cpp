// Reads JSON data files; nlohmann's exceptions end here.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/json_file.h"

#include "solver/error.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace sinew::nodes {

using Json = nlohmann::json;
using solver::Error;

std::string read_text(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw Error("IO401", "there is no file '" + path + "'", "Relative paths count from the graph file's folder.");
    if (std::filesystem::is_directory(path, ignored))
        throw Error("IO402", "'" + path + "' is a folder", "Name a file in it.");
    if (!std::filesystem::is_regular_file(path, ignored))
        throw Error("IO402", "'" + path + "' is a pipe or a device, not a file", "Name a file.");
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || in.bad()) throw Error("IO402", "'" + path + "' cannot be read", "Check its permissions.");
    return std::move(text).str();
}

std::string fault_of(const Json::exception& e) {
    const std::string says = e.what();
    const std::size_t after = says.find("] ");
    return after == says.npos ? says : says.substr(after + 2);
}

Json read_json(const std::string& path) {
    const std::string text = read_text(path);
    try {
        return Json::parse(text);
    } catch (const Json::exception& e) {
        throw Error("IO403", "'" + path + "' is not JSON: " + fault_of(e), "Correct the file at that place.");
    }
}

const Json& part_of(const Json& json, const std::string& pointer, const std::string& path) {
    try {
        return json.at(Json::json_pointer(pointer));
    } catch (const Json::exception&) {
        throw Error("IO403", "'" + path + "' has nothing at \"" + pointer + "\"",
                    "Write a JSON pointer into the file, for example /attachments/0/vertices.");
    }
}

namespace {

/// Of what a file holds, in a message.
constexpr std::size_t longest_shown = 40;

void collect(const Json& json, engine::NumberList& out, const std::string& what, const std::string& path) {
    for (const Json& entry : json) {
        if (entry.is_array()) {
            collect(entry, out, what, path);
        } else if (entry.is_number() && std::isfinite(entry.get<double>())) {
            out.push_back(entry.get<double>());
        } else {
            std::string shown = entry.dump(-1, ' ', true); // in ASCII, so that it can be cut anywhere
            if (shown.size() > longest_shown) shown = shown.substr(0, longest_shown) + " …";
            throw Error("IO403", "'" + path + "': " + what + " holds " + shown + ", which is not a number");
        }
    }
}

} // namespace

engine::NumberList numbers_of(const Json& json, const std::string& what, const std::string& path) {
    if (!json.is_array()) throw Error("IO403", "'" + path + "': " + what + " is not a list of numbers");
    engine::NumberList out;
    collect(json, out, what, path);
    return out;
}

} // namespace sinew::nodes
