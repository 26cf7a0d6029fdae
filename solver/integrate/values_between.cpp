// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/values_between.h"

#include "solver/term/type.h"

namespace sinew::solver {

namespace {

/// No loads at all is a load of zero on every vertex.
void mix_forces(const Points& from, Points& to, double share) {
    if (to.empty()) to.assign(from.size(), Vec3::Zero());
    for (std::size_t v = 0; v < to.size(); ++v)
        for (int c = 0; c < 3; ++c) mix(from.empty() ? 0 : from[v][c], to[v][c], share);
}

} // namespace

void copy_values(const StepInputs& in, StepInputs& out) {
    out.step_size = in.step_size;
    out.integrator = in.integrator;
    out.gravity = in.gravity;
    out.mass_damping = in.mass_damping;
    out.stiffness_damping = in.stiffness_damping;
    out.bodies.resize(in.bodies.size());
    for (std::size_t i = 0; i < in.bodies.size(); ++i) {
        if (std::holds_alternative<BoneInputs>(in.bodies[i]))
            out.bodies[i].emplace<BoneInputs>();
        else
            out.bodies[i] = in.bodies[i];
    }
    out.attachments = in.attachments;
    out.parts = in.parts;
}

void values_between(const Scene& scene, const StepInputs& before, const StepInputs& after, double share,
                    StepInputs& out) {
    copy_values(after, out);
    for (int c = 0; c < 3; ++c) mix(before.gravity[c], out.gravity[c], share);
    mix(before.mass_damping, out.mass_damping, share);
    mix(before.stiffness_damping, out.stiffness_damping, share);
    for (std::size_t i = 0; i < out.bodies.size(); ++i) {
        if (auto* cloth = std::get_if<ClothInputs>(&out.bodies[i])) {
            const auto& from = std::get<ClothInputs>(before.bodies[i]);
            const double enable = cloth->enable; // a switch acts over a whole step
            mix_fields(from, *cloth, share);
            cloth->enable = enable;
            for (std::size_t k = 0; k < cloth->layers.size(); ++k) mix_fields(from.layers[k], cloth->layers[k], share);
            mix_forces(from.forces, cloth->forces, share);
            continue;
        }
        auto* t = std::get_if<TissueInputs>(&out.bodies[i]);
        if (!t) continue;
        const auto& from = std::get<TissueInputs>(before.bodies[i]);
        if (conserves_volume(from) == conserves_volume(*t)) {
            const double enable = t->enable; // a switch acts over a whole step
            mix_fields(from, *t, share);
            t->enable = enable;
            for (std::size_t k = 0; k < t->layers.size(); ++k) mix_fields(from.layers[k], t->layers[k], share);
            for (std::size_t s = 0; s < t->subtissues.size(); ++s) {
                const SubtissueInputs& part = from.subtissues[s];
                mix_fields(part, t->subtissues[s], share);
                for (std::size_t k = 0; k < part.layers.size(); ++k)
                    mix_fields(part.layers[k], t->subtissues[s].layers[k], share);
            }
        }
        for (std::size_t k = 0; k < t->fibers.size(); ++k) mix_fields(from.fibers[k], t->fibers[k], share);
        mix_forces(from.forces, t->forces, share);
    }
    for (std::size_t k = 0; k < out.attachments.size(); ++k) {
        const AttachmentInputs& a = before.attachments[k];
        AttachmentInputs& m = out.attachments[k];
        // A coupling made or released within the step: half of it would throw bodies back that it no longer brakes.
        if ((a.stiffness * a.envelope == 0) != (m.stiffness * m.envelope == 0)) continue;
        if (a.mode() != m.mode()) continue; // a switch acts over a whole step
        mix_fields(a, m, share);
    }
    for (std::size_t k = 0; k < out.parts.size(); ++k) {
        const PartValues& a = before.parts[k];
        const TermType& type = *scene.description().parts[k].type;
        if (type.may_mix && !type.may_mix(a, out.parts[k])) continue;
        if (type.mix) {
            type.mix(a, out.parts[k], share);
            continue;
        }
        for (std::size_t i = 0; i < a.size(); ++i) mix(a[i], out.parts[k][i], share);
    }
}

void values_within(const Scene& scene, const StepInputs& known, const StepInputs& after, StepInputs& out) {
    copy_values(known, out);
    out.step_size = after.step_size, out.integrator = after.integrator;
    for (std::size_t i = 0; i < out.bodies.size(); ++i) {
        if (auto* cloth = std::get_if<ClothInputs>(&out.bodies[i]))
            cloth->enable = std::get<ClothInputs>(after.bodies[i]).enable;
        auto* t = std::get_if<TissueInputs>(&out.bodies[i]);
        if (!t) continue;
        const auto& end = std::get<TissueInputs>(after.bodies[i]);
        t->enable = end.enable;
        if (conserves_volume(*t) == conserves_volume(end)) continue;
        t->layers = end.layers, t->subtissues = end.subtissues;
        for (const auto& f : TissueInputs::fields()) (*t).*f.at = end.*f.at;
    }
    for (std::size_t k = 0; k < out.attachments.size(); ++k) out.attachments[k].set_mode(after.attachments[k].mode());
    for (std::size_t k = 0; k < out.parts.size(); ++k) {
        const auto may_mix = scene.description().parts[k].type->may_mix;
        if (may_mix && !may_mix(out.parts[k], after.parts[k])) out.parts[k] = after.parts[k];
    }
}

} // namespace sinew::solver
