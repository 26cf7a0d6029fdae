// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/doubts.h"

#include "engine/curve.h"
#include "engine/text.h"
#include "nodes/matrices.h"
#include "nodes/options.h"
#include "nodes/values.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/thickness.h"
#include "tools/cli/open_graph.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>

namespace sinew::cli {

using engine::Diagnostic;
using engine::Plug;

namespace {

/// Longest sides of a tissue between which it is taken as flesh [m]: from a muscle of the hand to a whale's back.
constexpr double least_extent = 0.01, largest_extent = 5;
/// Softer than brain by far [Pa]; what people write who mean kPa.
constexpr double least_modulus = 100;
/// Parts are thin below this share of a tet's length; muscles taper, so it takes this share of the surface.
constexpr double thin_part = 0.25, thin_share = 0.25;
constexpr std::size_t most_rays = 20000, most_rays_in_passing = 1000;
/// Triangles of a mesh that is looked at for flaws in passing.
constexpr std::size_t most_triangles_in_passing = 20000;
/// Attached shares of a surface from which on the whole is meant, or nothing was painted.
constexpr double nearly_whole = 0.9;
/// No body of a scene is so many times as large as another and none between them, if they are in one unit.
constexpr double unit_gap = 60;
/// [m/s^2]: the sun has 274.
constexpr double largest_gravity = 300;
/// Lungs have 250 [kg/m^3].
constexpr double least_density = 50;
/// A hundredth of what muscles have [Pa].
constexpr double least_strength = 1000;

/// "1.2", two digits of it.
std::string rough(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", value);
    return engine::number_text(std::stod(text));
}

/// "1.2 mm", "35 cm", "18 m".
std::string length_text(double metres) {
    if (metres < 0.01) return rough(1000 * metres) + " mm";
    return metres < 1 ? rough(100 * metres) + " cm" : rough(metres) + " m";
}

double extent(const solver::Points& points) {
    solver::Vec3 least = points.front(), most = least;
    for (const solver::Vec3& p : points) least = least.cwiseMin(p), most = most.cwiseMax(p);
    return (most - least).maxCoeff();
}

class Doubts {
  public:
    Doubts(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator, Look look,
           std::stop_token stop, const std::shared_ptr<engine::Failures>& failures)
        : graph_(graph)
        , evaluator_(evaluator)
        , look_(look)
        , stop_(stop)
        , failures_(failures) {}

    std::vector<Diagnostic> find(const std::vector<std::string>& nodes) {
        frame_ = start_frame(*graph_, nodes);
        for (const std::string& name : nodes) {
            const engine::Node* node = graph_->find(name);
            if (!node || !node->type) continue;
            if (name_of(node) == "zMaterial") soft_material(name), light_material(name);
            if (name_of(node) == "zFiber") weak_fiber(name);
            if (name_of(node) == "transform") mirroring_transform(name);
            if (name_of(node) == "zBone") mirroring_bone(name);
            if (name_of(node) == "zHold") whole_hold(name);
            if (name_of(node) == "zSolver") solver(name);
        }
        return std::move(out_);
    }

  private:
    static std::string_view name_of(const engine::Node* node) { return node->type->name; }

    void doubt(std::string_view code, const std::string& node, std::string_view attribute, std::string message,
               std::string hint) {
        Diagnostic d;
        d.severity = engine::Severity::warning;
        d.code = code;
        d.node = node, d.attribute = attribute;
        d.spot = graph_->spot(node, attribute);
        if (!d.spot) d.spot = graph_->spot(node);
        d.message = std::move(message), d.hint = std::move(hint);
        out_.push_back(std::move(d));
    }

    /// Empty where it cannot be had.
    template <class T>
    std::optional<T> value(const Plug& plug) {
        try {
            const engine::Value v = evaluator_.pull({graph_, plug, frame_, stop_, failures_});
            if (v.is<T>()) return v.as<T>();
        } catch (const engine::Failure&) {
        }
        return {};
    }

    /// The connections at an input, in order.
    std::vector<Plug> plugs(const std::string& node, std::string_view attribute) const {
        const auto& inputs = graph_->find(node)->inputs;
        const auto it = inputs.find(attribute);
        if (it == inputs.end()) return {};
        if (const auto* one = std::get_if<Plug>(&it->second)) return {*one};
        const auto* list = std::get_if<std::vector<Plug>>(&it->second);
        return list ? *list : std::vector<Plug>();
    }

