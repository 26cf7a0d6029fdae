// Tets fitted to the borders of layers: conforming, of the same volume, each on one side, well shaped.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/mesh/tet_quality.h"
#include "solver/meshing/lattice.h"
#include "solver/meshing/layer_border.h"
#include "solver/meshing/layer_place.h"
#include "tests/solver/meshing/lattice_checks.h"
#include "tests/support/rotated_box.h"
#include "tests/support/solver_scenes.h"

#include <catch2/catch.hpp>
#include <tbb/global_control.h>

using namespace sinew::solver;
using namespace sinew::test;

TEST_CASE("stats", "[.stats]") {
    const RotatedBox bar({0.4, 0.1, 0.1}, 30, 30);
    const SurfaceMesh skin = bar.surface(1);
    for (const int moments : {1, 4})
        for (const double size : {0.1, 0.05, 0.025}) {
            LatticeOptions options;
            options.tet_size = size, options.moments = moments;
            const TetMesh tets = make_lattice(skin.points, skin.triangles, options);
            SurfaceMesh place = RotatedBox({0.11, 2, 2}, 30, 30).surface(1);
            for (Vec3& p : place.points) p += bar.at({0.13, -1, -1});
            const Solid solid = make_layer_place(place.points, place.triangles);
            const FittedTets f = fit_to_borders(tets, {&solid}, skin.points, skin.triangles);
            const auto raw = layer_shares(f.mesh, solid, skin.points, skin.triangles);
            const auto s = fitted_shares(f, 0, solid, skin.points, skin.triangles);
            double q = 1, was = 1, all = 0, old = 0, mixed = 0, rounded = 0, layer = 0, worst_s = 0;
            for (std::size_t t = 0; t < f.mesh.tets.size(); ++t) {
                const auto c = [&](std::size_t k) { return f.mesh.vertices[std::size_t(f.mesh.tets[t][k])]; };
                q = std::min(q, tet_quality(c(0), c(1), c(2), c(3)));
                const double v = lattice_checks::volume_of(f.mesh, t) * f.mesh.coverage[t];
                all += v, layer += v * raw[t];
                if (s[t] > 1e-9 && s[t] < 1 - 1e-9) mixed += v, (size > 0.03 && moments == 1) ? printf("   share %.4g coverage %.4g parent %d at %d\n", s[t], f.mesh.coverage[t], f.parent[t], f.at_border[0][t]) : 0;
                if (std::abs(s[t] - raw[t]) > 1e-9) rounded += v, worst_s = std::max(worst_s, std::abs(s[t] - raw[t]));
            }
            for (std::size_t t = 0; t < tets.tets.size(); ++t) {
                const auto c = [&](std::size_t k) { return tets.vertices[std::size_t(tets.tets[t][k])]; };
                was = std::min(was, tet_quality(c(0), c(1), c(2), c(3)));
                old += lattice_checks::volume_of(tets, t) * tets.coverage[t];
            }
            const auto angles = dihedral_range(f.mesh);
            printf("moments %d size %.3f tets %zu -> %zu vertices %zu -> %zu q %.3f -> %.3f angles %.1f %.1f volume %.9f -> %.9f layer %.9f mixed %.3g rounded %.3g worst %.3g\n",
                   moments, size, tets.tets.size(), f.mesh.tets.size(), tets.vertices.size(), f.mesh.vertices.size(), was, q, angles[0],
                   angles[1], old, all, layer, mixed / all, rounded / all, worst_s);
        }
}
