// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/dirichlet_energy.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/joined_sets.h"

#include <Eigen/LU>

#include <algorithm>
#include <string>

namespace sinew::solver {

namespace {

/// Gradients of the four barycentric coordinates, one a column.
Eigen::Matrix<double, 3, 4> hat_gradients(const TetMesh& mesh, std::size_t tet) {
    const Tet& t = mesh.tets[tet];
    const Vec3& origin = mesh.vertices[at(t[0])];
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.row(k) = mesh.vertices[at(t[at(k + 1)])] - origin;
    // The bound of check_and_orient: below it the volume is rounding error.
    const double longest = edges.rowwise().norm().maxCoeff();
    if (!(edges.determinant() > 6e-15 * longest * longest * longest))
        throw Error("FE215",
                    "tet " + std::to_string(tet) +
                        " has no volume or is inside out, so nothing can be "
                        "extended through it",
                    "Remove or remesh flat tets.");
    Eigen::Matrix<double, 3, 4> g;
    g.rightCols<3>() = edges.inverse();
    g.col(0) = -(g.col(1) + g.col(2) + g.col(3));
    return g;
}

} // namespace

Eigen::SparseMatrix<double> dirichlet_matrix(const TetMesh& mesh, const std::vector<int>& number, int count) {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const Tet& tet = mesh.tets[t];
        if (std::all_of(tet.begin(), tet.end(), [&](int v) { return number[at(v)] < 0; })) continue;
        const auto g = hat_gradients(mesh, t);
        const double volume = tet_volume(mesh.vertices[at(tet[0])], mesh.vertices[at(tet[1])],
                                         mesh.vertices[at(tet[2])], mesh.vertices[at(tet[3])]);
        const double weight = (mesh.coverage.empty() ? 1.0 : mesh.coverage[t]) * volume;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) {
                const int row = number[at(tet[at(i)])], column = number[at(tet[at(j)])];
                if (row >= 0 && column >= 0) entries.emplace_back(row, column, weight * g.col(i).dot(g.col(j)));
            }
    }
    Eigen::SparseMatrix<double> out(count, count);
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
}

Points gradients_of(const TetMesh& mesh, const std::vector<double>& per_vertex) {
    Points gradients;
    gradients.reserve(mesh.tets.size());
    for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
        const Tet& t = mesh.tets[tet];
        // Differences first: a constant field must give exactly zero.
        const auto g = hat_gradients(mesh, tet);
        Vec3 sum = Vec3::Zero();
        for (int k = 1; k < 4; ++k) sum += (per_vertex[at(t[at(k)])] - per_vertex[at(t[0])]) * g.col(k);
        gradients.push_back(sum);
    }
    return gradients;
}

void make_unit(Points& gradients, double least_share) {
    double largest = 0;
    for (const Vec3& g : gradients) largest = std::max(largest, g.norm());
    for (Vec3& g : gradients) {
        const double length = g.norm();
        g = length > least_share * largest ? Vec3(g / length) : Vec3::Zero();
    }
}

std::vector<int> connected_parts(const TetMesh& mesh) {
    JoinedSets parts(mesh.vertices.size());
    for (const Tet& t : mesh.tets)
        for (std::size_t k = 1; k < 4; ++k) parts.join(t[0], t[k]);
    std::vector<int> out;
    for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) out.push_back(parts.root(v));
    return out;
}

} // namespace sinew::solver
