// Where a Newton solve may start after a hold has moved far: with the body taken along.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/parallel.h"
#include "solver/terms/hold/hold.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

Vec3 point(std::span<const double> numbers, int vertex) {
    const double* p = numbers.data() + 3 * at(vertex);
    return {p[0], p[1], p[2]};
}

void put_point(Positions& x, int vertex, const Vec3& p) {
    std::copy_n(p.data(), 3, x.begin() + static_cast<std::ptrdiff_t>(3 * at(vertex)));
}

double distance_to_nearest(const Points& points, const Bvh& tree, const Vec3& p) {
    double nearest = std::numeric_limits<double>::infinity();
    int stack[64];
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const int n = stack[--size];
        const BvhNode& node = tree.nodes[at(n)];
        if (squared_distance(node, p) >= nearest) continue;
        if (node.count == 0) {
            stack[size++] = node.first;
            stack[size++] = n + 1;
            continue;
        }
        for (int i = node.first; i < node.first + node.count; ++i)
            nearest = std::min(nearest, (points[at(tree.order[at(i)])] - p).squaredNorm());
    }
    return std::sqrt(nearest);
}

} // namespace

void Holds::set_nearness() {
    const Numbering& numbering = scene_.numbering();
    for (Held& held : bodies_) {
        if (held.holds.size() < 2) continue;
        const Deformable& body = numbering.deformables[held.deformable];
        for (Hold& hold : held.holds) {
            Points places;
            for (const int v : hold.vertices) places.push_back(point(numbering.rest, v));
            const Bvh tree = build_bvh(places, places);
            const double least = 1e-6 * body.spacing; // what lies on a held vertex is near, not infinitely so
            hold.nearness.resize(body.unknown_count);
            parallel_for(body.unknown_count, 64, [&](std::size_t u) {
                const int v = numbering.vertex_of_unknown[body.first_unknown + u];
                hold.nearness[u] = 1 / std::max(least, distance_to_nearest(places, tree, point(numbering.rest, v)));
            });
        }
    }
}

bool Holds::carry(const Positions& before, Positions& x, std::vector<char>& bodies) const {
    bool any = false;
    const Numbering& numbering = scene_.numbering();
    for (const Held& held : bodies_) {
        const Deformable& body = numbering.deformables[held.deformable];
        const auto vertex = [&](std::size_t u) { return numbering.vertex_of_unknown[body.first_unknown + u]; };
        bool moved = false;
        for (const Hold& hold : held.holds) {
            hold.from.clear(), hold.to.clear();
            for (const int v : hold.vertices) hold.from.push_back(point(before, v)), hold.to.push_back(point(x, v));
            moved = moved || hold.from != hold.to;
        }
        if (!moved || body.unknown_count == 0) continue;
        any = true;
        bodies[held.deformable] = 1;
        // Each hold's motion as that of the body's centre and a turn about it: those can be weighed and added.
        const auto sums = ordered_sums<3>(body.unknown_count, [&](std::size_t u, std::array<double, 3>& sum) {
            for (std::size_t c = 0; c < 3; ++c) sum[c] += x[3 * at(vertex(u)) + c];
        });
        const Vec3 centre = Vec3(sums[0], sums[1], sums[2]) / static_cast<double>(body.unknown_count);
        for (const Hold& hold : held.holds) {
            const RigidMotion motion = fit_rigid(hold.from, hold.to).motion;
            hold.shift = motion(centre) - centre;
            hold.turn = rotation_vector(motion.rotation);
        }
        parallel_for(body.unknown_count, 1024, [&](std::size_t u) {
            Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
            double total = 0;
            for (const Hold& hold : held.holds) {
                const double weight = held.holds.size() == 1 ? 1 : hold.nearness[u];
                shift += weight * hold.shift, turn += weight * hold.turn, total += weight;
            }
            const Vec3 from_centre = point(x, vertex(u)) - centre;
            put_point(x, vertex(u),
                      centre + shift / total + rotation_by(turn / total).toRotationMatrix() * from_centre);
        });
    }
    return any;
}

} // namespace sinew::solver
