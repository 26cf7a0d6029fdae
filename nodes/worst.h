// Where a frame is at its worst: which tet is squeezed most, which attachment is stretched most, where
// bodies are deepest in each other.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/contacts.h"
#include "nodes/solver_setup.h"
#include "solver/state.h"

namespace sinew::nodes {

/// Bodies and attachments by their places in zSolver's lists. Looks at every tet and anchor once.
WorstPlaces find_worst(const Setup& setup, const solver::Scene& scene, const solver::State& state);

/// Puts in the deepest contact; of several that are as deep the first.
void find_deepest(const ContactList& contacts, WorstPlaces& worst);

} // namespace sinew::nodes
