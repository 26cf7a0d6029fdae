// The bodies of contact in a scene, and which of them collide.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/index.h"
#include "solver/terms/contact/collision_body.h"
#include "solver/terms/contact/contact_rest.h"

#include <vector>

namespace sinew::solver {

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
    void find_pairs(const std::vector<PartValues>& values, std::vector<ContactPair>& out) const;

  private:
    std::vector<CollisionBody> bodies_;
    std::vector<const ContactRest*> rests_;
    std::vector<std::size_t> parts_;
};

} // namespace sinew::solver
