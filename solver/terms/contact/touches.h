// Which points may press into which surfaces within a step: those that do so already, and those outside that are near
// enough to come in.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/contact/closest_feature.h"
#include "solver/terms/contact/contact_memory.h"

#include <optional>
#include <vector>

namespace sinew::solver {

/// A point of one body and the surface of another, or of the same one.
struct Touch {
    int source = -1, point = -1, target = -1; ///< bodies: places among those of contact
    int kept = -1;                            ///< its contact of the state; -1: it is outside
    double area = 0;                          ///< that it stands for here [m^2]
    ClosestFeature feature;                   ///< at the start of the step
};

/// Two bodies, of which the first one's points are tested against the second one's surface.
struct ContactPair {
    int source = -1, target = -1;
    double stiffness = 0, friction = 0, damping = 0, longest = 0; ///< see ContactValues; series stiffness
    bool slides = true;
    bool both_ways = false; ///< the second one's points are tested against the first one's surface, too
};

/// The bodies of contact in a scene.
class CollisionBodies {
  public:
    explicit CollisionBodies(const Scene& scene);
    std::size_t count() const { return bodies_.size(); }
    const CollisionBody& operator[](int body) const { return bodies_[at(body)]; }
    const ContactRest& rest(int body) const { return *rests_[at(body)]; }
    std::size_t part(int body) const { return parts_[at(body)]; } ///< of the scene's
    /// Pairs that collide under these values, in fixed order.
    std::vector<ContactPair> pairs(const std::vector<PartValues>& values) const;

  private:
    std::vector<CollisionBody> bodies_;
    std::vector<const ContactRest*> rests_;
    std::vector<std::size_t> parts_;
};

/// Appends the vertices that a point and a triangle couple, lower number first; with `widely` also those of the
/// triangles about it. Nothing where one of the two is rigid.
void add_couplings(const CollisionBodies& bodies, const Touch& touch, int triangle, bool widely,
                   std::vector<std::pair<int, int>>& out);

/// Where everything is at the start of a step, and what is near what there.
class TouchSearch {
  public:
    explicit TouchSearch(const CollisionBodies& bodies);
    /// `carriers`: of each body, 3 numbers a vertex of what carries it.
    void begin(std::vector<const double*> carriers);
    const double* carriers(int body) const { return carriers_[at(body)]; }
    /// The contacts of the state that belong to the pair; those deeper than its longest are left out.
    void take_kept(const ContactPair& pair, const std::vector<KeptContact>& kept, std::vector<Touch>& out) const;
    /// Points of the pair outside of the surface up to a distance, but for those that `out` has already.
    void find_near(const ContactPair& pair, double distance, std::vector<Touch>& out);
    /// Points of the pair inside of the surface, wherever they are.
    void find_inside(const ContactPair& pair, std::vector<Touch>& out);

  private:
    void fit(int body);
    double area(const ContactPair& pair, int point, const ClosestFeature& feature) const;
    const CollisionBodies& bodies_;
    std::vector<const double*> carriers_;
    std::vector<CollisionBoxes> boxes_;
    std::vector<char> fitted_;
    std::vector<std::vector<double>> areas_;
};

} // namespace sinew::solver
