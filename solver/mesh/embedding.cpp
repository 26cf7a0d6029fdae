// Points that ride on a tet mesh.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/embedding.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/bvh.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/tet_boundary.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {
namespace {

using Barycentric = std::array<double, 4>;

/// A point this far outside a face still counts as held, so that points on shared faces find a host (the
/// lowest).
constexpr double face_slack = 1e-10;
/// Points nearer to a vertex than this share of the mesh's diagonal are on it.
constexpr double snap_share = 1e-13;

Barycentric coordinates(const TetMesh& mesh, std::size_t tet, const Vec3& p) {
    const Tet& t = mesh.tets[tet];
    const Vec3& origin = mesh.vertices[at(t[0])];
    const Vec3 a = mesh.vertices[at(t[1])] - origin, b = mesh.vertices[at(t[2])] - origin,
               c = mesh.vertices[at(t[3])] - origin, w = p - origin;
    const double det = a.dot(b.cross(c));
    if (det == 0) return {-1, 1, 1, 0}; // flat: holds nothing
    const double l1 = w.dot(b.cross(c)) / det, l2 = a.dot(w.cross(c)) / det, l3 = a.dot(b.cross(w)) / det;
    return {1 - l1 - l2 - l3, l1, l2, l3};
}

} // namespace

class TetLocator::Impl {
  public:
    explicit Impl(const TetMesh& mesh)
        : mesh_(mesh)
        , border_(tet_boundary(mesh.tets))
        , border_tree_(mesh.vertices, border_.triangles) {
        const Box box = bounding_box(mesh.vertices);
        const double slack = 1e-9 * box.size().norm();
        snap_ = snap_share * box.size().norm();
        Points low, high;
        for (const Tet& t : mesh.tets) {
            Vec3 a = mesh.vertices[at(t[0])], b = a;
            for (int v : t) a = a.cwiseMin(mesh.vertices[at(v)]), b = b.cwiseMax(mesh.vertices[at(v)]);
            low.emplace_back(a.array() - slack);
            high.emplace_back(b.array() + slack);
        }
        tree_ = build_bvh(low, high);
    }

    void locate(const Vec3& p, int& tet, Barycentric& barycentric) const {
        tet = holder(p);
        if (tet < 0) {
            const ClosestPoint nearest = border_tree_.closest(p);
            tet = nearest.triangle >= 0 ? border_.tet[at(nearest.triangle)] : 0;
        }
        const Tet& corners = mesh_.tets[at(tet)];
        for (std::size_t k = 0; k < 4; ++k)
            if ((mesh_.vertices[at(corners[k])] - p).norm() <= snap_) {
                barycentric = {0, 0, 0, 0};
                barycentric[k] = 1;
                return;
            }
        barycentric = coordinates(mesh_, at(tet), p);
    }

  private:
    /// The lowest tet that holds p, or -1.
    int holder(const Vec3& p) const {
        int best = -1;
        int stack[64];
        int size = 0;
        stack[size++] = 0;
        while (size > 0) {
            const int n = stack[--size];
            const BvhNode& node = tree_.nodes[at(n)];
            if ((p.array() < node.min.array()).any() || (p.array() > node.max.array()).any()) continue;
            if (node.count == 0) {
                stack[size++] = node.first;
                stack[size++] = n + 1;
                continue;
            }
            for (int i = node.first; i < node.first + node.count; ++i) {
                const int t = tree_.order[at(i)];
                if (best >= 0 && t > best) continue;
                const Barycentric b = coordinates(mesh_, at(t), p);
                if (*std::min_element(b.begin(), b.end()) >= -face_slack) best = t;
            }
        }
        return best;
    }

    const TetMesh& mesh_;
    TetBoundary border_;
    SurfaceTree border_tree_;
    Bvh tree_;
    double snap_ = 0;
};

TetLocator::TetLocator(const TetMesh& mesh) {
    if (mesh.tets.empty()) throw Error("FE201", "points cannot be embedded in a tet mesh without tets");
    impl_ = std::make_unique<Impl>(mesh);
}
TetLocator::~TetLocator() = default;
int TetLocator::locate(const Vec3& p, Barycentric& barycentric) const {
    int tet = 0;
    impl_->locate(p, tet, barycentric);
    return tet;
}

Embedding embed(const TetMesh& mesh, const Points& points) {
    if (points.empty()) return {};
    return embed(TetLocator(mesh), points); // refuses a mesh without tets
}

Embedding embed(const TetLocator& locator, const Points& points) {
    Embedding result;
    result.tet.resize(points.size());
    result.barycentric.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!points[i].allFinite()) throw Error("FE202", "vertex " + std::to_string(i) + " is not finite");
    parallel_for(points.size(), 64,
                 [&](std::size_t i) { result.tet[i] = locator.locate(points[i], result.barycentric[i]); });
    return result;
}

std::vector<double> widths_outside(const TetMesh& mesh, const Embedding& e) {
    std::vector<double> out(e.size(), 0.0);
    for (std::size_t i = 0; i < e.size(); ++i) {
        const Barycentric& b = e.barycentric[i];
        if (*std::min_element(b.begin(), b.end()) >= 0) continue;
        Vec3 corner[4];
        for (std::size_t k = 0; k < 4; ++k) corner[k] = mesh.vertices[at(mesh.tets[at(e.tet[i])][k])];
        const double volume6 =
            std::abs((corner[1] - corner[0]).dot((corner[2] - corner[0]).cross(corner[3] - corner[0])));
        double beyond = 0, longest = 0;
        for (std::size_t k = 0; k < 4; ++k) { // behind the face opposite to corner k
            const Vec3 &p = corner[(k + 1) % 4], &q = corner[(k + 2) % 4], &r = corner[(k + 3) % 4];
            beyond = std::max(beyond, -b[k] * volume6 / (q - p).cross(r - p).norm());
            longest = std::max({longest, (q - p).norm(), (r - q).norm(), (p - r).norm()});
        }
        out[i] = beyond / longest;
    }
    return out;
}

void apply(const Embedding& e, const std::vector<Tet>& tets, const double* x, Points& out) {
    out.resize(e.size());
    const auto one = [&](std::size_t i) {
        const Tet& t = tets[at(e.tet[i])];
        const Barycentric& b = e.barycentric[i];
        const auto vertex = [&](std::size_t k) { return Eigen::Map<const Vec3>(x + 3 * at(t[k])); };
        out[i] = b[0] * vertex(0) + b[1] * vertex(1) + b[2] * vertex(2) + b[3] * vertex(3);
    };
    parallel_for(e.size(), 4096, one);
}

} // namespace sinew::solver
