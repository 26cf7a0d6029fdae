// Target shapes of tissues on wires, and carried to the tets.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/node_type.h"
#include "nodes/values.h"

#include <functional>
#include <string_view>
#include <vector>

namespace sinew::nodes {

/// What a zRestShape gives to a tissue.
struct RestShapeTarget {
    Mesh target;                ///< scene units
    engine::NumberList weights; ///< painted: per vertex, one for all, or none for everywhere
    double weight = 0;          ///< envelope x targetWeight
};

/// One force a target, whose values are its weight; carrying it to the tets is done once.
/// Fails at `attribute` with FE285 (a target of another mesh), FE204 (a map that does not fit), FE286 (a target that
/// turns tets inside out).
void add_rest_shapes(const engine::Reads& in, std::string_view attribute,
                     const std::vector<std::reference_wrapper<const RestShapeTarget>>& targets, const BodyRest& rest,
                     std::vector<Force>& forces);

} // namespace sinew::nodes

namespace sinew::engine {

template <>
struct ValueTraits<nodes::RestShapeTarget> {
    static constexpr std::string_view name = "rest shape";
    static void hash(Hasher& h, const nodes::RestShapeTarget& v);
    static std::size_t bytes(const nodes::RestShapeTarget& v);
};

} // namespace sinew::engine
