// `sinew cache`: what is kept on disk of a graph's frames, and how to get rid of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/frame_store.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/json_text.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

namespace {

namespace fs = std::filesystem;

/// The folder itself, or the one beside a graph.
fs::path folder_of(const std::string& word) {
    std::error_code error;
    if (fs::is_directory(word, error)) return word;
    const fs::path beside = fs::path(word).replace_extension(".sinew-cache");
    if (!fs::is_directory(beside, error) && !fs::exists(word, error))
        throw UsageError("there is neither a graph nor a folder '" + word + "'.");
    return beside;
}

ExitCode cache(const Invocation& in) {
    const std::string what = in.arguments.operand(0).value();
    const fs::path folder = folder_of(in.arguments.operand(1).value());
    if (what != "info" && what != "clean") throw UsageError("'" + what + "' is neither info nor clean.");
    const engine::DiskUse use = engine::disk_use(folder);
    if (what == "clean") engine::remove_kept(folder);
    const bool json = in.arguments.has("--json");
    if (json) {
        const nlohmann::ordered_json out = {{"folder", folder.string()}, {"frames", use.frames},
                                            {"outputs", use.outputs},    {"files", use.files},
                                            {"bytes", use.bytes},        {"removed", what == "clean"}};
        in.out << json_text(out) << "\n";
    } else if (use.files == 0) {
        in.out << folder.string() << ": nothing is kept\n";
    } else {
        in.out << folder.string() << ": " << (what == "clean" ? "removed " : "") << use.frames << " frames, "
               << use.outputs << " outputs of nodes, " << rounded_bytes(static_cast<double>(use.bytes)) << "\n";
    }
    return done;
}

} // namespace

Command cache_command() {
    return {"cache",
            "say what is kept on disk of a graph, or remove it",
            {{"WHAT", "info or clean"}, {"GRAPH|DIR", "a graph file, or the folder that was given with --cache"}},
            {{"--json", "", "one JSON object instead of text"}},
            "sinew cache info graphs/scenes/arm.json\nsinew cache clean graphs/scenes/arm.json",
            cache};
}

} // namespace sinew::cli
