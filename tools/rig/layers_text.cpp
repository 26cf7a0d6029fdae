// Tissue, fascia and skin, a solver each.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/layers_text.h"

#include "solver/error.h"
#include "tools/rig/tet_limits.h"
#include "tools/rig/wrap.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace sinew::rig {

using engine::Severity;

namespace {

/// By the diagonal of all tissues.
constexpr double reach_share = 0.02, widest_gap = 0.15, shell_tets = 0.07, fascia_gap = 0.015, skin_gap = 0.03;
constexpr double fascia_thickness = 0.01, skin_thickness = 0.02;

double size_of(const Layers& layers) {
    solver::Box box = layers.rig.parts[layers.tissues.front()].box;
    for (const std::size_t t : layers.tissues) {
        box.min = box.min.cwiseMin(layers.rig.parts[t].box.min);
        box.max = box.max.cwiseMax(layers.rig.parts[t].box.max);
    }
    return box.size().norm();
}

class Writer {
  public:
    Writer(const Layers& layers, const TextOptions& options)
        : layers_(layers)
        , rig_(layers.rig)
        , options_(options)
        , size_(size_of(layers)) {}

    std::string text() {
        text_.comment("The bones; they stand still until a transform moves them (zBone.matrix).");
        for (const Part& part : rig_.parts)
            if (part.kind == Kind::bone) {
                write_bone(text_, rig_, part, options_);
                bodies_.push_back(wire(part.name, "outBody"));
            }
        tissues();
        shell("fascia", layers_.fascia,
              "The fascia: a thin, tight shell around the tissues, which it slides on; they are bones to it, and do "
              "not feel "
              "it.",
              "40000", "fascia", fascia_gap, fascia_thickness, tissues_meshes(), within_);
        text_.blank();
        text_.comment("The fascia as it comes out is a bone to the skin.");
        text_.node("fasciaSolved", "pickMesh", {{"meshes", wire("fasciaSolver", "outMeshes")}, {"body", "\"fascia\""}});
        text_.node("fasciaBelow", "zBone", {{"mesh", wire("fasciaSolved", "outMesh")}, {"appearance", "\"fascia\""}});
        shell("skin", layers_.skin,
              "The skin with the fat below it: a thicker, softer shell that slides on the fascia.", "8000", "skin",
              skin_gap, skin_thickness, {wire("fasciaMesh", "outMesh")}, {"fasciaBelow"});
        return text_.file(head_text(rig_, options_), 1, last_frame(options_), graph_fps);
    }

  private:
    const std::string& name(std::size_t part) const { return rig_.parts[part].name; }

    std::vector<std::string> tissues_meshes() const {
        std::vector<std::string> out;
        for (const std::size_t t : layers_.tissues) out.push_back(wire(name(t) + "Mesh", "outMesh"));
        return out;
    }

    void solver(const std::string& node, const std::vector<std::string>& bodies,
                const std::vector<std::string>& attachments) {
        Inputs inputs{{"bodies", list(bodies)}, {"attachments", list(attachments)}};
        add_space(inputs, rig_);
        inputs.emplace_back("stiffnessDamping", "0.01");
        inputs.emplace_back("maxNewtonIterations", "30");
        text_.node(node, "zSolver", inputs);
    }

