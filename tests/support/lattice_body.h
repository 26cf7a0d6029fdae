// One tissue through a lattice that does not fit it, held and loaded at many points of its surface.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/embedding.h"
#include "solver/meshing/lattice.h"
#include "tests/support/rotated_box.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>

namespace sinew::test {

struct LatticeBody {
    using Where = std::function<bool(const solver::Vec3&)>;
    std::shared_ptr<solver::TissueRest> rest = std::make_shared<solver::TissueRest>();
    solver::SceneDescription description;
    solver::StepInputs in = still_inputs();
    std::vector<solver::Triangle> triangles; ///< of the whole surface; rest->triangles are those that are held
    std::shared_ptr<const solver::Scene> scene;
    solver::State state;

    /// \param shape the surface that the lattice is made for \param points the same, fine enough to be held and loaded
    LatticeBody(const solver::SurfaceMesh& shape, const solver::SurfaceMesh& points, double tet_size,
                solver::ElasticLaw law, solver::ElementKind element, const solver::TissueInputs& values) {
        solver::LatticeOptions options;
        options.tet_size = tet_size;
        options.moments = element == solver::ElementKind::quadratic ? 4 : 1;
        rest->tets = solver::make_lattice(shape.points, shape.triangles, options);
        rest->surface = points.points;
        triangles = points.triangles;
        rest->embedding = solver::embed(rest->tets, rest->surface);
        rest->law = law;
        rest->element = element;
        rest->layer_weights = {std::vector<double>(rest->tets.tets.size(), 1.0)};
        description.bodies = {rest};
        in.integrator = solver::Integrator::quasi_static;
        in.bodies = {values};
    }
    solver::TissueInputs& values() { return std::get<solver::TissueInputs>(in.bodies[0]); }

    /// Springs of this stiffness [N/m^3] on the part of the surface where `where` holds at a triangle's corners.
    void hold(const Where& where, double stiffness) {
        const solver::Points plate{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        description.bodies.push_back(bone(plate, {{0, 1, 2}}));
        in.bodies.push_back(solver::BoneInputs{plate});
        solver::AttachmentRest a;
        a.source = 0, a.target = 1;
        for (const solver::Vec3& p : rest->surface) a.source_weights.push_back(where(p) ? 1 : 0);
        for (const solver::Triangle& t : triangles)
            if (on(t, where)) rest->triangles.push_back(t);
        description.attachments = {a};
        in.attachments = {{stiffness, 1, 0}};
    }
    void start() {
        scene = std::make_shared<const solver::Scene>(description);
        state = solver::initial_state(*scene, in);
    }
    /// After start(): dead loads of a uniform traction [Pa].
    void pull(const Where& where, const solver::Vec3& traction) {
        solver::Points& loads = values().forces;
        loads.assign(scene->vertex_count(0), solver::Vec3::Zero());
        for (const solver::Triangle& t : triangles) {
            if (!on(t, where)) continue;
            const auto p = [&](std::size_t c) { return rest->surface[static_cast<std::size_t>(t[c])]; };
            const double third = 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).norm() / 3;
            for (const int v : t) {
                const solver::PointWeights at = carrier(v);
                for (int k = 0; k < at.count; ++k)
                    loads[static_cast<std::size_t>(at.vertex[k])] += third * at.weight[k] * traction;
            }
        }
    }
    void solve(int steps = 1) {
        solver::Workspace workspace(scene);
        state = settle(workspace, state, in, steps);
    }
    solver::PointWeights carrier(int v) const {
        const auto at = static_cast<std::size_t>(v);
        return scene->embedded(0, rest->embedding.tet[at], rest->embedding.barycentric[at]);
    }
    solver::Vec3 displacement(int v) const {
        const solver::PointWeights at = carrier(v);
        solver::Vec3 p = -rest->surface[static_cast<std::size_t>(v)];
        for (int k = 0; k < at.count; ++k) p += at.weight[k] * position(state, at.vertex[k]);
        return p;
    }
    /// Mean over the surface's vertices where `where` holds.
    solver::Vec3 mean_displacement(const Where& where) const {
        solver::Vec3 sum = solver::Vec3::Zero();
        int count = 0;
        for (std::size_t v = 0; v < rest->surface.size(); ++v)
            if (where(rest->surface[v])) sum += displacement(static_cast<int>(v)), ++count;
        REQUIRE(count > 0);
        return sum / count;
    }

  private:
    bool on(const solver::Triangle& t, const Where& where) const {
        return std::all_of(t.begin(), t.end(),
                           [&](int v) { return where(rest->surface[static_cast<std::size_t>(v)]); });
    }
};

} // namespace sinew::test
