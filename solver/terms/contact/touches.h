// Which points may press into which surfaces within a step: those that do so already, and those outside that are near
// enough to come in.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/closest_feature.h"
#include "solver/terms/contact/body_motion.h"
#include "solver/terms/contact/collision_bodies.h"
#include "solver/terms/contact/contact_memory.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace sinew::solver {

class SurfaceTree;

/// A point of one body and the surface of another, or of the same one.
struct Touch {
    int source = -1, point = -1, target = -1; ///< bodies: places among those of contact
    int kept = -1;                            ///< its contact of the state; -1: it is outside
    int side = 1;                             ///< of a cloth, see KeptContact; of others 1
    ClosestFeature feature;                   ///< at the start of the step
};

/// How far a point is in what a surface pushes others out of, on the side that it belongs to.
struct Press {
    double depth = 0;        ///< [m]; negative: so far outside
    Vec3 out = Vec3::Zero(); ///< of unit length, the way that it is pushed
    bool behind = false;     ///< it is on the other side of the surface itself
};
/// Whether maxContactLength drops such a contact.
inline bool is_too_deep(const ContactPair& pair, const ClosestFeature& f) {
    return pair.longest > 0 && f.away.norm() > pair.longest;
}
/// `side`: of the touch.
Press press_of(const CollisionBody& target, const ContactPair& pair, int side, const ClosestFeature& f);

/// Calls visit(CoupledCarriers) for all that a point and a triangle couple; with `widely` also the triangles about it.
/// Stops, and returns false, where a visit returns false.
template <class Visit>
bool visit_couplings(const CollisionBodies& bodies, const Touch& touch, int triangle, bool widely, const Visit& visit) {
    const CollisionBody &source = bodies[touch.source], &target = bodies[touch.target];
    const auto couple = [&](int body, int carrier, int other_body, int other_carrier) {
        if (body == other_body && carrier == other_carrier) return true;
        CoupledCarriers c{body, carrier, other_body, other_carrier};
        if (std::pair(c.other_body, c.other_carrier) < std::pair(c.body, c.carrier))
            c = {c.other_body, c.other_carrier, c.body, c.carrier};
        return visit(c);
    };
    const auto all_of = [&](int body, std::span<const int> carriers, int other_body, std::span<const int> others) {
        for (const int one : carriers)
            for (const int other : others)
                if (!couple(body, one, other_body, other)) return false;
        return true;
    };
    const int carrier = source.carrier(touch.point);
    const std::span<const int> own(&carrier, source.deforms() ? 1 : 0);
    const auto of_triangle = [&](int t) {
        const std::span<const int> theirs = target.carriers_at(t);
        return all_of(touch.target, theirs, touch.target, theirs) && all_of(touch.source, own, touch.target, theirs);
    };
    if (!of_triangle(triangle)) return false;
    for (std::size_t c = 0; widely && c < 3; ++c)
        for (const int around : target.fan(target.triangles()[at(triangle)][c]))
            if (!of_triangle(around)) return false;
    return true;
}

/// Where everything is at the start of a step, and what is near what there.
class TouchSearch {
  public:
    explicit TouchSearch(const CollisionBodies& bodies);
    /// `carriers`: of each body, 3 numbers a vertex of what carries it.
    void begin(const std::vector<const double*>& carriers);
    /// The contacts of the state, sorted as there, that belong to the pair; those too deep for it are left out, and
    /// those of points that are flagged as `held` (none, or one a point of the source). Gives how many are too deep.
    std::uint64_t take_kept(const ContactPair& pair, const std::vector<KeptContact>& kept,
                            const std::vector<char>& held, std::vector<Touch>& out) const;
    /// Says where everything is later, or may be.
    void sweep(const std::vector<const double*>& later);
    /// Points of the pair outside of the surface whose way to where they are later comes nearer than a margin to that
    /// of the surface; but for those that are held, and those that `out` has already, from `first` on.
    void find_near(const ContactPair& pair, double margin, const std::vector<char>& held, std::size_t first,
                   std::vector<Touch>& out);
    /// As someone sees it who goes along with the touch's target as that was swept last: how far its point, which is
    /// there now, is from where it began [m].
    double way(const Touch& touch, const Vec3& now) const {
        return (ahead_[at(touch.target)].seen(now) - boxes_[at(touch.source)].places()[at(touch.point)]).norm();
    }
    /// As seen likewise, by who goes along with the body: the farthest of its points, which are there now [m].
    double farthest_way(int body, const Points& now) const {
        return ahead_[at(body)].farthest_way(boxes_[at(body)].places(), now);
    }
    /// The same of the places that it was swept to: bones are nowhere else [m].
    double farthest_swept(int body) const { return ahead_[at(body)].farthest(); }
    /// The area that a touching point stands for [m^2].
    double area(const ContactPair& pair, const Touch& touch) const;
    /// Points of the pair inside of the surface, wherever they are, but for those too deep: gives how many.
    std::uint64_t find_inside(const ContactPair& pair, std::vector<Touch>& out);

  private:
    const CollisionBodies& bodies_;
    std::vector<SurfaceBoxes> boxes_;
    std::vector<std::vector<double>> areas_;
    /// What was found out about distances in earlier steps and still holds, less what bodies have moved since against
    /// each other. It saves searches and changes none of their results.
    struct Known {
        double distance = 0; ///< at least so far [m]
        int triangle = -1;   ///< the nearest when that was found out
    };
    struct KnownOfPair {
        std::vector<Known> points;
        long long step = 0; ///< at which that was
    };
    void bring_up_to_date(const ContactPair& pair);
    std::vector<KnownOfPair> known_; ///< [source and target]
    long long step_ = 0;
    std::vector<std::vector<std::vector<int>>> elsewhere_;   ///< per body that touches itself: CollisionBody::elsewhere
    std::vector<std::shared_ptr<const SurfaceTree>> inside_; ///< per body whose inside was asked for in this step
    std::vector<Points> last_, later_;                       ///< per body, of its points: at the step before, and later
    std::vector<BodyMotion> behind_, ahead_;                 ///< from the step before, and to later
    std::vector<char> has_;                                  ///< of a search, per point
    std::vector<ClosestFeature> found_;
};

} // namespace sinew::solver
