// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/values_between.h"

#include <cmath>

namespace sinew::solver {

void copy_values(const StepInputs& in, StepInputs& out) {
    out.step_size = in.step_size;
    out.integrator = in.integrator;
    out.gravity = in.gravity;
    out.mass_damping = in.mass_damping;
    out.stiffness_damping = in.stiffness_damping;
    out.bodies.resize(in.bodies.size());
    for (std::size_t i = 0; i < in.bodies.size(); ++i) {
        if (std::holds_alternative<TissueInputs>(in.bodies[i]))
            out.bodies[i] = in.bodies[i];
        else
            out.bodies[i].emplace<BoneInputs>();
    }
    out.attachments = in.attachments;
}

void values_between(const StepInputs& before, const StepInputs& after, double share, StepInputs& out) {
    copy_values(after, out);
    const auto mix = [&](double from, double& to) {
        if (from != to) to = std::lerp(from, to, share); // what is not keyed keeps its bits
    };
    for (int c = 0; c < 3; ++c) mix(before.gravity[c], out.gravity[c]);
    mix(before.mass_damping, out.mass_damping);
    mix(before.stiffness_damping, out.stiffness_damping);
    for (std::size_t i = 0; i < out.bodies.size(); ++i) {
        auto* t = std::get_if<TissueInputs>(&out.bodies[i]);
        if (!t) continue;
        const auto& from = std::get<TissueInputs>(before.bodies[i]);
        if (conserves_volume(from) == conserves_volume(*t)) {
            mix(from.compression_resistance, t->compression_resistance);
            mix(from.transverse_anisotropy, t->transverse_anisotropy);
            for (std::size_t k = 0; k < t->layers.size(); ++k) {
                const MaterialValues& a = from.layers[k];
                MaterialValues& m = t->layers[k];
                mix(a.youngs_modulus, m.youngs_modulus), mix(a.poissons_ratio, m.poissons_ratio),
                    mix(a.mass_density, m.mass_density);
                mix(a.envelope, m.envelope), mix(a.volume_conservation, m.volume_conservation);
            }
        }
        for (std::size_t k = 0; k < t->fibers.size(); ++k) {
            const FiberValues& a = from.fibers[k];
            FiberValues& f = t->fibers[k];
            mix(a.strength, f.strength), mix(a.contraction_limit, f.contraction_limit);
            mix(a.excitation, f.excitation), mix(a.envelope, f.envelope);
        }
        // No loads at all is a load of zero on every vertex.
        if (t->forces.empty()) t->forces.assign(from.forces.size(), Vec3::Zero());
        for (std::size_t v = 0; v < t->forces.size(); ++v)
            for (int c = 0; c < 3; ++c) mix(from.forces.empty() ? 0 : from.forces[v][c], t->forces[v][c]);
    }
    for (std::size_t k = 0; k < out.attachments.size(); ++k) {
        const AttachmentInputs& a = before.attachments[k];
        AttachmentInputs& m = out.attachments[k];
        // A coupling made or released within the step: half of it would throw bodies back that it no longer brakes.
        if ((a.stiffness * a.envelope == 0) != (m.stiffness * m.envelope == 0)) continue;
        mix(a.stiffness, m.stiffness), mix(a.envelope, m.envelope), mix(a.damping, m.damping);
    }
}

} // namespace sinew::solver
