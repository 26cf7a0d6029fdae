// Where the eye stands: a direction by name or by angles, and the distance that shows everything.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::render {

using solver::Points;
using solver::Vec3;

/// Degrees. Azimuth 0 looks at the front (the +z side, or the -y side where z points up) and grows towards
/// the scene's left hand (+x); elevation 90 looks straight down.
struct View {
    double azimuth = 30, elevation = 15;
    char up = 'y'; ///< 'y' or 'z'
};

/// "front", "back", "left", "right", "top", "bottom", "corner" or "AZIMUTH,ELEVATION"; empty if it is none of
/// them.
std::optional<View> parse_view(std::string_view text);

/// A perspective camera.
struct Camera {
    Vec3 eye, right, up, backward; ///< unit axes; the camera looks along -backward
    double tan_x = 1, tan_y = 1;   ///< tangents of half the angles of view

    /// Coordinates in the camera's axes: x to the right, y up, z = distance in front of the eye.
    Vec3 to_camera(const Vec3& p) const {
        const Vec3 d = p - eye;
        return {right.dot(d), up.dot(d), -backward.dot(d)};
    }
    /// Unit direction through the point (u, v) of the picture, both in -1…1, v upwards.
    Vec3 ray(double u, double v) const { return (u * tan_x * right + v * tan_y * up - backward).normalized(); }
};

/// Collects points, and gives the camera nearest to them that looks in the view's direction and whose picture
/// holds every one. Keeps only what touches the picture's borders, so a long run costs no memory.
class Framing {
  public:
    /// \param aspect width / height
    /// \param margin share of the picture kept free at each border
    Framing(const View& view, double aspect, double margin = 0.05);
    void add(const Points& points);
    Camera camera() const;

  private:
    /// The two planes of one opening angle that touch the points from outside: their offsets, and where they
    /// meet.
    struct Wedge {
        double plus, minus;
        void add(double side, double depth, double tangent);
        double centre() const { return 0.5 * (plus - minus); }
        double apex(double tangent) const { return -0.5 * (plus + minus) / tangent; }
    };

    Camera axes_;
    double tx_ = 1, ty_ = 1, nearest_, farthest_;
    Wedge horizontal_, vertical_;
};

/// The camera nearest to the scene, looking in the view's direction, whose picture holds every point.
/// \param aspect width / height
/// \param margin share of the picture kept free at each border
Camera frame_points(const std::vector<const Points*>& points, const View& view, double aspect, double margin = 0.05);

} // namespace sinew::render
