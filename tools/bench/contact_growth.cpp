// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/contact_growth.h"

#include "solver/mesh/primitives.h"
#include "solver/terms/contact/contact.h"
#include "solver/terms/contact/contact_rest.h"
#include "tools/bench/beams.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tbb/task_arena.h>

namespace sinew::bench {

using namespace solver;

namespace {

constexpr double side = 0.2;
constexpr int steps = 8; ///< that are counted, after two

/// A cube with n x n squares on each side, on a slab with as fine squares on its top.
SceneDescription cube_on_slab(int n, StepInputs& in, int& points, int& triangles) {
    auto cube = make_tissue(box_mesh({0, 0, 0}, Vec3::Constant(side), 6, 6, 6), ElasticLaw::stvk);
    const SurfaceMesh skin = make_cube(side, side, side, n, n, n);
    cube->surface.clear();
    for (const Vec3& p : skin.points) cube->surface.push_back(p + Vec3::Constant(0.5 * side));
    cube->triangles = skin.triangles;
    cube->embedding = embed(cube->tets, cube->surface);
    const SurfaceMesh slab = make_cube(2 * side, 0.1, 2 * side, 2 * n, 1, 2 * n);
    auto bone = std::make_shared<BoneRest>();
    for (const Vec3& p : slab.points) bone->surface.push_back(p + Vec3(0.7 * side, -0.05, 0.5 * side));
    bone->triangles = slab.triangles;
    points = static_cast<int>(cube->surface.size() + bone->surface.size());
    triangles = static_cast<int>(cube->triangles.size() + bone->triangles.size());
    in.bodies = {material(1e6, 0.3), BoneInputs{bone->surface}};
    SceneDescription out{{std::shared_ptr<const TissueRest>(cube), std::shared_ptr<const BoneRest>(bone)}, {}};
    for (const int body : {0, 1}) {
        out.parts.push_back({&contact_type, {body}, std::make_shared<ContactRest>()});
        in.parts.emplace_back(contact_type.values.size());
    }
    return out;
}

struct Measured {
    double step_ms = 0, newton = 0;
    int contacts = 0, unconverged = 0;
};

Measured measure(int n, bool collides, const RunOptions& options, ContactGrowthRow& row) {
    using Clock = std::chrono::steady_clock;
    StepInputs in = tight_inputs();
    in.tolerance_factor = 1;
    in.step_size = 1.0 / 96;
    if (collides) in.gravity = Vec3(0, -9.8, 0);
    SceneDescription description = cube_on_slab(n, in, row.points, row.triangles);
    ContactValues values;
    values.stiffness = 1e7, values.collides = collides ? 1 : 0;
    for (PartValues& part : in.parts) put_fields(values, std::span(part));
    const std::vector<InitialMotion> motions = {{{0.5, 0, 0.1}, Vec3::Zero()}, {}};
    Simulation sim(std::move(description), in, options.stop, motions);
    Measured out;
    std::vector<double> times;
    for (int i = 0; i < steps + 2; ++i) {
        const auto start = Clock::now();
        sim.step();
        if (i < 2) continue;
        times.push_back(1000 * std::chrono::duration<double>(Clock::now() - start).count());
        out.newton += static_cast<double>(sim.state.record.newton_iterations) / steps;
    }
    out.step_ms = median(times), out.unconverged = sim.work.unconverged;
    out.contacts = static_cast<int>(value_of(sim.state.record.measured, "contact", "contacts"));
    return out;
}

} // namespace

std::vector<ContactGrowthRow> run_contact_growth(const RunOptions& options) {
    std::vector<ContactGrowthRow> rows;
    for (const int n : options.quick ? std::vector<int>{5, 8} : std::vector<int>{8, 16, 30, 56, 84, 119}) {
        ContactGrowthRow row;
        options.tell("contact of surfaces of " + std::to_string(n) + " squares a side");
        tbb::task_arena(1).execute([&] {
            row.without_ms = measure(n, false, options, row).step_ms;
            const Measured with = measure(n, true, options, row);
            row.contact_ms = with.step_ms - row.without_ms;
            row.newton = with.newton, row.contacts = with.contacts, row.unconverged = with.unconverged;
        });
        row.per_point_ns = 1e6 * row.contact_ms / (row.points * std::log2(row.points));
        row.exponent = rows.empty() ? std::numeric_limits<double>::quiet_NaN()
                                    : std::log(row.contact_ms / rows.back().contact_ms) /
                                          std::log(static_cast<double>(row.points) / rows.back().points);
        rows.push_back(row);
    }
    return rows;
}

Table contact_growth_table(const std::vector<ContactGrowthRow>& rows) {
    Table t{{"points", "triangles", "contacts", "Newton a step", "step without [ms]", "contact [ms]", "exponent",
             "ns per point and log2 of them", "note"},
            {}};
    for (const ContactGrowthRow& r : rows)
        t.rows.push_back({std::to_string(r.points), std::to_string(r.triangles), std::to_string(r.contacts),
                          number(r.newton, 3), number(r.without_ms, 3), number(r.contact_ms, 3),
                          std::isfinite(r.exponent) ? number(r.exponent, 3) : "", number(r.per_point_ns, 3),
                          r.unconverged ? std::to_string(r.unconverged) + " steps did not converge" : ""});
    return t;
}

nlohmann::ordered_json contact_growth_json(const std::vector<ContactGrowthRow>& rows) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const ContactGrowthRow& r : rows)
        out.push_back({{"points", r.points},
                       {"triangles", r.triangles},
                       {"contacts", r.contacts},
                       {"newton_per_step", r.newton},
                       {"without_ms", r.without_ms},
                       {"contact_ms", r.contact_ms},
                       {"exponent", r.exponent},
                       {"ns_per_n_log_n", r.per_point_ns},
                       {"unconverged", r.unconverged}});
    return out;
}

} // namespace sinew::bench
