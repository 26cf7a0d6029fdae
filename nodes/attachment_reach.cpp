// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/attachment_reach.h"

#include "engine/text.h"
#include "nodes/z_solver_attributes.h"

#include <algorithm>
#include <cstdio>

namespace sinew::nodes {

using namespace engine;
using namespace z_solver;

namespace {

/// Bodies one of which is so many times as large are perhaps in two units.
constexpr double unlike = 6;
/// What ties a bone reaches so many times the bone's length at most.
constexpr double longest_of_target = 3;

/// One end of an attachment.
struct End {
    std::string name;
    double length; ///< longest side of the box around its mesh, scene units
};

End end_of(const Reads& in, const Setup& setup, std::size_t attachment, std::size_t end) {
    const auto body = static_cast<std::size_t>(setup.key.links[attachment][end]);
    return {in.source_name(bodies.name, static_cast<std::size_t>(setup.simulated[body])),
            solver::bounding_box(*mesh_of(setup.body(body)).points).size().maxCoeff()};
}

void warn_of_left_out(const Reads& in, const std::string& name, const solver::AttachmentStart& s, double units) {
    char text[200];
    if (s.max_distance > 0)
        std::snprintf(text, sizeof text,
                      "%.3g %% of the painted area holds on to nothing: its closest points of the target have no "
                      "target weight, and none within %.4g has",
                      100 * s.left_out / s.painted, s.max_distance * units);
    else
        std::snprintf(text, sizeof text,
                      "%.3g %% of the painted area holds on to nothing: the target has no target weight there",
                      100 * s.left_out / s.painted);
    in.warn(attachments.name, "FE241", name + text,
            "Paint source and target where they face each other, or set maxDistance.");
}

void warn_of_length(const Reads& in, const std::string& name, const End& source, const End& target, double longest,
                    double painted) {
    std::string text = "it reaches " + rough_text(longest, 4) + " far, while ";
    if (longest > painted)
        text += "the painted part of its source is " + rough_text(painted, 4) + " large";
    else
        text += "its target is " + rough_text(target.length, 4) + " long";
    const bool are_unlike = std::max(source.length, target.length) >= unlike * std::min(source.length, target.length);
    if (are_unlike)
        text += " (" + source.name + " is " + rough_text(source.length, 3) + " long, " + target.name + " " +
                rough_text(target.length, 3) + ")";
    in.warn(attachments.name, "FE242", name + text,
            std::string("Check that it ties what it should; paint the part of the target that is meant as "
                        "targetWeights") +
                (are_unlike ? "; if one of the two is in another unit, scale it by a transform." : "."));
}

} // namespace

void warn_of_reach(const Reads& in, const Setup& setup, const std::vector<solver::AttachmentStart>& starts) {
    const double units = setup.key.scale;
    for (std::size_t a = 0; a < starts.size(); ++a) {
        const solver::AttachmentStart& s = starts[a];
        const std::string name = attachment_name(in, setup, static_cast<int>(a)) + ": ";
        if (s.left_out > 0) warn_of_left_out(in, name, s, units);
        const End source = end_of(in, setup, a, 0), target = end_of(in, setup, a, 1);
        const double longest = s.longest * units, painted = s.source_size * units;
        if (longest > painted || longest > longest_of_target * target.length)
            warn_of_length(in, name, source, target, longest, painted);
    }
}

} // namespace sinew::nodes
