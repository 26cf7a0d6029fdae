// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/parts.h"

#include "engine/digest.h"
#include "nodes/mesh_formats.h"
#include "nodes/values.h"
#include "solver/error.h"
#include "solver/mesh/mesh_check.h"
#include "solver/meshing/iso_mesh.h"
#include "solver/meshing/self_intersections.h"
#include "tools/rig/graph_text.h"

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

void add_folder(const std::string& folder, std::vector<std::string>& files, std::vector<Diagnostic>& wrong) {
    std::vector<std::string> found;
    std::error_code error, ignored; // of a link that leads nowhere: no mesh
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const bool is_hidden = entry.path().filename().string().starts_with(".");
        if (!is_hidden && entry.is_regular_file(ignored) && is_mesh(entry.path()))
            found.push_back(entry.path().string());
    }
    if (error) {
        wrong.push_back(say(Severity::error, "DG150", "", "cannot read '" + folder + "': " + error.message(),
                            "Check the folder's permissions."));
        return;
    }
    if (found.empty())
        wrong.push_back(say(Severity::error, "DG150", "", "the folder '" + folder + "' has no mesh in it",
                            "Name a folder with files that end in " + joined(nodes::mesh_endings()) + "."));
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
}

std::vector<std::string> find_files(const std::vector<std::string>& paths, std::vector<Diagnostic>& wrong) {
    std::vector<std::string> files;
    for (const std::string& path : paths) {
        std::error_code error;
        if (fs::is_directory(path, error))
            add_folder(path, files, wrong);
        else if (fs::exists(path, error))
            files.push_back(path);
        else
            wrong.push_back(say(Severity::error, "IO401", "", "there is no file or folder '" + path + "'",
                                "Name a mesh file, or a folder of mesh files."));
    }
    return files;
}

/// Of positions and triangles: of what makes two files the same mesh.
engine::Digest digest_of(const Part& part) {
    const nodes::Mesh mesh = nodes::Mesh::from(solver::SurfaceMesh::from_triangles(part.points, part.triangles));
    return engine::Hasher().add(mesh.points_digest).add(mesh.topology->digest).finish();
}

/// What nodes of a part are called after its own name.
constexpr const char* endings[] = {"",         "Solved", "Below", "Stuff", "Solver",       "Mesh",
                                   "Polygons", "Move",   "Tets",  "Flesh", "TendonA",      "TendonB",
                                   "TipA",     "TipB",   "Ends",  "Fibre", "TendonAPaint", "TendonBPaint"};

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

/// What keeps a mesh from being used as it is; empty if nothing does. Parts whose vertices are only split along edges
/// are as good as closed.
std::string fault_of(const solver::MeshCheck& check) {
    const auto it_has = [](const solver::Flaw& flaw, const char* one, const char* many) {
        return "it has " + solver::describe(flaw, one, many);
    };
    if (check.open_edges && !check.encloses) return it_has(check.open_edges, "open edge", "open edges");
    if (check.non_manifold_edges)
        return it_has(check.non_manifold_edges, "edge with over two triangles", "edges with over two triangles");
    if (check.badly_oriented_edges)
        return it_has(check.badly_oriented_edges, "edge whose triangles face different ways",
                      "edges whose triangles face different ways");
    if (check.volume < 0) return "its faces look inwards";
    return "";
}

/// In grid cells.
constexpr double narrowest_wrap = 0.6, widest_wrap = 8;

/// What meshing says of a shell that triangles cannot follow.
bool is_lost(const solver::Error& e) { return e.code == "FE231" || e.code == "FE234"; }

/// Whether the surface at this distance bounds a solid; through holes that are too wide it goes in, and is a shell.
bool is_solid(const solver::IsoMesh& mesh, double area, double distance) {
    return solver::enclosed_volume(mesh.points, mesh.triangles) > 2 * (2 * distance * area);
}

