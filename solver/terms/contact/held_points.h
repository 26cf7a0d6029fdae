// Points that contact leaves to attachments: where one holds two bodies together at least as firmly as their contact
// would push them apart, or two hold both to the same place of a third body, they stay as they were modelled, overlaps
// and all.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/state.h"
#include "solver/step_inputs.h"
#include "solver/terms/contact/collision_bodies.h"

#include <span>
#include <vector>

namespace sinew::solver {

class HeldPoints {
  public:
    /// Both outlive it.
    HeldPoints(const Scene& scene, const CollisionBodies& bodies);
    /// Finds the points that each attachment holds: those within a mean edge of where its samples are, on either body;
    /// and of each two that hold bodies to the same third one the points that both are near.
    /// Does nothing where the attachments' memory is what it was.
    void take(const State& before);
    /// Flags the points of a pair's source that fixed attachments between its bodies hold, or two to one other body,
    /// whose stiffness times envelope, of two in series, is that of the contact or more. Empty: there are none.
    void find(const ContactPair& pair, std::span<const AttachmentInputs> inputs, std::vector<char>& held) const;

  private:
    struct Held {
        int source = -1, target = -1; ///< bodies of contact; -1: none
        std::vector<char> of[2];      ///< flags of their points
        std::size_t attachments[2];   ///< that hold them; twice the same where it is one
    };
    std::vector<char> flags(int body, const Points& places) const;
    const Scene& scene_;
    const CollisionBodies& bodies_;
    std::vector<int> contact_body_; ///< per body of the scene; -1: it does not collide
    TermMemory memory_;
    bool taken_ = false;
    std::vector<Held> held_;
};

} // namespace sinew::solver
