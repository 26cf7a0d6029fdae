// Examples of the terms that every scene of bodies has: elasticity and attachments.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/lattice.h"
#include "solver/terms/attachment/attachment.h"
#include "solver/terms/elastic/elastic.h"
#include "tests/support/rotated_box.h"
#include "tests/support/swing.h"
#include "tests/support/term_checks.h"

#include <tuple>

namespace sinew::test {

using namespace solver;

namespace {

std::string name_of(ElementKind kind) { return kind == ElementKind::linear ? "linear" : "quadratic"; }

/// Tets around a block that stands askew, so that most of them are cut by its surface.
TetMesh lattice(ElementKind kind, int fineness) {
    const SurfaceMesh box = RotatedBox({0.2, 0.1, 0.1}, 30, 30).surface(1);
    LatticeOptions options;
    options.tet_size = 0.15 / fineness;
    options.moments = kind == ElementKind::quadratic ? 4 : 1;
    return make_lattice(box.points, box.triangles, options);
}

/// A block with fibres that flies, or is held at one side, deformed by moving loads.
ExampleScene block(ElasticLaw law, ElementKind kind, double volume_conservation, bool cut, bool held, bool grows,
                   int fineness) {
    auto t = tissue(cut ? lattice(kind, fineness) : box_mesh({0.2, 0.1, 0.1}, 2 * fineness, fineness, fineness), law);
    t->element = kind;
    if (held) t->fixed_vertices = vertices_where(t->tets.vertices, [](const Vec3& p) { return p.x() < 1e-9; });
    const std::size_t n = t->tets.tets.size();
    if (needs_direction(law)) t->stiff_directions.assign(n, Vec3(1, 2, -0.5).normalized());
    t->fibers = {{Points(n, Vec3(1, 0.2, 0).normalized()), std::vector<double>(n, 1.0)}};
    auto scene = std::make_shared<const Scene>(SceneDescription{.bodies = {t}, .attachments = {}, .parts = {}});
    return {scene, [scene, volume_conservation, grows](int step) {
                StepInputs in = still_inputs();
                TissueInputs values = material(2e4, 0.45, 1000);
                values.layers[0].volume_conservation = volume_conservation;
                values.compression_resistance = 100;
                values.transverse_anisotropy = 0.5;
                values.fibers = {{1e4, 0.6, 0.1 * step, 1}};
                if (grows) {
                    values.layers[0].rest_scale = 1.2;
                    values.rest_scale_envelope = 1 + 0.2 * step;
                    values.fibers[0].growth = 0.8 + 0.1 * step;
                }
                values.forces.assign(scene->vertex_count(0), Vec3(0.1, 0, 0.02 * step));
                in.stiffness_damping = 0.01;
                in.bodies = {values};
                return in;
            }};
}

/// Two blocks on top of each other, tied by their vertices at the border, or one to a bone that moves; the lower one
/// may be held on the right, also where it is tied.
ExampleScene tied(ElementKind kind, bool to_bone, double damping, bool held, int fineness) {
    const Vec3 size(0.2, 0.1, 0.1);
    auto lower = tissue(box_mesh(size, 2 * fineness, fineness, fineness), ElasticLaw::stvk);
    auto upper = tissue(box_mesh(size, 3 * fineness, fineness, fineness), ElasticLaw::stvk);
    lower->element = upper->element = kind;
    if (held)
        lower->fixed_vertices = vertices_where(lower->tets.vertices, [](const Vec3& p) { return p.x() > 0.2 - 1e-9; });
    for (Points* points : {&upper->tets.vertices, &upper->surface})
        for (Vec3& p : *points) p.y() += 0.1;
    const Points plate = {{-1, 0.1, -1}, {-1, 0.1, 2}, {2, 0.1, -1}};
    SceneDescription d;
    d.bodies = {lower};
    if (to_bone)
        d.bodies.emplace_back(bone(plate, {{0, 1, 2}}));
    else
        d.bodies.emplace_back(upper);
    AttachmentRest a;
    a.source = 0, a.target = 1;
    for (const Vec3& p : lower->surface) a.source_weights.push_back(p.y() > 0.1 - 1e-9 ? 0.8 : 0.0);
    d.attachments = {a};
    auto scene = std::make_shared<const Scene>(std::move(d));
    return {scene, [=](int step) {
                StepInputs in = still_inputs();
                in.gravity = Vec3(0, -9.8, 3);
                TissueInputs values = material(2e4, 0.45, 1000);
                values.forces.assign(scene->vertex_count(0), Vec3(0.02 * step, -0.1, 0));
                in.bodies = {values};
                if (to_bone) {
                    Points moved = plate;
                    for (Vec3& p : moved) p.x() += 0.01 * step;
                    in.bodies.emplace_back(BoneInputs{moved});
                } else {
                    in.bodies.emplace_back(material(1e4, 0.3, 500));
                }
                in.attachments = {{1e6, 0.9, damping}};
                return in;
            }};
}

} // namespace

std::vector<TermExample> elastic_examples() {
    std::vector<TermExample> out;
    for (const LawFacts& law : elastic_laws)
        for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic})
            for (const auto& [conservation, cut, held, grows] : {std::tuple{0.0, false, false, false},
                                                                 {0.0, false, true, false},
                                                                 {1e5, false, false, false},
                                                                 {1e5, true, false, false},
                                                                 {1e5, true, false, true}}) {
                TermExample e;
                e.name = std::string(law.name) + ", " + name_of(kind) + (conservation > 0 ? ", keeps its volume" : "") +
                         (cut ? ", cut tets" : "") + (held ? ", held" : "") + (grows ? ", grows" : "");
                e.type = &elastic_type;
                e.make = [law = law.law, kind, conservation = conservation, cut = cut, held = held, grows = grows](
                             int fineness) { return block(law, kind, conservation, cut, held, grows, fineness); };
                e.forces_cancel = true;
                e.torques_cancel = true;
                e.projects_exactly = false; // of the viscous stress only the definite part is kept
                e.knows_inverted = law.law != ElasticLaw::log_neo_hookean;
                out.push_back(std::move(e));
            }
    return out;
}

std::vector<TermExample> attachment_examples() {
    std::vector<TermExample> out;
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic})
        for (const bool to_bone : {false, true})
            for (const auto& [damping, held] : {std::pair{0.0, false}, {30.0, false}, {30.0, true}}) {
                TermExample e;
                e.name = "attachment to a " + std::string(to_bone ? "bone, " : "tissue, ") + name_of(kind) +
                         (damping > 0 ? ", damped" : "") + (held ? ", held" : "");
                e.type = &attachment_type;
                e.make = [kind, to_bone, damping = damping, held = held](int fineness) {
                    return tied(kind, to_bone, damping, held, fineness);
                };
                e.forces_cancel = !to_bone;
                e.torques_cancel = !to_bone && damping == 0; // a drag does not act along the line between its ends
                out.push_back(std::move(e));
            }
    return out;
}

} // namespace sinew::test
