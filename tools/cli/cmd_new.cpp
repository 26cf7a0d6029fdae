// `sinew new`: graphs to begin with, written around meshes that are there.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "tools/cli/arguments.h"
#include "tools/cli/atomic_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/departure.h"
#include "tools/cli/long_task.h"
#include "tools/cli/open_graph.h"
#include "tools/cli/print.h"
#include "tools/cli/read_files.h"
#include "tools/rig/guess.h"
#include "tools/rig/layers_text.h"
#include "tools/rig/rig_text.h"

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <stdexcept>

namespace sinew::cli {

namespace {

namespace fs = std::filesystem;
using engine::Severity;

using rig::rough;

/// All that is read, whatever the kind. What is not there is told where it is looked for.
ReadFiles meshes_and_motion(const Invocation& in, const engine::FileAccess& files) {
    ReadFiles out;
    std::vector<std::string> paths = in.arguments.operands_from(1);
    for (const std::string_view flag : {"--bones", "--muscles", "--fascia", "--skin"})
        for (const std::string& path : in.arguments.values(flag)) paths.push_back(path);
    std::vector<engine::Diagnostic> ignored; // told where the graph is made
    for (const std::string& path : paths) {
        try {
            for (const std::string& file : rig::mesh_files(files, {path}, ignored))
                out.add(file, "which the graph is made around");
        } catch (const engine::Failure&) {
        }
    }
    if (const auto motion = in.arguments.value("--motion")) out.add(*motion, "which moves the bones");
    return out;
}

/// Said before anything is computed, so that nobody waits for nothing.
std::string output_file(const Invocation& in, const engine::FileAccess& files) {
    const auto file = in.arguments.value("--out");
    if (!file || file->empty()) throw UsageError("say where the graph goes: -o FILE.");
    files.check(*file, "--out");
    if (const auto motion = in.arguments.value("--motion")) files.check(*motion, "--motion");
    std::error_code error;
    if (fs::is_directory(*file, error)) throw UsageError("'" + *file + "' is a folder; name a file: -o FILE.");
    meshes_and_motion(in, files).check_kept(*file, "--out");
    if (fs::exists(*file, error) && !in.arguments.has("--force"))
        throw engine::Failure(rig::say(Severity::error, "DG160", "", "'" + *file + "' is there already",
                                       "Choose another name, or write over it with --force."));
    return *file;
}

std::string command_line(const Invocation& in) {
    std::string out = "sinew new";
    for (const std::string& word : in.arguments.operands_from(0)) out += " " + word;
    for (const Flag& flag : new_command().flags) {
        if (flag.name == "--force" || flag.name == "--json" || flag.name == root_flag.name) continue;
        for (const std::string& value : in.arguments.values(flag.name))
            out += " " + std::string(flag.name) +
                   (value.find_first_of("* ?") == value.npos ? " " + value : " '" + value + "'");
    }
    return out;
}

double positive(const Invocation& in, std::string_view flag, double otherwise) {
    const auto text = in.arguments.value(flag);
    if (!text) return otherwise;
    const auto value = to_number(*text);
    if (!value || !(*value > 0) || *value > 1e6) throw UsageError(std::string(flag) + " needs a number above 0.");
    return *value;
}

/// As far as a graph may run, from frame 1 on.
std::optional<int> last_frame(const Invocation& in) {
    constexpr int most = 1'000'000;
    return in.arguments.has("--end") ? std::optional(in.arguments.whole_number("--end", 24, 2, most)) : std::nullopt;
}

/// All options, refused before any mesh is read.
rig::GuessOptions guess_options(const Invocation& in) {
    rig::GuessOptions out;
    out.unit = in.arguments.value("--unit").value_or("");
    out.up = in.arguments.value("--up").value_or("");
    if (!out.up.empty() && out.up != "y" && out.up != "z") throw UsageError("--up is y or z.");
    out.overlaps = in.arguments.value("--overlaps").value_or("tie");
    if (out.overlaps != "tie" && out.overlaps != "slide" && out.overlaps != "none")
        throw UsageError("--overlaps is tie, slide or none.");
    out.files = file_access(in.arguments);
    out.tet_scale = positive(in, "--tet-scale", 1);
    for (const std::string& text : in.arguments.values("--set")) out.overrides.push_back(rig::parse_override(text));
    const std::stop_token stop = in.stop;
    out.stop = [stop] { return stop.stop_requested(); };
    rig::check_options(out);
    last_frame(in);
    return out;
}

std::string ends_in_words(const rig::Rig& rig, const rig::End& end) {
    std::string out;
    for (const rig::Hold& hold : end.holds)
        out += (out.empty() ? "" : " + ") + rig.parts[hold.target].name + " (" + std::to_string(hold.points) + ")";
    return out.empty() ? "nothing" : out;
}

void print_rig(const rig::Rig& rig, std::ostream& out) {
    out << "unit " << rig.unit.name << " (" << rig.unit.how_known << "), " << rig.up.axis << " up (" << rig.up.how_known
        << ")\n";
    for (const rig::Part& part : rig.parts)
        if (part.is_wrapped)
            out << part.name << ": wrapped" << (part.wrap > 0 ? " at " + rough(part.wrap) : "") << ", because "
                << part.why_wrapped << "\n";
    if (rig.muscles.empty()) return;
    std::size_t width = 6;
    for (const rig::Muscle& m : rig.muscles) width = std::max(width, rig.parts[m.part].name.size());
    const auto padded = [](std::string text, std::size_t size) {
        return text + std::string(size > text.size() ? size - text.size() : 0, ' ');
    };
    out << padded("muscle", width) << "  length  thickness  tetSize  ends (vertices attached)\n";
    for (const rig::Muscle& m : rig.muscles)
        out << padded(rig.parts[m.part].name, width) << "  " << padded(rough(m.shape.length), 6) << "  "
            << padded(rough(m.shape.thickness), 9) << "  " << padded(rough(m.tet_size), 7) << "  "
            << ends_in_words(rig, m.ends[0]) << " – " << ends_in_words(rig, m.ends[1]) << "\n";
    if (rig.touches.empty()) return;
    out << "touching:";
    for (std::size_t i = 0; i < rig.touches.size(); ++i)
        out << (i > 0 ? ", " : " ") << rig.parts[rig.touches[i].source].name << " on "
            << rig.parts[rig.touches[i].target].name << (rig.touches[i].slides ? " (slides)" : "");
    out << "\n";
}

rig::TextOptions text_options(const Invocation& in, const std::string& file, rig::Rig& rig) {
    rig::TextOptions out;
    out.folder = fs::path(file).parent_path().string();
    out.made_by = command_line(in);
    if (const auto motion = in.arguments.value("--motion"))
        out.motion = rig::read_motion(file_access(in.arguments), *motion, rig, in.arguments.has("--up"));
    out.end = last_frame(in);
    return out;
}

/// Flags that belong to other kinds are refused, not left unread.
void refuse(const Invocation& in, const std::string& kind, const std::vector<std::string_view>& flags) {
    for (const std::string_view flag : flags)
        if (in.arguments.has(flag)) throw UsageError(std::string(flag) + " has no meaning for '" + kind + "'.");
}

ExitCode finish(const Invocation& in, const std::string& file, const rig::Rig& rig, const std::string& text) {
    write_file(file, text, file_access(in.arguments));
    print_rig(rig, in.out);
    print_diagnostics(rig.notes, false, in.out, in.err);
    in.out << "wrote " << file << "\n";
    return done;
}

ExitCode write_rig(const Invocation& in, const std::string& file, const std::vector<std::string>& bones,
                   const std::vector<std::string>& muscles, bool is_one_muscle) {
    rig::GuessOptions guess = guess_options(in);
    guess.is_one_muscle = is_one_muscle;
    rig::Rig made = rig::guess_rig(bones, muscles, guess);
    const rig::TextOptions options = text_options(in, file, made);
    return finish(in, file, made, rig::rig_text(made, options));
}

ExitCode new_rig(const Invocation& in) {
    refuse(in, "rig", {"--fascia", "--skin"});
    const std::string file = output_file(in, file_access(in.arguments));
    std::vector<std::string> bones = in.arguments.values("--bones"), muscles = in.arguments.values("--muscles");
    const std::vector<std::string> folders = in.arguments.operands_from(1);
    if (folders.size() > 2 || (folders.size() < 2 && muscles.empty()) || (folders.empty() && bones.empty()))
        throw UsageError(
            "two folders are meant: `sinew new rig BONES MUSCLES -o FILE`; more with --bones and --muscles.");
    if (!folders.empty()) bones.insert(bones.begin(), folders[0]);
    if (folders.size() > 1) muscles.insert(muscles.begin(), folders[1]);
    return write_rig(in, file, bones, muscles, false);
}

/// The meshes but for the last one, and the last one.
std::pair<std::vector<std::string>, std::string> all_and_last(const Invocation& in, const std::string& kind,
                                                              const std::string& others) {
    std::vector<std::string> meshes = in.arguments.operands_from(1);
    if (meshes.size() < 2)
        throw UsageError("two meshes at least are meant: `sinew new " + kind + " " + others + " -o FILE`.");
    const std::string last = meshes.back();
    file_access(in.arguments).check(last, "the " + kind);
    std::error_code error;
    if (fs::is_directory(last, error)) throw UsageError("'" + last + "' is a folder; one " + kind + " is meant.");
    meshes.pop_back();
    return {meshes, last};
}

ExitCode new_muscle(const Invocation& in) {
    refuse(in, "muscle", {"--bones", "--muscles", "--fascia", "--skin"});
    const std::string file = output_file(in, file_access(in.arguments));
    const auto [bones, muscle] = all_and_last(in, "muscle", "BONE… MUSCLE");
    return write_rig(in, file, bones, {muscle}, true);
}

ExitCode new_cloth(const Invocation& in) {
    refuse(in, "cloth", {"--bones", "--muscles", "--fascia", "--skin", "--overlaps", "--set", "--tet-scale"});
    const std::string file = output_file(in, file_access(in.arguments));
    const auto [bodies, cloth] = all_and_last(in, "cloth", "BODY… CLOTH");
    rig::Rig made = rig::guess_cloth(bodies, cloth, guess_options(in));
    const rig::TextOptions options = text_options(in, file, made);
    return finish(in, file, made, rig::cloth_text(made, options));
}

ExitCode new_layers(const Invocation& in) {
    refuse(in, "layers", {"--muscles", "--overlaps", "--set"});
    const std::string file = output_file(in, file_access(in.arguments));
    rig::Layers made =
        rig::guess_layers({in.arguments.values("--bones"), in.arguments.operands_from(1),
                           in.arguments.value("--fascia").value_or(""), in.arguments.value("--skin").value_or("")},
                          guess_options(in));
    const rig::TextOptions options = text_options(in, file, made.rig);
    return finish(in, file, made.rig, rig::layers_text(made, options));
}

ExitCode make_new(const Invocation& in) {
    const std::string kind = in.arguments.operand(0).value();
    const Departure departure(in.stop, "sinew new", false);
    const LongTask task(in.err, "looking at the meshes", false);
    try {
        if (kind == "rig") return new_rig(in);
        if (kind == "muscle") return new_muscle(in);
        if (kind == "cloth") return new_cloth(in);
        if (kind == "layers") return new_layers(in);
    } catch (const std::invalid_argument& e) {
        throw UsageError(e.what());
    } catch (const solver::Stopped&) {
        throw engine::Cancelled();
    }
    const std::vector<std::string> kinds = {"rig", "muscle", "cloth", "layers"};
    throw UsageError("'" + kind + "' is none of rig, muscle, cloth and layers." + did_you_mean(kind, kinds));
}

} // namespace

Command new_command() {
    return {
        "new",
        "write a graph to begin with around meshes that are there",
        {{"KIND", "rig: all muscles of a folder on the bones of another; muscle: one of them; cloth: one sheet over "
                  "bodies; layers: tissues, fascia and skin"},
         {"MESHES",
          "rig: a folder of bones and a folder of muscles; muscle: bones, then the muscle; cloth: bodies that "
          "it lies on, then the cloth, which is the last one; layers: the tissues",
          false, true}},
        {{"--out", "FILE", "the graph file to write", false, 'o'},
         {"--force", "", "write over a file that is there"},
         {"--bones", "PATH", "rig: further bones, a mesh file or a folder; layers: the bones", true},
         {"--muscles", "PATH", "rig: further muscles", true},
         {"--fascia", "FILE", "layers: its mesh; default: made around the tissues"},
         {"--skin", "FILE", "layers: its mesh; default: made around the fascia"},
         {"--unit", "UNIT", "what the meshes are in: mm, cm, dm, m, in or ft; default: guessed by the bones' sizes"},
         {"--up", "AXIS", "y or z; default: guessed"},
         {"--motion", "FILE", "a motion file with tracks named like the bones, which then move"},
         {"--end", "FRAME", "the last frame; default: that of the motion, else 24"},
         {"--overlaps", "HOW", "rig, muscle: tie (default), slide or none: how it goes with bodies that touch"},
         {"--tet-scale", "FACTOR", "multiplies the tet sizes that are guessed: 2 is coarser and quicker"},
         {"--set", "PATTERN:NAME=VALUE",
          "rig, muscle: of the muscles whose names match: tetSize, reach, attachTo, overlaps, preset, law, "
          "youngsModulus, tendonModulus, massDensity, strength, excitation (docs/concepts/new-rig.md)",
          true},
         root_flag},
        "sinew new rig arm/bones arm/muscles -o arm.json\n"
        "sinew new rig arm/bones arm/muscles -o arm.json --set 'triceps*:tetSize=1.2' --set "
        "'biceps:attachTo=scapula,radius'",
        make_new};
}

} // namespace sinew::cli
