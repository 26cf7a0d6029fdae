// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/oscillator.h"

#include "tools/bench/reference.h"

#include <cmath>

namespace sinew::bench {

using namespace solver;
using nlohmann::json;

namespace {

const json& values() { return reference_values()["integrators"]["one_dof"]; }

TetMesh tet() { return regular_tet(values()["edge"]); }

SceneDescription scene() {
    const auto rest = make_tissue(tet(), ElasticLaw::neo_hookean);
    auto bone = std::make_shared<BoneRest>();
    bone->surface = rest->surface, bone->triangles = rest->triangles;
    AttachmentRest a;
    a.source = 0, a.target = 1, a.source_weights = {1};
    return {{rest, bone}, {a}};
}

StepInputs inputs(Integrator integrator, double step_size, double damping_per_mass, bool gravity) {
    const json& r = values();
    StepInputs in = tight_inputs();
    in.integrator = integrator;
    in.step_size = step_size;
    if (gravity) in.gravity = Vec3(0, 0, -9.81);
    in.bodies = {material(1e5, 0.3, r["rho"]), BoneInputs{tet().vertices}};
    AttachmentInputs a;
    a.stiffness = r["attachment_stiffness"];
    a.damping = damping_per_mass * r["mass"].get<double>() / r["area"].get<double>();
    in.attachments = {a};
    return in;
}

} // namespace

Oscillator::Oscillator(Integrator integrator, double step_size, double damping_per_mass, double speed)
    : omega(values()["omega"])
    , sag(values()["static_sag"])
    , sim(scene(), inputs(integrator, step_size, damping_per_mass, speed == 0), {},
          std::array{InitialMotion{Vec3(0, 0, speed), Vec3::Zero()}, InitialMotion{}})
    , rest_height_(position(sim.state.x, 0).z()) {}

void Oscillator::set_history(std::complex<double> y) {
    const TetMesh rest = tet();
    State& s = sim.state;
    s.history.step_size = sim.inputs.step_size;
    s.history.x = s.x, s.history.v = s.v, s.history.bones = s.bones;
    for (std::size_t i = 0; i < 4; ++i) {
        s.history.x[3 * i + 2] = rest.vertices[i].z() + y.real();
        s.history.v[3 * i + 2] = -omega * y.imag();
    }
}

double Oscillator::error_at(Integrator integrator, double end, int steps) {
    Oscillator o(integrator, end / steps);
    for (int i = 0; i < steps; ++i) o.sim.step();
    return std::abs(o.height() + o.sag * (1 - std::cos(o.omega * end)));
}

} // namespace sinew::bench