/// The same told from few triangles, which is quicker where it is a shell.
bool closes(const Part& part, solver::IsoMeshOptions options, double area, const solver::MeshingControl& control) {
    options.triangle_size = 2 * solver::default_triangle_size(part.points, part.triangles);
    options.is_manifold = false;
    try {
        return is_solid(solver::make_iso_mesh(part.points, part.triangles, options, control), area, options.iso_value);
    } catch (const solver::Error& e) {
        if (!is_lost(e)) throw;
        return false;
    }
}

double area_of(const Part& part) {
    double out = 0;
    for (const double a : solver::vertex_areas(part.points, part.triangles)) out += a;
    return out;
}

void wrap(Part& part, const std::function<bool()>& stop) {
    const solver::MeshCheck check = solver::inspect_mesh(part.points, part.triangles);
    part.why_wrapped = fault_of(check);
    if (part.why_wrapped.empty()) return;
    solver::IsoMeshOptions options;
    options.resolution = wrap_resolution;
    // Where triangles are only turned differently, or doubled, the surface itself can be made anew.
    const double cell = part.box.size().maxCoeff() / wrap_resolution, area = area_of(part);
    solver::MeshingControl control;
    control.stop = stop;
    for (double cells = check.encloses ? 0 : narrowest_wrap;; cells *= 2) {
        options.iso_value = cells * cell;
        // A hole that was too wide leaves a hollow, or an edge where its rims just meet; a wider wrap closes it. Sheets
        // have no volume at any width.
        const bool is_last = cells == 0 || cells > widest_wrap / 2;
        if (!is_last && cells > narrowest_wrap && !closes(part, options, area, control)) continue;
        solver::IsoMesh made;
        try {
            made = solver::make_iso_mesh(part.points, part.triangles, options, control);
        } catch (const solver::Error& e) {
            if (is_last || !is_lost(e)) throw;
            continue;
        }
        if (!is_last && !is_solid(made, area, options.iso_value)) continue;
        part.is_wrapped = true;
        part.wrap = options.iso_value;
        part.points = std::move(made.points);
        part.triangles = std::move(made.triangles);
        part.box = solver::bounding_box(part.points);
        return;
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

std::vector<std::string> mesh_files(const std::vector<std::string>& paths) {
    std::vector<Diagnostic> wrong;
    std::vector<std::string> files = find_files(paths, wrong);
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
    return files;
}

std::pair<std::vector<std::string>, std::vector<std::string>> mesh_files(const std::vector<std::string>& some,
                                                                         const std::vector<std::string>& others) {
    std::vector<Diagnostic> wrong;
    std::pair<std::vector<std::string>, std::vector<std::string>> files;
    files.first = find_files(some, wrong), files.second = find_files(others, wrong);
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
    return files;
}

std::vector<Part> read_parts(const std::vector<std::string>& bones, const std::vector<std::string>& muscles,
                             std::vector<Diagnostic>& notes, const std::string& soft) {
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
            solver::SurfaceMesh mesh = nodes::read_mesh({}, file);
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

void wrap_open(std::vector<Part>& parts, std::vector<Diagnostic>& notes, const std::function<bool()>& stop) {
    std::vector<Diagnostic> wrong;
    for (Part& part : parts) {
        try {
            const double cell = part.box.size().maxCoeff() / wrap_resolution;
            wrap(part, stop);
            if (part.wrap > 2 * cell)
                notes.push_back(say(Severity::warning, "DG163", part.name,
                                    "'" + part.file + "' has wide holes: the surface that closes them is " +
                                        rough(part.wrap) + " around it, by which the body gets larger",
                                    "Close the holes in the mesh."));
        } catch (const solver::Error& e) {
            wrong.push_back(say(
                Severity::error, e.code, part.name,
                part.file + ": " + part.why_wrapped + ", and no surface can be put around it: " + e.what(), e.hint));
        }
    }
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
}

} // namespace sinew::rig
