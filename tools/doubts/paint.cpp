// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/painted_maps.h"
#include "tools/doubts/kinds.h"

#include <algorithm>
#include <limits>

namespace sinew::doubts {

namespace {

/// "(muscle is 300 long, femur 30)": most often one of two is in another unit where they do not reach each other.
std::string sizes_of(const std::string& one, const solver::Points& a, const std::string& other,
                     const solver::Points& b) {
    return "(" + one + " is " + rough(extent(a), 3) + " long, " + other + " " + rough(extent(b), 3) + ")";
}

void doubt_near(Doubting& d, const std::string& node, const std::string& painted, const solver::Points& points) {
    const auto outer = d.number<double>(node, "outerDistance");
    for (const engine::Plug& plug : d.plugs(node, "otherMesh")) {
        const auto other = d.value<nodes::Mesh>(plug);
        if (!outer || !other || other->points->empty()) return;
        const double nearest = nodes::nearest_distance(points, *other);
        if (nearest < *outer) return;
        d.doubt("FE325", node, "outerDistance",
                "nothing of " + painted + " is within " + rough(*outer, 3) + " of " + plug.node +
                    ", so nothing is painted: its nearest point is " + rough(nearest, 3) + " away " +
                    sizes_of(painted, points, plug.node, *other->points),
                "widen outerDistance, or, if one of them is modelled in another unit, scale it by a transform");
    }
}

void doubt_sphere(Doubting& d, const std::string& node, const std::string& painted, const solver::Points& points) {
    const auto centre = d.number<engine::Vec3>(node, "center");
    const auto radius = d.number<double>(node, "radius"), falloff = d.number<double>(node, "falloff");
    if (!centre || !radius || !falloff) return;
    const solver::Vec3 c((*centre)[0], (*centre)[1], (*centre)[2]);
    double nearest = std::numeric_limits<double>::infinity();
    for (const solver::Vec3& p : points) nearest = std::min(nearest, (p - c).norm());
    if (nearest <= *radius || nearest < *radius + *falloff) return;
    d.doubt("FE325", node, "radius",
            "nothing of " + painted + " is in the sphere, so nothing is painted: its nearest point is " +
                rough(nearest, 3) + " from the centre (" + painted + " is " + rough(extent(points), 3) + " long)",
            "widen radius or falloff, or move center; both are in scene units");
}

void doubt_ramp(Doubting& d, const std::string& node, const std::string& painted, const solver::Points& points) {
    const auto axis = d.number<std::string>(node, "axis");
    const auto start = d.number<double>(node, "start"), end = d.number<double>(node, "end");
    if (!axis || !start || !end || axis->size() != 1 || (*axis)[0] < 'x' || (*axis)[0] > 'z') return;
    const solver::Box box = solver::bounding_box(points);
    const double low = box.min[(*axis)[0] - 'x'], high = box.max[(*axis)[0] - 'x'];
    d.doubt("FE325", node, "start",
            "nothing of " + painted + " lies where it rises from 0 at " + *axis + " = " + rough(*start, 3) +
                " to 1 at " + rough(*end, 3) + ", so nothing is painted: " + painted + " reaches from " +
                rough(low, 3) + " to " + rough(high, 3),
            "choose start and end within that; they are in scene units. If " + painted +
                " is modelled in another unit, scale it by a transform");
}

} // namespace

void doubt_reach_of_paint(Doubting& d, const std::string& node, bool ramps) {
    const auto mode = d.number<std::string>(node, "mode"), on = d.number<std::string>(node, "on");
    if (mode != "near" && mode != "sphere" && !(ramps && mode == "ramp")) return;
    const auto map = d.value<engine::NumberList>({node, "outWeights"});
    if (!map || map->empty()) return;
    // Mostly something is painted, and then nothing is to be measured. A map that is turned round or raised says
    // nothing of what the rule paints.
    const bool plain = d.number<bool>(node, "invert") == false && d.number<double>(node, "offset") == 0.0;
    if (!plain || std::any_of(map->begin(), map->end(), [](double w) { return w > 0; })) return;
    for (const engine::Plug& plug : d.plugs(node, "mesh")) {
        const auto mesh = d.value<nodes::Mesh>(plug);
        if (!mesh || mesh->points->empty()) return;
        const solver::Points points = on == "faces" ? nodes::face_centres(*mesh) : *mesh->points;
        if (points.empty()) return;
        (mode == "near" ? doubt_near : mode == "ramp" ? doubt_ramp : doubt_sphere)(d, node, plug.node, points);
    }
}

void doubt_blank_paint(Doubting& d, const std::string& body) {
    const auto look_at = [&](const std::string& layer) {
        const auto is_blank = [](const engine::NumberList& map) {
            return map.size() > 1 && std::none_of(map.begin(), map.end(), [](double w) { return w > 0; });
        };
        const auto literal = d.number<engine::NumberList>(layer, "weights");
        std::string source = "weights";
        bool blank = literal && is_blank(*literal);
        for (const engine::Plug& plug : d.plugs(layer, "weights"))
            if (const auto map = d.value<engine::NumberList>(plug)) blank = is_blank(*map), source = plug.node;
        if (!blank || !d.once("FE328", layer)) return;
        d.doubt("FE328", layer, "weights", "is nowhere: all numbers of " + source + " are 0 at the first frame",
                "paint where it is to be, or take it out of the graph");
    };
    const std::vector<engine::Plug> layers = d.plugs(body, "materials");
    for (std::size_t k = 1; k < layers.size(); ++k) look_at(layers[k].node); // the first covers all, whatever it says
    for (const engine::Plug& fiber : d.plugs(body, "fibers")) look_at(fiber.node);
}

} // namespace sinew::doubts
