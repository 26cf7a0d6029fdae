// Cloth within a stage: what presses on it, what rubs, and where its entries go.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace sinew::solver {

void Contacts::begin_cloth() {
    cloth_pairs_.clear(), presses_.clear(), drags_.clear(), cloth_strong_.clear();
    if (!cloth_.any()) return;
    bodies_.find_thick_pairs(stage_->inputs.parts, cloth_pairs_);
    count_presses(cloth_pairs_);
    cloth_held_.resize(cloth_pairs_.size());
    for (std::size_t p = 0; p < cloth_pairs_.size(); ++p) {
        ContactPair pair = cloth_pairs_[p];
        attached_.find(pair, stage_->inputs.attachments, cloth_held_[p][0]);
        std::swap(pair.source, pair.target);
        attached_.find(pair, stage_->inputs.attachments, cloth_held_[p][1]);
    }
}

/// What presses at the start of the step, and what may until it is over.
void Contacts::begin_cloth_search() {
    if (!cloth_.any()) return;
    cloth_places_.resize(bodies_.count());
    const auto place_all = [&](const std::vector<const double*>& carriers) {
        for (std::size_t b = 0; b < bodies_.count(); ++b) {
            const CollisionBody& body = bodies_[static_cast<int>(b)];
            cloth_places_[b].resize(body.point_count());
            for (std::size_t p = 0; p < body.point_count(); ++p)
                cloth_places_[b][p] = body.place(static_cast<int>(p), carriers[b]);
        }
    };
    place_all(before_);
    cloth_.begin(cloth_pairs_, cloth_held_, cloth_places_, lost_points());
    place_all(expected_);
    cloth_.search(cloth_places_);
    make_drags();
    looked_at_.clear();
}

std::vector<ClothContact::Lost> Contacts::lost_points() const {
    std::vector<ClothContact::Lost> out; // in order, as the contacts are by source, target and point
    for (const KeptContact& c : kept_.contacts) out.push_back({c.source, c.point, c.target});
    std::sort(out.begin(), out.end());
    return out;
}

/// Points that have got through something: from the next step on Touch draws them back.
void Contacts::remember_lost() const {
    for (const ClothContact::Press& press : presses_) {
        if (!press.through || press.split != 1) continue;
        const int source = cloth_.body_of(press.corners[0]), target = cloth_.body_of(press.corners[1]);
        const int point = cloth_.point_of(press.corners[0]), triangle = cloth_.triangle_of(press);
        const auto known = [&](const KeptContact& c) {
            return c.source == source && c.point == point && c.target == target;
        };
        if (std::any_of(next_.contacts.begin(), next_.contacts.end(), known)) continue;
        const std::array<double, 3> place{-press.weights[1], -press.weights[2], -press.weights[3]};
        const int side = bodies_[target].is_cloth() ? press.side : 0;
        next_.contacts.push_back({source, point, target, triangle, place, triangle, side, place, press.force()});
    }
}

Vec3 Contacts::way_between(const ClothContact::Press& press) const {
    Vec3 out = Vec3::Zero();
    for (std::size_t c = 0; c < 4; ++c) out += press.weights[c] * cloth_.place(press.corners[c], places_);
    return out;
}

void Contacts::make_drags() {
    drags_.clear();
    const ImplicitForm& form = stage_->form;
    const auto rubs = [&](const ContactPair& p) {
        return !p.slides || p.friction > 0 || (p.damping > 0 && form.velocity_factor > 0);
    };
    if (std::none_of(cloth_pairs_.begin(), cloth_pairs_.end(), rubs)) return;
    cloth_.find_presses_at_start(presses_);
    for (const ClothContact::Press& press : presses_) {
        const ContactPair& pair = cloth_.pair(press.pair);
        if (!rubs(pair) || press.stiffness <= 0) continue;
        Drag drag;
        drag.press = press;
        const Mat3 across = press.out * press.out.transpose();
        drag.holds = Mat3::Identity() - across;
        const double most = pair.slides ? pair.friction * press.force() : std::numeric_limits<double>::infinity();
        drag.spring = {press.stiffness, most};
        if (form.velocity_factor > 0) drag.brakes = pair.damping * press.stiffness / pair.stiffness * across;
        for (std::size_t c = 0; c < 4; ++c) {
            const int body = cloth_.body_of(press.corners[c]), point = cloth_.point_of(press.corners[c]);
            drag.way += press.weights[c] * bodies_[body].place(point, before_[at(body)]);
            if (form.velocity_factor > 0) drag.drift += press.weights[c] * drift_of(body, point);
        }
        drag.drift += form.velocity_factor * drag.way;
        drags_.push_back(drag);
    }
    presses_.clear();
}

bool Contacts::widen_cloth(const Positions& x) {
    if (cloth_pairs_.empty()) return false;
    look_at(x);
    if (cloth_.covers(places_)) return false;
    find_features(x);
    const std::vector<ClothContact::Press> before = presses_;
    cloth_.search(places_);
    cloth_.find_presses(places_, presses_);
    looked_at_.clear();
    const auto alike = [](const ClothContact::Press& a, const ClothContact::Press& b) {
        return a.corners == b.corners && a.through == b.through && a.stiffness == b.stiffness;
    };
    return !std::ranges::equal(presses_, before, alike);
}

Contacts::Force Contacts::drag_force(const Drag& drag, double* stored) const {
    const Vec3 moved = way_between(drag.press) - drag.way, held = drag.holds * moved;
    Force out{drag.spring.energy(held), drag.spring.force(held)};
    if (stored) *stored = out.energy;
    const double factor = stage_->form.velocity_factor;
    if (factor > 0 && !drag.brakes.isZero(0)) {
        const Vec3 velocity = factor * moved + drag.drift, force = drag.brakes * velocity;
        out.energy += 0.5 * force.dot(velocity) / factor;
        out.by_point += force;
    }
    return out;
}