    void tissues() {
        text_.blank();
        text_.comment(
            "The tissues, attached to the bones that they touch: whole up to the inner distance, then fading.");
        text_.node("flesh", "zMaterial", {{"youngsModulus", "{\"preset\": \"skeletalMuscle\"}"}});
        std::vector<std::string> bodies = bodies_, attachments;
        for (std::size_t i = 0; i < layers_.tissues.size(); ++i) {
            const Part& part = rig_.parts[layers_.tissues[i]];
            write_mesh(text_, rig_, part, options_);
            const std::string mesh = wire(part.name + "Mesh", "outMesh");
            text_.node(part.name + "Tets", "zTet", {{"mesh", mesh}, {"tetSize", number(layers_.tet_sizes[i])}});
            Inputs inputs;
            if (layers_.holders[i].empty()) inputs.emplace_back("enable", "false");
            inputs.emplace_back("mesh", mesh);
            inputs.emplace_back("tets", wire(part.name + "Tets", "outTets"));
            inputs.emplace_back("materials", list({wire("flesh", "outMaterial")}));
            text_.node(part.name, "zTissue", inputs);
            bodies.push_back(wire(part.name, "outBody"));
            for (const auto& [bone, gap, reach] : layers_.holders[i]) {
                std::string node = part.name + "To" + name(bone);
                char& first = node[part.name.size() + 2];
                first = static_cast<char>(std::toupper(static_cast<unsigned char>(first)));
                text_.node(node + "Paint", "weights",
                           {{"mesh", mesh},
                            {"mode", "\"near\""},
                            {"otherMesh", wire(name(bone) + "Mesh", "outMesh")},
                            {"innerDistance", number(gap + reach)},
                            {"outerDistance", number(gap + 2 * reach)}});
                text_.node(node, "zAttachment",
                           {{"source", wire(part.name, "outBody")},
                            {"target", wire(name(bone), "outBody")},
                            {"weights", wire(node + "Paint", "outWeights")}});
                attachments.push_back(wire(node, "outAttachment"));
            }
        }
        solver("tissueSolver", bodies, attachments);
        text_.blank();
        text_.comment("The tissues as they come out are bones to the next layer.");
        for (const std::size_t t : layers_.tissues) {
            text_.node(name(t) + "Solved", "pickMesh",
                       {{"meshes", wire("tissueSolver", "outMeshes")}, {"body", text_of(name(t))}});
            text_.node(name(t) + "Below", "zBone",
                       {{"mesh", wire(name(t) + "Solved", "outMesh")}, {"appearance", "\"muscle\""}});
            within_.push_back(name(t) + "Below");
        }
    }

    /// A layer that slides on what is `below` it.
    void shell(const std::string& node, int part, const std::string& what, const std::string& modulus,
               const std::string& look, double gap, double thickness, const std::vector<std::string>& around,
               const std::vector<std::string>& below) {
        text_.blank();
        text_.comment(what);
        if (part >= 0) {
            text_.node(
                node + "Mesh", "meshFile",
                {{"file", text_of(path_from(options_.folder, rig_.parts[static_cast<std::size_t>(part)].file))}});
        } else {
            text_.comment("No mesh was given: a surface " + length_text(rig_, gap * size_) + " around what is below.");
            text_.node(node + "Mesh", "zIsoMesh",
                       {{"meshes", list(around)},
                        {"isoValue", number(gap * size_)},
                        {"triangleSize", "0.8"},
                        {"resolution", "96"}});
        }
        text_.node(node + "Tets", "zTet",
                   {{"mesh", wire(node + "Mesh", "outMesh")},
                    {"tetSize", number(layers_.tet_size)},
                    {"fillInterior", "\"SurfaceOnly\""},
                    {"thickness", number(thickness * size_)}});
        text_.node(node + "Stuff", "zMaterial", {{"youngsModulus", modulus}});
        text_.node(node, "zTissue",
                   {{"mesh", wire(node + "Mesh", "outMesh")},
                    {"tets", wire(node + "Tets", "outTets")},
                    {"materials", list({wire(node + "Stuff", "outMaterial")})},
                    {"inertialDamping", "0.5"},
                    {"appearance", text_of(look)}});
        std::vector<std::string> bodies, attachments;
        for (const std::string& bone : below) {
            std::string slide = node + "On" + bone;
            char& first = slide[node.size() + 2];
            first = static_cast<char>(std::toupper(static_cast<unsigned char>(first)));
            text_.node(slide, "zAttachment",
                       {{"source", wire(node, "outBody")},
                        {"target", wire(bone, "outBody")},
                        {"attachmentMode", "\"sliding\""},
                        {"stiffness", "1e6"},
                        {"damping", "1000"}});
            bodies.push_back(wire(bone, "outBody"));
            attachments.push_back(wire(slide, "outAttachment"));
        }
        bodies.push_back(wire(node, "outBody"));
        solver(node + "Solver", bodies, attachments);
    }

    const Layers& layers_;
    const Rig& rig_;
    const TextOptions& options_;
    const double size_;
    GraphText text_;
    std::vector<std::string> bodies_, within_;
};

} // namespace

namespace {

/// Throws engine::Failure with all tets that zTet refuses. Fascia and skin are about as large as what is in them.
void check_tets(const Layers& layers, const GuessOptions& options) {
    std::vector<engine::Diagnostic> wrong;
    const auto look_at = [&](std::size_t part, double tet_size) {
        const Part& p = layers.rig.parts[part];
        if (auto said = refused_tets(p.name, p.points, p.triangles, tet_size, "--tet-scale", options.stop))
            wrong.push_back(std::move(*said));
    };
    for (std::size_t i = 0; i < layers.tissues.size(); ++i)
        look_at(layers.tissues[i], std::min(layers.tet_sizes[i], layers.tet_size));
    if (!wrong.empty()) throw engine::Failure(std::move(wrong));
}

} // namespace