    /// A literal; the default if nothing stands there; empty if it is keyed or connected.
    template <class T>
    std::optional<T> number(const std::string& node, std::string_view attribute) const {
        const engine::Node& n = *graph_->find(node);
        const auto it = n.inputs.find(attribute);
        engine::Value v;
        if (it == n.inputs.end())
            v = engine::default_value(*n.type->find_input(attribute), graph_->timing());
        else if (const auto* literal = std::get_if<engine::Value>(&it->second))
            v = *literal;
        if (v.is<T>()) return v.as<T>();
        return {};
    }

    /// The same of vectors and matrices, with the value that keys give at the start.
    template <class T>
    std::optional<T> at_start(const std::string& node, std::string_view attribute) const {
        const auto& inputs = graph_->find(node)->inputs;
        const auto it = inputs.find(attribute);
        const auto* curve = it == inputs.end() ? nullptr : std::get_if<engine::Curve>(&it->second);
        if (!curve) return number<T>(node, attribute);
        if constexpr (std::is_same_v<T, engine::Matrix4>) return curve->matrix_at(frame_);
        const std::vector<double> numbers = curve->at(frame_);
        T out{};
        if (numbers.size() != out.size()) return {};
        std::copy(numbers.begin(), numbers.end(), out.begin());
        return out;
    }

    void soft_material(const std::string& name) {
        const auto material = value<nodes::Material>({name, "outMaterial"});
        if (!material) return;
        const double modulus = material->values.youngs_modulus;
        for (const engine::Preset& p : graph_->find(name)->type->find_input("youngsModulus")->presets)
            if (modulus == p.value) return; // asked for by name
        if (modulus < least_modulus)
            doubt("FE263", name, "youngsModulus",
                  engine::number_text(modulus) + " Pa is softer than any flesh; brain has 500 Pa, a muscle 12 kPa",
                  "if kilopascals are meant, write \"" + engine::number_text(modulus) + " kPa\"");
    }

    void light_material(const std::string& name) {
        const auto density = number<double>(name, "massDensity");
        if (!density || *density <= 0 || *density >= least_density) return;
        doubt("FE323", name, "massDensity",
              engine::number_text(*density) + " kg/m^3 is lighter than any flesh; water has 1000, a lung 250",
              "if grams a cubic centimetre are meant, write \"" + engine::number_text(*density) + " g/cm^3\"");
    }

    void weak_fiber(const std::string& name) {
        const auto strength = number<double>(name, "strength");
        if (!strength || *strength <= 0 || *strength >= least_strength) return; // 0: a direction and no pull
        doubt("FE324", name, "strength",
              engine::number_text(*strength) + " Pa hardly pulls; muscles have 100 to 300 kPa",
              "if kilopascals are meant, write \"" + engine::number_text(*strength) + " kPa\"");
    }

    bool has_track(const std::string& name) const {
        const auto file = number<engine::File>(name, "track");
        return file && !file->path.empty();
    }

    static bool is_negative(const std::optional<engine::Vec3>& v) { return v && (*v)[0] * (*v)[1] * (*v)[2] < 0; }
    static bool is_negative(const std::optional<engine::Matrix4>& m) { return m && nodes::volume_factor(*m) < 0; }

    /// The transform whose outMatrix is applied after this one; empty if there is none.
    std::string above(const std::string& name) const {
        for (const Plug& plug : plugs(name, "offsetParentMatrix"))
            if (const engine::Node* node = graph_->find(plug.node); node->type && name_of(node) == "transform")
                return plug.node;
        return {};
    }

    /// Whether all that a transform does, those above it included, mirrors. Chains are walked once and not evaluated:
    /// that would take the square of their length. What a recorded motion does only evaluation tells.
    bool mirrors(const std::string& name) {
        std::vector<std::string> way;
        for (std::string at = name; !at.empty() && !mirrors_.contains(at); at = above(at)) way.push_back(at);
        for (; !way.empty(); way.pop_back()) {
            const std::string& at = way.back();
            if (has_track(at)) {
                mirrors_[at] = is_negative(value<engine::Matrix4>({at, "outMatrix"}));
                continue;
            }
            const bool itself = is_negative(at_start<engine::Vec3>(at, "scale")) !=
                                is_negative(at_start<engine::Matrix4>(at, "offsetParentMatrix"));
            const std::string next = above(at);
            mirrors_[at] = itself != (!next.empty() && mirrors_[next]);
        }
        return mirrors_[name];
    }

