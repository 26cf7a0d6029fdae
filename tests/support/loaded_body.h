// One body with a force on its surface, for tests of pressure and surface tension.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tests/support/surface_forces.h"
#include "tests/support/trial.h"

#include <Eigen/Dense>

namespace sinew::test {

/// Springs of linear elasticity against change of volume [Pa].
inline double bulk_modulus(double youngs, double poissons) { return youngs / (3 * (1 - 2 * poissons)); }

struct LoadedBody : Trial {
    LoadedBody(const TetMesh& mesh, ElementKind kind, const TissueInputs& values, const Where& held = nowhere,
               ElasticLaw law = ElasticLaw::log_neo_hookean)
        : Trial(mesh, law, kind, held, values) {
        in.tolerance_factor = 1e-4;
        if (rest->fixed_vertices.empty()) use_backward_euler(10); // so long that inertia has no part in it
    }
    /// In place of the box: a ball of the lattice.
    void use(std::shared_ptr<TissueRest> body) {
        rest = std::move(body);
        description.bodies[0] = rest;
        nodes = rest->tets.vertices;
        if (rest->element == ElementKind::quadratic)
            for (const auto& [a, b] : edges_of(rest->tets.tets)) nodes.push_back(0.5 * (node(a) + node(b)));
    }
    void load(const TermType& type, double value, std::vector<double> weights = {}) {
        std::vector<SurfaceLayers::Layer> layers{{value, {}}};
        if (!weights.empty()) {
            layers = {{0, {}}, {value, std::move(weights)}};
            rest->layer_weights.emplace_back(rest->tets.tets.size(), 0.0);
            values().layers.push_back(values().layers.front());
        }
        description.parts = {on_surface(type, 0, std::move(layers))};
        in.parts = {{1}};
    }
    std::vector<double> weights(const std::function<double(const Vec3&)>& at_vertex) const {
        std::vector<double> out;
        for (const Vec3& p : rest->surface) out.push_back(at_vertex(p));
        return out;
    }
    void settle(int steps = 3) {
        if (!workspace) start();
        for (int i = 0; i < steps; ++i) {
            if (in.integrator == Integrator::backward_euler || in.integrator == Integrator::quasi_static) {
                REQUIRE(step());
            } else { // which the judge does not know
                state = advance(*workspace, state, std::span(&in, 1));
                REQUIRE(state.record.converged);
            }
        }
    }
    /// What acts on each node where it is now, held ones left out [N].
    std::vector<Vec3> forces() {
        if (!workspace) start();
        Judge judge(*this, state);
        std::vector<double> gradient;
        judge.potential.evaluate(state.x, &gradient, nullptr);
        std::vector<Vec3> out(nodes.size(), Vec3::Zero());
        const Numbering& numbering = scene->numbering();
        for (std::size_t u = 0; u < numbering.unknown_count(); ++u)
            out[static_cast<std::size_t>(numbering.vertex_of_unknown[u])] =
                -Vec3(gradient[3 * u], gradient[3 * u + 1], gradient[3 * u + 2]);
        return out;
    }
    Vec3 net_force() {
        Vec3 sum = Vec3::Zero();
        for (const Vec3& f : forces()) sum += f;
        return sum;
    }
    /// Sum of f.x of elasticity alone: the integral of the stress's trace [J].
    double elastic_virial() {
        LoadedBody bare = *this;
        bare.description.parts.clear(), bare.in.parts.clear();
        bare.in.integrator = Integrator::quasi_static;
        bare.workspace.reset();
        bare.start();
        bare.state.x = state.x;
        double sum = 0;
        const std::vector<Vec3> f = bare.forces();
        for (std::size_t v = 0; v < f.size(); ++v) sum -= f[v].dot(position(state, static_cast<int>(v)));
        return sum;
    }
    LoadedBody(const LoadedBody& o)
        : Trial(o.rest->tets, o.rest->law, o.rest->element, nowhere, {}) {
        rest = o.rest, description = o.description, in = o.in, nodes = o.nodes;
    }
    Vec3 node(int v) const { return rest->tets.vertices[static_cast<std::size_t>(v)]; }

    /// Of all tets, as their nodes are now: the integral of det F, which a quadratic tet has of degree 3.
    double tet_volume_now() const {
        constexpr double rule[5][5] = {{0.25, 0.25, 0.25, 0.25, -0.8},
                                       {0.5, 1. / 6, 1. / 6, 1. / 6, 0.45},
                                       {1. / 6, 0.5, 1. / 6, 1. / 6, 0.45},
                                       {1. / 6, 1. / 6, 0.5, 1. / 6, 0.45},
                                       {1. / 6, 1. / 6, 1. / 6, 0.5, 0.45}};
        const auto edges = edges_of(rest->tets.tets);
        double volume = 0;
        for (const Tet& t : rest->tets.tets) {
            const auto corner = [&](int c) { return position(state, t[static_cast<std::size_t>(c)]); };
            const auto middle = [&](int a, int b) {
                const int i = t[static_cast<std::size_t>(a)], j = t[static_cast<std::size_t>(b)];
                if (rest->element == ElementKind::linear) return Vec3(0.5 * (corner(a) + corner(b)));
                const std::array<int, 2> edge{std::min(i, j), std::max(i, j)};
                return position(
                    state, static_cast<int>(rest->tets.vertices.size()) +
                               static_cast<int>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin()));
            };
            for (const auto& q : rule) {
                Mat3 f = Mat3::Zero(); // by coordinates 1 to 3; coordinate 0 is what is left
                for (int d = 1; d < 4; ++d) {
                    Vec3 column = (4 * q[d] - 1) * corner(d) - (4 * q[0] - 1) * corner(0);
                    for (int a = 0; a < 4; ++a)
                        for (int b = a + 1; b < 4; ++b)
                            column += 4 * ((a == d ? q[b] : b == d ? q[a] : 0) - (a == 0 ? q[b] : 0)) * middle(a, b);
                    f.col(d - 1) = column;
                }
                volume += q[4] * f.determinant() / 6;
            }
        }
        return volume;
    }
};

} // namespace sinew::test
