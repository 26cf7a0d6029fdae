// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/print.h"

#include "tools/cli/json_text.h"
#include "tools/embed/frame_json.h"

#include "nodes/contacts.h"
#include "nodes/marks.h"
#include "nodes/options.h"
#include "nodes/rest_shapes.h"
#include "nodes/values.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

namespace sinew::cli {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::size_t long_list = 12, shown_of_long_list = 6;

Json coordinates(const solver::Vec3& p) { return {p[0], p[1], p[2]}; }

void add_box(Json& out, const solver::Points& points) {
    if (points.empty()) return;
    const solver::Box box = solver::bounding_box(points);
    out["box"] = {{"min", coordinates(box.min)}, {"max", coordinates(box.max)}};
}

Json describe(const nodes::Mesh& mesh) {
    Json out = {{"vertices", mesh.points->size()},
                {"faces", mesh.topology->face_sizes.size()},
                {"triangles", mesh.topology->triangles.size()},
                {"closed", solver::is_closed(mesh.topology->triangles)}};
    add_box(out, *mesh.points);
    out["digest"] = mesh.points_digest.hex();
    return out;
}

Json describe(const solver::TetMesh& mesh) {
    double volume = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto corner = [&](std::size_t k) -> const solver::Vec3& {
            return mesh.vertices[static_cast<std::size_t>(mesh.tets[t][k])];
        };
        volume += solver::tet_volume(corner(0), corner(1), corner(2), corner(3)) * mesh.coverage[t];
    }
    Json out = {{"vertices", mesh.vertices.size()}, {"tets", mesh.tets.size()}, {"solid_volume", volume}};
    add_box(out, mesh.vertices);
    return out;
}

/// What a step takes of it, by the names that attributes have.
template <class T>
requires requires { T::fields(); }
Json describe(const T& values) {
    Json out = Json::object();
    for (const auto& f : T::fields()) out[f.name] = values.*f.at;
    return out;
}

Json describe(const nodes::Body& body) {
    const char* kind = body.is_bone() ? "bone" : body.is_cloth() ? "cloth" : body.subtissue ? "subtissue" : "tissue";
    Json out = {{"kind", kind}, {"enable", body.enable}};
    out["mesh"] = describe(body.is_bone() ? std::get<nodes::Mesh>(body.values) : body.rest->mesh);
    const auto* tissue = std::get_if<std::shared_ptr<const solver::TissueRest>>(&body.rest->data);
    if (tissue && !body.subtissue) out["tets"] = describe((*tissue)->tets);
    if (const auto* values = std::get_if<solver::TissueInputs>(&body.values)) {
        out["compressionResistance"] = values->compression_resistance;
        out["restScaleEnvelope"] = values->rest_scale_envelope;
        out["inertialDamping"] = values->inertial_damping;
        for (const auto& layer : values->layers) out["materials"].push_back(describe(layer));
        for (const auto& fiber : values->fibers) out["fibers"].push_back(describe(fiber));
        for (const auto& part : values->subtissues) {
            Json materials = Json::array();
            for (const auto& layer : part.layers) materials.push_back(describe(layer));
            out["subtissues"].push_back(
                {{"restScaleEnvelope", part.rest_scale_envelope}, {"materials", std::move(materials)}});
        }
    }
    if (const auto* values = std::get_if<solver::ClothInputs>(&body.values)) {
        out["restScaleEnvelope"] = values->rest_scale_envelope;
        for (const auto& layer : values->layers) out["materials"].push_back(describe(layer));
    }
    return out;
}

Json describe(const nodes::Attachment& a) {
    std::size_t held = 0;
    for (const double w : a.rest.source_weights) held += w > 0;
    return {{"attachmentMode", nodes::word_of(a.values.mode())},
            {a.rest.source_painted == solver::PaintedOn::faces ? "source_triangles" : "source_vertices", held},
            {"stiffness", a.values.stiffness},
            {"damping", a.values.damping},
            {"envelope", a.values.envelope}};
}

