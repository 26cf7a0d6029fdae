// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/parts.h"

#include "engine/digest.h"
#include "nodes/mesh_formats.h"
#include "nodes/values.h"
#include "solver/error.h"
#include "solver/mesh/mesh_check.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

namespace sinew::rig {

namespace fs = std::filesystem;
using engine::Diagnostic;
using engine::Severity;

namespace {

bool is_mesh(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    const std::vector<std::string> known = nodes::mesh_endings();
    return std::find(known.begin(), known.end(), ending) != known.end();
}

std::string joined(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& w : words) out += (out.empty() ? "" : ", ") + w;
    return out;
}

/// What is found, and what is to be said of it.
struct Found {
    std::vector<std::string> files;
    std::vector<Diagnostic> wrong, notes;
};

void add_folder(const engine::FileAccess& access, const std::string& folder, Found& out) {
    std::vector<std::string> found, within;
    std::error_code error, ignored; // of a link that leads nowhere: no mesh
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const bool is_hidden = entry.path().filename().string().starts_with(".");
        if (is_hidden) continue;
        // A link out of the root is refused when it is read; what is there is not looked at.
        const bool leads_out = access.refusal(entry.path()).has_value();
        if (is_mesh(entry.path()) && (leads_out || entry.is_regular_file(ignored)))
            found.push_back(entry.path().string());
        else if (!leads_out && entry.is_directory(ignored))
            within.push_back("'" + entry.path().string() + "'");
    }
    if (error) {
        out.wrong.push_back(say(Severity::error, "DG150", "", "cannot read '" + folder + "': " + error.message(),
                                "Check the folder's permissions."));
        return;
    }
    std::sort(found.begin(), found.end());
    std::sort(within.begin(), within.end());
    const std::string passed_over =
        (within.size() == 1 ? "the folder " : "the folders ") + joined(within) + (within.size() == 1 ? " is" : " are");
    if (found.empty())
        out.wrong.push_back(say(Severity::error, "DG150", "",
                                "the folder '" + folder + "' has no mesh in it" +
                                    (within.empty() ? "" : "; " + passed_over + " not looked into"),
                                "Name a folder with files that end in " + joined(nodes::mesh_endings()) + "."));
    else if (!within.empty())
        out.notes.push_back(say(Severity::note, "DG180", "", passed_over + " not looked into",
                                "Name each folder whose meshes are meant, too (rig: --bones, --muscles)."));
    out.files.insert(out.files.end(), found.begin(), found.end());
}

Found find_files(const engine::FileAccess& access, const std::vector<std::string>& paths) {
    Found out;
    for (const std::string& path : paths) {
        std::error_code error;
        if (auto fault = access.refusal(path))
            out.wrong.push_back(say(Severity::error, fault->code, "", fault->message, fault->hint));
        else if (fs::is_directory(path, error))
            add_folder(access, path, out);
        else if (fs::exists(path, error))
            out.files.push_back(path);
        else
            out.wrong.push_back(say(Severity::error, "IO401", "", "there is no file or folder '" + path + "'",
                                    "Name a mesh file, or a folder of mesh files."));
    }
    return out;
}

/// Of positions and triangles: of what makes two files the same mesh.
engine::Digest digest_of(const Part& part) {
    const nodes::Mesh mesh = nodes::Mesh::from(solver::SurfaceMesh::from_triangles(part.points, part.triangles));
    return engine::Hasher().add(mesh.points_digest).add(mesh.topology->digest).finish();
}

/// What nodes of a part are called after its own name.
constexpr const char* endings[] = {"",     "Solved", "Below",        "Stuff",        "Solver",  "Mesh", "Polygons",
                                   "Move", "Tets",   "Flesh",        "TendonA",      "TendonB", "TipA", "TipB",
                                   "Ends", "Fibre",  "TendonAPaint", "TendonBPaint", "Lids"};

