// Which triangle is seen at each point of a grid. Knows no camera and no colours: it gets screen coordinates,
// so the eye's picture and the light's shadow map come from the same code.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/types.h"

#include <cstdint>
#include <vector>

namespace sinew::render {

/// x to the right and y down in grid units; nearness must be linear over the screen and grow towards the
/// viewer (1 / distance for a perspective picture, -distance for a parallel one).
struct ScreenVertex {
    float x = 0, y = 0, nearness = 0;
};

/// What is to be drawn: one entry a surface.
struct ScreenSurface {
    std::vector<ScreenVertex> vertices;
    const std::vector<solver::Triangle>* triangles = nullptr;
};

struct Visibility {
    int width = 0, height = 0;
    std::vector<float> nearness;                 ///< of the seen point
    std::vector<std::int32_t> surface, triangle; ///< surface = -1 where nothing is seen

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

/// Samples at the centres of the grid's cells; both sides of a triangle are seen. Where two triangles are
/// equally near the first one wins, so the result does not depend on the number of threads.
Visibility rasterise(int width, int height, const std::vector<ScreenSurface>& surfaces);

} // namespace sinew::render
