// Painted triangles as points that are dense enough for the tets they pass through.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/paint_samples.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace sinew::solver {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// How far apart samples may lie in a tet.
double spacing(const TetMesh& mesh, const Tet& t) {
    double sum = 0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < a; ++b) sum += (mesh.vertices[at(t[a])] - mesh.vertices[at(t[b])]).norm();
    return 0.5 * sum / 6;
}

struct Sample {
    Vec3 shares;
    Vec3 place;
    int tet;
    std::array<double, 4> barycentric;
    double spacing;
    double area = 0;
};

double spacing_at(const TetMesh& mesh, int tet, const std::array<double, 4>& barycentric) {
    constexpr double far_outside = -2;
    const Tet& t = mesh.tets[at(tet)];
    const bool is_flat = !(tet_volume(mesh.vertices[at(t[0])], mesh.vertices[at(t[1])], mesh.vertices[at(t[2])],
                                      mesh.vertices[at(t[3])]) > 0);
    if (is_flat || *std::min_element(barycentric.begin(), barycentric.end()) < far_outside) return no_limit;
    return spacing(mesh, t);
}

/// Halves one triangle until its parts fit the tets.
class Splitter {
  public:
    Splitter(const TetMesh& mesh, const PaintedSurface& surface, const Triangle& triangle)
        : mesh_(mesh) {
        for (int k = 0; k < 3; ++k) {
            const std::size_t v = at(triangle[at(k)]);
            const int tet = surface.embedding.tet[v];
            const auto& b = surface.embedding.barycentric[v];
            samples_.push_back({Vec3::Unit(k), surface.points[v], tet, b, spacing_at(mesh, tet, b)});
        }
        area_ = 0.5 * (samples_[1].place - samples_[0].place).cross(samples_[2].place - samples_[0].place).norm();
    }

    bool fits() const { return !longest_edge({{0, 1, 2}, area_}); }

    /// The corners of all parts; the first three are the triangle's own.
    std::vector<Sample> split(const TetLocator& locator) {
        std::vector<Part> open{{{0, 1, 2}, area_}};
        while (!open.empty()) {
            const Part part = open.back();
            open.pop_back();
            if (const auto edge = longest_edge(part)) {
                const std::size_t a = part.corners[*edge], b = part.corners[(*edge + 1) % 3],
                                  c = part.corners[(*edge + 2) % 3], m = middle(a, b, locator);
                open.push_back({{a, m, c}, part.area / 2});
                open.push_back({{m, b, c}, part.area / 2});
            } else {
                for (const std::size_t corner : part.corners) samples_[corner].area += part.area / 3;
            }
        }
        return std::move(samples_);
    }

  private:
    struct Part {
        std::array<std::size_t, 3> corners;
        double area;
    };

    /// Which edge to halve: the longest, unless all are short enough.
    std::optional<std::size_t> longest_edge(const Part& part) const {
        std::size_t longest = 0;
        double length = -1, limit = no_limit;
        for (std::size_t k = 0; k < 3; ++k) {
            const Sample &a = samples_[part.corners[k]], &b = samples_[part.corners[(k + 1) % 3]];
            limit = std::min(limit, a.spacing);
            const double l = (b.place - a.place).norm();
            if (l > length) length = l, longest = k;
        }
        if (!(length > limit)) return std::nullopt;
        return longest;
    }

    std::size_t middle(std::size_t a, std::size_t b, const TetLocator& locator) {
        const auto [found, is_new] = middles_.try_emplace(std::minmax(a, b), samples_.size());
        if (is_new) {
            Sample s{0.5 * (samples_[a].shares + samples_[b].shares), Vec3::Zero(), 0, {}, 0};
            for (int k = 0; k < 3; ++k) s.place += s.shares[k] * samples_[at(k)].place;
            s.tet = locator.locate(s.place, s.barycentric);
            s.spacing = spacing_at(mesh_, s.tet, s.barycentric);
            samples_.push_back(s);
        }
        return found->second;
    }

    const TetMesh& mesh_;
    double area_ = 0;
    std::vector<Sample> samples_;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles_; ///< of edges that have been halved
};

void check(const PaintedSurface& surface, std::size_t painted) {
    const std::size_t points = surface.points.size();
    if (surface.embedding.size() != points)
        throw Error("FE204", std::to_string(surface.embedding.size()) + " embedded points for " +
                                 std::to_string(points) + " vertices");
    if (painted != points)
        throw Error("FE204", std::to_string(painted) + " flags for " + std::to_string(points) + " embedded points");
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (const int v : surface.triangles[t])
            if (v < 0 || at(v) >= points)
                throw Error("FE203", "triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " +
                                         std::to_string(points));
}

} // namespace

std::vector<double> PaintSamples::values(const std::vector<double>& at_vertices) const {
    if (at_vertices.size() != vertices())
        throw Error("FE204", std::to_string(at_vertices.size()) + " values for " + std::to_string(vertices()) +
                                 " embedded points");
    std::vector<double> out = at_vertices;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const double a = at_vertices[at(corners[i][0])], b = at_vertices[at(corners[i][1])],
                     c = at_vertices[at(corners[i][2])];
        // Differences first: equal corners give exactly their value.
        const double value = a + shares[i][1] * (b - a) + shares[i][2] * (c - a);
        const auto [low, high] = std::minmax({a, b, c});
        out.push_back(value < low ? low : value > high ? high : value); // rounding; keeps what is not finite
    }
    return out;
}

std::vector<char> PaintSamples::painted(const std::vector<char>& at_vertices) const {
    std::vector<char> out = at_vertices;
    out.resize(out.size() + corners.size(), 1);
    return out;
}

PaintSamples sample_paint(const TetMesh& mesh, const PaintedSurface& surface, const std::vector<char>& painted) {
    check(surface, painted.size());
    PaintSamples out;
    out.embedding = surface.embedding;
    out.areas = vertex_areas(surface.points, surface.triangles);
    std::vector<std::size_t> large;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Triangle& c = surface.triangles[t];
        if (painted[at(c[0])] && painted[at(c[1])] && painted[at(c[2])] && !Splitter(mesh, surface, c).fits())
            large.push_back(t);
    }
    if (large.empty()) return out;

    std::optional<TetLocator> own;
    const TetLocator& locator = surface.locator ? *surface.locator : own.emplace(mesh);
    std::vector<std::vector<Sample>> samples(large.size());
    parallel_for(large.size(), 8, [&](std::size_t i) {
        samples[i] = Splitter(mesh, surface, surface.triangles[large[i]]).split(locator);
    });
    for (std::size_t i = 0; i < large.size(); ++i) {
        const Triangle& corners = surface.triangles[large[i]];
        double area = 0;
        for (const Sample& s : samples[i]) area += s.area;
        // The corners keep what the parts about them have.
        for (std::size_t k = 0; k < 3; ++k) out.areas[at(corners[k])] += samples[i][k].area - area / 3;
        for (std::size_t k = 3; k < samples[i].size(); ++k) {
            const Sample& s = samples[i][k];
            out.embedding.tet.push_back(s.tet);
            out.embedding.barycentric.push_back(s.barycentric);
            out.areas.push_back(s.area);
            out.corners.push_back(corners);
            out.shares.push_back(s.shares);
        }
    }
    return out;
}

} // namespace sinew::solver
