// Pictures of surfaces without a display: three lights, soft shadow, dark cavities, smooth edges.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/render/camera.h"
#include "tools/render/image.h"
#include "tools/render/look.h"

#include <string>
#include <vector>

namespace sinew::render {

/// A surface in one pose. Normals and grain have one entry a point; an empty grain means none.
struct Surface {
    Points points, normals;
    std::vector<solver::Triangle> triangles;
    Points grain; ///< rest position in the body's own frame: long axis first, half its length = 1
    Look look;
    float opacity = 1;     ///< below 1 what lies behind shines through; such surfaces do not show one another
    bool is_framed = true; ///< the camera makes room for it
};

/// A line that is as wide wherever it is; both ends at one place give a dot. It hides behind opaque surfaces,
/// casts no shadow and is not lit.
struct Segment {
    Vec3 from, to;
    Eigen::Vector3f colour; ///< linear light
    float width = 1;        ///< pixels
};

/// Rest coordinates for the fibre grain: centred, turned to the principal axes, divided by half the longest
/// side.
Points grain_of(const Points& rest);

/// \param smoothing  samples along each side of a pixel
Image draw_picture(const std::vector<Surface>& surfaces, const Camera& camera, int width, int height, int smoothing = 3,
                   const std::vector<Segment>& segments = {});

/// One picture of a contact sheet.
struct Shot {
    std::string label;
    std::vector<Surface> surfaces;
    std::vector<Segment> segments = {};
};

/// A shot as this camera sees it, with its label in the lower left corner.
Image labelled_picture(const Shot& shot, const Camera& camera, int width, int height, int smoothing = 3);

/// Several shots side by side, wrapped into rows so that each is as large as possible, all with one camera
/// that frames the points of every shot: of what is framed, or of all if nothing is there that is.
Image contact_sheet(const std::vector<Shot>& shots, const View& view, int width, int height, int smoothing = 3);

} // namespace sinew::render
