// Contact as it was at the start of a step, carried along with what touched: a first guess of where bones take flesh
// that has yet to follow them. Where bodies are then, new places of some and old ones of others, tells nothing of
// contact.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/terms/contact/contact.h"

namespace sinew::solver {

/// Fixed contacts are tethers, and carried along anyhow.
bool Contacts::pressed_before(std::size_t i) const {
    return touches_[i].kept >= 0 && presses(i, press(i, touches_[i].feature).depth);
}

/// Its depth along the way that it was pushed, which turns along with the triangle; less than zero where the two have
/// parted.
Press Contacts::carried_press(std::size_t i) const {
    const Touch& t = touches_[i];
    const CollisionBody& target = bodies_[t.target];
    const Points& places = places_[at(t.target)];
    ClosestFeature carried = t.feature;
    carried.away = turned_along(target, places, starts_[i], starts_[i].away);
    carried.normal = turned_along(target, places, starts_[i], starts_[i].normal);
    Press out = press(i, carried);
    out.depth = press(i, t.feature).depth - out.out.dot(point_at(t) - moved_along(target, places, starts_[i]));
    return out;
}

double Contacts::carried_energy(const Positions& x, bool with_forces) {
    find_all_touches();
    look_at(x);
    if (with_forces) gradient_.clear(x.size());
    double energy = 0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        if (!pressed_before(i)) continue;
        const Touch& t = touches_[i];
        const Press pressed = carried_press(i);
        const double k = stiffness(i);
        energy += 0.5 * k * pressed.depth * pressed.depth;
        if (!with_forces) continue;
        elements_[i].set_nodes(bodies_[t.source].free_ride(t.point), bodies_[t.target], t.feature.triangle,
                               scene_.numbering());
        elements_[i].add_gradient(corner_weights_of(t.feature.place), -k * pressed.depth * pressed.out,
                                  gradient_.data());
    }
    for (std::size_t i = 0; i < tethers_.size(); ++i) {
        tether_forces_[i] = tether_force(tethers_[i], nullptr);
        energy += tether_forces_[i].energy;
    }
    if (with_forces) add_tether_forces();
    return energy;
}

void Contacts::add_carried_hessian(const Positions& x, BlockMatrix& a) {
    look_at(x);
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        if (!pressed_before(i)) continue;
        const Touch& t = touches_[i];
        const Vec3 out = carried_press(i).out;
        elements_[i].set(bodies_[t.source].free_ride(t.point), bodies_[t.target], t.feature.triangle,
                         scene_.numbering(), *pattern_);
        PointTriangleBlocks blocks;
        for (Mat3& block : blocks) block.setZero();
        add_square(t.feature.place, out * out.transpose(), blocks);
        elements_[i].add_hessian(blocks, stiffness(i), a);
    }
    add_tether_hessian(a);
}

} // namespace sinew::solver
