// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/iso_deviation.h"

#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sinew::solver {

namespace {

constexpr std::size_t most_samples = 20000;

struct Surface {
    const Points& points;
    const std::vector<Triangle>& triangles;

    const Vec3& corner(std::size_t t, std::size_t k) const { return points[static_cast<std::size_t>(triangles[t][k])]; }
    Vec3 middle(std::size_t t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3; }
    std::array<Vec3, 4> samples(std::size_t t) const { return {corner(t, 0), corner(t, 1), corner(t, 2), middle(t)}; }
    /// Twice as long as the area.
    Vec3 normal(std::size_t t) const { return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)); }
    double volume() const {
        const Vec3 origin = points[static_cast<std::size_t>(triangles.front()[0])];
        double six = 0;
        for (std::size_t t = 0; t < triangles.size(); ++t)
            six += (corner(t, 0) - origin).dot((corner(t, 1) - origin).cross(corner(t, 2) - origin));
        return six / 6;
    }
    /// Calls `take(t)` for triangles spread evenly.
    template <class Take>
    void for_some(Take take) const {
        const std::size_t count = std::min(most_samples, triangles.size());
        for (std::size_t i = 0; i < count; ++i) take(i * triangles.size() / count);
    }
};

class Measure {
  public:
    Measure(const Surface& from, const Surface& result, double iso)
        : from_(from)
        , result_(result)
        , iso_(iso)
        , from_tree_(from.points, from.triangles)
        , result_tree_(result.points, result.triangles) {
        look_around();
    }

    IsoDeviation run() {
        result_.for_some([&](std::size_t t) {
            for (const Vec3& p : result_.samples(t)) note(std::abs(from_tree_.closest(p).distance - std::abs(iso_)), p);
        });
        if (iso_ >= 0)
            from_.for_some([&, sample = std::size_t{0}](std::size_t t) mutable {
                const int w = winding_[sample++];
                if (!is_open_ && w != 0 && w != 1) return; // within another part
                for (const Vec3& p : from_.samples(t)) {
                    const double distance = result_tree_.closest(p).distance;
                    if (iso_ == 0)
                        note(distance, p);
                    else // inside and at least as deep as iso
                        note(result_tree_.inside(p) ? std::max(0.0, iso_ - distance) : iso_ + distance, p);
                }
            });
        out_.volume_ratio = volume_ratio();
        return out_;
    }

  private:
    void note(double distance, const Vec3& place) {
        if (distance > out_.distance) out_.distance = distance, out_.place = place;
    }

    /// Of the sampled triangles, in their order; those without area count as outward ones.
    void look_around() {
        const double depth = 1e-6 * bounding_box(from_.points).size().norm();
        from_.for_some([&](std::size_t t) {
            const Vec3 n = from_.normal(t);
            const double length = n.norm();
            // 1 below faces that look outwards, 0 below those turned round, more where parts lie in each other.
            const double w = length > 0 ? from_tree_.winding_number(from_.middle(t) - (depth / length) * n) : 1;
            winding_.push_back(static_cast<int>(std::lround(w)));
            is_open_ = is_open_ || std::abs(w - std::round(w)) > 0.05;
        });
    }

    double volume_ratio() const {
        constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
        if (iso_ != 0 || is_open_) return unknown;
        const auto all = [&](int w) {
            return std::all_of(winding_.begin(), winding_.end(), [&](int each) { return each == w; });
        };
        if (!all(1) && !all(0)) return unknown; // 0: turned inside out as a whole
        const double before = std::abs(from_.volume());
        return before > 0 ? std::abs(result_.volume()) / before : unknown;
    }

    Surface from_, result_;
    double iso_;
    SurfaceTree from_tree_, result_tree_;
    std::vector<int> winding_;
    bool is_open_ = false;
    IsoDeviation out_;
};

} // namespace

IsoDeviation measure_iso_mesh(const Points& points, const std::vector<Triangle>& triangles, double iso,
                              const Points& result_points, const std::vector<Triangle>& result_triangles) {
    check_usable(SurfaceMesh::from_triangles(points, triangles));
    check_usable(SurfaceMesh::from_triangles(result_points, result_triangles));
    return Measure({points, triangles}, {result_points, result_triangles}, iso).run();
}

} // namespace sinew::solver