Layers guess_layers(const LayerFiles& files, const GuessOptions& options) {
    Layers out;
    auto [soft, bones] = mesh_files(options.files, files.tissues, files.bones, out.rig.notes);
    if (soft.empty() || bones.empty())
        throw engine::Failure(
            say(Severity::error, "DG156", "",
                soft.empty() ? "there is no tissue" : "there is no bone, so nothing would hold the tissues",
                "Name meshes of tissues, and bones with --bones."));
    if (!files.fascia.empty()) soft.push_back(files.fascia);
    if (!files.skin.empty()) soft.push_back(files.skin);
    Rig& rig = out.rig;
    rig.parts = read_parts(options.files, bones, soft, rig.notes, "tissue");
    set_space(rig, options);
    for (std::size_t p = 0; p < rig.parts.size(); ++p) {
        if (rig.parts[p].kind == Kind::bone) continue;
        if (rig.parts[p].file == files.fascia)
            out.fascia = static_cast<int>(p);
        else if (rig.parts[p].file == files.skin)
            out.skin = static_cast<int>(p);
        else
            out.tissues.push_back(p);
        rig.parts[p].keeps_file = static_cast<int>(p) == out.fascia || static_cast<int>(p) == out.skin;
        // Their nodes are called fascia and skin, whatever the files are.
        if (static_cast<int>(p) == out.fascia || static_cast<int>(p) == out.skin)
            std::erase_if(rig.notes, [&](const engine::Diagnostic& d) {
                return d.code == "DG154" && d.node == rig.parts[p].name;
            });
    }
    wrap_open(rig.parts, rig.notes, options.stop);
    const double size = size_of(out);
    out.reach = reach_share * size;
    out.tet_size = shell_tets * size * options.tet_scale;
    for (const std::size_t t : out.tissues) {
        const MuscleShape shape = measure_muscle(rig.parts[t].points, rig.parts[t].triangles);
        out.tet_sizes.push_back(std::min(0.8 * shape.thickness, shape.length / 3) * options.tet_scale);
    }
    if (options.tet_scale != 1) check_tets(out, options);
    bool is_held = false;
    for (const std::size_t t : out.tissues) {
        std::vector<Layers::Holder> near;
        for (std::size_t p = 0; p < rig.parts.size(); ++p) {
            if (rig.parts[p].kind != Kind::bone) continue;
            const std::vector<double> to = distances(rig.parts[t], Surface(rig.parts[p]), widest_gap * size);
            const auto [nearest, farthest] = std::minmax_element(to.begin(), to.end());
            // A tissue that lies along the bone with all of its surface is held by the nearer half of it.
            const double reach = std::min(out.reach, (*farthest - *nearest) / 4);
            if (*nearest <= widest_gap * size) near.push_back({p, *nearest, reach});
        }
        const auto is_touching = [&](const Layers::Holder& h) { return h.gap <= out.reach; };
        if (std::any_of(near.begin(), near.end(), is_touching))
            std::erase_if(near, [&](const Layers::Holder& h) { return !is_touching(h); });
        else
            for (const auto& [bone, gap, reach] : near)
                rig.notes.push_back(say(Severity::warning, "DG155", rig.parts[t].name,
                                        "it touches no bone; it is attached to " + rig.parts[bone].name +
                                            " over a gap of " + rough(gap),
                                        "Look at it, and move the mesh if it should touch."));
        out.holders.push_back(std::move(near));
        is_held = is_held || !out.holders.back().empty();
        if (out.holders.back().empty())
            rig.notes.push_back(say(Severity::warning, "DG158", rig.parts[t].name,
                                    "no bone is near it, so it would fall; it is written with enable false",
                                    "Attach it to something and remove enable."));
    }
    if (!is_held)
        throw engine::Failure(say(Severity::error, "DG158", "", "no bone is near any tissue",
                                  "Give the bones that hold them with --bones, in the same pose, unit and space."));
    return out;
}

std::string layers_text(const Layers& layers, const TextOptions& options) { return Writer(layers, options).text(); }

} // namespace sinew::rig
