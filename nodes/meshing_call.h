// Long meshing inside a node: progress to the host, stopping when the host asks, errors with node and
// attribute.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/adapters.h"
#include "solver/meshing/meshing_control.h"

namespace sinew::nodes {

/// Calls `mesh(control)`. `attribute` is blamed for errors, but for
/// those whose code is in `blame`, a list of {code, attribute}.
template <class Call>
auto meshing(const engine::Reads& in, std::string_view attribute,
             std::initializer_list<std::pair<std::string_view, std::string_view>> blame, Call&& mesh) {
    solver::MeshingControl control;
    control.stop = [&in] { return in.stop_requested(); };
    control.progress = [&in](double done, std::string_view what) { in.progress(done, what); };
    try {
        return mesh(control);
    } catch (const solver::Stopped&) {
        throw engine::Cancelled();
    } catch (const solver::Error& e) {
        for (const auto& [code, other] : blame)
            if (e.code == code) attribute = other;
        in.fail(attribute, e.code, e.what(), e.hint);
    }
}

} // namespace sinew::nodes
