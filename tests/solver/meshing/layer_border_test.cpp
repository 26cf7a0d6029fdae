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

namespace {

SurfaceMesh moved(SurfaceMesh mesh, const Mat3& turn, const Vec3& by) {
    for (Vec3& p : mesh.points) p = turn * p + by;
    return mesh;
}
SurfaceMesh joined(SurfaceMesh one, const SurfaceMesh& other) {
    const int count = static_cast<int>(one.points.size());
    one.points.insert(one.points.end(), other.points.begin(), other.points.end());
    for (const Triangle& t : other.triangles) one.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
    return one;
}

/// A fitted mesh and what is known of it.
struct Fit {
    TetMesh before;
    FittedTets tets;
    std::vector<double> exact, shares;
    double solid = 0, layer = 0; ///< volumes, by exact shares
    double taken = 0;            ///< of the layer, by the shares that count
    double mixed = 0;            ///< of tets in part inside by the shares that count
    Fit(const TetMesh& mesh, const SurfaceMesh& place, const SurfaceMesh& skin)
        : before(mesh) {
        const Solid solid_place = make_layer_place(place.points, place.triangles);
        tets = fit_to_borders(mesh, {&solid_place}, skin.points, skin.triangles);
        exact = layer_shares(tets.mesh, solid_place, skin.points, skin.triangles);
        shares = fitted_shares(tets, 0, solid_place, skin.points, skin.triangles);
        for (std::size_t t = 0; t < shares.size(); ++t) {
            const double volume = lattice_checks::volume_of(tets.mesh, t) *
                                  (tets.mesh.coverage.empty() ? 1 : tets.mesh.coverage[t]);
            solid += volume, layer += volume * exact[t], taken += volume * shares[t];
            if (shares[t] > 1e-9 && shares[t] < 1 - 1e-9) mixed += volume;
        }
    }
    void print(const char* name) const {
        const auto a = dihedral_range(tets.mesh);
        printf("%s: tets %zu -> %zu vertices %zu -> %zu angles %.1f %.1f solid %.12g layer %.12g taken %.9g mixed %.3g\n", name,
               before.tets.size(), tets.mesh.tets.size(), before.vertices.size(), tets.mesh.vertices.size(), a[0], a[1],
               solid, layer, taken, mixed);
    }
};

} // namespace

TEST_CASE("stats", "[.stats]") {
    const SurfaceMesh cube = RotatedBox({1, 1, 1}, 0, 0).surface(1);
    const TetMesh block = box_mesh({1, 1, 1}, 5, 4, 6);
    const RotatedBox inner({0.5, 0.5, 0.5}, 30, 30);
    const SurfaceMesh turned = moved(inner.surface(1), Mat3::Identity(), Vec3(0.5, 0.5, 0.5) - inner.at({0.25, 0.25, 0.25}));
    Fit(block, turned, cube).print("turned cube in block");
    for (int n : {6, 12, 24})
        Fit(box_mesh({1, 1, 1}, n, n, n), moved(make_sphere(0.33, 46, 34), Mat3::Identity(), {0.52, 0.47, 0.51}), cube).print("ball in block");
    for (double d : {0.1, 0.03, 0.01, 0.001})
    Fit(block, moved(RotatedBox({3, 3, d}, 30, 30).surface(1), Mat3::Identity(), {-1, -1, 0.51}), cube).print("slab in block");
    Fit(block, moved(RotatedBox({1, 1, 0.5}, 0, 0).surface(1), Mat3::Identity(), {0, 0, 0.02}), cube).print("skin shared");
    for (double r : {0.2, 0.1, 0.05, 0.02})
    Fit(block, moved(make_cylinder(r, 3, 20, 1, 1), inner.turn, {0.5, 0.5, 0.5}), cube).print("rod");
    Fit(block, joined(moved(make_sphere(0.4, 20, 20), Mat3::Identity(), {0.5, 0.5, 0.5}), moved(make_sphere(0.3, 20, 20), Mat3::Identity(), {0.5, 0.5, 0.5})), cube).print("shell");
    Fit(block, joined(moved(make_sphere(0.25, 20, 20), Mat3::Identity(), {0.4, 0.5, 0.5}), moved(make_sphere(0.25, 20, 20), Mat3::Identity(), {0.6, 0.5, 0.5})), cube).print("two balls");
    const RotatedBox bar({0.4, 0.1, 0.1}, 30, 30);
    const SurfaceMesh skin = bar.surface(1);
    for (const int moments : {1, 4})
        for (const double size : {0.1, 0.05, 0.025}) {
            LatticeOptions options;
            options.tet_size = size, options.moments = moments;
            const TetMesh tets = make_lattice(skin.points, skin.triangles, options);
            for (double e : {0.0, 0.001, 0.3}) {
                SurfaceMesh place = moved(RotatedBox({0.11, 0.1 + 2 * e, 0.1 + 2 * e}, 30, 30).surface(1), Mat3::Identity(), bar.at({0.13, -e, -e}));
                Fit(tets, place, skin).print("bar");
            }
            Fit(tets, moved(make_sphere(0.04, 46, 34), Mat3::Identity(), bar.at({0.2, 0.05, 0.05})), skin).print("ball in bar");
            Fit(tets, moved(make_sphere(0.06, 46, 34), Mat3::Identity(), bar.at({0.2, 0.05, 0.05})), skin).print("ball through bar");
        }
}
