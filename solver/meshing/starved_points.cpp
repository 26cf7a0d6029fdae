// Incremental insertion within a fixed boundary.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/starved_points.h"

#include "solver/index.h"
#include "solver/mesh/embedding.h"
#include "solver/meshing/tet_cavity.h"

#include <Eigen/LU>

#include <algorithm>
#include <limits>
#include <random>

namespace sinew::solver {
namespace {

class Inserter {
  public:
    Inserter(TetComplex& complex, const InnerPoints& points, std::vector<int> hosts, const MeshingControl& control)
        : complex_(complex)
        , cavity_(complex)
        , points_(points)
        , host_(std::move(hosts))
        , control_(control)
        , waiting_(complex.count()) {
        for (std::size_t i = 0; i < host_.size(); ++i)
            if (host_[i] >= 0) waiting_[at(host_[i])].push_back(static_cast<int>(i));
    }

    void run() {
        // In no order of place: then cavities become small quickly.
        std::vector<int> order;
        for (std::size_t i = 0; i < host_.size(); ++i)
            if (host_[i] >= 0) order.push_back(static_cast<int>(i));
        std::mt19937 random(12345);
        for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i % 64 == 0)
                control_.report(static_cast<double>(i) / static_cast<double>(order.size()), "filling the inside");
            insert(order[i]);
        }
    }

  private:
    const Vec3& x(int v) const { return complex_.vertices[at(v)]; }

    /// Whether p lies in the ball about a tet; flat tets are taken to have every point in theirs.
    bool in_ball(int t, const Vec3& p) const {
        const Tet& c = complex_.tet(t);
        Eigen::Matrix3d edges;
        Vec3 halves;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 e = x(c[k + 1]) - x(c[0]);
            edges.row(static_cast<int>(k)) = e.transpose();
            halves[static_cast<int>(k)] = 0.5 * e.squaredNorm();
        }
        const Vec3 centre = edges.partialPivLu().solve(halves); // from corner 0
        const double radius2 = centre.squaredNorm();
        return !std::isfinite(radius2) || (p - x(c[0]) - centre).squaredNorm() < radius2 * (1 - 1e-9);
    }

    void insert(int i) {
        const Vec3& p = points_.points[at(i)];
        const int host = host_[at(i)];
        cavity_.start(host);
        for (std::size_t n = 0; n < cavity_.tets().size(); ++n) {
            const Tet c = complex_.tet(cavity_.tets()[n]);
            // As near to others as lattice points are not: it would only make short edges.
            for (const int v : c)
                if ((x(v) - p).squaredNorm() < 0.25 * points_.edges[at(i)] * points_.edges[at(i)]) return;
            for (const auto& [a, b, d, across] : tet_faces) {
                const int beyond = complex_.beside(cavity_.tets()[n], c[a], c[b], c[d]);
                if (beyond >= 0 && !cavity_.holds(beyond) && in_ball(beyond, p)) cavity_.add(beyond);
            }
        }
        constexpr double passable = 0.02; // on the way; later points and the improvement do the rest
        if (!cavity_.make_star_shaped(p, 1e-6)) return;
        if (!(cavity_.star_quality(p) > std::min(cavity_.present_quality(), passable))) return;
        std::vector<int> homeless;
        for (const int t : cavity_.tets())
            for (const int w : waiting_[at(t)])
                if (w != i) homeless.push_back(w);
        for (const int t : cavity_.tets()) std::vector<int>().swap(waiting_[at(t)]);
        std::sort(homeless.begin(), homeless.end());
        const std::vector<int> fresh = cavity_.fill(complex_.add_vertex(p));
        waiting_.resize(complex_.count());
        for (const int w : homeless) {
            host_[at(w)] = holder(points_.points[at(w)], fresh);
            waiting_[at(host_[at(w)])].push_back(w);
        }
    }

    /// The tet in which a point lies deepest.
    int holder(const Vec3& p, const std::vector<int>& among) const {
        int best = among.front();
        double most = -std::numeric_limits<double>::infinity();
        for (const int t : among) {
            const Tet& c = complex_.tet(t);
            const double whole = tet_volume(x(c[0]), x(c[1]), x(c[2]), x(c[3]));
            double least = std::numeric_limits<double>::infinity();
            for (const auto& [i, j, k, l] : tet_faces)
                least = std::min(least, tet_volume(x(c[i]), x(c[k]), x(c[j]), p) / whole);
            if (least > most) most = least, best = t;
        }
        return best;
    }

    TetComplex& complex_;
    TetCavity cavity_;
    const InnerPoints& points_;
    std::vector<int> host_; ///< of each point: the tet in which it lies; -1: not to be inserted
    const MeshingControl& control_;
    std::vector<std::vector<int>> waiting_; ///< points in each tet
};

} // namespace

void add_starved_points(TetMesh& mesh, const InnerPoints& points, const MeshingControl& control) {
    if (points.points.empty() || mesh.tets.empty()) return;
    std::vector<int> hosts = embed(mesh, points.points).tet;
    bool any = false;
    for (std::size_t i = 0; i < hosts.size(); ++i) {
        const Tet& t = mesh.tets[at(hosts[i])];
        double longest = 0;
        for (const auto& [a, b] : tet_edges)
            longest = std::max(longest, (mesh.vertices[at(t[a])] - mesh.vertices[at(t[b])]).norm());
        if (longest > 3 * points.edges[i])
            any = true;
        else
            hosts[i] = -1;
    }
    if (!any) return;
    TetComplex complex(std::move(mesh.vertices), std::move(mesh.tets));
    Inserter(complex, points, std::move(hosts), control).run();
    mesh.tets = complex.living();
    mesh.vertices = std::move(complex.vertices);
}

} // namespace sinew::solver
