// trackChannel: a recorded number over time, mapped to the range that an attribute needs.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/limits.h"
#include "nodes/motion_track.h"

#include <algorithm>
#include <cmath>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<File> file{
    .name = "file",
    .doc = "A motion file (JSON) whose frames carry numbers.",
    .required = true,
};
const Input<std::string> channel{
    .name = "channel",
    .doc = "The name of the number in each frame, for example elbow_flexion_deg.",
    .required = true,
};
const Input<double> offset{
    .name = "offset",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Shift along the track, in track frames: graph frame 1 shows track frame 1 + offset.",
};
const Input<double> rate{
    .name = "rate",
    .def = 1,
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Track frames per graph frame: 5 for data of 120 samples a second at 24 frames a second.",
    .keyable = false,
};
const Input<double> in_min{
    .name = "inMin", .def = 0, .limits = within_reach, .doc = "The recorded number that gives outMin."};
const Input<double> in_max{
    .name = "inMax",
    .def = 1,
    .limits = within_reach,
    .doc = "The recorded number that gives outMax; not equal to inMin.",
};
const Input<double> out_min{.name = "outMin", .def = 0, .limits = within_reach, .doc = "The value at inMin."};
const Input<double> out_max{
    .name = "outMax", .def = 1, .limits = within_reach, .doc = "The value at inMax; may be below outMin."};
const Input<bool> clamp{.name = "clamp", .def = true, .doc = "Keeps the value between outMin and outMax."};
const Output<double> out_value{.name = "outValue", .doc = "The mapped number at this frame."};

void compute(const Reads& in, Writes& out) {
    if (in[in_min] == in[in_max])
        in.fail(in_max.name, "DG110", "inMin and inMax are both " + std::to_string(in[in_min]),
                "Give the two recorded numbers that map to outMin and outMax.");
    const Digest key = Hasher().add("trackChannel.file").add(in[file].content).add(in[channel]).finish();
    auto track = in.lease<NumberTrack>(key, [&] {
        return guarded(in, file.name, [&] {
            return std::make_shared<NumberTrack>(read_number_track(in.files(), in[file].path, in[channel]));
        });
    });
    const double recorded = track->at(track_frame(in.frame(), in[offset], in[rate]));
    const double share = (recorded - in[in_min]) / (in[in_max] - in[in_min]);
    out.set(out_value, std::lerp(in[out_min], in[out_max], in[clamp] ? std::clamp(share, 0.0, 1.0) : share));
}

} // namespace

void add_track_channel(Registry& registry) {
    NodeType type;
    type.name = "trackChannel";
    type.doc = "Reads a recorded number over time, for example a joint angle that drives zFiber.excitation.";
    type.inputs = {describe(file),   describe(channel), describe(offset),  describe(rate), describe(in_min),
                   describe(in_max), describe(out_min), describe(out_max), describe(clamp)};
    type.outputs = {describe(out_value)};
    type.uses_time = true; // the track is read at the frame
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
