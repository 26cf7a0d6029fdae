// Bodies that a frame leaves deep inside each other: contact pushes them apart, but too softly, and a solve that is in
// balance says nothing of it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/contacts.h"
#include "nodes/solver_setup.h"

namespace sinew::nodes {

/// Puts into `report.worst` the contact that is deepest by the thickness of what is thinner, where it is deeper than
/// contact is meant to be, and warns of it in a frame that has converged (FE307). `meshes`: of zSolver.bodies at
/// that frame.
void find_deep(const engine::Reads& in, const Setup& setup, const MeshList& meshes, const ContactList& contacts,
               SolveReport& report);

} // namespace sinew::nodes
