// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/rig/motion.h"

#include "nodes/json_file.h"
#include "nodes/motion_track.h"
#include "solver/error.h"

#include <algorithm>
#include <cmath>

namespace sinew::rig {

using engine::Severity;
using nlohmann::json;

namespace {

json read(const engine::FileAccess& access, const std::string& file) {
    try {
        json out = nodes::read_json(access, file);
        if (out.is_object() && out.contains("frames") && out["frames"].is_array() && !out["frames"].empty() &&
            out["frames"].front().is_object() && out["frames"].front().contains("bones") &&
            out["frames"].front()["bones"].is_object())
            return out;
    } catch (const solver::Error& e) {
        throw engine::Failure(say(Severity::error, e.code, "", e.what(), e.hint));
    }
    throw engine::Failure(say(Severity::error, "IO403", "", file + ": this is no motion of bones", nodes::motion_form));
}

double frame_of(const json& frame, double otherwise) {
    return frame.contains("frame") && frame["frame"].is_number() ? frame["frame"].get<double>() : otherwise;
}

} // namespace

int Motion::frames(int graph_fps) const {
    constexpr double most = 999'999; // frames that a graph may have after its first
    return std::max(2, 1 + static_cast<int>(std::min(most, std::floor((last - first) * graph_fps / fps + 1e-6))));
}

Motion read_motion(const engine::FileAccess& access, const std::string& file, Rig& rig, bool is_up_given) {
    const json all = read(access, file);
    Motion out;
    out.file = file;
    if (all.contains("fps") && all["fps"].is_number() && all["fps"].get<double>() > 0) out.fps = all["fps"];
    out.first = frame_of(all["frames"].front(), 1);
    out.last = frame_of(all["frames"].back(), static_cast<double>(all["frames"].size()));
    std::map<std::string, std::string> known;
    for (const auto& [name, matrix] : all["frames"].front()["bones"].items()) known[camel_case(name)] = name;
    std::string still;
    for (const Part& part : rig.parts) {
        if (part.kind != Kind::bone) continue;
        const auto track = known.find(camel_case(part.stem));
        if (track != known.end())
            out.tracks[part.name] = track->second;
        else
            still += (still.empty() ? "" : ", ") + part.name;
    }
    std::string names;
    for (const auto& [name, track] : known) names += (names.empty() ? "" : ", ") + track;
    if (out.tracks.empty())
        throw engine::Failure(say(Severity::error, "DG159", "", file + ": it moves none of the bones (" + still + ")",
                                  "Its tracks: " + names + ". Name the mesh files like them."));
    if (!still.empty())
        rig.notes.push_back(say(Severity::warning, "DG159", "",
                                file + " has no track for " + still + ", which stand still",
                                "Its tracks: " + names + "."));
    if (all.contains("units") && all["units"].is_string() && unit_of(all["units"]) &&
        unit_of(all["units"])->per_metre != rig.unit.per_metre)
        rig.notes.push_back(
            say(Severity::warning, "DG159", "",
                file + " is in " + all["units"].get<std::string>() + ", but the meshes seem to be in " + rig.unit.name,
                "Say the unit with --unit, or take a motion of these meshes."));
    if (!is_up_given && all.contains("up_axis") && all["up_axis"].is_string()) {
        const std::string axis = all["up_axis"];
        const char letter =
            axis.empty() ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(axis.back())));
        if (letter == 'y' || letter == 'z') rig.up = {letter, "as the motion says"};
    }
    return out;
}

} // namespace sinew::rig
