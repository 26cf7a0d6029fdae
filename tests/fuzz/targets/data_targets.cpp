// Recorded motion, curves and painted maps from files.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/curve_file.h"
#include "nodes/motion_track.h"
#include "nodes/painted_maps.h"
#include "solver/fiber/curve.h"
#include "solver/mesh/coordinates.h"
#include "tests/fuzz/targets/refused.h"
#include "tests/fuzz/targets/targets.h"

#include <cmath>

namespace sinew::fuzz {

void read_motion(std::string_view bytes) {
    refused_or_read([&] {
        const nodes::MatrixTrack track = nodes::parse_matrix_track(bytes, "motion.json", "ulna");
        promise(track.frames.size() == track.matrices.size() && !track.frames.empty(), "a motion without frames");
        for (const double frame : track.frames) track.at(frame), track.at(frame + 0.5);
        track.at(-1e9), track.at(1e9);
    });
    refused_or_read([&] {
        const nodes::NumberTrack track = nodes::parse_number_track(bytes, "motion.json", "flexion");
        promise(track.frames.size() == track.values.size() && !track.frames.empty(), "a channel without frames");
        for (const double frame : track.frames) {
            promise(std::isfinite(track.at(frame)), "a channel that is not finite");
            track.at(frame + 0.5);
        }
    });
}

void read_curve_file(std::string_view bytes) {
    for (const char* file : {"curve.json", "curve.txt"})
        refused_or_read([&] {
            const engine::NumberList numbers = nodes::parse_curve(bytes, file, "");
            if (numbers.size() % 3 != 0 || numbers.size() < 6) return; // which the node refuses
            for (const auto form : {solver::CurveForm::polyline, solver::CurveForm::cubic})
                refused_or_read([&] {
                    solver::Curve curve;
                    curve.form = form;
                    for (std::size_t i = 0; i < numbers.size(); i += 3)
                        curve.points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
                    solver::check_coordinates(curve.points);
                    solver::check_curve(curve);
                    promise(solver::curve_length(curve) >= 0, "a curve of no length that there is");
                });
        });
}

void read_painted_map(std::string_view bytes) {
    for (const char* pointer : {"", "/a", "/a/0/vertices"})
        refused_or_read([&] {
            for (const double number : nodes::parse_map(bytes, "map.json", pointer).numbers)
                promise(std::isfinite(number), "a weight that is not finite");
        });
}

} // namespace sinew::fuzz
