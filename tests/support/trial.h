// One body through hard times: a tissue of linear or quadratic tets, what happens to it, and a judge of its own for
// whatever a step calls converged.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/linear/component_factors.h"
#include "solver/newton/potential.h"
#include "solver/system.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace sinew::test {

using namespace solver;
using Map = std::function<Vec3(const Vec3&)>;
using Where = std::function<bool(const Vec3&)>;

constexpr ElementKind kinds[] = {ElementKind::linear, ElementKind::quadratic};
constexpr ElasticLaw laws[] = {ElasticLaw::stvk, ElasticLaw::neo_hookean, ElasticLaw::corotational};

inline bool nowhere(const Vec3&) { return false; }
inline bool everywhere(const Vec3&) { return true; }
inline bool at_root(const Vec3& p) { return p.x() < 1e-9; }

/// One body, quasi-static without gravity unless said otherwise, and what happens to it.
struct Trial {
    std::shared_ptr<TissueRest> rest;
    SceneDescription description;
    StepInputs in;
    Points nodes; ///< rest positions of all vertices of the first body
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<Workspace> workspace;
    State state;
    int iterations = 0;

    Trial(const TetMesh& mesh, ElasticLaw law, ElementKind kind, const Where& held, const TissueInputs& values) {
        rest = tissue(mesh, law);
        rest->element = kind;
        nodes = mesh.vertices;
        if (kind == ElementKind::quadratic)
            for (const auto& [a, b] : edges_of(mesh.tets))
                nodes.push_back(
                    0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
        rest->fixed_vertices = vertices_where(nodes, held);
        description.bodies = {rest};
        in.gravity = Vec3::Zero();
        in.integrator = Integrator::quasi_static;
        in.max_newton_iterations = 200;
        in.bodies = {values};
    }
    TissueInputs& values() { return std::get<TissueInputs>(in.bodies[0]); }
    void use_backward_euler(double step_size) {
        in.integrator = Integrator::backward_euler;
        in.step_size = step_size;
    }
    /// A bone, and springs from it to the vertices of tissue `source` whose rest position has x = 0.
    void add_bone(const Points& corners) {
        description.bodies.push_back(bone(corners, {{0, 1, 2}}));
        in.bodies.push_back(BoneInputs{corners});
    }
    void attach_root(int source, int target, double stiffness) {
        AttachmentRest a;
        a.source = source, a.target = target;
        a.source_weights.assign(rest->surface.size(), 0.0);
        for (const int v : vertices_where(rest->surface, at_root)) a.source_weights[static_cast<std::size_t>(v)] = 1;
        description.attachments.push_back(a);
        in.attachments.push_back({stiffness, 1, 0});
    }
    void start() {
        scene = std::make_shared<const Scene>(description);
        workspace = std::make_unique<Workspace>(scene);
        state = initial_state(*scene, in);
    }
    /// Puts the vertices for which `which` holds at rest to where `to` takes them.
    void place(const Where& which, const Map& to) {
        for (std::size_t v = 0; v < nodes.size(); ++v)
            if (which(nodes[v])) set_position(state, static_cast<int>(v), to(nodes[v]));
    }

    /// The step's potential, made anew, at its end.
    struct Judge {
        Potential potential;
        ImplicitForm form;
        Judge(const Trial& t, const State& before)
            : potential(*t.scene) {
            if (t.in.integrator == Integrator::quasi_static)
                quasi_static_form(before, form);
            else
                backward_euler_form(before, t.in.step_size, form);
            potential.take(before, t.in);
            potential.begin_step(before, t.in);
            potential.begin_stage(before, form, t.state.bones);
        }
        /// Small forces that Newton's exact step, made anew and taken whole, does not halve are rounding's.
        bool is_in_balance(const Trial& t) {
            std::vector<double> gradient;
            std::vector<BodyForces> forces;
            const double tolerance = 1e-6 * t.in.tolerance_factor;
            potential.evaluate(t.state.x, &gradient, &forces);
            const Balance here = potential.balance(t.state.x, forces, tolerance);
            if (here.reached || here.residual > 1e-4) return here.reached;
            BlockMatrix hessian(potential.pattern());
            potential.assemble(t.state.x, false, hessian);
            ComponentFactors factors(potential.pattern());
            if (!factors.factorize(hessian)) return false;
            std::vector<double> step(gradient.size());
            factors.solve(gradient.data(), step.data());
            Positions there = t.state.x;
            const std::vector<int>& vertex_of = potential.numbering().vertex_of_unknown;
            for (std::size_t u = 0; u < vertex_of.size(); ++u)
                for (std::size_t d = 0; d < 3; ++d)
                    there[3 * static_cast<std::size_t>(vertex_of[u]) + d] -= step[3 * u + d];
            potential.evaluate(there, &gradient, &forces);
            return potential.balance(there, forces, tolerance).residual > 0.5 * here.residual;
        }
        bool is_minimum(const Trial& t) {
            BlockMatrix hessian(potential.pattern());
            potential.assemble(t.state.x, false, hessian);
            return ComponentFactors(potential.pattern()).factorize(hessian);
        }
    };
    /// Whatever the step did, it must have left numbers; what it calls converged must be in balance, and with
    /// `minimum_too` have no direction that leads down.
    bool step(bool minimum_too = false) {
        const State before = state;
        state = advance(*workspace, before, std::span(&in, 1));
        iterations += state.record.newton_iterations;
        bool finite = std::isfinite(state.record.energy) && std::isfinite(state.record.residual) &&
                      std::isfinite(state.record.min_j);
        for (const auto* numbers : {&state.x, &state.v})
            for (const double c : *numbers) finite = finite && std::isfinite(c);
        CHECK(finite);
        if (state.record.converged) {
            Judge judge(*this, before);
            INFO(name() << ", least det F " << state.record.min_j << ", energy " << state.record.energy);
            CHECK(judge.is_in_balance(*this));
            if (minimum_too) CHECK(judge.is_minimum(*this));
        }
        return state.record.converged;
    }
    /// Greatest distance of a vertex of the first body from where `to` takes its rest position.
    double distance_from(const Map& to) const {
        double worst = 0;
        for (std::size_t v = 0; v < nodes.size(); ++v)
            worst = std::max(worst, (position(state, static_cast<int>(v)) - to(nodes[v])).norm());
        return worst;
    }
    double distance_from(const Trial& other) const {
        double worst = 0;
        for (std::size_t v = 0; v < nodes.size(); ++v)
            worst = std::max(
                worst, (position(state, static_cast<int>(v)) - position(other.state, static_cast<int>(v))).norm());
        return worst;
    }
    /// Greatest change of a distance between two vertices: 0 for any rigid motion of the rest shape, also mirrored.
    double distortion() const {
        double worst = 0;
        for (std::size_t a = 0; a < nodes.size(); ++a)
            for (std::size_t b = 0; b < a; ++b)
                worst = std::max(
                    worst,
                    std::abs((position(state, static_cast<int>(a)) - position(state, static_cast<int>(b))).norm() -
                             (nodes[a] - nodes[b]).norm()));
        return worst;
    }
    std::string name() const {
        return std::string(rest->element == ElementKind::linear ? "linear" : "quadratic") + ", " +
               std::string(law_facts(rest->law).name) + ", " + std::to_string(iterations) + " iterations, residual " +
               std::to_string(state.record.residual);
    }
};

inline TissueInputs flesh(double youngs_modulus, double poissons_ratio, double compression_resistance = 0) {
    TissueInputs t = material(youngs_modulus, poissons_ratio);
    t.compression_resistance = compression_resistance;
    return t;
}

/// Corners of a bone in the plane x = 0.
inline Points root_plate() { return {{0, -0.1, -0.1}, {0, 0.2, -0.1}, {0, 0, 0.2}}; }

} // namespace sinew::test
