// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace sinew::render {

namespace {

constexpr double half_view_tangent = 0.2; // of the shorter side: a long lens, about 23 degrees, keeps proportions

struct NamedView {
    std::string_view name;
    double azimuth, elevation;
};
constexpr std::array<NamedView, 7> named_views{{{"front", 0, 0},
                                                {"back", 180, 0},
                                                {"left", 90, 0},
                                                {"right", -90, 0},
                                                {"top", 0, 90},
                                                {"bottom", 0, -90},
                                                {"corner", 30, 15}}};

std::optional<double> parse_degrees(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

} // namespace

std::optional<View> parse_view(std::string_view text) {
    for (const NamedView& v : named_views)
        if (v.name == text) return View{v.azimuth, v.elevation};
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) return {};
    const auto azimuth = parse_degrees(text.substr(0, comma)), elevation = parse_degrees(text.substr(comma + 1));
    if (!azimuth || !elevation || std::abs(*elevation) > 90) return {};
    return View{*azimuth, *elevation};
}

void Framing::Wedge::add(double side, double depth, double tangent) {
    plus = std::max(plus, side - tangent * depth);
    minus = std::max(minus, -side - tangent * depth);
}

Framing::Framing(const View& view, double aspect, double margin)
    : nearest_(infinity)
    , farthest_(-infinity)
    , horizontal_{-infinity, -infinity}
    , vertical_{-infinity, -infinity} {
    const double degree = std::numbers::pi / 180, a = view.azimuth * degree, e = view.elevation * degree;
    // Built with y up; where z is up the same picture is turned by 90 degrees about x.
    axes_.right = {std::cos(a), 0, -std::sin(a)};
    axes_.backward = {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
    if (view.up == 'z') {
        for (Vec3* axis : {&axes_.right, &axes_.backward}) *axis = Vec3((*axis)[0], -(*axis)[2], (*axis)[1]);
    }
    axes_.up = axes_.backward.cross(axes_.right);
    axes_.tan_x = half_view_tangent * std::max(1.0, aspect);
    axes_.tan_y = axes_.tan_x / aspect;
    tx_ = axes_.tan_x * (1 - 2 * margin), ty_ = axes_.tan_y * (1 - 2 * margin);
}

void Framing::add(const Points& points) {
    for (const Vec3& p : points) {
        const double depth = -axes_.backward.dot(p);
        horizontal_.add(axes_.right.dot(p), depth, tx_);
        vertical_.add(axes_.up.dot(p), depth, ty_);
        nearest_ = std::min(nearest_, depth), farthest_ = std::max(farthest_, depth);
    }
}

Camera Framing::camera() const {
    // With the direction fixed, the eye must lie behind the four planes that touch the points and carry the
    // border rays. Left and right planes meet in a line (the apex of a wedge), so do top and bottom: the eye
    // stands at the rearmost apex, centred in both wedges. Exact, no search.
    Camera camera = axes_;
    if (!std::isfinite(nearest_)) return camera; // no points: any camera shows all of them
    double depth = std::min(horizontal_.apex(tx_), vertical_.apex(ty_));
    // A line seen end on, or a lone point, wherever that is.
    depth = std::min(depth, nearest_ - std::max({1e-3 * (farthest_ - nearest_), 1e-9 * std::abs(nearest_), 1e-9}));
    camera.eye = horizontal_.centre() * camera.right + vertical_.centre() * camera.up - depth * camera.backward;
    return camera;
}

Camera frame_points(const std::vector<const Points*>& points, const View& view, double aspect, double margin) {
    Framing framing(view, aspect, margin);
    for (const Points* list : points) framing.add(*list);
    return framing.camera();
}

} // namespace sinew::render
