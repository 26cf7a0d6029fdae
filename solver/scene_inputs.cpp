// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/scene_inputs.h"

#include "solver/error.h"
#include "solver/term/type.h"

#include <cmath>
#include <string>

namespace sinew::solver {

void check_inputs(const Scene& scene, const StepInputs& in) {
    if (static_cast<int>(in.bodies.size()) != scene.body_count() ||
        in.attachments.size() != scene.description().attachments.size() ||
        in.parts.size() != scene.description().parts.size())
        throw std::logic_error("step inputs must name every body, attachment and part of the scene, in order");
    if (!(in.step_size > 0) || !std::isfinite(in.step_size))
        throw Error("FE304", "the step size is " + std::to_string(in.step_size) + " s", "it must be positive");
    if (!in.gravity.allFinite())
        throw Error("FE304", "gravity is not a finite number", "check what it is connected to");
    for (const auto& [what, value] : {std::pair("massDamping", in.mass_damping),
                                      {"stiffnessDamping", in.stiffness_damping},
                                      {"solverToleranceFactor", in.tolerance_factor}})
        if (!std::isfinite(value))
            throw Error("FE304", std::string(what) + " is not a finite number", "check what it is connected to");
    for (std::size_t k = 0; k < in.attachments.size(); ++k) {
        const AttachmentInputs& a = in.attachments[k];
        if (std::isfinite(a.stiffness) && std::isfinite(a.envelope) && std::isfinite(a.damping)) continue;
        Error bad("FE304",
                  "a value of attachment " + std::to_string(k) + ", which starts from it, is not a finite number",
                  "stiffness, envelope and damping must be finite");
        bad.body = scene.description().attachments[k].source;
        throw bad;
    }
    for (std::size_t k = 0; k < in.parts.size(); ++k) {
        const Part& part = scene.description().parts[k];
        if (in.parts[k].size() != part.type->values.size())
            throw std::logic_error("step inputs must give every value of a part");
        for (std::size_t i = 0; i < in.parts[k].size(); ++i) {
            if (std::isfinite(in.parts[k][i])) continue;
            Error bad("FE304",
                      std::string("the ") + part.type->values[i].name + " of a " + std::string(part.type->name) +
                          " is not a finite number",
                      "check what it is connected to");
            if (!part.bodies.empty()) bad.body = part.bodies.front();
            throw bad;
        }
    }
    for (int body = 0; body < scene.body_count(); ++body) {
        const BodyInputs& b = in.bodies[static_cast<std::size_t>(body)];
        if (const BoneRest* bone = scene.bone(body)) {
            const Points& p = std::get<BoneInputs>(b).positions;
            if (p.size() != bone->surface.size()) {
                Error changed("FE211",
                              "the bone has " + std::to_string(p.size()) + " vertices; it started with " +
                                  std::to_string(bone->surface.size()),
                              "a body keeps its vertices");
                changed.body = body;
                throw changed;
            }
            for (std::size_t i = 0; i < p.size(); ++i)
                if (!p[i].allFinite()) {
                    Error bad("FE202", "vertex " + std::to_string(i) + " of the bone is not a finite number",
                              "check the transform that moves it");
                    bad.body = body;
                    throw bad;
                }
            continue;
        }
        if (const double damping = inertial_damping(b); !(damping >= 0 && damping <= 1)) {
            Error bad("FE304", "inertialDamping is " + std::to_string(damping), "it must be 0 to 1");
            bad.body = body;
            throw bad;
        }
        if (const ClothRest* cloth = scene.cloth(body)) {
            const auto& values = std::get<ClothInputs>(b);
            if (values.layers.size() != cloth->layer_weights.size())
                throw std::logic_error("step inputs must give values for every layer of a cloth");
            if (!values.forces.empty() && values.forces.size() != scene.vertex_count(body))
                throw std::logic_error("step inputs must give one load per vertex of a cloth, or none");
        } else {
            const auto& t = std::get<TissueInputs>(b);
            const TissueRest& rest = *scene.tissue(body);
            if (rest.carried_by >= 0) continue; // its values are among those of the tissue that it is a part of
            bool fits = t.layers.size() == rest.layer_weights.size() && t.fibers.size() == rest.fibers.size() &&
                        t.subtissues.size() == rest.subtissues.size();
            for (std::size_t i = 0; fits && i < rest.subtissues.size(); ++i)
                fits = t.subtissues[i].layers.size() == rest.subtissues[i].layer_weights.size();
            if (!fits) throw std::logic_error("step inputs must give values for every layer and fibre of a tissue");
            if (!t.forces.empty() && t.forces.size() != scene.vertex_count(body))
                throw std::logic_error("step inputs must give one load per vertex of a tissue, or none");
        }
    }
}

void set_bones(const Scene& scene, const StepInputs& in, std::vector<Points>& bones) {
    bones.resize(static_cast<std::size_t>(scene.body_count()));
    for (int body = 0; body < scene.body_count(); ++body)
        if (scene.bone(body))
            bones[static_cast<std::size_t>(body)] =
                std::get<BoneInputs>(in.bodies[static_cast<std::size_t>(body)]).positions;
}

} // namespace sinew::solver
