// Examples of fields: each kind, each switch, on two bodies of different tets.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/fields.h"
#include "tests/support/term_checks.h"

namespace sinew::test {

using namespace solver;

namespace {

/// A block of linear tets that is held at one side, and one of quadratic tets that flies above.
ExampleScene blocks(const TestField& field, int fineness) {
    auto held = tissue(box_mesh({0.2, 0.1, 0.1}, 2 * fineness, fineness, fineness), ElasticLaw::stvk);
    held->fixed_vertices = vertices_where(held->tets.vertices, [](const Vec3& p) { return p.x() < 1e-9; });
    held->layer_weights.push_back(std::vector<double>(held->tets.tets.size(), 0.25));
    auto flies = tissue(box_mesh({0.1, 0.1, 0.2}, fineness, fineness, 2 * fineness), ElasticLaw::stvk);
    flies->element = ElementKind::quadratic;
    for (Points* points : {&flies->tets.vertices, &flies->surface})
        for (Vec3& p : *points) p.y() += 0.15;
    const Part part = field.part({1, 0});
    auto scene =
        std::make_shared<const Scene>(SceneDescription{.bodies = {held, flies}, .attachments = {}, .parts = {part}});
    return {scene, [scene, field](int step) {
                StepInputs in = still_inputs();
                in.gravity = Vec3(0, -9.8, 0);
                TissueInputs soft = material(2e4, 0.4, 900), layered = soft;
                layered.layers.push_back({3e4, 0.3, 1500, 0.5});
                soft.forces.assign(scene->vertex_count(1), Vec3(0.02 * step, 0, 0.01));
                in.bodies = {layered, soft};
                TestField now = field;
                now.values.magnitude *= 1 + 0.1 * step;
                now.values.evolution += 0.05 * step;
                in.parts = {now.numbers()};
                return in;
            }};
}

} // namespace

std::vector<TermExample> field_examples() {
    using enum FieldKind;
    std::vector<TermExample> out;
    const auto add = [&](const char* name, const TestField& field, bool has_energy) {
        TermExample e;
        e.name = name;
        e.type = &field_type;
        e.make = [=](int fineness) { return blocks(field, fineness); };
        e.has_energy = has_energy;
        e.turns = false; // the field's place and directions are values that the harness does not turn
        out.push_back(std::move(e));
    };
    const Vec3 beside(-0.05, 0.3, 0.02), aslant(1, 2, -0.5);
    add("uniform field", TestField(uniform, 2e4).towards(aslant), true);
    add("uniform field that falls off", TestField(uniform, 2e4).towards(aslant).at(beside).falling(1.5, 0.1), false);
    add("gravity field", TestField(gravity, 15).towards(aslant), true);
    add("newton field", TestField(newton, 30).at(beside).falling(2, 0.15), true);
    add("newton field that ends", TestField(newton, -30).at(beside).falling(1, 0.4).ending(0.35), true);
    add("radial field", TestField(radial, 3e4).at(beside), true);
    add("radial field that ends", TestField(radial, 3e4).at(beside).falling(0.5, 0.05).ending(0.35), true);
    TestField wind = TestField(air, 3e4).towards(aslant);
    wind.values.air_speed = 3;
    add("air field", wind, true);
    add("air field that falls off", TestField(wind).at(beside).falling(2, 0.1).ending(0.5), false);
    wind.rest.component_only = true;
    wind.values.magnitude *= -1;
    add("air field, component only", wind, true);
    TestField mud(drag, 4e3);
    add("drag field", mud, true);
    mud.values.speed_attenuation = 0.7;
    add("drag field on fast things", mud, true);
    mud.rest.use_direction = true;
    mud.values.speed_attenuation = 0;
    add("drag field along a direction, fading", TestField(mud).towards(aslant).at(beside).ending(0.4), false);
    add("vortex field", TestField(vortex, 2e4).around(aslant).at(beside).falling(1, 0.1), false);
    TestField swirls(turbulence, 1e4);
    swirls.rest.noise_level = 2;
    swirls.values.wavelength = 0.4;
    swirls.values.phase_x = 0.3, swirls.values.phase_z = -4.6;
    add("turbulence field", TestField(swirls).at(beside).falling(1, 0.2), false);
    TestField volume = TestField(volume_axis, 1e4).around(aslant).towards({1, 0, 0}).at({0.02, 0.12, 0});
    volume.values.radius = 0.3, volume.values.height = 0.5;
    volume.values.away_from_center = 0.5, volume.values.away_from_axis = -0.7, volume.values.along_axis = 0.3;
    volume.values.around_axis = 1, volume.values.directional_speed = 0.4;
    add("volume axis field", volume, false);
    volume.rest.volume = FieldVolume::cylinder;
    volume.values.attenuation = 1.5;
    add("volume axis field in a cylinder", volume, false);
    volume.rest.invert_attenuation = true;
    volume.values.attenuation = 0.5;
    add("volume axis field, inverted", volume, false);
    return out;
}

} // namespace sinew::test