/// Lengths in scene units, all else in SI units.
Json describe(const nodes::Force& f) {
    Json out = {{"term", f.type->name}};
    if (f.on_all)
        out["bodies"] = "all tissues of the solver";
    else
        out["bodies"] = f.bodies.size();
    for (std::size_t i = 0; i < f.values.size(); ++i) out[f.type->values[i].name] = f.values[i];
    return out;
}

Json describe(const nodes::SolveReport& r) {
    Json out = embed::step_json(r.record);
    out["size"] = embed::size_json(r);
    for (const nodes::LineReport& line : r.lines) out["lines_of_action"].push_back(embed::line_json(line));
    return out;
}

Json describe(const nodes::MarkList& list) {
    Json out = Json::array();
    for (const solver::MarkGroup& group : list.groups) {
        Json json = {{"term", group.term}, {"what", group.what}, {"marks", group.marks.size()}};
        if (!group.marks.empty()) {
            const auto less = [](const solver::Mark& a, const solver::Mark& b) { return a.value < b.value; };
            const auto [least, most] = std::minmax_element(group.marks.begin(), group.marks.end(), less);
            json["unit"] = group.unit, json["least"] = least->value, json["most"] = most->value;
        }
        out.push_back(std::move(json));
    }
    return out;
}

/// One entry a pair of bodies, by their places in zSolver.bodies.
Json describe(const nodes::ContactList& list) {
    Json out = Json::array();
    for (const nodes::ContactSum& pair : nodes::sums_of(list)) {
        const solver::ContactPoint& deepest = list.contacts[pair.deepest];
        out.push_back({{"source", pair.source},
                       {"target", pair.target},
                       {"contacts", pair.contacts},
                       {"sliding", pair.sliding},
                       {"max_depth_m", deepest.depth},
                       {"deepest_at", coordinates(deepest.place)},
                       {"force_N", coordinates(pair.force)}});
    }
    return out;
}

Json describe(const nodes::CurvePoints& curve) {
    Json out = {
        {"points", curve.points.size()}, {"form", nodes::word_of(curve.form)}, {"length", solver::curve_length(curve)}};
    for (const solver::Vec3& p : curve.points) out["at"].push_back({p.x(), p.y(), p.z()});
    add_box(out, curve.points);
    return out;
}

Json describe(const nodes::LineOfAction& line) {
    Json out = {{"curves", Json::array()}};
    for (const nodes::CurvePoints& curve : line.curves) out["curves"].push_back(describe(curve));
    for (const auto& f : solver::LineOfActionValues::fields()) out[f.name] = line.values.*f.at;
    return out;
}

Json describe(const nodes::RestShapeTarget& shape) {
    return {{"target", describe(shape.target)}, {"weights", shape.weights}, {"weight", shape.weight}};
}

Json describe(const nodes::Solved& solved) {
    Json out = Json::array();
    for (std::size_t i = 0; i < solved.positions.size(); ++i) {
        Json body = {{"vertices", solved.positions[i].size()}};
        add_box(body, solved.positions[i]);
        out.push_back(std::move(body));
    }
    return out;
}

/// A list of numbers as one line.
std::string line_of(const Json& list) {
    if (list.empty()) return "none";
    const bool shorten = list.size() > long_list;
    std::string out;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (shorten && i == shown_of_long_list) {
            out += " … (" + std::to_string(list.size()) + " in all)";
            break;
        }
        out += (i ? " " : "") + (list[i].is_string() ? list[i].get<std::string>() : json_text(list[i]));
    }
    return out;
}

void append_text(const Json& d, const std::string& indent, std::string& out) {
    const bool flat = !d.is_structured() || (d.is_array() && (d.empty() || !d.front().is_structured()));
    if (flat) {
        out += (d.is_array() ? line_of(d) : d.is_string() ? d.get<std::string>() : json_text(d)) + "\n";
        return;
    }
    std::size_t number = 0;
    for (const auto& [key, entry] : d.items()) {
        out += indent + (d.is_array() ? std::to_string(++number) : key) + ":";
        const bool nested = entry.is_object() || (entry.is_array() && !entry.empty() && entry.front().is_structured());
        out += nested ? "\n" : " ";
        append_text(entry, indent + "  ", out);
    }
}

} // namespace

