// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/marks.h"

#include <algorithm>

namespace sinew::nodes {

MarkList mark_list(solver::Marks groups, const std::vector<int>& simulated, const SolverSpace& space) {
    MarkList out;
    for (solver::MarkGroup& group : groups) {
        for (solver::Mark& m : group.marks) {
            m.from = space.place_in_scene(m.from), m.to = space.place_in_scene(m.to);
            for (int& body : m.bodies)
                if (body >= 0) body = simulated[static_cast<std::size_t>(body)];
        }
        const auto at = std::find_if(out.groups.begin(), out.groups.end(), [&](const solver::MarkGroup& g) {
            return g.term == group.term && g.what == group.what && g.unit == group.unit;
        });
        if (at == out.groups.end())
            out.groups.push_back(std::move(group));
        else
            at->marks.insert(at->marks.end(), group.marks.begin(), group.marks.end());
    }
    return out;
}

} // namespace sinew::nodes

namespace sinew::engine {

void ValueTraits<nodes::MarkList>::hash(Hasher& h, const nodes::MarkList& v) {
    h.add(static_cast<std::uint64_t>(v.groups.size()));
    for (const solver::MarkGroup& group : v.groups) {
        h.add(group.term).add(group.what).add(group.unit).add(static_cast<std::uint64_t>(group.marks.size()));
        for (const solver::Mark& m : group.marks) {
            h.add(m.part).add(m.value).add_ints(m.bodies);
            for (const solver::Vec3* p : {&m.from, &m.to}) h.add_doubles(std::span<const double>(p->data(), 3));
        }
    }
}

std::size_t ValueTraits<nodes::MarkList>::bytes(const nodes::MarkList& v) {
    std::size_t n = v.groups.size() * sizeof(solver::MarkGroup);
    for (const solver::MarkGroup& group : v.groups) n += group.marks.size() * sizeof(solver::Mark);
    return n;
}

} // namespace sinew::engine
