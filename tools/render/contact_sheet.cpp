// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/font.h"
#include "tools/render/picture.h"

#include <algorithm>
#include <cmath>

namespace sinew::render {

namespace {

constexpr int gap = 2; // pixels between pictures
constexpr Pixel gap_colour{8, 9, 11}, label_colour{190, 196, 206};

struct Grid {
    int columns = 1, rows = 1, cell_width = 1, cell_height = 1;
};

/// An arrangement without empty cells is taken where it shows the scene at least so large as the one that shows it
/// largest.
constexpr double full_enough = 0.6;

/// The number of columns that shows a scene of this shape (width / height) largest, or nearly so and leaves no cell
/// empty.
Grid arrange(int count, int width, int height, double aspect) {
    Grid best, full;
    double best_size = 0, full_size = 0;
    for (int columns = 1; columns <= count; ++columns) {
        Grid grid{columns, (count + columns - 1) / columns, 0, 0};
        grid.cell_width = std::max(1, (width - (columns - 1) * gap) / columns);
        grid.cell_height = std::max(1, (height - (grid.rows - 1) * gap) / grid.rows);
        const double size = std::min(grid.cell_width / aspect, static_cast<double>(grid.cell_height));
        if (size > best_size) best = grid, best_size = size;
        if (columns * grid.rows == count && size > full_size) full = grid, full_size = size;
    }
    return full_size >= full_enough * best_size ? full : best;
}

/// Width over height of the scene as this view sees it.
double scene_aspect(const std::vector<const Points*>& points, const View& view) {
    const Camera axes = frame_points({}, view, 1);
    double x[2] = {1e300, -1e300}, y[2] = {1e300, -1e300};
    for (const Points* list : points)
        for (const Vec3& p : *list) {
            x[0] = std::min(x[0], axes.right.dot(p)), x[1] = std::max(x[1], axes.right.dot(p));
            y[0] = std::min(y[0], axes.up.dot(p)), y[1] = std::max(y[1], axes.up.dot(p));
        }
    return x[1] > x[0] && y[1] > y[0] ? std::clamp((x[1] - x[0]) / (y[1] - y[0]), 0.25, 4.0) : 1;
}

} // namespace

Image labelled_picture(const Shot& shot, const Camera& camera, int width, int height, int smoothing) {
    Image picture = draw_picture(shot.surfaces, camera, width, height, smoothing, shot.segments);
    const double size = std::max(9.0, height / 36.0), border = 0.8 * size;
    draw_text(picture, border, height - border - size, shot.label, label_colour, size);
    return picture;
}

Image contact_sheet(const std::vector<Shot>& shots, const View& view, int width, int height, int smoothing) {
    Image sheet(width, height, gap_colour);
    if (shots.empty()) return sheet;
    std::vector<const Points*> points;
    const auto take = [&](bool all) {
        for (const Shot& shot : shots)
            for (const Surface& surface : shot.surfaces)
                if (all || surface.is_framed) points.push_back(&surface.points);
    };
    take(false);
    if (points.empty()) take(true);
    const Grid grid = arrange(static_cast<int>(shots.size()), width, height, scene_aspect(points, view));
    const Camera camera = frame_points(points, view, static_cast<double>(grid.cell_width) / grid.cell_height);
    for (int i = 0; i < static_cast<int>(shots.size()); ++i) {
        const Image picture =
            labelled_picture(shots[static_cast<std::size_t>(i)], camera, grid.cell_width, grid.cell_height, smoothing);
        paste(sheet, picture, i % grid.columns * (grid.cell_width + gap), i / grid.columns * (grid.cell_height + gap));
    }
    // What is left of the last row is as empty as the room around the bodies, not a hole.
    for (int i = static_cast<int>(shots.size()); i < grid.columns * grid.rows; ++i)
        paste(sheet, draw_picture({}, camera, grid.cell_width, grid.cell_height, 1),
              i % grid.columns * (grid.cell_width + gap), i / grid.columns * (grid.cell_height + gap));
    return sheet;
}

} // namespace sinew::render
