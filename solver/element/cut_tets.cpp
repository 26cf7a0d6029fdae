// What elements make of tets that the solid's surface cuts.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/cut_tets.h"

#include "solver/parallel.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Quadratic tets with a smaller share inside are helped, the more the less they have.
constexpr double small_part = 0.1;
double help(double inside) { return std::max(0.0, 1 - inside / small_part); }
/// Share of a tet's volume that is added to what a quadratic tet with nothing inside counts for.
constexpr double added_share = 1e-4;
/// Energy of a bent edge: this times the modulus times the tet's volume, where half the energy of a strain of 1 stands
/// at one for a bend as high as the edges are long.
constexpr double edge_stiffness = 1e-2;

/// The shape functions of the ten nodes as homogeneous polynomials of degree 2, by products of two coordinates.
struct ShapeTerm {
    std::size_t i, j;
    double factor;
};
std::vector<ShapeTerm> shape_terms(std::size_t node) {
    if (node >= 4) {
        const int* e = tet_edge_corners[node - 4];
        return {{static_cast<std::size_t>(e[0]), static_cast<std::size_t>(e[1]), 4}};
    }
    // l (2 l - 1) with 1 the sum of all four
    std::vector<ShapeTerm> terms;
    for (std::size_t other = 0; other < 4; ++other) terms.push_back({node, other, other == node ? 1.0 : -1.0});
    return terms;
}

/// Integrals of the products of shape functions.
void add_consistent_mass(const std::array<std::vector<ShapeTerm>, 10>& shapes, const double* quartic, double factor,
                         double* out) {
    for (std::size_t a = 0, entry = 0; a < 10; ++a)
        for (std::size_t b = a; b < 10; ++b, ++entry) {
            double sum = 0;
            for (const ShapeTerm& s : shapes[a])
                for (const ShapeTerm& t : shapes[b])
                    sum += s.factor * t.factor * quartic[quartic_index(s.i, s.j, t.i, t.j)];
            out[entry] = factor * sum;
        }
}

/// Of the part inside, or of the tet where there is none.
Barycentric centroid(const TetMoments& quartic) {
    const MomentTensors m(quartic.value.data());
    Barycentric out{};
    double sum = 0;
    for (std::size_t c = 0; c < 4; ++c) sum += out[c] = std::max(m.first[c], 0.0);
    for (double& b : out) b = sum > 1e-12 ? b / sum : 0.25;
    return out;
}

void set_linear(const TetMesh& mesh, CutElements& out) {
    const std::size_t stride = moment_count(mesh.cut.degree);
    for (std::size_t k = 0; k < out.tets.size(); ++k) {
        const double* moments = mesh.cut.moments.data() + stride * k;
        double first[4], inside = 0;
        for (std::size_t c = 0; c < 4; ++c)
            first[c] = mesh.cut.degree == 1 ? moments[c] : MomentTensors(moments).first[c], inside += first[c];
        const double share = std::max(mesh.coverage[static_cast<std::size_t>(out.tets[k])], least_coverage);
        out.share[k] = share;
        for (std::size_t c = 0; c < 4; ++c)
            out.mass[4 * k + c] = (std::max(first[c], 0.0) + 0.25 * std::max(share - inside, 0.0)) / share;
    }
}

void set_quadratic(const TetMesh& mesh, CutElements& out) {
    std::array<std::vector<ShapeTerm>, 10> shapes;
    for (std::size_t node = 0; node < 10; ++node) shapes[node] = shape_terms(node);
    const TetMoments whole = whole_moments(4);
    out.points.resize(out.tets.size());
    out.straightness.resize(out.tets.size());
    parallel_for(out.tets.size(), 16, [&](std::size_t k) {
        TetMoments solid;
        std::copy_n(mesh.cut.of(k), most_moments, solid.value.begin());
        const double inside = solid.volume();
        // Of less than this all but the centroid is rounding.
        constexpr double some_part = 1e-5;
        if (inside > some_part)
            out.points[k] = four_points(solid.value.data());
        else
            out.points[k].point.fill(centroid(solid));
        solid.add(whole, added_share * help(inside));
        out.share[k] = inside + added_share * help(inside);
        out.straightness[k] = edge_stiffness * help(inside);
        add_consistent_mass(shapes, solid.value.data(), 1 / out.share[k], &out.mass[quadratic_mass_entries * k]);
    });
}

} // namespace

