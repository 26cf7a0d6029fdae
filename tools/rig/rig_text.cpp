// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/rig_text.h"

#include "tools/rig/graph_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

namespace sinew::rig {

namespace {

constexpr double tendon_modulus = 1e6, hold_stiffness = 1e9, touch_stiffness = 1e5;
constexpr double flesh_density = 1060, tendon_density = 1120, fat_density = 920;
constexpr double usual_strength = 12e3, usual_excitation = 0.3;

std::string capital(std::string name) {
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    return name;
}

class Writer {
  public:
    Writer(const Rig& rig, const TextOptions& options)
        : rig_(rig)
        , options_(options) {}

    std::string text() {
        for (const Part& part : rig_.parts)
            if (part.kind == Kind::bone) bone(part);
        materials();
        for (const Muscle& m : rig_.muscles) muscle(m);
        for (const Muscle& m : rig_.muscles) attachments(m);
        if (!rig_.touches.empty()) {
            text_.blank();
            text_.comment(
                "Bodies that touch, but do not hold on to each other: soft springs between what is near, so that "
                "they neither part nor pass each other. Fixed ones shear, sliding ones hold along the normal "
                "alone; contacts are exact and slower (zSolver.collisionDetection).");
            for (const Touch& t : rig_.touches) touch(t);
        }
        solver();
        return text_.file(head_text(rig_, options_), 1, last_frame(options_), graph_fps);
    }

  private:
    std::string length(double value) const { return length_text(rig_, value); }
    const std::string& name(std::size_t part) const { return rig_.parts[part].name; }

    void bone(const Part& part) {
        if (!is_first_) text_.blank();
        is_first_ = false;
        write_bone(text_, rig_, part, options_);
    }

    void materials() {
        const auto uses = [&](bool tendon) {
            return std::any_of(rig_.muscles.begin(), rig_.muscles.end(),
                               [&](const Muscle& m) { return !has_own_material(m) && m.is_tendon == tendon; });
        };
        text_.blank();
        text_.comment(
            "What they are made of. Real tendons are a thousand times stiffer; these hardly give under a muscle "
            "either, and are easier to solve.");
        if (uses(false))
            text_.node("flesh", "zMaterial",
                       {{"youngsModulus", "{\"preset\": \"skeletalMuscle\"}"}, {"massDensity", number(flesh_density)}});
        if (uses(true))
            text_.node("sinew", "zMaterial",
                       {{"youngsModulus", number(tendon_modulus)}, {"massDensity", number(tendon_density)}});
    }

    static bool has_own_material(const Muscle& m) {
        return m.options.youngs_modulus || m.options.density || m.options.preset == "fat";
    }

    /// The node that gives the muscle's lowest layer.
    std::string base_material(const Muscle& m) {
        const MuscleOptions& o = m.options;
        if (!has_own_material(m)) return m.is_tendon ? "sinew" : "flesh";
        const bool is_fat = o.preset == "fat";
        const std::string node = name(m.part) + "Flesh";
        const std::string usual = is_fat ? "{\"preset\": \"fat\"}" : m.is_tendon ? number(tendon_modulus) : "12000";
        text_.node(node, "zMaterial",
                   {{"youngsModulus", o.youngs_modulus ? number(*o.youngs_modulus) : usual},
                    {"massDensity", number(o.density.value_or(is_fat        ? 920
                                                              : m.is_tendon ? 1120
                                                                            : 1060))}});
        return node;
    }

    std::string hold_name(const Muscle& m, std::size_t end, std::size_t hold) const {
        const std::size_t target = m.ends[end].holds[hold].target;
        std::string out = name(m.part) + "To" + capital(name(target));
        // Both ends on one bone.
        if (end == 1)
            for (const Hold& other : m.ends[0].holds)
                if (other.target == target) out += "2";
        return out;
    }

    void sphere(const std::string& node, const std::string& mesh, const solver::Vec3& centre, double radius,
                double falloff, bool is_inverted) {
        Inputs inputs{{"mesh", wire(mesh, "outMesh")},
                      {"mode", "\"sphere\""},
                      {"center", vector(centre)},
                      {"radius", number(radius)},
                      {"falloff", number(falloff)}};
        if (is_inverted) inputs.emplace_back("invert", "true");
        text_.node(node, "weights", inputs);
    }

