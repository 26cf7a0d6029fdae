// Friction: its force from iteration to iteration, and, once a stage is roughly solved, as hard as the step presses and
// of points that come in within it.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <limits>

namespace sinew::solver {

namespace {

/// Of the most that friction between two bodies could do: where it is off by less it may be so until the next step, so
/// that what slides evenly, or rests and has points come and go at its rim, is not solved twice.
constexpr double least_share = 0.1;
/// What a contact has turned aside is off its free fall along the normal, up to this share.
constexpr double off_normal = 0.2;

} // namespace

/// Where a point comes in on its straight way from where it was at the start of the step to p, as the target sees it
/// that moves along to `places`. triangle = -1: it does not.
ClosestFeature Contacts::way_in(std::size_t i, const Points& places, const Vec3& p) const {
    const CollisionBody& target = bodies_[touches_[i].target];
    const ClosestFeature f = follow_feature(target, places, starts_[i], p);
    const Press pressed = press(i, f);
    if (!(pressed.depth > 0)) return {};
    const Vec3 back = moved_along(target, places, starts_[i]) - p;
    const double height = pressed.out.dot(back);
    const double inside = height > pressed.depth ? pressed.depth / height : 1;
    return follow_feature(target, places, f.triangle, p + inside * back);
}

void Contacts::place_flown() {
    flown_.resize(bodies_.count());
    for (std::size_t b = 0; b < bodies_.count(); ++b) {
        const CollisionBody& body = bodies_[static_cast<int>(b)];
        flown_[b].resize(body.point_count());
        const double* carriers = carriers_expected(static_cast<int>(b));
        for (std::size_t p = 0; p < flown_[b].size(); ++p) flown_[b][p] = body.place(static_cast<int>(p), carriers);
    }
}

/// Where a point that presses at x came in on its way until then: as it flew on and gravity made it fall, if that is
/// where it would be but for the contact; else, what something else holds, as it flew on; else straight to where it is.
ClosestFeature Contacts::first_place(std::size_t i, const Vec3& out) const {
    const Touch& t = touches_[i];
    const Vec3 flown = flown_[at(t.source)][at(t.point)];
    const Points& places = flown_[at(t.target)];
    if (stage_->form.mass_factor > 0 && bodies_[t.source].deforms() != bodies_[t.target].deforms()) {
        const Vec3 fall = (bodies_[t.source].deforms() ? 1 : -1) / stage_->form.mass_factor * stage_->inputs.gravity;
        Vec3 pushed = point_at(t) - flown - fall;
        const Triangle& corners = bodies_[t.target].triangles()[at(now_[i].triangle)];
        for (int c = 0; c < 3; ++c)
            pushed -= now_[i].place[c] * (places_[at(t.target)][at(corners[at(c)])] - places[at(corners[at(c)])]);
        const double along = out.dot(pushed);
        if ((pushed - along * out).norm() < off_normal * along)
            if (const ClosestFeature in = way_in(i, places, flown + fall); in.triangle >= 0) return in;
    }
    const ClosestFeature in = way_in(i, places, flown);
    return in.triangle >= 0 ? in : way_in(i, places_[at(t.target)], point_at(t));
}

/// Before an iteration, after find_features.
void Contacts::follow_friction() {
    for (Tether& t : tethers_) t.followed.follow(t.spring, t.holds * reach(t));
    for (Drag& d : drags_) d.followed.follow(d.spring, d.holds * (way_between(d.press) - d.way));
}

/// Where a stage has been solved roughly with all that touches; whether that changes friction enough to count. Until
/// they touch, bodies fly on as they did: what they do after that turns them aside, and is no part of their way there.
bool Contacts::renew_friction(const Positions& x) {
    find_features(x);
    bool flown = false;
    rubbing_.assign(pairs_.size(), {}), limits_.clear();
    ties_before_.assign(tethers_.begin() + static_cast<std::ptrdiff_t>(first_ties_), tethers_.end());
    tethers_.resize(first_ties_);
    for (const Tether& tether : tethers_) limits_.push_back(tether.spring.most);
    std::size_t known = 0, tied = 0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& t = touches_[i];
        const ContactPair& pair = pair_of(i);
        Rubbing& sum = rubbing_[pair_of_touch_[i]];
        while (known < first_ties_ && tethers_[known].touch < i) ++known;
        const bool is_tied = tied < ties_before_.size() && ties_before_[tied].touch == i;
        const Tether* before = is_tied ? &ties_before_[tied++] : nullptr;
        const Vec3 rubbed = before ? tether_force(*before, nullptr).by_point : Vec3(Vec3::Zero());
        if (now_[i].triangle < 0 || (pair.slides ? pair.friction <= 0 : t.kept >= 0)) {
            sum.change += rubbed.norm();
            continue;
        }
        const Press pressed = press(i, now_[i]);
        const double presses = pressed.depth > 0 ? stiffness(i) * pressed.depth : 0;
        const double most = pair.slides ? pair.friction * presses : std::numeric_limits<double>::infinity();
        sum.could += pair.slides ? most : presses;
        if (known < first_ties_ && tethers_[known].touch == i && tethers_[known].spring.stiffness > 0) {
            Tether renewed = tethers_[known];
            renewed.spring.most = limits_[known] = most;
            sum.change +=
                (tether_force(renewed, nullptr).by_point - tether_force(tethers_[known], nullptr).by_point).norm();
            continue;
        }
        if (!(presses > 0)) {
            sum.change += rubbed.norm();
            continue;
        }
        Tether tie;
        if (before) tie.followed = before->followed;
        if (t.kept >= 0) {
            const KeptContact& was = kept_.contacts[at(t.kept)];
            tie.triangle = was.anchor_triangle, tie.place = Vec3(was.anchor[0], was.anchor[1], was.anchor[2]);
        } else {
            if (!flown) place_flown(), flown = true;
            const ClosestFeature in = first_place(i, pressed.out);
            if (in.triangle < 0) {
                sum.change += rubbed.norm();
                continue;
            }
            tie.triangle = in.triangle, tie.place = in.place;
        }
        tie.touch = i, tie.spring = {stiffness(i), most};
        tie.holds = Mat3::Identity() - pressed.out * pressed.out.transpose();
        sum.change += (tether_force(tie, nullptr).by_point - rubbed).norm();
        tethers_.push_back(tie), limits_.push_back(most);
    }
    const bool counts = std::any_of(rubbing_.begin(), rubbing_.end(),
                                    [](const Rubbing& r) { return r.change > least_share * r.could; });
    if (counts) {
        for (std::size_t k = 0; k < tethers_.size(); ++k) tethers_[k].spring.most = limits_[k];
    } else {
        tethers_.resize(first_ties_);
        tethers_.insert(tethers_.end(), ties_before_.begin(), ties_before_.end());
    }
    tether_forces_.resize(tethers_.size());
    if (tether_elements_.size() < tethers_.size()) tether_elements_.resize(tethers_.size());
    return counts;
}

const Contacts::Tether* Contacts::first_tie(std::size_t touch) const {
    const auto tie = std::lower_bound(tethers_.begin() + static_cast<std::ptrdiff_t>(first_ties_), tethers_.end(),
                                      touch, [](const Tether& t, std::size_t i) { return t.touch < i; });
    return tie != tethers_.end() && tie->touch == touch ? &*tie : nullptr;
}

} // namespace sinew::solver