CutElements make_cut_elements(const TetMesh& mesh, ElementKind element) {
    CutElements out;
    out.tets = mesh.cut.tets;
    out.share.resize(out.tets.size());
    const bool quadratic = element == ElementKind::quadratic;
    out.mass.resize((quadratic ? quadratic_mass_entries : 4) * out.tets.size());
    if (quadratic)
        set_quadratic(mesh, out);
    else
        set_linear(mesh, out);

    double solid = 0, counted = 0;
    std::size_t next = 0;
    for (std::size_t t = 0; t < mesh.tets.size() && !out.tets.empty(); ++t) {
        const auto corner = [&](std::size_t c) { return mesh.vertices[static_cast<std::size_t>(mesh.tets[t][c])]; };
        const double volume = tet_volume(corner(0), corner(1), corner(2), corner(3));
        if (next == out.tets.size() || out.tets[next] != static_cast<int>(t)) {
            const double share = mesh.coverage.empty() ? 1.0 : std::max(mesh.coverage[t], least_coverage);
            solid += share * volume, counted += share * volume;
            continue;
        }
        TetMoments inside;
        inside.degree = mesh.cut.degree;
        std::copy_n(mesh.cut.of(next), moment_count(inside.degree), inside.value.begin());
        solid += inside.volume() * volume, counted += out.share[next++] * volume;
    }
    if (counted > 0) out.mass_factor = solid / counted;
    return out;
}

void set_cut_volumes(const TetMesh& mesh, const CutElements& cut, std::vector<TetBatch>& batches) {
    for (std::size_t k = 0; k < cut.tets.size(); ++k) {
        const std::size_t tet = static_cast<std::size_t>(cut.tets[k]);
        const auto corner = [&](std::size_t c) { return mesh.vertices[static_cast<std::size_t>(mesh.tets[tet][c])]; };
        batches[tet / lanes].volume[tet % lanes] =
            cut.share[k] * tet_volume(corner(0), corner(1), corner(2), corner(3));
    }
}

namespace {

/// Volume of a tet over the mean square of its edges [m].
double volume_by_area(const TetMesh& mesh, std::size_t tet) {
    const auto corner = [&](int c) {
        return mesh.vertices[static_cast<std::size_t>(mesh.tets[tet][static_cast<std::size_t>(c)])];
    };
    double squares = 0;
    for (const auto& [i, j] : tet_edge_corners) squares += (corner(i) - corner(j)).squaredNorm() / 6;
    return tet_volume(corner(0), corner(1), corner(2), corner(3)) / squares;
}

} // namespace

void place_points(const TetMesh& mesh, const CutElements& cut, std::span<EdgeBatch> edges) {
    std::vector<int> place(mesh.tets.size(), -1);
    for (std::size_t k = 0; k < cut.tets.size(); ++k)
        place[static_cast<std::size_t>(cut.tets[k])] = static_cast<int>(k);
    // Corners of whole tets are solid; what no whole tet reaches lies outside.
    std::vector<char> solid(mesh.vertices.size(), 0);
    for (std::size_t tet = 0; tet < place.size(); ++tet)
        if (place[tet] < 0)
            for (const int v : mesh.tets[tet]) solid[static_cast<std::size_t>(v)] = 1;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        auto places = std::make_shared<PointPlaces>();
        bool any = false;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const std::size_t tet = std::min(i * lanes + lane, mesh.tets.size() - 1);
            const int k = place[tet];
            any = any || k >= 0;
            const bool padding = i * lanes + lane >= mesh.tets.size();
            places->straightness[lane] =
                k >= 0 && !padding ? cut.straightness[static_cast<std::size_t>(k)] * volume_by_area(mesh, tet) : 0;
            for (std::size_t c = 0; c < 4; ++c) {
                for (std::size_t p = 0; p < 4; ++p) {
                    places->coordinate[p][c][lane] =
                        k >= 0 ? cut.points[static_cast<std::size_t>(k)].point[p][c] : usual_coordinate(p == c);
                }
                places->outside[c][lane] = !solid[static_cast<std::size_t>(mesh.tets[tet][c])];
            }
        }
        if (any) edges[i].places = std::move(places);
    }
}

} // namespace sinew::solver
