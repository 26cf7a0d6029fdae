// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/tet_box.h"

#include <utility>

namespace sinew::solver {

TetMesh kuhn_mesh(int nx, int ny, int nz, const std::function<Vec3(double, double, double)>& place) {
    TetMesh mesh;
    const auto vertex = [&](const int* at) { return (at[0] * (ny + 1) + at[1]) * (nz + 1) + at[2]; };
    for (int x = 0; x <= nx; ++x)
        for (int y = 0; y <= ny; ++y)
            for (int z = 0; z <= nz; ++z)
                mesh.vertices.push_back(
                    place(static_cast<double>(x) / nx, static_cast<double>(y) / ny, static_cast<double>(z) / nz));
    // The six paths from a cube's lowest to its highest corner, one for each order of the axes; odd orders are turned
    // inside out and need a swap.
    constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int x = 0; x < nx; ++x)
        for (int y = 0; y < ny; ++y)
            for (int z = 0; z < nz; ++z)
                for (int o = 0; o < 6; ++o) {
                    int at[3] = {x, y, z};
                    Tet tet{vertex(at), 0, 0, 0};
                    for (std::size_t k = 0; k < 3; ++k) {
                        ++at[orders[o][k]];
                        tet[k + 1] = vertex(at);
                    }
                    if (o >= 3) std::swap(tet[1], tet[2]);
                    mesh.tets.push_back(tet);
                }
    mesh.coverage.assign(mesh.tets.size(), 1.0);
    return mesh;
}

} // namespace sinew::solver
