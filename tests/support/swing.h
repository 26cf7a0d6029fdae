// A muscle that moves with its bones: the scene of tests that need everything a step can have at once.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tests/support/solver_scenes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sinew::test {

/// A muscle between two bones: a box of tets, fibres, two attachments, the second bone swings.
struct Swing {
    solver::TetMesh mesh;
    std::shared_ptr<const solver::Scene> scene;
    solver::Points left, right;
    explicit Swing(solver::ElementKind kind = solver::ElementKind::linear, int fineness = 2)
        : mesh(box_mesh({0.3, 0.06, 0.06}, 5 * fineness, fineness, fineness)) {
        using namespace solver;
        auto t = tissue(mesh, ElasticLaw::stvk);
        t->element = kind;
        t->fibers = {{Points(mesh.tets.size(), Vec3(1, 0, 0)), std::vector<double>(mesh.tets.size(), 1.0)}};
        left = {{0, -0.1, -0.1}, {0, 0.2, -0.1}, {0, 0, 0.2}};
        right = {{0.3, -0.1, -0.1}, {0.3, 0.2, -0.1}, {0.3, 0, 0.2}};
        SceneDescription d;
        d.bodies = {t, bone(left, {{0, 1, 2}}), bone(right, {{0, 1, 2}})};
        for (const int end : {0, 1}) {
            AttachmentRest a;
            a.source = 0, a.target = 1 + end;
            a.source_weights.assign(mesh.vertices.size(), 0.0);
            for (const int v :
                 vertices_where(mesh.vertices, [&](const Vec3& p) { return std::abs(p.x() - 0.3 * end) < 1e-9; }))
                a.source_weights[static_cast<std::size_t>(v)] = 1;
            d.attachments.push_back(a);
        }
        scene = std::make_shared<const Scene>(std::move(d));
    }
    solver::StepInputs inputs(double frame) const {
        using namespace solver;
        StepInputs in;
        TissueInputs values = material(2e4, 0.45, 1060);
        values.compression_resistance = 20000;
        values.fibers = {{5e4, 0.5, std::min(1.0, frame / 10), 1}};
        const Mat3 turn = Eigen::AngleAxisd(0.1 * frame, Vec3(0, 0, 1)).toRotationMatrix();
        Points moved = right;
        for (Vec3& p : moved) p = turn * p;
        in.bodies = {values, BoneInputs{left}, BoneInputs{moved}};
        in.attachments = {{1e8, 1, 0}, {1e8, 1, 50}};
        in.stiffness_damping = 0.001;
        in.mass_damping = 0.1;
        in.max_newton_iterations = 30;
        return in;
    }
};

} // namespace sinew::test
