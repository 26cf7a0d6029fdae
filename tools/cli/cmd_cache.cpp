// `sinew cache`: what is kept on disk of a graph's frames, and how to get rid of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/diagnostics.h"
#include "engine/eval/cache_folder.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/json_text.h"
#include "tools/cli/open_graph.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

namespace fs = std::filesystem;

/// The folder itself, or the one beside a graph. Throws Failure IO410.
fs::path folder_of(const std::string& word, const engine::FileAccess& files) {
    files.check(word, "GRAPH|DIR"); // before anything is asked of the disk
    std::error_code error;
    if (fs::is_directory(word, error)) return word;
    const fs::path beside = fs::path(word).replace_extension(".sinew-cache");
    files.check(beside, "the cache");
    if (!fs::is_directory(beside, error) && !fs::exists(word, error))
        throw UsageError("there is neither a graph nor a folder '" + word + "'.");
    if (!fs::is_directory(beside, error) && !may_be_graph(word))
        throw UsageError("'" + word + "' is no graph; one is meant, or a folder with what was kept of it.");
    return beside;
}

engine::Diagnostic unremovable(const fs::path& folder, const engine::Removal& removal) {
    engine::Diagnostic d;
    d.code = "IO405";
    d.message =
        "cannot remove '" + removal.first.string() + "'" +
        (removal.left > 1 ? " and " + std::to_string(removal.left - 1) + " more files in '" + folder.string() + "'"
                          : std::string()) +
        ": " + removal.why;
    d.hint = "make the folder and what is in it writable";
    return d;
}

ExitCode cache(const Invocation& in) {
    const std::string what = in.arguments.operand(0).value();
    const fs::path folder = folder_of(in.arguments.operand(1).value(), file_access(in.arguments));
    if (what != "info" && what != "clean") throw UsageError("'" + what + "' is neither info nor clean.");
    const engine::Removal removal = what == "clean" ? engine::remove_kept(folder) : engine::Removal();
    const engine::DiskUse use = what == "clean" ? removal.removed : engine::disk_use(folder);
    const bool is_left = !removal.why.empty();
    const bool json = in.arguments.has("--json");
    if (json) {
        const nlohmann::ordered_json out = {{"folder", folder.string()}, {"frames", use.frames},
                                            {"outputs", use.outputs},    {"files", use.files},
                                            {"bytes", use.bytes},        {"removed", what == "clean" && !is_left}};
        in.out << json_text(out) << "\n";
    } else if (use.files == 0 && is_left) {
        in.out << folder.string() << ": nothing was removed\n";
    } else if (use.files == 0) {
        in.out << folder.string() << ": nothing is kept\n";
    } else {
        in.out << folder.string() << ": " << (what == "clean" ? "removed " : "") << use.frames << " frames, "
               << use.outputs << " outputs of nodes, " << rounded_bytes(static_cast<double>(use.bytes)) << "\n";
    }
    if (is_left) throw engine::Failure(unremovable(folder, removal));
    return done;
}

} // namespace

Command cache_command() {
    return {"cache",
            "say what is kept on disk of a graph, or remove it",
            {{"WHAT", "info or clean"}, {"GRAPH|DIR", "a graph file, or the folder that was given with --cache"}},
            {root_flag, {"--json", "", "one JSON object instead of text"}},
            "sinew cache info graphs/scenes/arm.json\nsinew cache clean graphs/scenes/arm.json",
            cache};
}

} // namespace sinew::cli
