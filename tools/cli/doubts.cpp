// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/doubts.h"

#include "engine/text.h"
#include "nodes/options.h"
#include "nodes/values.h"
#include "solver/mesh/thickness.h"
#include "tools/cli/open_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

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
constexpr std::size_t most_rays = 20000;

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
    Doubts(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator, std::stop_token stop,
           const std::shared_ptr<engine::Failures>& failures)
        : graph_(graph)
        , evaluator_(evaluator)
        , stop_(stop)
        , failures_(failures) {}

    std::vector<Diagnostic> find() {
        const std::vector<std::string> all = graph_->node_names();
        frame_ = start_frame(*graph_, all);
        for (const std::string& name : all) {
            const engine::Node* node = graph_->find(name);
            if (!node->type) continue;
            if (name_of(node) == "zMaterial") soft_material(name);
            if (name_of(node) == "transform") mirrored(name);
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

    /// A literal or the value of keys at the start; the default if nothing stands there; empty if it is connected.
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

    void mirrored(const std::string& name) {
        const auto scale = number<engine::Vec3>(name, "scale");
        if (!scale || !((*scale)[0] * (*scale)[1] * (*scale)[2] < 0)) return;
        doubt("FE265", name, "scale", "the scale mirrors, which turns what is moved inside out: its faces look inwards",
              "mirror the mesh where it is modelled and turn its faces, or scale by positive numbers and rotate");
    }

    struct Member {
        std::string name;
        nodes::Body body;
    };

    void solver(const std::string& name) {
        std::vector<Member> members;
        for (const Plug& plug : plugs(name, "bodies"))
            if (auto body = value<nodes::Body>(plug); body && body->enable)
                members.push_back({plug.node, std::move(*body)});
        const auto units = number<double>(name, "scale");
        if (members.size() != plugs(name, "bodies").size() || !units) return; // disabled, or told elsewhere
        floating(name, members);
        implausible_size(name, members, *units);
        for (const Member& m : members)
            if (const auto* rest = std::get_if<0>(&m.body.rest->data); rest && !m.body.subtissue) thin_parts(m, **rest);
        std::vector<nodes::BodyId> ids;
        for (const Member& m : members) ids.push_back(id_of(m.body));
        for (const Plug& plug : plugs(name, "attachments"))
            if (const auto a = value<nodes::Attachment>(plug)) whole_body(plug.node, *a, members, ids);
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
        std::vector<std::array<int, 2>> links; // a part of a tissue goes with it
        for (std::size_t i = 0; i < members.size(); ++i)
            for (std::size_t k = 0; k < members.size() && members[i].body.subtissue; ++k)
                for (const nodes::BodyRest::Part& part : members[k].body.rest->parts)
                    if (part.digest == members[i].body.subtissue->digest)
                        links.push_back({static_cast<int>(i), static_cast<int>(k)});
        for (const Plug& plug : plugs(solver, "attachments"))
            if (const auto a = value<nodes::Attachment>(plug); a && a->values.mode() != solver::AttachmentMode::none)
                links.push_back({find_body(ids, a->source_body), find_body(ids, a->target_body)});
        for (bool grows = true; grows;) {
            grows = false;
            for (const auto& [a, b] : links)
                if (a >= 0 && b >= 0 && held[at(a)] != held[at(b)]) held[at(a)] = held[at(b)] = 1, grows = true;
        }
        for (std::size_t i = 0; i < members.size(); ++i)
            if (!held[i] && !members[i].body.subtissue)
                doubt("FE260", solver, "bodies",
                      members[i].name + " falls: no chain of attachments ties it to a bone, and nothing holds it",
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
        // The usual unit that gives something like an arm or a leg.
        constexpr std::array<std::pair<double, const char*>, 4> usual{
            {{1, "metres"}, {10, "decimetres"}, {100, "centimetres"}, {1000, "millimetres"}}};
        const auto off = [&](double per_metre) { return std::abs(std::log(found / per_metre / 0.5)); };
        const auto best = std::min_element(usual.begin(), usual.end(),
                                           [&](const auto& a, const auto& b) { return off(a.first) < off(b.first); });
        const bool helps = found / best->first >= least_extent && found / best->first <= largest_extent;
        doubt("FE261", solver, "scale",
              largest->name + " is " + length_text(metres) + " long: " + rough(found) + " scene units, " +
                  engine::number_text(units) + " a metre",
              helps ? "if it is modelled in " + std::string(best->second) + ", write \"scale\": " +
                          engine::number_text(best->first) + ", which makes it " + length_text(found / best->first)
                    : "scale is the number of scene units in a metre; choose it, or scale the meshes");
    }

    void thin_parts(const Member& m, const solver::TissueRest& rest) {
        if (rest.tets.coverage.empty()) return;      // tets that fit the surface
        std::vector<std::pair<double, double>> thin; // thickness, area
        double all = 0, thin_area = 0, largest = 0;
        for (const solver::Thickness& t : solver::thickness(rest.surface, rest.triangles, most_rays)) {
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

    void whole_body(const std::string& name, const nodes::Attachment& a, const std::vector<Member>& members,
                    const std::vector<nodes::BodyId>& ids) {
        const int source = find_body(ids, a.source_body);
        if (source < 0 || members[at(source)].body.is_bone() || a.values.mode() != solver::AttachmentMode::fixed)
            return;
        const auto& weights = a.rest.source_weights;
        if (std::any_of(weights.begin(), weights.end(), [](double w) { return w <= 0; })) return;
        doubt("FE264", name, "weights", "ties the whole surface of " + members[at(source)].name,
              "paint where it holds on: a node weights with the mesh of " + members[at(source)].name +
                  ", for example with mode near");
    }

    std::shared_ptr<const engine::Graph> graph_;
    engine::Evaluator& evaluator_;
    std::stop_token stop_;
    std::shared_ptr<engine::Failures> failures_;
    double frame_ = 1;
    std::vector<Diagnostic> out_;
};

} // namespace

std::vector<Diagnostic> find_doubts(const std::shared_ptr<const engine::Graph>& graph, engine::Evaluator& evaluator,
                                    std::stop_token stop, const std::shared_ptr<engine::Failures>& failures) {
    return Doubts(graph, evaluator, stop, failures).find();
}

} // namespace sinew::cli
