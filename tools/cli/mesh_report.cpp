// The state of every mesh in a graph.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/mesh_report.h"

#include "nodes/mesh_formats.h"
#include "nodes/options.h"
#include "nodes/values.h"
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/self_intersections.h"
#include "tools/cli/json_text.h"
#include "tools/cli/open_graph.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>
#include <typeindex>

namespace sinew::cli {

using solver::Flaw;
using solver::MeshCheck;

namespace {

MeshReport report_surface(const solver::Points& points, std::size_t faces,
                          const std::vector<solver::Triangle>& triangles) {
    MeshReport r;
    r.vertices = points.size();
    r.faces = faces;
    r.triangles = triangles.size();
    r.check = solver::inspect_mesh(points, triangles);
    return r;
}

MeshReport report_tets(const solver::TetMesh& mesh) {
    const auto boundary = solver::boundary_triangles(mesh.tets);
    MeshReport r = report_surface(mesh.vertices, boundary.size(), boundary);
    r.check.unused_vertices = {}; // those inside
    r.tets = mesh.tets.size();
    r.dihedral = solver::dihedral_range(mesh);
    r.check.flat_tets = solver::flat_tets(mesh);
    return r;
}

std::optional<MeshReport> report_value(const engine::Value& value) {
    if (value.is<nodes::Mesh>()) {
        const auto& m = value.as<nodes::Mesh>();
        return report_surface(*m.points, m.topology->face_sizes.size(), m.topology->triangles);
    }
    if (value.is<nodes::TetMeshValue>()) return report_tets(*value.as<nodes::TetMeshValue>().mesh);
    return std::nullopt;
}

struct NamedFlaw {
    const Flaw* flaw;
    const char *key, *one, *many;
};

std::vector<NamedFlaw> flaws_of(const MeshCheck& c) {
    return {
        {&c.open_edges, "openEdges", "open edge", "open edges"},
        {&c.non_manifold_edges, "nonManifoldEdges", "edge with over two triangles", "edges with over two triangles"},
        {&c.badly_oriented_edges, "badlyOrientedEdges", "edge between opposite sides", "edges between opposite sides"},
        {&c.non_manifold_vertices, "nonManifoldVertices", "vertex with several fans", "vertices with several fans"},
        {&c.degenerate_triangles, "degenerateTriangles", "triangle without area", "triangles without area"},
        {&c.duplicate_triangles, "duplicateTriangles", "repeated triangle", "repeated triangles"},
        {&c.coinciding_vertices, "coincidingVertices", "vertex at another's place", "vertices at others' places"},
        {&c.unused_vertices, "unusedVertices", "unused vertex", "unused vertices"},
        {&c.inside_out_parts, "insideOutParts", "part turned inside out, at triangle",
         "parts turned inside out, at triangles"},
        {&c.flat_tets, "flatTets", "nearly flat tet", "nearly flat tets"},
        {&c.crossing_triangles, "crossingTriangles", "pair of crossing triangles", "pairs of crossing triangles"}};
}

std::string flaws_as_text(const MeshCheck& check) {
    std::string text;
    for (const NamedFlaw& f : flaws_of(check))
        if (*f.flaw) text += (text.empty() ? "" : "; ") + solver::describe(*f.flaw, f.one, f.many);
    if (!check.crossing_triangles.is_whole)
        text += std::string(text.empty() ? "" : "; ") + "too many triangles meet to look at all pairs for crossings";
    return text.empty() ? "none" : text;
}

/// "welded": once vertices at one place are one and triangles are turned alike, as zTet and zIsoMesh take it.
std::string closed_as_text(const MeshCheck& check) {
    return !check.encloses ? "no" : check.is_closed() ? "yes" : "welded";
}

nlohmann::ordered_json as_json(const MeshReport& r) {
    nlohmann::ordered_json flaws = nlohmann::ordered_json::object();
    for (const NamedFlaw& f : flaws_of(r.check)) {
        nlohmann::ordered_json first = nlohmann::ordered_json::array();
        for (const int place : f.flaw->first) first.push_back(place);
        for (const auto& edge : f.flaw->edges) first.push_back(edge);
        flaws[f.key] = {{"count", f.flaw->count}, {"first", first}};
        if (!f.flaw->is_whole) flaws[f.key]["whole"] = false;
    }
    nlohmann::ordered_json line = {
        {"event", "mesh"}, {"mesh", r.name}, {"vertices", r.vertices}, {"faces", r.faces}, {"triangles", r.triangles}};
    if (r.tets > 0)
        line["tets"] = r.tets, line["leastDihedral"] = r.dihedral[0], line["largestDihedral"] = r.dihedral[1];
    line["parts"] = r.check.components;
    line["closed"] = r.check.is_closed();
    line["closedOnceWelded"] = r.check.encloses;
    line["manifold"] = r.check.is_manifold();
    if (r.check.is_closed()) line["volume"] = r.check.volume;
    line["flaws"] = std::move(flaws);
    return line;
}

std::string cell(const std::string& text, int width) {
    const std::string space(static_cast<std::size_t>(std::max(0, std::abs(width) - static_cast<int>(text.size()))),
                            ' ');
    return width < 0 ? text + space : space + text;
}

bool has_tets(const engine::NodeType& type) {
    return std::any_of(type.outputs.begin(), type.outputs.end(), [](const engine::AttributeInfo& output) {
        return output.type == std::type_index(typeid(nodes::TetMeshValue));
    });
}

bool keeps_cavities(const engine::Graph& graph, const std::string& tets) {
    const auto& inputs = graph.find(tets)->inputs;
    const auto fill = inputs.find("fillInterior");
    const auto* word = fill == inputs.end() ? nullptr : std::get_if<engine::Value>(&fill->second);
    return word && word->is<std::string>() && word->as<std::string>() == nodes::word_of(solver::Fill::empty_cavities);
}

/// What the mesh at this input cannot do; empty if nothing.
std::string what_is_off(const engine::Graph& graph, const std::string& node, const std::string& attribute,
                        const MeshCheck& check) {
    const std::string& type = graph.find(node)->type_name;
    if (type == "zTet" && attribute == "mesh" && check.is_closed() && check.crossing_triangles &&
        keeps_cavities(graph, node))
        return "fillInterior EmptyCavities cannot tell a cavity there: surfaces that cross do not lie in each other, "
               "and "
               "what they enclose is filled";
    if (check.is_closed()) return {};
    if ((type == "zTissue" || type == "zTet") && attribute == "mesh" && check.encloses) return {};
    if (type == "zTissue" && attribute == "collisionShape")
        return "it has no inside: it can stand for the tissue's surface as a sheet alone, not as a solid";
    if ((type == "zTissue" || type == "zTet") && attribute == "mesh")
        return "what is inside can only be guessed: small holes get lids, at large ones the border of the "
               "solid "
               "is drawn where the winding number is one half";
    if (type == "weights" && attribute == "otherMesh")
        return "mode near measures the distance to the surface alone; vertices deep inside are not at "
               "distance 0";
    return {};
}

engine::Diagnostic warning_at(const engine::Graph& graph, const std::string& node, const std::string& attribute) {
    engine::Diagnostic d;
    d.severity = engine::Severity::warning;
    d.code = "FE238";
    d.node = node;
    d.attribute = attribute;
    d.spot = graph.spot(node, attribute);
    return d;
}

} // namespace

std::vector<MeshReport> mesh_reports(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
                                     std::stop_token stop, const std::shared_ptr<engine::Failures>& failures) {
    const std::vector<std::string> names = graph->node_names();
    const double frame = start_frame(*graph, names);
    std::vector<MeshReport> out;
    for (const std::string& name : names) {
        const engine::Node* node = graph->find(name);
        if (!node->type) continue;
        for (const engine::AttributeInfo& output : node->type->outputs) {
            const engine::Plug plug{name, std::string(output.name)};
            try {
                auto report = report_value(evaluator.pull({graph, plug, frame, stop, failures}));
                if (report && report->vertices > 0) { // a transform without a mesh gives an empty one
                    // The border of tets keeps their numbers, those of inner vertices too.
                    if (report->tets == 0 && has_tets(*node->type)) report->check.unused_vertices = {};
                    report->plug = plug;
                    report->name = plug.text();
                    out.push_back(std::move(*report));
                }
            } catch (const engine::Failure&) {
                break; // find_problems has told, and the other outputs fail alike
            }
        }
    }
    return out;
}

namespace {

/// The files of a tet mesh: TetGen's two lie beside each other.
std::pair<std::string, std::string> tet_files(const std::filesystem::path& path) {
    const std::string ending = path.extension().string();
    const auto with = [&](const char* other) { return std::filesystem::path(path).replace_extension(other).string(); };
    if (ending == ".node") return {path.string(), with(".ele")};
    if (ending == ".ele") return {with(".node"), path.string()};
    return {path.string(), ""};
}

} // namespace

std::optional<MeshReport> report_of_file(const std::string& path, const engine::FileAccess& files) {
    if (files.refusal(path)) return std::nullopt; // what reads graphs says so
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const auto is_one_of = [&](const std::vector<std::string>& all) {
        return std::find(all.begin(), all.end(), ending) != all.end();
    };
    const bool surface = is_one_of(nodes::mesh_endings());
    const bool tets = is_one_of(solver::tet_endings());
    const bool scene = solver::is_scene_ending(ending) && std::filesystem::exists(path); // also one that is JSON
    if (!surface && !tets && !scene && (ending == ".json" || may_be_graph(path))) return std::nullopt;
    try {
        MeshReport report;
        if (!tets) { // an ending that nobody knows is refused there, with those that are known
            const solver::SurfaceMesh m = nodes::read_mesh(files, path);
            report = report_surface(m.points, m.face_sizes.size(), m.triangles);
        } else {
            const auto [node, elements] = tet_files(path);
            report = report_tets(nodes::read_tets(files, node, elements));
        }
        report.name = path;
        return report;
    } catch (const solver::Error& e) {
        engine::Diagnostic d;
        d.code = e.code;
        d.message = e.what();
        if (d.message.find(path) == std::string::npos) d.message = path + ": " + d.message;
        d.hint = e.hint;
        throw engine::Failure(d);
    }
}

std::vector<engine::Diagnostic> features_off(const engine::Graph& graph, const std::vector<MeshReport>& reports) {
    std::vector<engine::Diagnostic> out;
    for (const std::string& name : graph.node_names())
        for (const auto& [attribute, binding] : graph.find(name)->inputs) {
            const auto* source = std::get_if<engine::Plug>(&binding);
            if (!source) continue;
            for (const MeshReport& r : reports) {
                if (r.plug != *source) continue;
                if (r.tets > 0) {
                    if (!r.check.flat_tets) continue;
                    engine::Diagnostic d = warning_at(graph, name, attribute);
                    d.message = r.name + " has " +
                                solver::describe(r.check.flat_tets, "nearly flat tet", "nearly flat tets") +
                                ", so steps may fail or take many iterations";
                    d.hint = "Remesh, or let zTet make the tets.";
                    out.push_back(std::move(d));
                    continue;
                }
                const std::string off = what_is_off(graph, name, attribute, r.check);
                if (off.empty()) continue;
                engine::Diagnostic d = warning_at(graph, name, attribute);
                const bool closed = r.check.is_closed();
                d.message = r.name + (closed ? " crosses itself (" : " is not closed (") + flaws_as_text(r.check) +
                            "), so " + off;
                d.hint = closed ? "Take the crossing parts apart, or wrap them by zIsoMesh."
                                : "Close the mesh, or wrap it by zIsoMesh with isoValue > 0.";
                out.push_back(std::move(d));
            }
        }
    return out;
}

void print_meshes(const std::vector<MeshReport>& reports, bool as_json_lines, std::ostream& out) {
    if (as_json_lines) {
        for (const MeshReport& r : reports) out << json_text(as_json(r)) << "\n";
        return;
    }
    std::size_t wide = 4;
    for (const MeshReport& r : reports) wide = std::max(wide, r.name.size());
    const int name = -static_cast<int>(wide) - 1;
    out << cell("mesh", name) << "vertices triangles    tets parts closed manifold  flaws\n";
    for (const MeshReport& r : reports) {
        out << cell(r.name, name) << cell(std::to_string(r.vertices), 8) << cell(std::to_string(r.triangles), 10)
            << cell(r.tets ? std::to_string(r.tets) : "-", 8) << cell(std::to_string(r.check.components), 6)
            << cell(closed_as_text(r.check), 7) << cell(r.check.is_manifold() ? "yes" : "no", 9) << "  "
            << flaws_as_text(r.check);
        if (r.tets > 0) {
            char angles[64];
            std::snprintf(angles, sizeof angles, "; dihedral angles %.1f to %.1f", r.dihedral[0], r.dihedral[1]);
            out << angles;
        }
        out << "\n";
    }
}

} // namespace sinew::cli