Json describe_value(const engine::Value& v) {
    using namespace nodes;
    if (!v) return nullptr;
    if (v.is<bool>()) return v.as<bool>();
    if (v.is<std::int64_t>()) return v.as<std::int64_t>();
    if (v.is<double>()) return v.as<double>();
    if (v.is<std::string>()) return v.as<std::string>();
    if (v.is<engine::Vec3>()) return v.as<engine::Vec3>();
    if (v.is<engine::NumberList>()) return v.as<engine::NumberList>();
    if (v.is<engine::Matrix4>()) {
        const engine::Matrix4& m = v.as<engine::Matrix4>();
        Json rows = Json::array();
        for (std::size_t r = 0; r < 4; ++r) rows.push_back({m[4 * r], m[4 * r + 1], m[4 * r + 2], m[4 * r + 3]});
        return rows;
    }
    if (v.is<engine::File>())
        return {{"path", v.as<engine::File>().path}, {"digest", v.as<engine::File>().content.hex()}};
    if (v.is<Mesh>()) return describe(v.as<Mesh>());
    if (v.is<MeshList>()) {
        Json out = Json::array();
        for (const Mesh& mesh : v.as<MeshList>().meshes) out.push_back(describe(mesh));
        return out;
    }
    if (v.is<TetMeshValue>()) return describe(*v.as<TetMeshValue>().mesh);
    if (v.is<CurvePoints>()) return describe(v.as<CurvePoints>());
    if (v.is<RestShapeTarget>()) return describe(v.as<RestShapeTarget>());
    if (v.is<LineOfAction>()) return describe(v.as<LineOfAction>());
    if (v.is<Material>()) {
        const Material& m = v.as<Material>();
        Json out = describe(m.values);
        out["pressure"] = m.pressure, out["surfaceTension"] = m.surface_tension;
        out["cloth"] = describe(m.cloth);
        out["weights"] = m.weights;
        return out;
    }
    if (v.is<Fiber>()) {
        Json out = describe(v.as<Fiber>().values);
        out["weights"] = v.as<Fiber>().weights;
        out["endPoints"] = v.as<Fiber>().end_points;
        if (v.as<Fiber>().line) out["lineOfAction"] = describe(*v.as<Fiber>().line);
        return out;
    }
    if (v.is<Body>()) return describe(v.as<Body>());
    if (v.is<Attachment>()) return describe(v.as<Attachment>());
    if (v.is<Force>()) return describe(v.as<Force>());
    if (v.is<SolveReport>()) return describe(v.as<SolveReport>());
    if (v.is<Solved>()) return describe(v.as<Solved>());
    if (v.is<MarkList>()) return describe(v.as<MarkList>());
    if (v.is<ContactList>()) return describe(v.as<ContactList>());
    if (v.is<FileContent>())
        return {{"ending", v.as<FileContent>().ending}, {"bytes", v.as<FileContent>().bytes.size()}};
    return Json::object();
}

std::string as_text(const Json& description) {
    std::string out;
    append_text(description, "  ", out);
    return out;
}

std::string file_url(const std::filesystem::path& absolute) {
    constexpr std::string_view plain = "/-._~!$&'()*+,;=:@"; // beside letters and digits
    std::string out = "file://";
    for (const char c : absolute.string()) {
        const auto byte = static_cast<unsigned char>(c);
        if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
            plain.find(c) != std::string_view::npos) {
            out += c;
            continue;
        }
        constexpr char digits[] = "0123456789ABCDEF";
        out += {'%', digits[byte >> 4], digits[byte & 15]};
    }
    return out;
}

void print_diagnostics(std::span<const engine::Diagnostic> diagnostics, bool as_json, std::ostream& out,
                       std::ostream& err) {
    for (const engine::Diagnostic& d : diagnostics) {
        if (!as_json) {
            err << engine::to_text(d) << "\n";
            continue;
        }
        Json line = {{"event", "diagnostic"}};
        line.update(Json::parse(engine::to_json(d)));
        out << json_text(line) << "\n";
    }
    (as_json ? out : err).flush();
}

} // namespace sinew::cli