    /// Paint of one end on what it reaches; gives the node with the weights.
    std::string paint(const Muscle& m, std::size_t end, std::size_t index) {
        const Hold& hold = m.ends[end].holds[index];
        const std::string mesh = name(m.part) + "Mesh", node = hold_name(m, end, index) + "Paint";
        const bool is_masked = hold.mask != Mask::none;
        const std::string near = is_masked ? hold_name(m, end, index) + "Near" : node;
        text_.node(near, "weights",
                   {{"mesh", wire(mesh, "outMesh")},
                    {"mode", "\"near\""},
                    {"otherMesh", wire(name(hold.target) + "Mesh", "outMesh")},
                    {"innerDistance", number(hold.inner)},
                    {"outerDistance", number(hold.outer)}});
        if (!is_masked) return node + ".outWeights";
        const MaskSphere s = sphere_of(hold.mask, end, m);
        sphere(hold_name(m, end, index) + "Side", mesh, m.ends[s.tip].tip, s.radius, s.falloff, s.is_inverted);
        text_.node(
            node, "combineWeights",
            {{"weights", list({wire(near, "outWeights"), wire(hold_name(m, end, index) + "Side", "outWeights")})}});
        return node + ".outWeights";
    }

    std::string story(const Muscle& m) const {
        std::string out = length(m.shape.length) + " long, belly " + length(m.shape.thickness) + " thick.";
        for (std::size_t e = 0; e < 2; ++e) {
            const End& end = m.ends[e];
            out += e == 0 ? " From " : " to ";
            if (end.holds.empty()) {
                out += "nothing";
            } else {
                for (std::size_t h = 0; h < end.holds.size(); ++h)
                    out += (h > 0 ? " and " : "") + name(end.holds[h].target);
                out += end.holds[0].gap > 0 ? " (" + length(end.holds[0].gap) + " away)" : " (touching)";
            }
        }
        out += ".";
        for (const End& end : m.ends)
            for (const std::size_t p : end.also_near)
                out += " An end touches " + name(p) + ", too, but is not attached to it.";
        return out;
    }

    void muscle(const Muscle& m) {
        const Part& part = rig_.parts[m.part];
        const std::string mesh_node = part.name + "Mesh";
        text_.blank();
        text_.comment(part.name + ": " + story(m));
        write_mesh(text_, rig_, part, options_);
        text_.node(part.name + "Tets", "zTet", {{"mesh", wire(mesh_node, "outMesh")}, {"tetSize", number(m.tet_size)}});

        std::vector<std::string> layers{wire(base_material(m), "outMaterial")};
        if (!m.is_tendon)
            for (std::size_t e = 0; e < 2; ++e) {
                if (m.shape.tendons[e] == 0) continue;
                const std::string tendon = part.name + "Tendon" + (e == 0 ? "A" : "B");
                const double radius = m.shape.tendons[e] * m.shape.length;
                sphere(tendon + "Paint", mesh_node, m.ends[e].tip, 0.8 * radius, 0.4 * radius, false);
                text_.node(tendon, "zMaterial",
                           {{"youngsModulus", number(m.options.tendon_modulus.value_or(tendon_modulus))},
                            {"massDensity", number(tendon_density)},
                            {"weights", wire(tendon + "Paint", "outWeights")}});
                layers.push_back(wire(tendon, "outMaterial"));
            }

        std::array<std::string, 2> starts;
        for (std::size_t e = 0; e < 2; ++e) {
            for (std::size_t h = 0; h < m.ends[e].holds.size(); ++h) {
                const std::string node = paint(m, e, h);
                if (h == 0) starts[e] = node;
            }
            if (has_fibres(m) && m.ends[e].fibres_by_tip) {
                const std::string tip = part.name + "Tip" + (e == 0 ? "A" : "B");
                sphere(tip, mesh_node, m.ends[e].tip, tip_radius(m), 0, false);
                starts[e] = tip + ".outWeights";
            }
        }
        Inputs inputs;
        if (!m.is_held()) inputs.emplace_back("enable", "false");
        inputs.emplace_back("mesh", wire(mesh_node, "outMesh"));
        inputs.emplace_back("tets", wire(part.name + "Tets", "outTets"));
        if (!m.options.law.empty()) inputs.emplace_back("material", text_of(m.options.law));
        inputs.emplace_back("materials", list(layers));
        if (has_fibres(m)) {
            fibres(m, starts);
            inputs.emplace_back("fibers", list({wire(part.name + "Fibre", "outFiber")}));
        }
        if (m.is_tendon) inputs.emplace_back("appearance", "\"tendon\"");
        if (m.options.preset == "fat") inputs.emplace_back("appearance", "\"fat\"");
        text_.node(part.name, "zTissue", inputs);
    }

