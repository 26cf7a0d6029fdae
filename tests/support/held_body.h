// One body of a box mesh with holds, for tests of them: values by name, reactions out of the report.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/newton/potential.h"
#include "solver/terms/hold/hold.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace sinew::test {

using namespace solver;
using Where = std::function<bool(const Vec3&)>;

/// Rest positions of corners, then of the middles of edges.
inline Points nodes_of(const TissueRest& rest) {
    Points out = rest.tets.vertices;
    if (rest.element == ElementKind::quadratic)
        for (const auto& [a, b] : edges_of(rest.tets.tets))
            out.push_back(0.5 * (rest.tets.vertices[std::size_t(a)] + rest.tets.vertices[std::size_t(b)]));
    return out;
}

/// A turn about an axis through a point.
inline RigidMotion about(const Vec3& point, const Eigen::AngleAxisd& turn) {
    return {Eigen::Quaterniond(turn), point - turn * point};
}

/// Quasi-static without gravity unless said otherwise; material and scheme are set before start().
struct HeldBody {
    std::shared_ptr<TissueRest> rest;
    SceneDescription description;
    StepInputs in;
    Points nodes, bone_points;
    std::vector<InitialMotion> motions;
    std::vector<HoldValues> holds;
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    std::unique_ptr<Potential> potential;
    State state;

    HeldBody(const Vec3& size, int nx, int ny, int nz, ElasticLaw law, ElementKind kind,
             const std::vector<Where>& held) {
        rest = tissue(box_mesh(size, nx, ny, nz), law);
        rest->element = kind;
        rest->stiff_directions.assign(rest->tets.tets.size(), Vec3::UnitX());
        nodes = nodes_of(*rest);
        description.bodies = {rest};
        in = still_inputs();
        in.integrator = Integrator::quasi_static;
        in.bodies = {material(1e5, 0.3)};
        for (const Where& where : held) {
            std::vector<double> weights;
            for (const Vec3& p : rest->surface) weights.push_back(where(p) ? 1 : 0);
            auto part = std::make_shared<HoldRest>();
            part->part = painted_vertices(rest->triangles, weights);
            description.parts.push_back({&hold_type, {0}, part});
            holds.emplace_back();
        }
        put_holds();
    }
    TissueInputs& values() { return std::get<TissueInputs>(in.bodies[0]); }
    HoldValues& hold(std::size_t k) { return holds[k]; }
    void put_holds() {
        in.parts.assign(holds.size(), PartValues(hold_type.values.size()));
        for (std::size_t k = 0; k < holds.size(); ++k) put_fields(holds[k], in.parts[k]);
    }
    /// Lets hold `k` follow a bone with these vertices.
    void follow_bone(const Points& points, std::size_t k = 0) {
        description.bodies.push_back(bone(points, {{0, 1, 2}}));
        in.bodies.push_back(BoneInputs{points});
        bone_points = points;
        auto part = std::make_shared<HoldRest>(static_cast<const HoldRest&>(*description.parts[k].rest));
        part->follows_bone = true;
        description.parts[k].rest = part;
        description.parts[k].bodies = {0, 1};
    }
    void move_bone(const RigidMotion& motion) {
        Points& now = std::get<BoneInputs>(in.bodies[1]).positions;
        for (std::size_t i = 0; i < now.size(); ++i) now[i] = motion(bone_points[i]);
    }
    /// The same body again, held by nothing.
    void add_free_body() {
        description.bodies.push_back(rest);
        in.bodies.push_back(in.bodies[0]);
    }
    void start() {
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        potential.reset();
        state = initial_state(*scene, in, motions);
    }
    bool step() {
        state = advance(*workspace, state, std::span(&in, 1));
        return state.record.converged;
    }
    /// Drops all but the saved state.
    void reload() {
        state = load(save(state));
        workspace = std::make_unique<Workspace>(scene);
    }
    const MassMatrix& masses() {
        if (!potential) potential = std::make_unique<Potential>(*scene);
        potential->take(state, in);
        return potential->masses();
    }
    Vec3 centre_of_mass() {
        const std::vector<double>& weight = masses().weight();
        Vec3 sum = Vec3::Zero();
        double mass = 0;
        for (std::size_t v = 0; v < nodes.size(); ++v)
            sum += weight[v] * position(state, static_cast<int>(v)), mass += weight[v];
        return sum / mass;
    }
    Vec3 measured(const char* what, int part) const {
        Vec3 out = Vec3::Constant(NAN);
        for (int c = 0; c < 3; ++c) {
            const std::string name = std::string(what) + "_" + "xyz"[c] + (what[0] == 'f' ? "_N" : "_Nm");
            for (const Measured& m : state.record.measured)
                if (m.what->term == "hold" && m.what->name == name && m.part == part) out[c] = m.value;
        }
        return out;
    }
    Vec3 force(int part) const { return measured("force", part); }
    Vec3 moment(int part) const { return measured("moment", part); }
    std::string name() const {
        return std::string(law_facts(rest->law).name) +
               (rest->element == ElementKind::linear ? ", linear" : ", quadratic");
    }
};

} // namespace sinew::test