    void mirrored(const std::string& name, std::string_view attribute, const std::string& what) {
        doubt("FE265", name, attribute, what + " mirrors, which turns what is moved inside out: its faces look inwards",
              "mirror the mesh where it is modelled and turn its faces, or scale by positive numbers and rotate");
    }

    /// Told where the mirroring comes in, not of all that goes along.
    void mirroring_transform(const std::string& name) {
        if (!mirrors(name)) return;
        if (const std::string next = above(name); !next.empty() && mirrors(next)) return;
        if (is_negative(at_start<engine::Vec3>(name, "scale")))
            mirrored(name, "scale", "the scale");
        else if (is_negative(at_start<engine::Matrix4>(name, "offsetParentMatrix")))
            mirrored(name, "offsetParentMatrix", "the matrix");
        else
            mirrored(name, "track", "the recorded motion");
    }

    void mirroring_bone(const std::string& name) {
        if (is_negative(at_start<engine::Matrix4>(name, "matrix"))) mirrored(name, "matrix", "the matrix");
    }

    void whole_hold(const std::string& name) {
        if (number<bool>(name, "enable") == false) return;
        auto weights = number<engine::NumberList>(name, "weights");
        for (const Plug& plug : plugs(name, "weights")) weights = value<engine::NumberList>(plug);
        if (!weights || !std::all_of(weights->begin(), weights->end(), [](double w) { return w > 0; })) return;
        for (const Plug& plug : plugs(name, "tissue"))
            doubt("FE331", name, "weights",
                  "holds the whole of " + plug.node + ", so nothing of it moves or deforms by itself",
                  "paint what is to be held: a node weights with the mesh of " + plug.node +
                      ", for example with mode near; what is to move as a whole is a zBone");
    }

    struct Member {
        std::string name;
        nodes::Body body;
    };

    void solver(const std::string& name) {
        std::vector<Member> members;
        std::size_t disabled = 0;
        for (const Plug& plug : plugs(name, "bodies"))
            if (auto body = value<nodes::Body>(plug)) {
                if (body->takes_part && !body->enable) return; // comes later
                disabled += body->takes_part ? 0 : 1;
                if (body->takes_part) members.push_back({plug.node, std::move(*body)});
            }
        const auto units = number<double>(name, "scale");
        if (members.size() + disabled != plugs(name, "bodies").size() || !units) return; // told elsewhere
        strong_gravity(name);
        floating(name, members);
        implausible_size(name, members, *units);
        other_units(name, members);
        for (const Member& m : members)
            if (!m.body.is_bone() && !m.body.subtissue) flawed_mesh(m);
        for (const Member& m : members)
            if (const auto* rest = std::get_if<0>(&m.body.rest->data); rest && !m.body.subtissue) thin_parts(m, **rest);
        std::vector<nodes::BodyId> ids;
        for (const Member& m : members) ids.push_back(id_of(m.body));
        for (const Plug& plug : plugs(name, "attachments"))
            if (const auto a = value<nodes::Attachment>(plug)) whole_body(plug.node, *a, members, ids);
    }

    void strong_gravity(const std::string& solver) {
        const auto gravity = number<engine::Vec3>(solver, "gravity");
        if (!gravity) return;
        const engine::Vec3& g = *gravity;
        const double size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
        if (size <= largest_gravity) return;
        std::string cure;
        for (const double part : g) cure += (cure.empty() ? "[" : ", ") + engine::number_text(part / size * 9.8 + 0.0);
        doubt("FE322", solver, "gravity", rough(size) + " m/s^2 is " + rough(size / 9.8) + " times the earth's",
              "gravity is in m/s^2, whatever the scene's scale: " + cure + "]");
    }

    /// Attachments that are there but pull at nothing, at all frames.
    bool is_idle(const std::string& attachment) const {
        return number<double>(attachment, "envelope") == 0.0 || number<double>(attachment, "stiffness") == 0.0;
    }

