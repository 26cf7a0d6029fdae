// A command as data: the parser, --help and the documentation read the same declaration.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/cli/exit_code.h"

#include <iosfwd>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::cli {

class Arguments;

struct Operand {
    std::string_view name, doc;
    bool required = true;
    bool repeats = false; ///< the last operand only: any number of words may follow
};

struct Flag {
    std::string_view name;       ///< with its dashes: "--frames"
    std::string_view value = ""; ///< what stands after it, for the usage line; empty = a switch
    std::string_view doc = "";
    bool repeats = false; ///< may be given more than once
    char letter = 0;      ///< short form: 'o' = "-o"
};

/// What a command works with. `out` is for results, `err` for people.
struct Invocation {
    const Arguments& arguments;
    std::ostream& out;
    std::ostream& err;
    std::stop_token stop = {}; ///< the user asked to stop
};

struct Command {
    std::string_view name, summary;
    std::vector<Operand> operands;
    std::vector<Flag> flags;
    std::string_view example; ///< lines to type, with what they do
    ExitCode (*run)(const Invocation&);
};

/// "sinew run GRAPH [--frames A-B] …"
std::string usage_line(const Command& command);
/// What `sinew COMMAND --help` prints.
std::string help_text(const Command& command);
/// What `sinew --help` prints.
std::string overview(const std::vector<Command>& commands);

} // namespace sinew::cli
