// Examples of pressure and surface tension: closed and open surfaces, constant and painted, on tets that fit the
// surface and on those of the lattice.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"
#include "tests/support/surface_forces.h"
#include "tests/support/term_checks.h"

namespace sinew::test {

using namespace solver;

namespace {

struct Setting {
    ElementKind kind = ElementKind::linear;
    bool lattice = false, painted = false, open = false, held = false;
    double envelope = 1;
};

/// Two layers, the upper one painted or everywhere at half; a block, or a ball in the lattice.
ExampleScene scene_of(const TermType& type, double value, const Setting& s, int fineness) {
    auto t = s.lattice ? lattice_ball(0.1, 0.15 / fineness, ElasticLaw::stvk, s.kind)
                       : tissue(box_mesh({0.2, 0.1, 0.1}, 2 * fineness, fineness, fineness), ElasticLaw::stvk);
    t->element = s.kind;
    t->layer_weights.emplace_back(t->tets.tets.size(), 0.5);
    if (s.open) t->triangles.resize(t->triangles.size() - 3);
    if (s.held) t->fixed_vertices = vertices_where(t->tets.vertices, [](const Vec3& p) { return p.x() < 1e-9; });
    SurfaceLayers::Layer upper{-0.4 * value, {}};
    for (const Vec3& p : t->surface)
        upper.weights.push_back(s.painted ? std::clamp(5 * p.x() + 3 * p.y(), 0.0, 1.0) : 1.0);
    return {std::make_shared<const Scene>(SceneDescription{
                .bodies = {t}, .attachments = {}, .parts = {on_surface(type, 0, {{value, {}}, upper})}}),
            [s](int step) {
                StepInputs in = still_inputs();
                TissueInputs values = material(2e4, 0.45, 1000);
                values.layers.push_back({1e4, 0.3, 1000, 0.3});
                in.bodies = {values};
                in.parts = {{s.envelope * (1 + 0.1 * step)}};
                return in;
            }};
}

std::vector<TermExample> examples(const TermType& type, double value, bool has_energy_painted) {
    std::vector<TermExample> out;
    const auto add = [&](std::string name, const Setting& s) {
        const bool potential = has_energy_painted || !(s.painted || s.open);
        TermExample e;
        e.name = std::string(type.name) + ": " + name + (s.kind == ElementKind::linear ? ", linear" : ", quadratic");
        e.type = &type;
        e.make = [=, &type](int fineness) { return scene_of(type, value, s, fineness); };
        e.has_energy = e.forces_cancel = e.torques_cancel = potential;
        e.projects_exactly = &type != &pressure_type; // which leaves its Hessian out then
        out.push_back(std::move(e));
    };
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        add("block", {.kind = kind});
        add("block, outwards", {.kind = kind, .held = true, .envelope = -1});
        add("painted block", {.kind = kind, .painted = true});
        add("open block", {.kind = kind, .open = true, .held = true});
        add("ball in the lattice", {.kind = kind, .lattice = true});
        add("painted ball in the lattice", {.kind = kind, .lattice = true, .painted = true, .envelope = -1});
    }
    return out;
}

} // namespace

std::vector<TermExample> pressure_examples() { return examples(pressure_type, 500, false); }
std::vector<TermExample> surface_tension_examples() { return examples(surface_tension_type, 15, true); }

} // namespace sinew::test