    void floating(const std::string& solver, const std::vector<Member>& members) {
        const auto gravity = number<engine::Vec3>(solver, "gravity");
        const auto integrator = number<std::string>(solver, "integrator");
        if (gravity == engine::Vec3{}) return;
        if (integrator == std::string(nodes::word_of(solver::Integrator::quasi_static))) return; // FE303
        if (number<bool>(solver, "collisionDetection").value_or(false)) return; // what it falls on may catch it
        std::vector<nodes::BodyId> ids;
        std::vector<char> held;
        for (const Member& m : members) ids.push_back(id_of(m.body)), held.push_back(m.body.is_bone());
        for (const Plug& plug : plugs(solver, "forces"))
            if (const auto force = value<nodes::Force>(plug); force && force->type->ties)
                for (const nodes::BodyId& id : force->bodies) set(held, find_body(ids, id));
        std::string idle;
        std::vector<std::array<int, 2>> links; // a part of a tissue goes with it
        for (std::size_t i = 0; i < members.size(); ++i)
            for (std::size_t k = 0; k < members.size() && members[i].body.subtissue; ++k)
                for (const nodes::BodyRest::Part& part : members[k].body.rest->parts)
                    if (part.digest == members[i].body.subtissue->digest)
                        links.push_back({static_cast<int>(i), static_cast<int>(k)});
        for (const Plug& plug : plugs(solver, "attachments"))
            if (const auto a = value<nodes::Attachment>(plug); a && a->values.mode() != solver::AttachmentMode::none) {
                if (is_idle(plug.node))
                    idle += (idle.empty() ? "" : ", ") + plug.node;
                else
                    links.push_back({find_body(ids, a->source_body), find_body(ids, a->target_body)});
            }
        for (bool grows = true; grows;) {
            grows = false;
            for (const auto& [a, b] : links)
                if (a >= 0 && b >= 0 && held[at(a)] != held[at(b)]) held[at(a)] = held[at(b)] = 1, grows = true;
        }
        for (std::size_t i = 0; i < members.size(); ++i)
            if (!held[i] && !members[i].body.subtissue)
                doubt("FE260", solver, "bodies",
                      members[i].name + " falls: no chain of attachments ties it to a bone, and nothing holds it" +
                          (idle.empty() ? "" : "; attachments without stiffness or envelope tie nothing: " + idle),
                      "attach it to a bone, hold a part of it by zHold, or switch gravity off: [0, 0, 0]");
    }

    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    static void set(std::vector<char>& flags, int i) {
        if (i >= 0) flags[at(i)] = 1;
    }

    void implausible_size(const std::string& solver, const std::vector<Member>& members, double units) {
        const Member* largest = nullptr;
        double found = 0; // scene units
        for (const Member& m : members)
            if (!m.body.is_bone() && extent(*m.body.rest->mesh.points) > found)
                found = extent(*m.body.rest->mesh.points), largest = &m;
        const double metres = found / units;
        if (!largest || (metres >= least_extent && metres <= largest_extent)) return;
        constexpr std::array<std::pair<double, const char*>, 3> usual{
            {{100, "centimetres"}, {1000, "millimetres"}, {1, "metres"}}};
        std::string cure;
        for (const auto& [per_metre, unit] : usual) {
            const double length = found / per_metre;
            if (length < least_extent || length > largest_extent) continue;
            const std::string scale = engine::number_text(per_metre), size = "which makes it " + length_text(length);
            cure += cure.empty()
                        ? "if it is modelled in " + std::string(unit) + ", write \"scale\": " + scale + ", " + size
                        : "; if in " + std::string(unit) + ", " + scale + ", " + size;
        }
        if (cure.empty()) cure = "scale is the number of scene units in a metre; choose it, or scale the meshes";
        if (const std::string file = file_of(largest->name); file.ends_with(".glb") && units != 1)
            cure += "; what a GLB holds is in metres by its format: \"scale\": 1";
        doubt("FE261", solver, "scale",
              largest->name + " is " + length_text(metres) + " long: " + rough(found) + " scene units, " +
                  engine::number_text(units) + " a metre",
              cure);
    }

