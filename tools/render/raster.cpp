// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/render/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

namespace sinew::render {

namespace {

constexpr int band_rows = 32; // bands are drawn independently, each over all triangles that touch it

struct Corners {
    const ScreenVertex *a, *b, *c;
};

Corners corners(const ScreenSurface& surface, const solver::Triangle& t) {
    const auto& v = surface.vertices;
    return {&v[static_cast<std::size_t>(t[0])], &v[static_cast<std::size_t>(t[1])], &v[static_cast<std::size_t>(t[2])]};
}

/// First and last cell whose centre lies in [low, high], cut to [first, last].
std::pair<int, int> cells(float low, float high, int first, int last) {
    const float from = std::ceil(low - 0.5f), to = std::floor(high - 0.5f);
    return {from <= static_cast<float>(first) ? first : static_cast<int>(std::min(from, static_cast<float>(last) + 1)),
            to >= static_cast<float>(last) ? last : static_cast<int>(std::max(to, static_cast<float>(first) - 1))};
}

void draw_triangle(Visibility& out, const Corners& k, int surface, int triangle, int first_row, int last_row) {
    const auto [y0, y1] =
        cells(std::min({k.a->y, k.b->y, k.c->y}), std::max({k.a->y, k.b->y, k.c->y}), first_row, last_row);
    const auto [x0, x1] =
        cells(std::min({k.a->x, k.b->x, k.c->x}), std::max({k.a->x, k.b->x, k.c->x}), 0, out.width - 1);
    const float abx = k.b->x - k.a->x, aby = k.b->y - k.a->y, acx = k.c->x - k.a->x, acy = k.c->y - k.a->y;
    const float twice_area = abx * acy - aby * acx;
    if (twice_area == 0 || !std::isfinite(twice_area)) return;
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const float px = static_cast<float>(x) + 0.5f - k.a->x, py = static_cast<float>(y) + 0.5f - k.a->y;
            const float b = (px * acy - py * acx) / twice_area, c = (abx * py - aby * px) / twice_area;
            if (b < 0 || c < 0 || b + c > 1) continue;
            const float near =
                k.a->nearness + b * (k.b->nearness - k.a->nearness) + c * (k.c->nearness - k.a->nearness);
            const std::size_t cell = out.index(x, y);
            if (near <= out.nearness[cell]) continue;
            out.nearness[cell] = near;
            out.surface[cell] = surface;
            out.triangle[cell] = triangle;
        }
}

} // namespace

Visibility rasterise(int width, int height, const std::vector<ScreenSurface>& surfaces) {
    Visibility out;
    out.width = width, out.height = height;
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    out.nearness.assign(count, -std::numeric_limits<float>::infinity());
    out.surface.assign(count, -1);
    out.triangle.assign(count, -1);
    tbb::parallel_for(0, (height + band_rows - 1) / band_rows, [&](int band) {
        const int first_row = band * band_rows, last_row = std::min(height, first_row + band_rows) - 1;
        for (std::size_t s = 0; s < surfaces.size(); ++s)
            for (std::size_t t = 0; t < surfaces[s].triangles->size(); ++t) {
                const Corners k = corners(surfaces[s], (*surfaces[s].triangles)[t]);
                if (std::max({k.a->y, k.b->y, k.c->y}) < static_cast<float>(first_row) ||
                    std::min({k.a->y, k.b->y, k.c->y}) > static_cast<float>(last_row + 1))
                    continue;
                draw_triangle(out, k, static_cast<int>(s), static_cast<int>(t), first_row, last_row);
            }
    });
    return out;
}

} // namespace sinew::render
