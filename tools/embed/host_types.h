// Node types that a host brings.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/registry.h"

namespace sinew::embed {

/// Adds a type of the host's own, beside those of nodes::register_all. Its compute must be a pure function of what it
/// reads: results are found again by the type's name, `revision` and inputs, in this process and, kept on disk, in
/// others. Other code, another revision: one is required.
///
/// Names, docs, units and options of the type and its attributes are views: what they look at must live as long as the
/// registry, as texts in quotes do. Compute may not evaluate the session that computes it (DG140).
///
/// What compute throws becomes a failure of the node (DG127) with its words, but for Failure and Cancelled, which stay.
/// Throws Misuse DG128 for a declaration that cannot be: a name that is taken, a default outside the limits, no doc.
void add_host_type(engine::Registry& registry, engine::NodeType type);

} // namespace sinew::embed
