// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/fibre_field.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/linear/scalar_cholesky.h"
#include "solver/mesh/dirichlet_energy.h"
#include "solver/mesh/paint_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace sinew::solver {
namespace {

using Vector = Eigen::VectorXd;

double solid_volume(const TetMesh& mesh, std::size_t t) {
    const Tet& tet = mesh.tets[t];
    return (mesh.coverage.empty() ? 1 : mesh.coverage[t]) *
           tet_volume(mesh.vertices[at(tet[0])], mesh.vertices[at(tet[1])], mesh.vertices[at(tet[2])],
                      mesh.vertices[at(tet[3])]);
}

/// What flows in at each vertex: out of every source 1 in all, into every sink as much, by their areas.
class Flow {
  public:
    Flow(const TetMesh& mesh, const PaintPieces& pieces)
        : mesh_(mesh)
        , pieces_(pieces)
        , part_(connected_parts(mesh))
        , ends_(part_.size()) {
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            if (!std::isfinite(pieces.values[p]))
                throw Error("FE202", "the painted value of piece " + std::to_string(p) + " is not finite");
            End& end = ends_[at(part_of(p))][which(p)];
            end.area += area(p), ++end.pieces;
        }
    }

    bool through(int vertex) const {
        const auto& [source, sink] = ends_[at(part_[at(vertex)])];
        return source.pieces > 0 && sink.pieces > 0;
    }
    int part(int vertex) const { return part_[at(vertex)]; }

    Vector at_vertices(const std::vector<int>& number, int count) const {
        Vector out = Vector::Zero(count);
        for (std::size_t p = 0; p < pieces_.size(); ++p) {
            const End& end = ends_[at(part_of(p))][which(p)];
            const double share = end.area > 0 ? area(p) / end.area : 1.0 / end.pieces;
            for (std::size_t k = 0; k < 4; ++k) {
                const int row = number[at(mesh_.tets[at(pieces_.embedding.tet[p])][k])];
                if (row >= 0) out[row] += (which(p) ? share : -share) * pieces_.embedding.barycentric[p][k];
            }
        }
        return out;
    }

  private:
    struct End {
        double area = 0;
        int pieces = 0;
    };
    std::size_t which(std::size_t piece) const { return pieces_.values[piece] > 0.5 ? 1 : 0; }
    int part_of(std::size_t piece) const { return part_[at(mesh_.tets[at(pieces_.embedding.tet[piece])][0])]; }
    double area(std::size_t piece) const {
        return std::isfinite(pieces_.areas[piece]) ? std::max(pieces_.areas[piece], 0.0) : 0.0;
    }

    const TetMesh& mesh_;
    const PaintPieces& pieces_;
    std::vector<int> part_;
    std::vector<std::array<End, 2>> ends_; ///< by the parts' lowest vertices
};

/// Solves K f = b. A small multiple of the identity keeps pivots above zero; it stands only in the matrix that
/// corrects, so it costs rounds and no accuracy.
Vector solve(const Eigen::SparseMatrix<double>& k, const Vector& b) {
    const double scale = Vector(k.diagonal()).maxCoeff();
    Eigen::SparseMatrix<double> near = k;
    ScalarCholesky factor(near);
    for (double share = 1e-14; share < 1e-8; share *= 100) {
        for (int i = 0; i < near.rows(); ++i) near.coeffRef(i, i) = k.coeff(i, i) + share * scale;
        if (!factor.factorize(near)) continue;
        Vector f = factor.solve(b);
        constexpr int rounds = 12;
        for (int round = 0; round < rounds; ++round) {
            const Vector step = factor.solve(b - k * f);
            f += step;
            if (step.cwiseAbs().maxCoeff() <= 1e-14 * f.cwiseAbs().maxCoeff()) break;
        }
        return f;
    }
    throw Error("FE208", "fibres cannot be laid through the volume: the tet mesh is degenerate");
}

/// The gradient that a fibre meets, in the mean over all fibres: where many run the field is steep.
double met_by_fibres(const TetMesh& mesh, const Points& gradients) {
    double squares = 0, sum = 0;
    for (std::size_t t = 0; t < gradients.size(); ++t) {
        const double volume = solid_volume(mesh, t);
        squares += volume * gradients[t].squaredNorm(), sum += volume * gradients[t].norm();
    }
    return sum > 0 ? squares / sum : 0;
}

/// In a tip beyond an end the field fades, and which way it still points is a matter of the tets. A muscle's belly is
/// not a thousand times as wide as where its fibres are densest.
constexpr double faint = 1e-3;

} // namespace

Points fibre_gradients(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<double>& values,
                       const std::vector<char>& painted) {
    const PaintPieces pieces = cut_paint(mesh, surface, values, painted);
    if (pieces.size() == 0) throw Error("FE212", "no point is painted, so there is nothing to extend into the volume");
    const Flow flow(mesh, pieces);
    // Nothing follows from a vertex that hangs on tets which nothing covers.
    std::vector<char> covered(mesh.vertices.size(), 0);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        for (const int v : mesh.tets[t])
            if (solid_volume(mesh, t) > 0) covered[at(v)] = 1;
    // The field is known but for a constant: one vertex of each part stays at 0.
    std::vector<int> number(mesh.vertices.size(), -1);
    std::vector<char> held(mesh.vertices.size(), 0); // by parts
    int count = 0;
    for (int v = 0; v < static_cast<int>(number.size()); ++v) {
        if (!covered[at(v)] || !flow.through(v)) continue;
        if (held[at(flow.part(v))])
            number[at(v)] = count++;
        else
            held[at(flow.part(v))] = 1;
    }
    std::vector<double> field(number.size(), 0.0);
    if (count > 0) {
        const Vector f = solve(dirichlet_matrix(mesh, number, count), flow.at_vertices(number, count));
        for (std::size_t v = 0; v < field.size(); ++v)
            if (number[v] >= 0) field[v] = f[number[v]];
    }
    return gradients_of(mesh, field);
}

Points fibre_directions(const TetMesh& mesh, Points directions) {
    const double least = faint * met_by_fibres(mesh, directions);
    for (Vec3& g : directions)
        if (!(g.norm() > least)) g.setZero();
    make_unit(directions, 0);
    // Round after round, directions spread over shared vertices into the tets that have none.
    std::vector<std::size_t> empty;
    for (std::size_t t = 0; t < directions.size(); ++t)
        if (directions[t].isZero()) empty.push_back(t);
    while (!empty.empty()) {
        Points at_vertex(mesh.vertices.size(), Vec3::Zero());
        for (std::size_t t = 0; t < directions.size(); ++t)
            for (int v : mesh.tets[t]) at_vertex[at(v)] += directions[t];
        std::vector<std::size_t> still_empty;
        for (std::size_t t : empty) {
            Vec3 sum = Vec3::Zero();
            for (int v : mesh.tets[t]) sum += at_vertex[at(v)];
            const double length = sum.norm();
            if (length > 1e-6)
                directions[t] = sum / length;
            else
                still_empty.push_back(t);
        }
        if (still_empty.size() == empty.size()) break; // a part without any direction
        empty = std::move(still_empty);
    }
    return directions;
}

} // namespace sinew::solver