/// Two names that are alike: the later one says what it is, or gets a number.
void make_unique(std::vector<Part>& parts, std::string soft, std::vector<Diagnostic>& notes) {
    soft[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(soft[0])));
    // What graphs of this room call other nodes.
    std::set<std::string> taken{"solver", "flesh", "sinew", "fabric", "fascia", "skin"};
    // And attachments and ties between two parts.
    for (const Part& a : parts)
        for (Part b : parts) {
            if (!b.name.empty()) b.name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(b.name[0])));
            for (const char* other : {"", "2"}) taken.insert(a.name + "To" + b.name + other);
            taken.insert(a.name + "Over" + b.name);
        }
    const auto is_free = [&](const std::string& name) {
        return std::none_of(std::begin(endings), std::end(endings),
                            [&](const char* ending) { return taken.contains(name + ending); });
    };
    for (Part& part : parts) {
        const std::string wanted = part.name;
        if (!is_free(wanted)) {
            part.name = wanted + (part.kind == Kind::bone ? "Bone" : soft);
            for (int number = 2; !is_free(part.name); ++number) part.name = wanted + std::to_string(number);
            notes.push_back(say(Severity::note, "DG154", part.name,
                                "the name '" + wanted + "' is in use; '" + part.file + "' is called " + part.name,
                                "Rename the file if the name matters."));
        }
        for (const char* ending : endings) taken.insert(part.name + ending);
    }
}

} // namespace

Diagnostic say(Severity severity, std::string code, std::string node, std::string message, std::string hint) {
    Diagnostic out;
    out.severity = severity;
    out.code = std::move(code);
    out.node = std::move(node);
    out.message = std::move(message);
    out.hint = std::move(hint);
    return out;
}

std::string camel_case(const std::string& stem) {
    std::string out;
    bool is_first = true, raise = false;
    for (const char c : stem) {
        const auto u = static_cast<unsigned char>(c);
        const bool is_plain = u < 128 && std::isalnum(u);
        if (!is_plain) {
            raise = !out.empty();
            continue;
        }
        out += static_cast<char>(is_first ? std::tolower(u) : raise ? std::toupper(u) : c);
        is_first = raise = false;
    }
    if (out.empty() || std::isdigit(static_cast<unsigned char>(out[0]))) out = "mesh" + out;
    return out;
}

std::vector<std::string> mesh_files(const engine::FileAccess& access, const std::vector<std::string>& paths,
                                    std::vector<Diagnostic>& notes) {
    return mesh_files(access, paths, {}, notes).first;
}

std::pair<std::vector<std::string>, std::vector<std::string>> mesh_files(const engine::FileAccess& access,
                                                                         const std::vector<std::string>& some,
                                                                         const std::vector<std::string>& others,
                                                                         std::vector<Diagnostic>& notes) {
    Found first = find_files(access, some), second = find_files(access, others);
    first.wrong.insert(first.wrong.end(), second.wrong.begin(), second.wrong.end());
    if (!first.wrong.empty()) throw engine::Failure(std::move(first.wrong));
    for (const Found* found : {&first, &second}) notes.insert(notes.end(), found->notes.begin(), found->notes.end());
    return {std::move(first.files), std::move(second.files)};
}

std::vector<Part> read_parts(const engine::FileAccess& access, const std::vector<std::string>& bones,
                             const std::vector<std::string>& muscles, std::vector<Diagnostic>& notes,
                             const std::string& soft) {
    std::vector<Part> parts;
    std::vector<Diagnostic> wrong;
    std::map<engine::Digest, std::size_t> known; // by what is in them
    const auto read = [&](const std::string& file, Kind kind) {
        Part part;
        part.file = file;
        part.kind = kind;
        part.stem = fs::path(file).stem().string();
        part.name = camel_case(part.stem);
        try {
            solver::SurfaceMesh mesh = nodes::read_mesh(access, file);
            solver::check_usable(mesh);
            part.points = std::move(mesh.points);
            part.triangles = std::move(mesh.triangles);
        } catch (const solver::Error& e) {
            const std::string what = e.what();
            const bool names_it = what.find(file) != std::string::npos;
            wrong.push_back(say(Severity::error, e.code, part.name, names_it ? what : file + ": " + what, e.hint));
            return;
        }
        part.box = solver::bounding_box(part.points);
        const auto [same, is_new] = known.emplace(digest_of(part), parts.size());
        if (is_new) {
            parts.push_back(std::move(part));
            return;
        }
        const Part& first = parts[same->second];
        const std::string what = "'" + file + "' is the same mesh as '" + first.file + "'";
        if (first.kind != kind)
            wrong.push_back(say(Severity::error, "DG153", part.name,
                                what + ", which is a " + (first.kind == Kind::bone ? "bone" : soft),
                                "Keep it in one of the two folders."));
        else
            notes.push_back(
                say(Severity::warning, "DG153", part.name, what + "; it is left out", "Remove one of the two files."));
    };
    for (const std::string& file : bones) read(file, Kind::bone);
    for (const std::string& file : muscles) read(file, Kind::muscle);
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
    make_unique(parts, soft, notes);
    return parts;
}

} // namespace sinew::rig
