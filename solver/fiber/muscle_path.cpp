// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/fiber/muscle_path.h"

#include "solver/index.h"
#include "solver/mesh/harmonic.h"
#include "solver/mesh/surface_mesh.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Where the field takes `value` between two corners.
Vec3 crossing(const TetMesh& mesh, const std::vector<double>& field, int a, int b, double value) {
    const double share = (value - field[at(a)]) / (field[at(b)] - field[at(a)]);
    return (1 - share) * mesh.vertices[at(a)] + share * mesh.vertices[at(b)];
}

/// Of painted vertices at one end, by the area that they stand for.
Vec3 end_middle(const PaintedSurface& surface, const std::vector<double>& ends, const std::vector<char>& painted,
                double end) {
    const std::vector<double> areas = vertex_areas(surface.points, surface.triangles);
    Vec3 sum = Vec3::Zero(), plain = Vec3::Zero();
    double area = 0, count = 0;
    for (std::size_t v = 0; v < ends.size(); ++v) {
        if (!painted[v] || ends[v] != end) continue;
        sum += areas[v] * surface.points[v], area += areas[v];
        plain += surface.points[v], ++count;
    }
    return area > 0 ? Vec3(sum / area) : Vec3(plain / count);
}

} // namespace

bool section_middle(const TetMesh& mesh, const std::vector<double>& field, double value, Vec3& middle) {
    Vec3 sum = Vec3::Zero();
    double area = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        Tet below, above;
        std::size_t lows = 0, highs = 0;
        for (const int v : mesh.tets[t]) (field[at(v)] < value ? below[lows++] : above[highs++]) = v;
        if (lows == 0 || highs == 0) continue;
        // Corners of the section in order around it: three, or four where two corners lie on either side.
        Points corners;
        for (std::size_t i = 0; i < lows; ++i)
            for (std::size_t k = 0; k < highs; ++k)
                corners.push_back(crossing(mesh, field, below[i], above[i % 2 ? highs - 1 - k : k], value));
        const double coverage = mesh.coverage.empty() ? 1.0 : mesh.coverage[t];
        for (std::size_t i = 2; i < corners.size(); ++i) {
            const double a = coverage * 0.5 * (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]).norm();
            area += a;
            sum += a / 3 * (corners[0] + corners[i - 1] + corners[i]);
        }
    }
    if (!(area > 0)) return false;
    middle = sum / area;
    return true;
}

Points muscle_path(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<double>& ends,
                   const std::vector<char>& painted, int count) {
    const std::vector<double> field = harmonic_extensions(mesh, surface, {ends}, painted).front();
    Points out{end_middle(surface, ends, painted, 0)};
    for (int i = 1; i + 1 < count; ++i)
        if (Vec3 middle; section_middle(mesh, field, static_cast<double>(i) / (count - 1), middle))
            out.push_back(middle);
    out.push_back(end_middle(surface, ends, painted, 1));
    return out;
}

} // namespace sinew::solver
