// Maps that are painted on a body's mesh, by vertices or by faces as another attribute says: of attachments and holds.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/values.h"

#include <string>

namespace sinew::nodes {

/// The map with one number per vertex, or, where `on` says faces, per triangle of the body's faces. Fails at `map` with
/// FE204 if it does not fit.
/// \param on an attribute with the words of options_of<solver::PaintedOn>
/// \param name the body's, for the message
engine::NumberList painted_map(const engine::Reads& in, const engine::Input<engine::NumberList>& map,
                               const engine::Input<std::string>& on, const Body& body, const std::string& name);

} // namespace sinew::nodes
