// `sinew live`: a graph in a browser that is simulated again as files and attributes change.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/arguments.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/open_graph.h"
#include "tools/live/server.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <ostream>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>

extern char** environ;

namespace sinew::cli {

namespace {

/// Asks the desktop to show the page. Without a desktop nothing happens, and the address has been printed.
void show_in_browser(const std::string& address) {
    std::string program = "xdg-open", word = address;
    char* words[] = {program.data(), word.data(), nullptr};
    pid_t child = 0;
    if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, words, environ) == 0)
        std::thread([child] { waitpid(child, nullptr, 0); }).detach();
}

ExitCode live(const Invocation& in) {
    const Arguments& arguments = in.arguments;
    std::optional<Departure> departure(std::in_place, in.stop, "sinew live", false); // to open a graph may take long
    live::Options options;
    options.file = arguments.operand(0).value();
    options.files = file_access(arguments);
    options.open = [&arguments](std::vector<engine::Diagnostic>& notes) {
        OpenGraph open = open_graph(arguments);
        notes = std::move(open.notes);
        return open.graph;
    };
    if (const auto text = arguments.value("--frames")) options.frames = parse_frames(*text);
    std::sort(options.frames.begin(), options.frames.end());
    options.with_lattices = !arguments.has("--surfaces");
    options.threads = arguments.whole_number("--threads", 0, 1, most_threads);
    const int port = arguments.whole_number("--port", 0, 1);
    if (port > 65535) throw UsageError("--port needs a number up to 65535, not " + std::to_string(port) + ".");
    try {
        std::vector<engine::Diagnostic> notes;
        options.open(notes);
    } catch (const engine::Failure& failure) {
        // A graph with errors may be mended while it is watched, but a word that is no file is a mistake.
        const engine::Diagnostic& first = failure.diagnostics().front();
        if (first.code.starts_with("IO4") && (!first.spot || first.spot->pointer.empty())) throw;
    }
    options.store = store_policy(arguments, options.file);
    live::Session session(std::move(options));
    live::Server server(session, port);
    in.out << "open " << server.address() << "\nCtrl-C ends it\n" << std::flush;
    if (arguments.has("--open")) show_in_browser(server.address());
    // To end it is no failure, and frames and files are written whole or not at all.
    departure.emplace(in.stop, "sinew live", false, done);
    server.serve(in.stop);
    return done;
}

} // namespace

Command live_command() {
    return {
        "live",
        "show a graph in a browser and simulate it again whenever a file or an attribute changes",
        {{"GRAPH", "a graph file"}},
        {{"--port", "N", "of 127.0.0.1; default: one that is free"},
         {"--open", "", "show the page in the desktop's browser"},
         {"--frames", "A-B", "frames, for example 12, 1-24 or 1,64,128; default: all"},
         {"--surfaces", "", "leave out tets, fibres and attachments; smaller pages"},
         {"--set", "NODE.ATTR=JSON", "give an input another value; not written when the page writes the file", true},
         {"--threads", "N", "default: all cores", false, 'j'},
         root_flag,
         memory_flag,
         cache_flag,
         no_cache_flag,
         cache_size_flag},
        "sinew live graphs/scenes/arm.json --open\n"
        "sinew live shot.json --port 8000 --frames 1-24",
        live};
}

} // namespace sinew::cli
