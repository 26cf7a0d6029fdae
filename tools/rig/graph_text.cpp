// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/graph_text.h"

#include "engine/diagnostics.h"
#include "engine/format/layout.h"
#include "engine/text.h"
#include "tools/cli/json_text.h"
#include "tools/rig/parts.h"

#include <cstdio>
#include <filesystem>
#include <sstream>

namespace sinew::rig {

namespace {

constexpr std::size_t width = 120;

std::string wrapped(const std::string& text, const std::string& indent) {
    std::string out;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::string row = indent + "//";
        std::istringstream words(line);
        for (std::string word; words >> word;) {
            if (row.size() + 1 + word.size() > width) {
                out += row + "\n";
                row = indent + "//";
            }
            row += " " + word;
        }
        out += row + "\n";
    }
    return out;
}

std::string digits_of(double value, int digits) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    std::string out = text;
    if (const std::size_t at = out.find("e+0"); at != out.npos) out.erase(at + 1, 2); // 1e6, not 1e+06
    return out;
}

} // namespace

std::string number(double value) { return digits_of(value, 6); }
std::string coordinate(double value) { return digits_of(value, 9); }

std::string text_of(std::string_view text) { return cli::json_text(nlohmann::json(std::string(text))); }

std::string wire(const std::string& node, const std::string& output) {
    return "{\"from\": " + text_of(node + "." + output) + "}";
}

std::string list(const std::vector<std::string>& items) {
    std::string out;
    for (const std::string& item : items) out += (out.empty() ? "" : ", ") + item;
    return "[" + out + "]";
}

std::string vector(const solver::Vec3& v) { return list({number(v.x()), number(v.y()), number(v.z())}); }

std::string rise(int start, int end, double value) {
    return "{\"keys\": [[" + std::to_string(start) + ", 0], [" + std::to_string(end) + ", " + number(value) +
           "]], \"interp\": \"smooth\"}";
}

std::string rough(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

void GraphText::comment(const std::string& text) { items_.push_back({wrapped(text, "    ")}); }
void GraphText::blank() { items_.push_back({"\n"}); }

void GraphText::node(const std::string& name, const std::string& type, const Inputs& inputs) {
    std::string text;
    for (const auto& [input, value] : inputs) text += (text.empty() ? "" : ", ") + text_of(input) + ": " + value;
    items_.push_back(
        {"    " + text_of(name) + ": {\"type\": " + text_of(type) + ", \"inputs\": {" + text + "}}", true});
}

std::string GraphText::file(const std::string& head, int start, int end, int fps) const {
    std::string out = "{\n  \"format\": \"sinew 1\",\n" + wrapped(head, "  ");
    out += "  \"timing\": {\"fps\": " + std::to_string(fps) + ", \"start\": " + std::to_string(start) +
           ", \"end\": " + std::to_string(end) + "},\n  \"nodes\": {\n";
    std::size_t last = 0;
    for (std::size_t i = 0; i < items_.size(); ++i)
        if (items_[i].is_node) last = i;
    for (std::size_t i = 0; i < items_.size(); ++i)
        out += items_[i].is_node ? items_[i].text + (i == last ? "\n" : ",\n") : items_[i].text;
    // Comments name files and options as they were typed.
    return engine::laid_out(engine::utf8_text(out + "  }\n}\n"));
}

std::string path_from(const std::string& folder, const std::string& file) {
    namespace fs = std::filesystem;
    // What is not there yet stays as it is written, so it is made absolute first.
    const fs::path from = fs::weakly_canonical(fs::absolute(folder.empty() ? "." : folder)),
                   to = fs::weakly_canonical(fs::absolute(file));
    const fs::path relative = to.lexically_relative(from);
    std::string out = (relative.empty() ? to : relative).generic_string();
    if (const std::string shown = engine::utf8_text(out); shown != out)
        throw engine::Failure(say(engine::Severity::error, "DG164", "",
                                  "a graph is written in UTF-8 and cannot name '" + shown + "'",
                                  "Rename the file or folder, or convert its name to UTF-8 (convmv)."));
    return out;
}

} // namespace sinew::rig
