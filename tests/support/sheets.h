// Sheets of cloth for tests: rectangles in several triangulations, and what a scene of one cloth needs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/cloth/sheet.h"
#include "tests/support/solver_scenes.h"

#include <algorithm>
#include <cmath>

namespace sinew::test {

/// Diagonals all alike, turned from cell to cell, or rows of triangles with equal sides (where the cells allow it).
enum class Weave { diagonal, crossed, bricks };

struct Sheet {
    solver::Points points;
    std::vector<solver::Triangle> triangles;
    /// Vertices of column i.
    std::vector<std::vector<int>> columns;
};

/// A rectangle of columns at x[0], x[1] … and `across` cells of width over y in [0, width], z = 0. Bricks have every
/// other row shifted by half a cell inside; their ends stay straight.
inline Sheet make_sheet(const std::vector<double>& x, double width, int across, Weave weave) {
    Sheet out;
    const int n = static_cast<int>(x.size());
    out.columns.resize(x.size());
    for (int j = 0; j <= across; ++j)
        for (int i = 0; i < n; ++i) {
            double at = x[std::size_t(i)];
            const bool inside = i > 1 && i + 1 < n;
            if (weave == Weave::bricks && j % 2 == 1 && inside) at += 0.5 * (x[std::size_t(i) - 1] - at);
            out.columns[std::size_t(i)].push_back(static_cast<int>(out.points.size()));
            out.points.emplace_back(at, width * j / across, 0);
        }
    for (int j = 0; j < across; ++j)
        for (int i = 0; i + 1 < n; ++i) {
            const int a = j * n + i, b = a + 1, c = a + n, d = c + 1;
            const bool turned = weave == Weave::crossed ? (i + j) % 2 == 1 : weave == Weave::bricks && j % 2 == 0;
            if (turned) {
                out.triangles.push_back({a, b, d});
                out.triangles.push_back({a, d, c});
            } else {
                out.triangles.push_back({a, b, c});
                out.triangles.push_back({b, d, c});
            }
        }
    return out;
}

inline std::vector<double> evenly(double from, double to, int cells) {
    std::vector<double> out;
    for (int i = 0; i <= cells; ++i) out.push_back(from + (to - from) * i / cells);
    return out;
}

inline std::shared_ptr<solver::ClothRest> cloth(const solver::Points& points,
                                                const std::vector<solver::Triangle>& triangles,
                                                const solver::Vec3& warp = {1, 0, 0}) {
    auto out = std::make_shared<solver::ClothRest>();
    out->surface = points, out->triangles = triangles;
    out->warp = solver::warp_directions(points, triangles, warp);
    out->layer_weights = {std::vector<double>(points.size(), 1.0)};
    return out;
}

inline solver::ClothInputs cloth_material(double tensile, double shear, double bend, double density) {
    solver::ClothInputs out;
    out.layers.push_back({tensile, shear, bend, density, 1, 1});
    return out;
}

} // namespace sinew::test
