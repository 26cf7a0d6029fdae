// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/hold/start_motion.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <string>

namespace sinew::solver {

namespace {

/// Of a bone's size: what its vertices may be off a rigid motion. Recorded motions have some six digits.
constexpr double rigid_tolerance = 1e-4;

const HoldRest& rest_of(const Part& part) { return static_cast<const HoldRest&>(*part.rest); }

int followed_bone(const Scene& scene, const Part& part) {
    for (const int body : part.bodies)
        if (scene.bone(body)) return body;
    return -1;
}

/// How many numbers a part has in the memory: those of a motion, or the bone's vertices.
std::size_t count_of(const Scene& scene, const Part& part) {
    if (part.type != &hold_type) return 0;
    if (!rest_of(part).follows_bone) return HoldValues::fields().size();
    const int bone = followed_bone(scene, part);
    return bone < 0 ? 0 : 3 * scene.bone(bone)->surface.size();
}

/// A part's numbers in the memory.
const double* numbers_of(const Scene& scene, std::size_t part, const TermMemory& memory) {
    const std::vector<Part>& parts = scene.description().parts;
    std::size_t first = 0, total = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (k == part) first = total;
        total += count_of(scene, parts[k]);
    }
    if (memory.bytes.size() != total * sizeof(double)) throw std::logic_error("a state of another scene's holds");
    return reinterpret_cast<const double*>(memory.bytes.data()) + first;
}

} // namespace

int held_body(const Scene& scene, const Part& part) {
    if (rest_of(part).follows_bone && followed_bone(scene, part) < 0) return -1;
    for (const int body : part.bodies)
        if (scene.deforms(body)) return body;
    return -1;
}

void remember_start(const Scene& scene, const StepInputs& inputs, const std::vector<Points>& surfaces,
                    TermMemory& memory) {
    const std::vector<Part>& parts = scene.description().parts;
    std::vector<double> numbers;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (count_of(scene, parts[k]) == 0) continue;
        if (!rest_of(parts[k]).follows_bone)
            numbers.insert(numbers.end(), inputs.parts[k].begin(), inputs.parts[k].end());
        else
            for (const Vec3& p : surfaces[at(followed_bone(scene, parts[k]))])
                numbers.insert(numbers.end(), p.data(), p.data() + 3);
    }
    const auto from = std::as_bytes(std::span(numbers));
    std::copy(from.begin(), from.end(), memory.bytes.rewrite(from.size()).begin());
}

void follow_bone(const Scene& scene, std::size_t part, const TermMemory& memory, const std::vector<Points>& bones,
                 std::span<double> values) {
    const Part& p = scene.description().parts[part];
    const int bone = followed_bone(scene, p);
    if (!rest_of(p).follows_bone || bone < 0) return;
    const Points& now = bones[at(bone)];
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    const std::span<const Vec3> start(reinterpret_cast<const Vec3*>(numbers_of(scene, part, memory)), now.size());
    const RigidFit fit = fit_rigid(start, now);
    const double size = bounding_box(now).size().norm();
    if (!(fit.farthest <= rigid_tolerance * size)) {
        char text[200];
        std::snprintf(text, sizeof text,
                      "the bone changes its shape: a vertex is %.3g m from where the nearest rigid motion since the "
                      "start frame would take it (a hold follows bones to within %.3g m)",
                      fit.farthest, rigid_tolerance * size);
        Error e("FE250", text, "hold with a bone that moves rigidly, or tie with a zAttachment");
        e.body = bone, e.part = static_cast<int>(part);
        throw e;
    }
    HoldValues v = get_fields<HoldValues>(values);
    v.set_motion(fit.motion);
    put_fields(v, values);
}

RigidMotion moved_since_start(const Scene& scene, std::size_t part, const TermMemory& memory,
                              std::span<const double> values) {
    const RigidMotion now = get_fields<HoldValues>(values).motion();
    if (rest_of(scene.description().parts[part]).follows_bone) return now;
    const std::span<const double> start(numbers_of(scene, part, memory), values.size());
    const RigidMotion then = get_fields<HoldValues>(start).motion();
    return now == then ? RigidMotion{} : now.after(then.inverse());
}

} // namespace sinew::solver
