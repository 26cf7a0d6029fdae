// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/command.h"

#include <algorithm>
#include <sstream>

namespace sinew::cli {

namespace {

constexpr std::size_t page_width = 100;

std::string flag_word(const Flag& flag) {
    std::string word = flag.letter ? std::string{'-', flag.letter} + ", " : "";
    word += flag.name;
    if (!flag.value.empty()) word += " " + std::string(flag.value);
    return word;
}

/// Appends `words` broken at spaces so that no line passes the page width; further lines start at `indent`.
void wrap(std::string& line, std::string_view words, std::size_t indent, std::string& out) {
    std::istringstream in{std::string(words)};
    std::string word;
    for (bool first = true; in >> word; first = false) {
        if (!first && line.size() + 1 + word.size() > page_width) {
            out += line + "\n";
            line.assign(indent, ' ');
            line += word;
        } else {
            line += (first ? "" : " ") + word;
        }
    }
    out += line + "\n";
}

struct Row {
    std::string left;
    std::string_view right;
};

/// Two columns, the right one wrapped.
std::string table(const std::vector<Row>& rows) {
    std::size_t width = 0;
    for (const Row& row : rows) width = std::max(width, row.left.size());
    std::string out;
    for (const Row& row : rows) {
        std::string line = "  " + row.left + std::string(width - row.left.size() + 2, ' ');
        wrap(line, row.right, width + 4, out);
    }
    return out;
}

} // namespace

std::string usage_line(const Command& command) {
    std::string line = "sinew " + std::string(command.name), words, out;
    for (const Operand& o : command.operands)
        words += (o.required ? std::string(o.name) : "[" + std::string(o.name) + "]") + (o.repeats ? "… " : " ");
    for (const Flag& f : command.flags) {
        // \x01 stands for a space at which the line must not break.
        words += "[" + std::string(f.name) + (f.value.empty() ? "" : "\x01" + std::string(f.value)) +
                 (f.repeats ? "]… " : "] ");
    }
    const std::size_t indent = line.size() + 1;
    line += " ";
    wrap(line, words, indent, out);
    std::replace(out.begin(), out.end(), '\x01', ' ');
    return out;
}

std::string help_text(const Command& command) {
    std::string out = "sinew " + std::string(command.name) + ": ";
    out += command.summary;
    out += "\n\nUsage: " + usage_line(command);
    std::vector<Row> rows;
    for (const Operand& o : command.operands) rows.push_back({std::string(o.name), o.doc});
    if (!rows.empty()) out += "\n" + table(rows);
    rows.clear();
    for (const Flag& f : command.flags) rows.push_back({flag_word(f), f.doc});
    rows.push_back({"--help", "print this text"});
    out += "\n" + table(rows) + "\nExample:\n";
    std::istringstream lines{std::string(command.example)};
    for (std::string line; std::getline(lines, line);) out += "  " + line + "\n";
    return out;
}

std::string overview(const std::vector<Command>& commands) {
    std::string out = "sinew: a soft-tissue simulator\n\nUsage: sinew COMMAND …\n\n";
    std::vector<Row> rows;
    for (const Command& c : commands) rows.push_back({std::string(c.name), c.summary});
    out += table(rows);
    out += "\n`sinew COMMAND --help` explains a command, `sinew --version` names the program.\n"
           "Exit codes: 0 done, 1 the graph is wrong, 2 usage, 3 the solve failed, 4 cancelled, 5 internal "
           "error.\n";
    return out;
}

} // namespace sinew::cli
