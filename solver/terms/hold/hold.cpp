// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/hold/hold.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/terms/hold/start_motion.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::solver {

namespace {

constexpr Measure measures[] = {
    {"hold", "reaction_N", "N", "largest force of a hold", Combine::most},
    {"hold", "force_x_N", "N", "force along x", Combine::last},
    {"hold", "force_y_N", "N", "force along y", Combine::last},
    {"hold", "force_z_N", "N", "force along z", Combine::last},
    {"hold", "moment_x_Nm", "N*m", "moment about x", Combine::last},
    {"hold", "moment_y_Nm", "N*m", "moment about y", Combine::last},
    {"hold", "moment_z_Nm", "N*m", "moment about z", Combine::last},
};
constexpr auto value_names = field_names<HoldValues>();

Vec3 point(std::span<const double> numbers, int vertex) {
    const double* p = numbers.data() + 3 * at(vertex);
    return {p[0], p[1], p[2]};
}

void put_point(Positions& x, int vertex, const Vec3& p) {
    std::copy_n(p.data(), 3, x.begin() + static_cast<std::ptrdiff_t>(3 * at(vertex)));
}

} // namespace

const TermType hold_type{
    .name = "hold",
    .values = value_names,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        const std::vector<Part>& parts = scene.description().parts;
        const bool used = std::any_of(parts.begin(), parts.end(),
                                      [&](const Part& p) { return p.type == &hold_type && held_body(scene, p) >= 0; });
        return used ? std::make_unique<Holds>(scene) : nullptr;
    },
    .start = remember_start,
    .memory_version = 1,
    .has_memory = true,
    .hold =
        [](const Part& part, const BodyRest& body, std::vector<char>& held) {
            const auto& rest = static_cast<const HoldRest&>(*part.rest);
            if (rest.follows_bone && part.bodies.size() < 2) return;
            for (const int v : carriers_of(body, rest.part)) held[at(v)] = 1;
        },
    .follow = follow_bone,
    .mix =
        [](std::span<const double> from, std::span<double> to, double share) {
            const HoldValues a = get_fields<HoldValues>(from);
            HoldValues b = get_fields<HoldValues>(to);
            b.set_motion(between(a.motion(), b.motion(), share));
            for (double HoldValues::*c : {&HoldValues::about_x, &HoldValues::about_y, &HoldValues::about_z})
                solver::mix(a.*c, b.*c, share);
            put_fields(b, to);
        },
    .ties = true,
};

void HoldValues::set_motion(const RigidMotion& m) {
    x = m.translation.x(), y = m.translation.y(), z = m.translation.z();
    qx = m.rotation.x(), qy = m.rotation.y(), qz = m.rotation.z(), qw = m.rotation.w();
}

Holds::Holds(const Scene& scene)
    : scene_(scene) {
    const std::vector<Part>& parts = scene.description().parts;
    const Numbering& numbering = scene.numbering();
    std::vector<char> taken(numbering.vertex_count(), 0);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const int body = parts[k].type == &hold_type ? held_body(scene, parts[k]) : -1;
        if (body < 0) continue;
        const PaintedPart& painted = static_cast<const HoldRest&>(*parts[k].rest).part;
        Hold hold{k, carriers_of(scene.description().bodies[at(body)], painted), {}, {}, {}, {}, {}};
        std::size_t twice = 0;
        for (int& v : hold.vertices) {
            v += scene.first_vertex(body);
            twice += taken[at(v)] != 0;
            taken[at(v)] = 1;
        }
        if (twice > 0) {
            Error e("FE251", "two holds take hold of the same " + std::to_string(twice) + " vertices of its tets",
                    "make one hold of the two, or leave more than a tet between what they hold");
            e.body = body, e.part = static_cast<int>(k);
            throw e;
        }
        const auto d = static_cast<std::size_t>(numbering.deformable_of(body));
        auto held = std::find_if(bodies_.begin(), bodies_.end(), [&](const Held& h) { return h.deformable == d; });
        if (held == bodies_.end()) held = bodies_.insert(held, {d, {}});
        held->holds.push_back(std::move(hold));
    }
    set_nearness();
}

Changes Holds::take(const StepInputs& inputs, const State&) {
    for (const Held& held : bodies_)
        for (const Hold& hold : held.holds) {
            const double length = get_fields<HoldValues>(inputs.parts[hold.part]).motion().rotation.norm();
            if (std::abs(length - 1) <= 1e-9) continue;
            Error e("FE304", "the rotation of a hold is a quaternion of length " + std::to_string(length),
                    "it must be of length 1");
            e.body = scene_.numbering().deformables[held.deformable].body, e.part = static_cast<int>(hold.part);
            throw e;
        }
    return {};
}

void Holds::place_held(const Stage& stage, Positions& x) const {
    const std::vector<double>& rest = scene_.numbering().rest;
    const TermMemory* memory = find_memory(stage.before.memories, hold_type.name);
    for (const Held& body : bodies_)
        for (const Hold& hold : body.holds) {
            const RigidMotion motion = moved_since_start(scene_, hold.part, *memory, stage.inputs.parts[hold.part]);
            const Mat3 turn = motion.rotation.toRotationMatrix();
            parallel_for(hold.vertices.size(), 4096, [&](std::size_t i) {
                put_point(x, hold.vertices[i], turn * point(rest, hold.vertices[i]) + motion.translation);
            });
        }
}

void Holds::measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const {
    const std::size_t largest = out.size();
    out.push_back({&measures[0], 0});
    int number = 0;
    for (std::size_t k = 0; k < scene_.description().parts.size(); ++k)
        for (const Held& body : bodies_)
            for (const Hold& hold : body.holds) {
                if (hold.part != k) continue;
                const HoldValues values = get_fields<HoldValues>(inputs_->parts[k]);
                const Vec3 about(values.about_x, values.about_y, values.about_z);
                Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
                for (const int v : hold.vertices) {
                    const Vec3 f = point(reactions, v);
                    force += f;
                    moment += (point(x, v) - about).cross(f);
                }
                out[largest].value = std::max(out[largest].value, force.norm());
                for (int c = 0; c < 3; ++c) out.push_back({&measures[1 + c], force[c], number});
                for (int c = 0; c < 3; ++c) out.push_back({&measures[4 + c], moment[c], number});
                ++number;
            }
}

} // namespace sinew::solver
