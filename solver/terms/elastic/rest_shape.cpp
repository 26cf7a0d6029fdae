// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/elastic/rest_shape.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/harmonic.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/parallel.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace sinew::solver {

namespace {

constexpr auto names_of_values = field_names<RestShapeValues>();
/// Lengths at rest grow or shrink by no more than this.
constexpr double most_change = 1e3;

/// f of the principal values, along the same axes.
template <class F>
Mat3 by_principal_values(const Mat3& symmetric, F f) {
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(symmetric);
    return eigen.eigenvectors() * eigen.eigenvalues().unaryExpr(f).asDiagonal() * eigen.eigenvectors().transpose();
}

Mat3 edges_of_tet(const Tet& t, const Points& vertices) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = vertices[at(t[at(k + 1)])] - vertices[at(t[0])];
    return edges;
}

} // namespace

const TermType rest_shape_type{
    .name = "restShape",
    .values = names_of_values,
    .make = [](const Scene&) -> std::unique_ptr<Term> { return nullptr; },
};

Points carried_to_target(const TetMesh& mesh, const PaintedSurface& surface, const Points& target) {
    // About the middle, so that far from the origin nothing is lost.
    const std::vector<double> areas = vertex_areas(surface.points, surface.triangles);
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    double area = 0;
    for (std::size_t v = 0; v < target.size(); ++v)
        from += areas[v] * surface.points[v], to += areas[v] * target[v], area += areas[v];
    if (area > 0) from /= area, to /= area;
    Mat3 moments = Mat3::Zero(), mixed = Mat3::Zero();
    for (std::size_t v = 0; v < target.size(); ++v) {
        const Vec3 x = surface.points[v] - from;
        moments += areas[v] * x * x.transpose();
        mixed += areas[v] * (target[v] - to) * x.transpose();
    }
    // A flat sheet says nothing of what is across it: there the shape stays.
    const Mat3 turned = (mixed - moments).transpose();
    const Mat3 affine = Mat3::Identity() + moments.completeOrthogonalDecomposition().solve(turned).transpose();

    std::vector<std::vector<double>> rest(3, std::vector<double>(target.size()));
    for (std::size_t v = 0; v < target.size(); ++v) {
        const Vec3 left = target[v] - to - affine * (surface.points[v] - from);
        for (int c = 0; c < 3; ++c) rest[at(c)][v] = left[c];
    }
    const auto extended =
        harmonic_extensions(mesh, surface, rest, std::vector<char>(target.size(), 1), HarmonicRange::free);
    Points out(mesh.vertices.size());
    for (std::size_t v = 0; v < out.size(); ++v)
        out[v] = to + affine * (mesh.vertices[v] - from) + Vec3(extended[0][v], extended[1][v], extended[2][v]);
    return out;
}

RestShape make_rest_shape(const TetMesh& mesh, const Points& target, const std::vector<double>& paint) {
    RestShape out;
    out.strains.resize(mesh.tets.size());
    std::vector<double> largest(mesh.tets.size(), 0.0);
    std::vector<char> turned(mesh.tets.size(), 0), bad(mesh.tets.size(), 0); // inside out; and painted
    parallel_for(mesh.tets.size(), 256, [&](std::size_t t) {
        const Mat3 f = edges_of_tet(mesh.tets[t], target) * edges_of_tet(mesh.tets[t], mesh.vertices).inverse();
        turned[t] = !(f.determinant() > 0);
        bad[t] = turned[t] && paint[t] != 0;
        if (turned[t] || paint[t] == 0) return;
        const Mat3 strain = paint[t] * by_principal_values(f.transpose() * f, [](double c) {
                                return 0.5 * std::log(std::max(c, 1e-300));
                            });
        out.strains[t] = {strain(0, 0), strain(1, 1), strain(2, 2), strain(1, 2), strain(2, 0), strain(0, 1)};
        largest[t] =
            Eigen::SelfAdjointEigenSolver<Mat3>(strain, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs().maxCoeff();
    });
    const auto count = std::count(bad.begin(), bad.end(), 1);
    if (count > 0) {
        const auto tet = static_cast<std::size_t>(std::find(bad.begin(), bad.end(), 1) - bad.begin());
        Vec3 middle = Vec3::Zero();
        for (const int v : mesh.tets[tet]) middle += 0.25 * mesh.vertices[at(v)];
        char place[120];
        std::snprintf(place, sizeof place, "; the first is tet %zu, near (%.4g, %.4g, %.4g)", tet, middle[0], middle[1],
                      middle[2]);
        const bool whole = std::ranges::all_of(turned, [](char t) { return t != 0; });
        throw Error("FE286",
                    "the target turns " + std::to_string(count) + " of " + std::to_string(mesh.tets.size()) +
                        " tets inside out" + place,
                    whole ? "It is a mirror image of the tissue, or flat: take one that is neither, with the "
                            "vertices in the tissue's order."
                          : "Choose smaller tets, or a target whose surface does not fold or pass through itself "
                            "there.");
    }
    for (const double l : largest) out.largest = std::max(out.largest, l);
    return out;
}

bool RestShapes::act() const {
    return std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
}

Mat3 RestShapes::stretch(std::size_t tet) const {
    std::array<double, 6> h{};
    for (std::size_t k = 0; k < shapes.size(); ++k)
        for (std::size_t i = 0; i < 6; ++i) h[i] += weights[k] * shapes[k]->strains[tet][i];
    if (h == std::array<double, 6>{}) return Mat3::Identity();
    Mat3 strain;
    strain << h[0], h[5], h[4], h[5], h[1], h[3], h[4], h[3], h[2];
    return by_principal_values(strain, [](double e) { return std::exp(e); });
}

RestShapes rest_shapes_of(const Scene& scene, int body, std::span<const PartValues> values) {
    RestShapes out;
    find_rest_shapes(scene, body, values, out);
    return out;
}

void find_rest_shapes(const Scene& scene, int body, std::span<const PartValues> values, RestShapes& out) {
    out.shapes.clear(), out.weights.clear();
    const std::vector<Part>& parts = scene.description().parts;
    for (std::size_t k = 0; k < parts.size() && k < values.size(); ++k) {
        if (parts[k].type != &rest_shape_type || parts[k].bodies.front() != body) continue;
        out.shapes.push_back(static_cast<const RestShape*>(parts[k].rest.get()));
        out.weights.push_back(get_fields<RestShapeValues>(values[k]).weight);
    }
}

void check_rest_shapes(const RestShapes& shapes) {
    double sum = 0;
    for (std::size_t k = 0; k < shapes.shapes.size(); ++k)
        sum += std::abs(shapes.weights[k]) * shapes.shapes[k]->largest;
    if (sum <= std::log(most_change)) return;
    char text[160];
    const double change = std::exp(sum);
    if (change < 1e9)
        std::snprintf(text, sizeof text,
                      "the rest shapes together stretch the tissue at rest by up to %.6g or its reciprocal", change);
    else
        std::snprintf(
            text, sizeof text,
            "the rest shapes together stretch the tissue at rest by more than 1e9 or its reciprocal, as flat ones do");
    throw Error("FE247", text, "lengths at rest may become 1000 times smaller to 1000 times larger");
}

} // namespace sinew::solver
