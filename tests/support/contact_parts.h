// What lets bodies of a test's scene touch each other.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/terms/contact/contact.h"

namespace sinew::test {

/// The first `bodies` of a scene collide, all with the same values. After its bodies and before other parts.
inline void let_collide(solver::SceneDescription& description, solver::StepInputs& in, int bodies,
                        const solver::ContactValues& values) {
    for (int body = 0; body < bodies; ++body) {
        description.parts.push_back({&solver::contact_type, {body}, std::make_shared<solver::ContactRest>()});
        put_fields(values, std::span(in.parts.emplace_back(solver::contact_type.values.size())));
    }
}

} // namespace sinew::test
