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

constexpr double half_view_tangent =
    0.2; // of the shorter side: a long lens, about 23 degrees, keeps proportions

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

/// The two planes of one opening angle that touch the points from outside: their offsets, and where they
/// meet.
struct Wedge {
    double plus = -std::numeric_limits<double>::infinity(), minus = plus;
    void add(double side, double depth, double tangent) {
        plus = std::max(plus, side - tangent * depth);
        minus = std::max(minus, -side - tangent * depth);
    }
    double centre() const { return 0.5 * (plus - minus); }
    double apex(double tangent) const { return -0.5 * (plus + minus) / tangent; }
};

} // namespace

std::optional<View> parse_view(std::string_view text) {
    for (const NamedView& v : named_views)
        if (v.name == text) return View{v.azimuth, v.elevation};
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) return {};
    const auto azimuth = parse_degrees(text.substr(0, comma)),
               elevation = parse_degrees(text.substr(comma + 1));
    if (!azimuth || !elevation || std::abs(*elevation) > 90) return {};
    return View{*azimuth, *elevation};
}

Camera frame_points(const std::vector<const Points*>& points, const View& view, double aspect,
                    double margin) {
    const double degree = std::numbers::pi / 180, a = view.azimuth * degree, e = view.elevation * degree;
    Camera camera;
    // Built with y up; where z is up the same picture is turned by 90 degrees about x.
    camera.right = {std::cos(a), 0, -std::sin(a)};
    camera.backward = {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
    if (view.up == 'z') {
        for (Vec3* axis : {&camera.right, &camera.backward})
            *axis = Vec3((*axis)[0], -(*axis)[2], (*axis)[1]);
    }
    camera.up = camera.backward.cross(camera.right);
    camera.tan_x = half_view_tangent * std::max(1.0, aspect);
    camera.tan_y = camera.tan_x / aspect;

    // With the direction fixed, the eye must lie behind the four planes that touch the points and carry the
    // border rays. Left and right planes meet in a line (the apex of a wedge), so do top and bottom: the eye
    // stands at the rearmost apex, centred in both wedges. Exact, no search.
    const double tx = camera.tan_x * (1 - 2 * margin), ty = camera.tan_y * (1 - 2 * margin);
    Wedge horizontal, vertical;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Points* list : points)
        for (const Vec3& p : *list) {
            const double depth = -camera.backward.dot(p);
            horizontal.add(camera.right.dot(p), depth, tx);
            vertical.add(camera.up.dot(p), depth, ty);
            nearest = std::min(nearest, depth);
        }
    if (!std::isfinite(nearest)) return camera; // no points: any camera shows all of them
    double depth = std::min(horizontal.apex(tx), vertical.apex(ty));
    depth = std::min(
        depth, nearest - 1e-3 * std::max(1e-6, std::abs(nearest))); // a lone point or a line seen end on
    camera.eye = horizontal.centre() * camera.right + vertical.centre() * camera.up - depth * camera.backward;
    return camera;
}

} // namespace sinew::render
