// The Hessian of more tets than are held at a time.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/newton/potential.h"
#include "solver/system.h"
#include "solver/terms/elastic/hessian_chunk.h"
#include "tests/support/solver_scenes.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE("chunk by chunk the Hessian gives an affine motion's energy, and no force within a body") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        // The second body begins within the first one's last chunk and ends in a later one.
        const bool linear = kind == ElementKind::linear;
        const int n = linear ? 10 : 5, m = linear ? 11 : 6;
        SceneDescription description;
        StepInputs in;
        in.integrator = Integrator::quasi_static;
        in.gravity = Vec3::Zero();
        for (const int cells : {n, m}) {
            auto rest = tissue(box_mesh({0.2, 0.3, 0.1 * cells}, cells, cells, cells), ElasticLaw::stvk);
            rest->element = kind;
            description.bodies.push_back(rest);
            in.bodies.push_back(material(cells == n ? 2e4 : 7e5, 0.3));
        }
        const Scene scene(description);
        CHECK(scene.system().hessian_size > chunk_entries);
        CHECK(scene.system().tissues[0].hessian_at(scene.system().tissues[0].batch_count) % chunk_entries != 0);
        const State state = initial_state(scene, in);
        Potential potential(scene);
        potential.take(state, in);
        potential.begin_step(state, in);
        ImplicitForm form;
        quasi_static_form(state, form);
        potential.begin_stage(state, form, state.bones);
        BlockMatrix a(potential.pattern());
        for (const bool project : {false, true}) {
            potential.assemble(state.x, project, a);
            Mat3 slope;
            slope << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.9, 0.2, -0.6;
            const Mat3 strain = 0.5 * (slope + slope.transpose());
            std::vector<double> u(state.x.size()), force(u.size());
            for (std::size_t v = 0; v < u.size(); v += 3)
                Eigen::Map<Vec3>(u.data() + v) = slope * Eigen::Map<const Vec3>(state.x.data() + v);
            multiply(a, u.data(), force.data());
            for (std::size_t body = 0; body < 2; ++body) {
                const Deformable& d = scene.numbering().deformables[body];
                const double modulus = body == 0 ? 2e4 : 7e5, poisson = 0.3;
                const double mu = modulus / (2 * (1 + poisson)),
                             lambda = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson));
                const Vec3 size(0.2, 0.3, 0.1 * (body == 0 ? n : m));
                double twice = 0, largest = 0, within = 0;
                for (std::size_t v = 3 * d.first_vertex; v < 3 * (d.first_vertex + d.vertex_count); v += 3) {
                    const Eigen::Map<const Vec3> f(force.data() + v), p(state.x.data() + v);
                    twice += f.dot(Eigen::Map<const Vec3>(u.data() + v));
                    const bool inner = (p.array() > 1e-9).all() && (p.array() < size.array() - 1e-9).all();
                    (inner ? within : largest) = std::max(inner ? within : largest, f.norm());
                }
                const double trace = strain.trace();
                CHECK(twice ==
                      Approx(size.prod() * (2 * mu * strain.squaredNorm() + lambda * trace * trace)).epsilon(1e-11));
                CHECK(within < 1e-11 * largest);
            }
        }
    }
}
