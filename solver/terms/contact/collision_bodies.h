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
    double range = 0; ///< contact begins so far from the surface [m]: half the thickness of what is cloth
    bool slides = true;
    bool both_ways = false; ///< the second one's points are tested against the first one's surface, too
    bool two_sided = false; ///< the second one is a cloth
    /// Points that start a step outside are the business of ClothContact: here are those that got through alone.
    bool only_kept = false;
};

/// The bodies of contact in a scene.
class CollisionBodies {
  public:
    explicit CollisionBodies(const Scene& scene);
    std::size_t count() const { return bodies_.size(); }
    const CollisionBody& operator[](int body) const { return bodies_[at(body)]; }
    const ContactRest& rest(int body) const { return *rests_[at(body)]; }
    std::size_t part(int body) const { return parts_[at(body)]; } ///< of the scene's
    /// Pairs that collide under these values, in fixed order. Throws Error FE298 if one is a cloth thicker than half of
    /// its length.
    void find_pairs(const std::vector<PartValues>& values, std::vector<ContactPair>& out) const;
    /// Those of cloth that has a thickness with others and with itself: each once, the lower number first. Throws
    /// Error FE298 likewise.
    void find_thick_pairs(const std::vector<PartValues>& values, std::vector<ContactPair>& out) const;

  private:
    bool has_faces(std::size_t body) const { return sinew::solver::has_faces(*rests_[body]); }
    /// What of a pair follows from values alone; false: it does not collide.
    bool make_pair(const std::vector<PartValues>& values, std::size_t a, std::size_t b, ContactPair& out) const;
    [[noreturn]] void refuse_thickness(std::size_t body) const;
    std::vector<CollisionBody> bodies_;
    std::vector<const ContactRest*> rests_;
    std::vector<std::size_t> parts_;
    std::vector<char> too_thick_; ///< cloth that is thicker than half of its length
};

} // namespace sinew::solver
