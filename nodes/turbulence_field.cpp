// turbulenceField: smooth noise in space and time.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/field_node.h"

namespace sinew::nodes {

using namespace engine;

namespace {

const auto magnitude = field::magnitude(
    1000, "N/m^3",
    "Force per volume: the root of its mean square over space. A magnitude of Maya's divided by zSolver.scale.");
const auto attenuation = field::attenuation(0);
const Input<double> frequency{
    .name = "frequency",
    .def = 1,
    .limits = {.min = 0, .max = 1e9, .open_min = true},
    .doc = "Swirls per scene unit: higher is finer.",
};
const Input<Vec3> phase{
    .name = "phase",
    .unit = "1",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Shifts the pattern, in swirls; key it to let the pattern drift.",
};
const Input<double> rate{
    .name = "rate",
    .def = 0,
    .unit = "1",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "How much of the pattern is new each frame: 0 stands still, with 0.1 another one has come after ten frames.",
    .keyable = false,
};
const Input<std::int64_t> noise_level{
    .name = "noiseLevel",
    .def = 0,
    .limits = {.min = 0, .max = 8},
    .doc = "Finer patterns laid over the first, each twice as fine and as fast as the one before.",
    .keyable = false,
};
const Input<double> noise_ratio{
    .name = "noiseRatio",
    .def = 0.707,
    .unit = "1",
    .limits = {.min = 0, .max = 1},
    .doc = "Strength of each of these relative to the one before; the magnitude of the whole stays.",
};

void compute(const Reads& in, Writes& out) {
    solver::FieldRest rest;
    rest.kind = solver::FieldKind::turbulence;
    solver::FieldValues values = field::read_common(in, magnitude, attenuation, rest);
    values.wavelength = 1 / in[frequency];
    values.phase_x = in[phase][0], values.phase_y = in[phase][1], values.phase_z = in[phase][2];
    values.evolution = in[rate] == rate.def ? 0 : in[rate] * in.frame(); // without a rate the frame is not read
    rest.noise_level = static_cast<int>(in[noise_level]);
    values.noise_ratio = in[noise_ratio];
    field::publish(in, out, rest, values);
}

} // namespace

void add_turbulence_field(Registry& registry) {
    NodeType type = field::node_type(
        "turbulenceField", "Pushes tissue hither and thither: smooth noise in space and time, the same at every run.",
        magnitude, attenuation,
        {describe(frequency), describe(phase), describe(rate), describe(noise_level), describe(noise_ratio)}, compute);
    type.uses_time = true; // the pattern changes with the frame
    type.time_input = rate.name;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