    /// The file that a body's mesh comes from, in small letters; empty: from none.
    std::string file_of(const std::string& body) const {
        std::vector<std::string> sources;
        for (const Plug& plug : plugs(body, "mesh")) sources.push_back(plug.node);
        for (const std::string& name : upstream_of(*graph_, sources))
            for (const auto& [attribute, binding] : graph_->find(name)->inputs)
                if (const auto* v = std::get_if<engine::Value>(&binding); v && v->is<engine::File>()) {
                    std::string path = v->as<engine::File>().path;
                    for (char& c : path) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
                    if (!path.empty()) return path;
                }
        return {};
    }

    /// Of a bone where it is, which may be scaled.
    static const nodes::Mesh& mesh_of(const nodes::Body& body) {
        const auto* now = std::get_if<nodes::Mesh>(&body.values);
        return now ? *now : body.rest->mesh;
    }

    void other_units(const std::string& solver, const std::vector<Member>& members) {
        std::vector<std::pair<double, const Member*>> sizes;
        for (const Member& m : members)
            if (!m.body.subtissue) sizes.emplace_back(extent(*mesh_of(m.body).points), &m);
        std::sort(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        for (std::size_t k = 1; k < sizes.size(); ++k) {
            const double below = sizes[k - 1].first, above = sizes[k].first;
            if (!(below > 0 && above > unit_gap * below)) continue;
            // The fewer are taken for the mistake; what is made by a node is as large as the graph says.
            std::vector<const Member*> few;
            bool small = 2 * k <= sizes.size();
            const auto take_files = [&] {
                for (std::size_t i = small ? 0 : k; i < (small ? k : sizes.size()); ++i)
                    if (!file_of(sizes[i].second->name).empty()) few.push_back(sizes[i].second);
            };
            take_files();
            if (few.empty() && 2 * k == sizes.size()) small = false, take_files();
            if (few.empty()) return;
            std::string names;
            for (const Member* m : few) names += (names.empty() ? "" : ", ") + m->name;
            const double ratio = sizes.back().first / sizes.front().first, factor = ratio < 316 ? 100 : 1000;
            const auto range = [](double least, double most) {
                return rough(least) + (rough(least) == rough(most) ? "" : " to " + rough(most)) + " scene units";
            };
            const std::string one = range(sizes.front().first, below), other = range(above, sizes.back().first);
            doubt("FE320", solver, "bodies",
                  names + (few.size() == 1 ? " is " : " are ") + (small ? one : other) + " long, the other bodies " +
                      (small ? other : one) + ": " + (small ? "smaller" : "larger") + " by a factor of about " +
                      rough(ratio),
                  "if they are modelled in different units, put a transform with scale " +
                      engine::number_text(small ? factor : 1 / factor) + " between the file and " + names);
            return;
        }
    }

    void flawed_mesh(const Member& m) {
        const auto& triangles = m.body.rest->mesh.topology->triangles;
        if (look_ == Look::in_passing && triangles.size() > most_triangles_in_passing) return;
        const solver::MeshCheck check = solver::check_mesh(*m.body.rest->mesh.points, triangles);
        if (check.duplicate_triangles)
            doubt(
                "FE321", m.name, "mesh",
                "its mesh has " +
                    solver::describe(check.duplicate_triangles, "repeated triangle", "repeated triangles"),
                "remove faces that are there twice, or remesh it by zIsoMesh; volume, pressure and contact count them "
                "twice");
        else if (check.badly_oriented_edges)
            doubt(
                "FE321", m.name, "mesh",
                "some faces of its mesh look the other way than their neighbours: " +
                    solver::describe(check.badly_oriented_edges, "edge between opposite sides",
                                     "edges between opposite sides"),
                "turn the faces alike where it is modelled, or remesh it by zIsoMesh; pressure, contact and drawing go "
                "by the side that a face shows");
    }

    void thin_parts(const Member& m, const solver::TissueRest& rest) {
        if (rest.tets.coverage.empty()) return;      // tets that fit the surface
        std::vector<std::pair<double, double>> thin; // thickness, area
        double all = 0, thin_area = 0, largest = 0;
        for (const solver::Thickness& t : solver::thickness(
                 rest.surface, rest.triangles, look_ == Look::closely ? most_rays : most_rays_in_passing)) {
            all += t.area;
            const int vertex = rest.triangles[at(t.triangle)][0];
            const double length = longest_edge(rest, rest.embedding.tet[at(vertex)]);
            if (!(t.distance < thin_part * length)) continue;
            thin.emplace_back(t.distance, t.area);
            thin_area += t.area;
            largest = std::max(largest, length);
        }
        if (!(thin_area > thin_share * all)) return;
        std::sort(thin.begin(), thin.end());
        double area = 0, usual = 0; // half of what is thin is thinner
        for (std::size_t i = 0; i < thin.size() && area < thin_area / 2; ++i)
            area += thin[i].second, usual = thin[i].first;
        const std::vector<Plug> tets = plugs(m.name, "tets");
        const bool sized = !tets.empty() && graph_->find(tets.front().node)->type_name == "zTet";
        doubt("FE262", sized ? tets.front().node : m.name, sized ? "tetSize" : "tets",
              rough(100 * thin_area / all) + " % of the surface of " + m.name + " belongs to parts about " +
                  rough(usual) + " thick, less than a quarter of the tets there (" + rough(largest) + ")",
              std::string(sized ? "choose" : "connect a zTet with") + " a tetSize of about " + rough(usual) +
                  ", or refine there by weights and surfaceRefinement");
    }

    static double longest_edge(const solver::TissueRest& rest, int tet) {
        double longest = 0;
        const solver::Tet& t = rest.tets.tets[at(tet)];
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < i; ++j)
                longest = std::max(longest, (rest.tets.vertices[at(t[i])] - rest.tets.vertices[at(t[j])]).norm());
        return longest;
    }

