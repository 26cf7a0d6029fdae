// The meshing benchmark.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/meshing.h"

#include "solver/mesh/mesh_files.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/solid.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

namespace sinew::bench {
namespace {

using namespace solver;
namespace fs = std::filesystem;

bool ends_like(const fs::path& path, const std::vector<std::string>& endings) {
    return std::find(endings.begin(), endings.end(), path.extension().string()) != endings.end();
}

SurfaceMesh read(const std::string& file) {
    if (!ends_like(file, tet_endings())) return read_surface(file);
    TetMesh tets = read_tets(file);
    return SurfaceMesh::from_triangles(std::move(tets.vertices), boundary_triangles(tets.tets));
}

/// Wall time from one phase's first report to the next one's.
class PhaseClock {
  public:
    MeshingControl control(std::stop_token stop) {
        start_ = last_ = std::chrono::steady_clock::now();
        return {[stop] { return stop.stop_requested(); },
                [this](double, std::string_view what) { enter(std::string(what)); }};
    }
    void finish(MeshingResult& r) {
        enter("");
        r.phases = phases_;
        r.seconds = std::chrono::duration<double>(last_ - start_).count();
    }

  private:
    void enter(const std::string& name) {
        if (name == current_) return;
        const auto now = std::chrono::steady_clock::now();
        if (!current_.empty()) phases_.emplace_back(current_, std::chrono::duration<double>(now - last_).count());
        current_ = name;
        last_ = now;
    }

    std::chrono::steady_clock::time_point start_, last_;
    std::string current_;
    std::vector<std::pair<std::string, double>> phases_;
};

void measure_tets(const TetMesh& mesh, MeshingResult& r) {
    constexpr std::size_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    r.tets = mesh.tets.size();
    double least_cosine = 1, most_cosine = -1;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        std::array<Vec3, 4> c, normals;
        for (std::size_t k = 0; k < 4; ++k) c[k] = mesh.vertices[static_cast<std::size_t>(mesh.tets[t][k])];
        for (std::size_t f = 0; f < 4; ++f)
            normals[f] = (c[faces[f][1]] - c[faces[f][0]]).cross(c[faces[f][2]] - c[faces[f][0]]).normalized();
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const double cosine = std::clamp(-normals[i].dot(normals[j]), -1.0, 1.0);
                least_cosine = std::min(least_cosine, cosine), most_cosine = std::max(most_cosine, cosine);
            }
        r.covered_volume += mesh.coverage[t] * tet_volume(c[0], c[1], c[2], c[3]);
        r.whole += mesh.coverage[t] == 1;
    }
    r.least_angle = std::acos(most_cosine) * 180 / std::numbers::pi;
    r.most_angle = std::acos(least_cosine) * 180 / std::numbers::pi;
}

void describe_surface(const SurfaceMesh& mesh, MeshingResult& r) {
    const Solid solid = make_solid(mesh.points, mesh.triangles, r.fill);
    r.border_edges = solid.border_edges;
    if (!solid.is_closed) return;
    r.surface_volume = enclosed_volume(solid.points, solid.triangles);
    const Solid::Sides ordinary{1, 0};
    r.crossings = static_cast<int>(
        std::count_if(solid.sides.begin(), solid.sides.end(), [&](const Solid::Sides& s) { return !(s == ordinary); }));
}

std::string fill_name(Fill fill) {
    switch (fill) {
    case Fill::surface_only:
        return "SurfaceOnly";
    case Fill::filled_cavities:
        return "FilledCavities";
    default:
        return "EmptyCavities";
    }
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
    char text[200];
    std::snprintf(text, sizeof text, pattern, values...);
    return text;
}

} // namespace

std::vector<std::string> mesh_files_under(const std::vector<std::string>& paths) {
    std::vector<std::string> files;
    for (const std::string& path : paths) {
        if (!fs::exists(path)) throw Error("IO401", "'" + path + "' does not exist");
        if (!fs::is_directory(path)) {
            files.push_back(path);
            continue;
        }
        const std::size_t first = files.size();
        for (const auto& entry : fs::recursive_directory_iterator(path))
            if (entry.is_regular_file() &&
                (ends_like(entry.path(), surface_endings()) || ends_like(entry.path(), tet_endings())) &&
                entry.path().extension() != ".node") // its .ele is read
                files.push_back(entry.path().string());
        std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
    }
    return files;
}

MeshingResult run_meshing(const std::string& file, Fill fill, double parts, int refine, std::stop_token stop) {
    MeshingResult r;
    r.file = file, r.fill = fill, r.parts = parts, r.refine = refine;
    PhaseClock clock;
    try {
        const SurfaceMesh mesh = read(file);
        r.triangles = mesh.triangles.size();
        LatticeOptions options;
        options.fill = fill;
        options.refinement = {static_cast<double>(refine)};
        options.max_resolution = std::numeric_limits<int>::max();
        options.tet_size = bounding_box(mesh.points).size().maxCoeff() / parts;
        const TetMesh tets = make_lattice(mesh.points, mesh.triangles, options, clock.control(stop));
        clock.finish(r);
        measure_tets(tets, r);
        describe_surface(mesh, r);
    } catch (const Error& e) {
        r.code = e.code, r.message = e.what();
    }
    return r;
}

nlohmann::ordered_json as_json(const MeshingResult& r) {
    nlohmann::ordered_json line = {{"bench", "meshing"}, {"file", r.file},     {"fill", fill_name(r.fill)},
                                   {"parts", r.parts},   {"refine", r.refine}, {"triangles", r.triangles}};
    if (!r.code.empty()) {
        line["code"] = r.code;
        line["message"] = r.message;
        return line;
    }
    line["border_edges"] = r.border_edges;
    line["crossings"] = r.crossings;
    line["tets"] = r.tets;
    line["whole"] = r.whole;
    line["least_angle"] = r.least_angle;
    line["most_angle"] = r.most_angle;
    line["covered_volume"] = r.covered_volume;
    if (r.surface_volume != 0) line["surface_volume"] = r.surface_volume;
    line["seconds"] = r.seconds;
    for (const auto& [name, seconds] : r.phases) line["phases"][name] = seconds;
    return line;
}

std::string meshing_table_head() {
    return "| file | triangles | border edges | crossings | fill | parts | refine | result | tets | whole | "
           "dihedral "
           "| "
           "covered volume | error | seconds (by phase) |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
}

std::string as_table_row(const MeshingResult& r) {
    std::string row = "| " + r.file + " | " + std::to_string(r.triangles);
    if (!r.code.empty())
        return row + " | | | " + fill_name(r.fill) + format(" | %g | %d | ", r.parts, r.refine) + r.code + ": " +
               r.message + " | | | | | | |\n";
    row += " | " + std::to_string(r.border_edges) + " | " + std::to_string(r.crossings) + " | " + fill_name(r.fill) +
           format(" | %g | %d | ok | ", r.parts, r.refine) + std::to_string(r.tets) + " | " + std::to_string(r.whole) +
           format(" | %.0f-%.0f | %.6g | ", r.least_angle, r.most_angle, r.covered_volume);
    // A shell at the surface is not meant to cover the whole of it.
    if (r.surface_volume != 0 && r.fill != Fill::surface_only)
        row += format("%+.1e", r.covered_volume / r.surface_volume - 1);
    row += format(" | %.2f (", r.seconds);
    for (std::size_t i = 0; i < r.phases.size(); ++i) row += format(i > 0 ? " + %.2f" : "%.2f", r.phases[i].second);
    return row + ") |\n";
}

} // namespace sinew::bench
