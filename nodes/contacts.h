// The contacts of one frame as a value on a wire.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"
#include "nodes/solver_space.h"
#include "solver/terms/contact/contact_list.h"

#include <vector>

namespace sinew::nodes {

/// As the solver gives them, but for `place`, which is in scene units, and for bodies, which are places in
/// zSolver.bodies, counted from 0. By source, target and point.
struct ContactList {
    std::vector<solver::ContactPoint> contacts;
};

/// \param simulated places in zSolver.bodies of those of the scene
ContactList contact_list(std::vector<solver::ContactPoint> contacts, const std::vector<int>& simulated,
                         const SolverSpace& space);

/// What a pair of bodies has in contact.
struct ContactSum {
    int source = -1, target = -1; ///< places in zSolver.bodies
    std::size_t contacts = 0, sliding = 0;
    std::size_t deepest = 0;                   ///< place of that contact in the list
    solver::Vec3 force = solver::Vec3::Zero(); ///< on the source [N]
};

/// One entry for each pair that touches, in the order of the list.
std::vector<ContactSum> sums_of(const ContactList& list);

} // namespace sinew::nodes

namespace sinew::engine {

template <>
struct ValueTraits<nodes::ContactList> {
    static constexpr std::string_view name = "contacts";
    static void hash(Hasher& h, const nodes::ContactList& v);
    static std::size_t bytes(const nodes::ContactList& v);
};

} // namespace sinew::engine
