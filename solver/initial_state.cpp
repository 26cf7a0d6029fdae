// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/initial_state.h"

#include "solver/integrate/part_motion.h"
#include "solver/newton/potential.h"
#include "solver/parallel.h"
#include "solver/scene_inputs.h"
#include "solver/step.h"
#include "solver/terms/all_terms.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>

namespace sinew::solver {

namespace {

Vec3 centre_of_mass(const Deformable& body, const std::vector<double>& weight, const std::vector<double>& x) {
    const auto sums = ordered_sums<4>(body.vertex_count, [&](std::size_t i, std::array<double, 4>& sum) {
        const std::size_t v = body.first_vertex + i;
        sum[3] += weight[v];
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[v] * x[3 * v + c];
    });
    return Vec3(sums[0], sums[1], sums[2]) / sums[3];
}

/// Velocities of what nothing holds.
void set_in_motion(const Scene& scene, const StepInputs& inputs, std::span<const InitialMotion> motions, State& s) {
    if (motions.empty()) return;
    if (static_cast<int>(motions.size()) != scene.body_count())
        throw std::logic_error("there must be one initial motion a body, or none");
    const Numbering& numbering = scene.numbering();
    std::optional<Potential> potential; // knows what weighs at each vertex
    for (const Deformable& d : numbering.deformables) {
        const InitialMotion& motion = motions[static_cast<std::size_t>(d.body)];
        Vec3 centre = Vec3::Zero();
        if (!motion.angular_velocity.isZero(0)) {
            if (!potential) potential.emplace(scene).take(s, inputs);
            centre = centre_of_mass(d, potential->masses().weight(), s.x);
        }
        for (std::size_t v = d.first_vertex; v < d.first_vertex + d.vertex_count; ++v) {
            if (numbering.unknown[v] < 0) continue;
            const Vec3 p(s.x[3 * v], s.x[3 * v + 1], s.x[3 * v + 2]);
            const Vec3 velocity = motion.velocity + motion.angular_velocity.cross(p - centre);
            std::copy_n(velocity.data(), 3, s.v.begin() + static_cast<std::ptrdiff_t>(3 * v));
        }
    }
}

} // namespace

State initial_state(const Scene& scene, const StepInputs& inputs, std::span<const InitialMotion> motions) {
    check_inputs(scene, inputs);
    State s;
    s.x = scene.numbering().rest;
    s.v.assign(s.x.size(), 0.0);
    set_bones(scene, inputs, s.bones);
    std::vector<Points> surfaces(s.bones);
    for (int body = 0; body < scene.body_count(); ++body)
        if (scene.deforms(body)) surfaces[static_cast<std::size_t>(body)] = surface_positions(scene, s, body);
    for (const TermType* type : all_terms())
        if (type->start) {
            TermMemory memory{std::string(type->name), type->memory_version, {}};
            type->start(scene, inputs, surfaces, memory);
            if (!memory.bytes.empty()) s.memories.push_back(std::move(memory));
        }
    std::vector<PartValues> parts = inputs.parts;
    follow_bones(scene, s.memories, s.bones, parts);
    keep_places(scene, parts, s.parts);
    set_in_motion(scene, inputs, motions, s);
    return s;
}

State with_other_parts(const Scene& scene, const State& before, std::size_t same, const StepInputs& inputs) {
    check_inputs(scene, inputs);
    State s = before;
    std::vector<PartValues> parts;
    keep_places(scene, inputs.parts, parts);
    same = std::min({same, s.parts.size(), parts.size()});
    std::copy_n(s.parts.begin(), same, parts.begin());
    s.parts = std::move(parts);
    if (s.history.values) {
        std::vector<PartValues>& last = s.history.values->parts;
        last.resize(same);
        last.insert(last.end(), inputs.parts.begin() + static_cast<std::ptrdiff_t>(same), inputs.parts.end());
    }
    for (const TermType* type : all_terms()) {
        if (!type->begin) continue;
        const auto is_of_type = [&](const Part& part) { return part.type == type; };
        const std::vector<Part>& all = scene.description().parts;
        const auto first_other = all.begin() + static_cast<std::ptrdiff_t>(same);
        if (std::any_of(all.begin(), first_other, is_of_type)) continue; // it is there already
        std::erase_if(s.memories, [&](const TermMemory& m) { return m.term == type->name; });
        if (std::none_of(first_other, all.end(), is_of_type)) continue;
        TermMemory memory{std::string(type->name), type->memory_version, {}};
        type->begin(scene, inputs, s, memory);
        s.memories.push_back(std::move(memory));
    }
    return s;
}

} // namespace sinew::solver