    /// Of the surface, by area, from 0 to 1: exactly 1 where all of it is.
    static double painted_share(const nodes::Body& body, const std::vector<double>& weights) {
        if (std::all_of(weights.begin(), weights.end(), [](double w) { return w > 0; })) return 1;
        const solver::Points& points = *body.rest->mesh.points;
        double all = 0, painted = 0;
        for (const solver::Triangle& t : body.rest->mesh.topology->triangles) {
            const auto corner = [&](std::size_t i) -> const solver::Vec3& { return points[at(t[i])]; };
            const double third = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 6;
            for (std::size_t i = 0; i < 3; ++i) {
                all += third;
                if (weights.size() > at(t[i]) && weights[at(t[i])] > 0) painted += third;
            }
        }
        return all > 0 ? std::min(painted / all, 0.99) : 0;
    }

    void whole_body(const std::string& name, const nodes::Attachment& a, const std::vector<Member>& members,
                    const std::vector<nodes::BodyId>& ids) {
        const int source = find_body(ids, a.source_body);
        if (source < 0 || members[at(source)].body.is_bone() || a.values.mode() != solver::AttachmentMode::fixed)
            return;
        // A fascia of cloth may well cling to the flesh below it everywhere.
        const int target = find_body(ids, a.target_body);
        if (members[at(source)].body.is_cloth() && target >= 0 && !members[at(target)].body.is_bone()) return;
        const double share = painted_share(members[at(source)].body, a.rest.source_weights);
        if (share < nearly_whole) return;
        doubt("FE264", name, "weights",
              "ties " +
                  (share < 1 ? std::to_string(static_cast<int>(100 * share)) + " % of" : std::string("the whole")) +
                  (share < 1 ? " the" : "") + " surface of " + members[at(source)].name,
              "paint where it holds on: a node weights with the mesh of " + members[at(source)].name +
                  ", for example with mode near");
    }

    std::shared_ptr<const engine::Graph> graph_;
    engine::Evaluator& evaluator_;
    Look look_;
    std::stop_token stop_;
    std::shared_ptr<engine::Failures> failures_;
    double frame_ = 1;
    std::map<std::string, bool> mirrors_; ///< by transform
    std::vector<Diagnostic> out_;
};

} // namespace

std::vector<Diagnostic> find_doubts(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
                                    const std::vector<std::string>& nodes, Look look, std::stop_token stop,
                                    const std::shared_ptr<engine::Failures>& failures) {
    return Doubts(graph, evaluator, look, stop, failures).find(nodes);
}

} // namespace sinew::cli