    static bool has_fibres(const Muscle& m) {
        return !m.is_tendon && m.options.preset != "fat" && m.options.strength.value_or(usual_strength) > 0;
    }

    void fibres(const Muscle& m, const std::array<std::string, 2>& starts) {
        const std::string muscle = name(m.part);
        text_.node(muscle + "Ends", "endPoints",
                   {{"mesh", wire(muscle + "Mesh", "outMesh")},
                    {"source", "{\"from\": " + text_of(starts[0]) + "}"},
                    {"sink", "{\"from\": " + text_of(starts[1]) + "}"}});
        const double excitation = m.options.excitation.value_or(usual_excitation);
        text_.node(muscle + "Fibre", "zFiber",
                   {{"endPoints", wire(muscle + "Ends", "outEndPoints")},
                    {"strength", number(m.options.strength.value_or(usual_strength))},
                    {"excitation", excitation > 0 ? rise(1, 13, excitation) : "0"}});
    }

    void attachments(const Muscle& m) {
        for (std::size_t e = 0; e < 2; ++e)
            for (std::size_t h = 0; h < m.ends[e].holds.size(); ++h) {
                if (attachments_.empty()) {
                    text_.blank();
                    text_.comment("What the muscles hold on to.");
                }
                const std::string node = hold_name(m, e, h);
                text_.node(node, "zAttachment",
                           {{"source", wire(name(m.part), "outBody")},
                            {"target", wire(name(m.ends[e].holds[h].target), "outBody")},
                            {"weights", wire(node + "Paint", "outWeights")},
                            {"stiffness", number(hold_stiffness)}});
                attachments_.push_back(wire(node, "outAttachment"));
            }
    }

    void touch(const Touch& t) {
        const std::string node = name(t.source) + "Over" + capital(name(t.target));
        text_.node(node + "Paint", "weights",
                   {{"mesh", wire(name(t.source) + "Mesh", "outMesh")},
                    {"mode", "\"near\""},
                    {"otherMesh", wire(name(t.target) + "Mesh", "outMesh")},
                    {"innerDistance", number(t.inner)},
                    {"outerDistance", number(t.outer)}});
        Inputs inputs{{"source", wire(name(t.source), "outBody")},
                      {"target", wire(name(t.target), "outBody")},
                      {"weights", wire(node + "Paint", "outWeights")},
                      {"stiffness", number(touch_stiffness)}};
        if (t.slides) inputs.emplace_back("attachmentMode", "\"sliding\"");
        text_.node(node, "zAttachment", inputs);
        attachments_.push_back(wire(node, "outAttachment"));
    }

    void solver() {
        std::vector<std::string> bodies;
        for (const Part& part : rig_.parts) bodies.push_back(wire(part.name, "outBody"));
        Inputs inputs{
            {"bodies", list(bodies)}, {"attachments", list(attachments_)}, {"scale", number(rig_.unit.per_metre)}};
        if (rig_.up.axis == 'z') inputs.emplace_back("gravity", "[0, 0, -9.8]");
        inputs.emplace_back("stiffnessDamping", "0.01");
        inputs.emplace_back("maxNewtonIterations", "30");
        text_.blank();
        text_.comment("scale is how many " + rig_.unit.name +
                      " make a metre. More iterations than usual, as stiff ends pull.");
        text_.node("solver", "zSolver", inputs);
    }

    const Rig& rig_;
    const TextOptions& options_;
    GraphText text_;
    std::vector<std::string> attachments_;
    bool is_first_ = true;
};

} // namespace

std::string rig_text(const Rig& rig, const TextOptions& options) { return Writer(rig, options).text(); }

} // namespace sinew::rig
