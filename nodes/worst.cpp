// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/worst.h"

#include "solver/system.h"
#include "solver/terms/attachment/anchors.h"
#include "solver/terms/elastic/rest_change.h"

#include <Eigen/LU>
#include <array>

namespace sinew::nodes {

using solver::Vec3;

namespace {

Vec3 at(const std::vector<double>& x, int vertex) {
    return Eigen::Map<const Vec3>(x.data() + 3 * static_cast<std::size_t>(vertex));
}

/// The point of an anchor's end that lies on a body that deforms.
Vec3 carried(const solver::Scene& scene, const solver::State& state, int body, const solver::AnchorEnd& end) {
    const solver::PointWeights w = solver::carried_end(scene, body, end);
    Vec3 out = Vec3::Zero();
    for (int k = 0; k < w.count; ++k) out += w.weight[k] * at(state.x, w.vertex[k]);
    return out;
}

/// Least det F of each tet of a batch, as the solver's own measure takes it.
void least_of_batch(const solver::Scene::System& system, const solver::TissueBatches& tissue, std::size_t i,
                    const double* x, double* least) {
    const solver::TetBatch& batch = system.batches[tissue.first_batch + i];
    if (tissue.kind == solver::ElementKind::quadratic)
        return solver::quadratic_least_j(batch, system.edge_batches[tissue.first_edge_batch + i], x, least);
    solver::Pack f[9];
    solver::deformation_gradient(batch, solver::corners_of(batch, x), f);
    const solver::Pack det =
        f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
    for (int lane = 0; lane < solver::lanes; ++lane) least[lane] = det[lane];
}

void look_at_tets(const Setup& setup, const solver::Scene& scene, const solver::State& state,
                  const solver::TissueBatches& tissue, WorstPlaces& worst) {
    const solver::Scene::System& system = scene.system();
    const solver::TissueInputs& values = setup.tissue_values(static_cast<std::size_t>(tissue.body));
    std::vector<solver::PartValues> parts;
    for (const Force& f : setup.forces) parts.push_back(f.values);
    const solver::RestShapes shapes = rest_shapes_of(scene, tissue.body, parts);
    const bool changed = changes_rest(values) || shapes.act();
    for (std::size_t i = 0; i < tissue.batch_count; ++i) {
        double least[solver::lanes];
        least_of_batch(system, tissue, i, state.x.data(), least);
        const solver::TetBatch& batch = system.batches[tissue.first_batch + i];
        for (int lane = 0; lane < solver::lanes; ++lane) {
            if (changed && batch.volume[lane] > 0)
                least[lane] /=
                    rest_change(*scene.tissue(tissue.body), values, i * solver::lanes + std::size_t(lane), shapes)
                        .determinant();
            if (!(batch.volume[lane] > 0) || (worst.tet >= 0 && !(least[lane] < worst.j))) continue;
            worst.j = least[lane];
            worst.body = setup.simulated[static_cast<std::size_t>(tissue.body)];
            worst.tet = static_cast<int>(i) * solver::lanes + lane; // tets stand in batches in their own order
            Vec3 middle = Vec3::Zero();
            for (const auto& corner : batch.vertex) middle += 0.25 * at(state.x, corner[lane]);
            worst.tet_place = setup.space.numbers_in_scene(middle);
        }
    }
}

void look_at_anchors(const Setup& setup, const solver::Scene& scene, const solver::State& state,
                     std::span<const solver::Anchor> anchors, std::size_t attachment, WorstPlaces& worst) {
    const auto [source, target] = setup.key.links[attachment];
    const bool from_bone = scene.bone(source), to_bone = scene.bone(target);
    if (from_bone && to_bone) return; // has no effect
    const auto bone = [&](int body) -> const solver::Points& { return state.bones[static_cast<std::size_t>(body)]; };
    for (const solver::Anchor& anchor : anchors) {
        const Vec3 from =
            from_bone ? solver::bone_point(anchor.source, bone(source)) : carried(scene, state, source, anchor.source);
        Vec3 to = to_bone ? solver::bone_anchor(anchor, bone(target)) : carried(scene, state, target, anchor.target);
        if (scene.cloth(target)) to += solver::cloth_offset(scene, target, anchor, state.x);
        const double stretch = (from - to).norm();
        if (worst.attachment >= 0 && stretch <= worst.stretch) continue;
        worst.stretch = stretch;
        worst.attachment = setup.attachment_entries[attachment];
        worst.stretch_place = setup.space.numbers_in_scene(from);
        worst.source_body = setup.simulated[static_cast<std::size_t>(source)];
    }
}

} // namespace

WorstPlaces find_worst(const Setup& setup, const solver::Scene& scene, const solver::State& state) {
    WorstPlaces out;
    for (const solver::TissueBatches& tissue : scene.system().tissues) look_at_tets(setup, scene, state, tissue, out);
    const solver::AttachmentView attachments = attachments_kept(state.memories);
    for (std::size_t a = 0; a < attachments.anchors.size() && a < setup.key.links.size(); ++a)
        if (setup.attachments[a].get().values.mode() == solver::AttachmentMode::fixed)
            look_at_anchors(setup, scene, state, attachments.anchors[a], a, out);
    return out;
}

void find_deepest(const ContactList& contacts, WorstPlaces& worst) {
    for (const solver::ContactPoint& c : contacts.contacts) {
        if (worst.contact_body >= 0 && c.depth <= worst.depth) continue;
        worst.contact_body = c.source, worst.contact_target = c.target;
        worst.depth = c.depth;
        worst.contact_place = {c.place.x(), c.place.y(), c.place.z()};
    }
}

} // namespace sinew::nodes
