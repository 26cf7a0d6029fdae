// Triangulation of one polygon.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/triangulate.h"

#include "solver/error.h"

#include <cmath>
#include <string>
#include <utility>

namespace sinew::solver {
namespace {

using Vec2 = Eigen::Vector2d;

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Twice the vector area. Taken about the first corner, so that a polygon far from the origin keeps its
/// digits.
Vec3 newell_normal(const Points& points, std::span<const int> corners) {
    const Vec3& origin = points[static_cast<std::size_t>(corners[0])];
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        normal += (points[static_cast<std::size_t>(corners[i])] - origin)
                      .cross(points[static_cast<std::size_t>(corners[i + 1])] - origin);
    return normal;
}

/// The polygon in the plane of its normal, counter-clockwise.
std::vector<Vec2> flatten(const Points& points, std::span<const int> corners, const Vec3& normal) {
    Eigen::Index smallest = 0;
    normal.cwiseAbs().minCoeff(&smallest);
    const Vec3 n = normal.normalized();
    const Vec3 u = Vec3::Unit(smallest).cross(n).normalized();
    const Vec3 v = n.cross(u);
    std::vector<Vec2> flat;
    flat.reserve(corners.size());
    const Vec3& origin = points[static_cast<std::size_t>(corners[0])];
    for (int corner : corners) {
        const Vec3 d = points[static_cast<std::size_t>(corner)] - origin;
        flat.emplace_back(d.dot(u), d.dot(v));
    }
    return flat;
}

bool is_convex(const std::vector<Vec2>& flat) {
    const std::size_t n = flat.size();
    // Every fan triangle must also turn left: a star that winds twice passes the corner test alone.
    for (std::size_t i = 0; i < n; ++i) {
        if (turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) < 0) return false;
        if (i >= 1 && i + 1 < n && turn(flat[0], flat[i], flat[i + 1]) < 0) return false;
    }
    return true;
}

/// Smallest angle sine of the ear, so that good triangles are cut first.
double ear_quality(const std::vector<Vec2>& flat, std::size_t a, std::size_t b, std::size_t c) {
    const double ab = (flat[b] - flat[a]).squaredNorm(), bc = (flat[c] - flat[b]).squaredNorm(),
                 ca = (flat[a] - flat[c]).squaredNorm();
    const double sum = ab + bc + ca;
    return sum > 0 ? turn(flat[a], flat[b], flat[c]) / sum : 0;
}

/// Cuts ears off, the one of the best shape first. What is known of a corner stays true until a neighbour goes or,
/// where another corner lies in its ear, that one goes; so each is looked at a few times and not at every cut.
class EarClipping {
  public:
    explicit EarClipping(const std::vector<Vec2>& flat)
        : flat_(flat)
        , left_(flat.size())
        , known_(flat.size())
        , waiting_(flat.size()) {
        const std::size_t n = flat.size();
        for (std::size_t i = 0; i < n; ++i)
            ring_.push_back(i), before_.push_back((i + n - 1) % n), after_.push_back((i + 1) % n);
        for (std::size_t i = 0; i < n; ++i) look_at(i);
    }

    /// Calls take(a, b, c) for each triangle.
    template <class Take>
    void operator()(Take take) {
        while (left_ > 3) {
            const std::size_t ear = best();
            take(before_[ear], ear, after_[ear]);
            cut(ear);
        }
        const std::size_t first = first_left();
        take(first, after_[first], after_[after_[first]]);
    }

  private:
    struct Known {
        bool is_gone = false, is_ear = false;
        double quality = -1;
    };

    /// A corner that lies in the ear; `none` if none does and it turns left; the corner itself if it turns right.
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    std::size_t blocker(std::size_t at) const {
        const Vec2 &a = flat_[before_[at]], &b = flat_[at], &c = flat_[after_[at]];
        if (turn(a, b, c) <= 0) return at;
        for (const std::size_t other : ring_) {
            const Vec2& p = flat_[other];
            if (known_[other].is_gone || !(turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0)) continue;
            // Corners at the same place as the ear's own (bridges to holes) do not block it.
            if (p != a && p != b && p != c) return other;
        }
        return none;
    }

    void look_at(std::size_t at) {
        const std::size_t by = blocker(at);
        known_[at].is_ear = by == none;
        if (by == none) known_[at].quality = ear_quality(flat_, before_[at], at, after_[at]);
        if (by != none && by != at) waiting_[by].push_back(at);
    }

    std::size_t first_left() const {
        std::size_t i = 0;
        while (known_[i].is_gone) ++i;
        return i;
    }

    std::size_t best() const {
        std::size_t best = none;
        double best_quality = -1;
        for (const std::size_t i : ring_)
            if (!known_[i].is_gone && known_[i].is_ear && known_[i].quality > best_quality)
                best_quality = known_[i].quality, best = i;
        // A simple polygon always has an ear; one that crosses itself or is folded onto a line may not.
        return best == none ? after_[first_left()] : best;
    }

    void cut(std::size_t ear) {
        known_[ear].is_gone = true;
        after_[before_[ear]] = after_[ear], before_[after_[ear]] = before_[ear];
        if (--left_ < ring_.size() / 2) std::erase_if(ring_, [&](std::size_t i) { return known_[i].is_gone; });
        look_at(before_[ear]);
        look_at(after_[ear]);
        for (const std::size_t i : std::exchange(waiting_[ear], {}))
            if (!known_[i].is_gone && !known_[i].is_ear) look_at(i);
    }

    const std::vector<Vec2>& flat_;
    std::size_t left_;
    std::vector<std::size_t> ring_, before_, after_; ///< the ring holds some that are gone, too
    std::vector<Known> known_;
    std::vector<std::vector<std::size_t>> waiting_; ///< for this corner to go
};

} // namespace

void triangulate_polygon(const Points& points, std::span<const int> corners, std::vector<Triangle>& out) {
    const std::size_t n = corners.size();
    const auto fan = [&] {
        for (std::size_t i = 1; i + 1 < n; ++i) out.push_back({corners[0], corners[i], corners[i + 1]});
    };
    if (n < 3) return;
    if (n == 3) return fan();
    const Vec3 normal = newell_normal(points, corners);
    if (!(normal.squaredNorm() > 0) || !std::isfinite(normal.squaredNorm())) return fan();
    const std::vector<Vec2> flat = flatten(points, corners, normal);
    if (is_convex(flat)) return fan();
    if (n > most_clipped_corners)
        throw Error("FE208",
                    "a face of " + std::to_string(n) + " corners is not convex; at most " +
                        std::to_string(most_clipped_corners) + " can be cut into triangles",
                    "Cut it into triangles where it is made.");

    EarClipping clipping(flat);
    clipping([&](std::size_t a, std::size_t b, std::size_t c) { out.push_back({corners[a], corners[b], corners[c]}); });
}

} // namespace sinew::solver