double Contacts::evaluate_cloth(bool with_damping) {
    drag_forces_.resize(drags_.size());
    parallel_for(drags_.size(), 64, [&](std::size_t i) {
        double stored = 0;
        drag_forces_[i] = drag_force(drags_[i], &stored);
        if (!with_damping) drag_forces_[i].energy = stored;
    });
    return ordered_sum(presses_.size(), [&](std::size_t i) { return presses_[i].energy(); }) +
           ordered_sum(drags_.size(), [&](std::size_t i) { return drag_forces_[i].energy; });
}

void Contacts::add_cloth_forces() {
    const auto add = [&](const ClothContact::Press& press, const Vec3& force) {
        for (std::size_t c = 0; c < 4; ++c)
            for (const RideTerm& t : cloth_.ride(press.corners[c]))
                Eigen::Map<Vec3>(gradient_.data() + 3 * at(t.vertex)) += press.weights[c] * t.weight * force;
    };
    for (const ClothContact::Press& press : presses_) add(press, -press.force() * press.out);
    for (std::size_t i = 0; i < drags_.size(); ++i) add(drags_[i].press, drag_forces_[i].by_point);
}

void Contacts::add_cloth_hessian(bool project, BlockMatrix& a) {
    cloth_strong_.assign(presses_.size(), 0);
    const auto set = [&](const ClothContact::Press& press) {
        cloth_element_.set({cloth_.ride(press.corners[0]), cloth_.ride(press.corners[1]), cloth_.ride(press.corners[2]),
                            cloth_.ride(press.corners[3])},
                           press.split, scene_.numbering(), *pattern_);
    };
    for (std::size_t i = 0; i < presses_.size(); ++i) {
        const ClothContact::Press& press = presses_[i];
        if (project && press.stiffness <= 0) continue;
        set(press);
        // Sheets are so soft across that a factor which does not know of what lies on them is of no use.
        if (neither_stands(press) && !cloth_element_.coupled()) cloth_strong_[i] = 1;
        cloth_element_.add_hessian(cloth_.hessian(press, places_, project), 1, a);
    }
    for (const Drag& drag : drags_) {
        set(drag.press);
        const Vec3 held = drag.holds * (way_between(drag.press) - drag.way);
        const Mat3 by_way =
            stage_->form.velocity_factor * drag.brakes + drag.followed.stiffness(drag.spring, held, drag.holds);
        PointTriangleBlocks blocks;
        std::size_t entry = 0;
        for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t d = c; d < 4; ++d, ++entry)
                blocks[entry] = drag.press.weights[c] * drag.press.weights[d] * by_way;
        cloth_element_.add_hessian(blocks, 1, a);
    }
}

/// Adds what a press couples to next_.
void Contacts::couple_cloth(const ClothContact::Press& press) const {
    const auto couple = [&](int one, int other) {
        const int body = cloth_.body_of(one), other_body = cloth_.body_of(other);
        const int carrier = bodies_[body].carrier(cloth_.point_of(one)),
                  other_carrier = bodies_[other_body].carrier(cloth_.point_of(other));
        CoupledCarriers c{body, carrier, other_body, other_carrier};
        if (carrier < 0 || other_carrier < 0 || (body == other_body && carrier == other_carrier)) return; // bones

        if (std::pair(other_body, other_carrier) < std::pair(body, carrier))
            c = {other_body, other_carrier, body, carrier};
        next_.couplings.push_back(c);
    };
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) couple(press.corners[i], press.corners[j]);
}

/// What presses where a state is, without a step.
void Contacts::show_cloth(const Positions& x) const {
    shown_.clear();
    if (cloth_pairs_.empty()) return;
    look_at(x);
    cloth_.begin(cloth_pairs_, cloth_held_, places_, lost_points());
    cloth_.search(places_);
    cloth_.find_presses_at_start(shown_);
}

void Contacts::mark_cloth(const Positions& x, MarkGroup& group) const {
    show_cloth(x);
    for (const ClothContact::Press& press : shown_) {
        Vec3 one = Vec3::Zero();
        const auto split = static_cast<std::size_t>(press.split);
        for (std::size_t c = 0; c < split; ++c) one += press.weights[c] * cloth_.place(press.corners[c], places_);
        const int body = cloth_.body_of(press.corners[0]), other = cloth_.body_of(press.corners[3]);
        group.marks.push_back({static_cast<int>(bodies_.part(body)),
                               one,
                               one - press.away,
                               press.force(),
                               {bodies_[body].body(), bodies_[other].body()}});
    }
}

void Contacts::list_cloth(std::vector<ContactPoint>& out) const {
    for (const ClothContact::Press& press : shown_) {
        ContactPoint& made = out.emplace_back();
        made.source = bodies_[cloth_.body_of(press.corners[0])].body();
        made.target = bodies_[cloth_.body_of(press.corners[3])].body();
        made.point = cloth_.point_of(press.corners[0]);
        made.slides = cloth_.pair(press.pair).slides;
        for (std::size_t c = 0; c < static_cast<std::size_t>(press.split); ++c)
            made.place += press.weights[c] * cloth_.place(press.corners[c], places_);
        made.normal = press.out, made.depth = press.depth(), made.force = press.force() * press.out;
    }
    std::stable_sort(out.begin(), out.end(), [](const ContactPoint& a, const ContactPoint& b) {
        return std::tie(a.source, a.target, a.point) < std::tie(b.source, b.target, b.point);
    });
}

} // namespace sinew::solver
