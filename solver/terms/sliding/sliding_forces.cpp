// Sliding attachments within a stage: nearest places, energy and gradient.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/terms/sliding/sliding.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

void Slides::begin_stage(const Stage& stage) {
    stage_ = &stage;
    changing_.assign(slides_.size(), {});
    looked_at_.clear(), settled_ = widened_ = 0, alone_ = false;
    if (slides_.empty()) return;
    for (std::size_t a = 0; a < pulls_.size(); ++a) {
        const AttachmentInputs& in = stage.inputs.attachments[a];
        const double on = in.envelope * in.slides;
        pulls_[a] = {in.stiffness * on, in.damping * on * stage.form.velocity_factor};
    }
    // Where the points were at the start of the step.
    for (std::size_t b = 0; b < targets_.size(); ++b)
        if (targets_[b])
            targets_[b]->place(targets_[b]->surface().deforms() ? stage.before.x.data()
                                                                : stage.before.bones[b].data()->data());
    parallel_for(slides_.size(), 64, [&](std::size_t i) {
        const Slide& s = slides_[i];
        const SlidingTarget& target = *targets_[s.target];
        const SlidingMemory::Place& kept = kept_.places[at(s.attachment)][i - first_slide_[at(s.attachment)]];
        heights_[i] = kept.height;
        const Vec3 p = point_of(s, stage.before.x, stage.before.bones);
        const ClosestFeature f =
            follow_feature(target.surface(), target.places(), kept.triangle, p, Vec3::Zero(), allowed(s));
        starts_[i] = start_of(f, target.surface().corners(f.triangle, target.places()));
        nearest_[i] = find_nearest(i, p);
    });
    const auto weighed = bones_weighed(stage.form, stage.before, stage.bones_after);
    for (std::size_t b = 0; b < bones_.size(); ++b)
        if (scene_.bone(static_cast<int>(b))) place_bone(stage.form, weighed, b, bones_[b]);
    make_brakes();
    for (std::size_t b = 0; b < targets_.size(); ++b)
        if (targets_[b] && !targets_[b]->surface().deforms()) targets_[b]->place(bones_[b].data()->data());
}

/// While targets are placed at the start of the step.
void Slides::make_brakes() {
    brakes_.clear();
    if (std::none_of(pulls_.begin(), pulls_.end(), [](const Pull& p) { return p.viscous != 0; })) return;
    const ImplicitForm& form = stage_->form;
    const auto weighed = bones_weighed(form, stage_->before, stage_->bones_after);
    // A velocity is factor x place + drift: for what deforms factor x + offset, for bones as they move.
    const auto of_bone = [&](std::size_t body, const auto& place_in) {
        Vec3 out = -form.velocity_factor * place_in(bones_[body]);
        for (std::size_t time = 0; time < 3; ++time)
            if (form.bone_velocity[time] != 0) out += form.bone_velocity[time] * place_in((*weighed[time])[body]);
        return out;
    };
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const Slide& s = slides_[i];
        const SlidingTarget& target = *targets_[s.target];
        const ClosestFeature& f = starts_[i].feature;
        const std::array<Vec3, 3> corners = target.surface().corners(f.triangle, target.places());
        Brake brake;
        brake.triangle = f.triangle, brake.place = f.place;
        const Vec3 p = f.place[0] * corners[0] + f.place[1] * corners[1] + f.place[2] * corners[2] + f.away;
        brake.normal = target.height_over(target.feature_of(f), p, true).normal;
        const std::size_t source = at(scene_.description().attachments[at(s.attachment)].source);
        if (s.terms > 0) {
            for (const RideTerm& t : ride(s))
                brake.drift += t.weight * Eigen::Map<const Vec3>(form.velocity_offset.data() + 3 * at(t.vertex));
        } else {
            brake.drift = of_bone(source, [&](const Points& p) { return bone_point(s.source, p); });
        }
        for (int c = 0; c < 3; ++c) {
            const int corner = target.surface().triangles()[at(f.triangle)][at(c)];
            if (target.surface().deforms())
                brake.drift -= f.place[c] * target.surface().place(corner, form.velocity_offset.data());
            else
                brake.drift -= f.place[c] * of_bone(s.target, [&](const Points& p) {
                                   return target.surface().place(corner, p.data()->data());
                               });
        }
        brakes_.push_back(brake);
    }
}

Slides::Nearest Slides::find_nearest(std::size_t i, const Vec3& p) const {
    const Slide& s = slides_[i];
    const SlidingTarget& target = *targets_[s.target];
    const std::vector<char>* flags = allowed(s);
    ClosestFeature where = follow_feature(target.surface(), target.places(), starts_[i], p, flags), any = where;
    if (flags) {
        any = follow_feature(target.surface(), target.places(), where.triangle, p);
        if (!(*flags)[at(any.triangle)])
            where = nearest_allowed(target.surface(), target.places(), any, where, p, *flags);
        else if (any.away.squaredNorm() < where.away.squaredNorm())
            where = any;
        else
            any = where;
    }
    Nearest out{target.feature_of(where), target.feature_of(any)};
    out.apart = !(out.allowed == out.any) || out.any.rim;
    return out;
}

void Slides::look_at(const Positions& x) const {
    if (x == looked_at_ && !x.empty()) return;
    for (const auto& target : targets_)
        if (target && target->surface().deforms()) target->place(x.data());
    parallel_for(slides_.size(), 64, [&](std::size_t i) {
        const SlidingTarget& target = *targets_[slides_[i].target];
        points_[i] = point_of(slides_[i], x, bones_);
        now_[i].allowed = target.place_on(nearest_[i].allowed, points_[i]);
        if (heights_[i] != 0) now_[i].height = target.height_over(nearest_[i].any, points_[i], alone_);
    });
    looked_at_ = x;
}

/// True: something else is nearest. `stuck`: also to points whose nearest place goes to and fro.
bool Slides::find_all_nearest(const Positions& x, bool stuck) {
    look_at(x);
    newly_.resize(slides_.size());
    parallel_for(slides_.size(), 64, [&](std::size_t i) {
        constexpr int most_returns = 4, most_changes = 12;
        Changing& c = changing_[i];
        newly_[i] = nearest_[i];
        if (!stuck && (c.returns >= most_returns || c.changes >= most_changes)) return;
        const Nearest now = find_nearest(i, points_[i]);
        if (now == nearest_[i]) return;
        ++c.changes;
        if (now == c.former && ++c.returns >= most_returns && !stuck) return;
        c.former = nearest_[i], newly_[i] = now;
    });
    if (newly_ == nearest_) return false;
    nearest_.swap(newly_);
    looked_at_.clear();
    return true;
}

bool Slides::settle(const Positions& x, bool stuck) {
    constexpr int most = 20, most_stuck = 60;
    if (slides_.empty() || settled_ >= (stuck ? most_stuck : most) || (alone_ && !stuck)) return false;
    ++settled_;
    const bool other = stuck && !alone_;
    alone_ = alone_ || stuck;
    if (other) looked_at_.clear();
    return find_all_nearest(x, stuck) || other;
}

bool Slides::widen(const Positions& x) {
    constexpr int most = 2; // six ended no better: docs/theory/solver.md, Newton
    return !slides_.empty() && widened_++ < most && find_all_nearest(x, false);
}

Vec3 Slides::way_of_brake(std::size_t i) const {
    const Slide& s = slides_[i];
    const SlidingTarget& target = *targets_[s.target];
    const std::array<Vec3, 3> c = target.surface().corners(brakes_[i].triangle, target.places());
    return points_[i] - brakes_[i].place[0] * c[0] - brakes_[i].place[1] * c[1] - brakes_[i].place[2] * c[2];
}

double Slides::squared_way(std::size_t i) const {
    const double square = now_[i].allowed.away.squaredNorm();
    if (heights_[i] == 0) return square;
    const double h = now_[i].height.value, stretch = h - heights_[i];
    return stretch * stretch + (nearest_[i].apart ? square - h * h : 0);
}

double Slides::evaluate(const Positions& x, bool with_damping) const {
    if (slides_.empty()) return 0;
    look_at(x);
    const double factor = stage_->form.velocity_factor;
    return ordered_sum(slides_.size(), [&](std::size_t i) {
        double energy = 0.5 * stiffness(slides_[i]) * squared_way(i);
        if (with_damping && !brakes_.empty()) {
            const double speed = brakes_[i].normal.dot(factor * way_of_brake(i) + brakes_[i].drift);
            const Slide& s = slides_[i];
            energy += 0.5 * pulls_[at(s.attachment)].viscous * s.area_weight * speed * speed / (factor * factor);
        }
        return energy;
    });
}

double Slides::stored_energy(const Positions& x) { return evaluate(x, false); }

/// A force by the point at a place of its target; the target's points gather what presses on them.
void Slides::press(const Slide& s, int triangle, const Vec3& place, const Vec3& by_point) {
    for (const RideTerm& t : ride(s)) Eigen::Map<Vec3>(gradient_.data() + 3 * at(t.vertex)) += t.weight * by_point;
    const CarriedSurface& target = targets_[s.target]->surface();
    if (!target.deforms()) return;
    const Triangle& corners = target.triangles()[at(triangle)];
    for (int c = 0; c < 3; ++c) pressed_[s.target][at(corners[at(c)])] -= place[c] * by_point;
}

double Slides::energy(const Positions& x, bool with_forces) {
    const double energy = evaluate(x, true);
    if (!with_forces) return energy;
    gradient_.clear(x.size());
    pressed_.resize(targets_.size());
    for (std::size_t t = 0; t < targets_.size(); ++t)
        if (targets_[t]) pressed_[t].assign(targets_[t]->surface().point_count(), Vec3::Zero());
    const double factor = stage_->form.velocity_factor;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const Slide& s = slides_[i];
        const double k = stiffness(s), g = heights_[i];
        const ClosestFeature& f = now_[i].allowed;
        const Height& h = now_[i].height;
        if (g == 0) {
            press(s, f.triangle, f.place, k * f.away);
        } else if (nearest_[i].apart) {
            press(s, f.triangle, f.place, k * f.away);
            press(s, h.triangle, h.place, -k * g * h.normal);
        } else {
            press(s, h.triangle, h.place, k * (h.value - g) * h.normal);
        }
        if (brakes_.empty()) continue;
        const Brake& b = brakes_[i];
        const double speed = b.normal.dot(factor * way_of_brake(i) + b.drift);
        press(s, b.triangle, b.place, pulls_[at(s.attachment)].viscous * s.area_weight * speed / factor * b.normal);
    }
    for (std::size_t t = 0; t < targets_.size(); ++t)
        if (targets_[t]) targets_[t]->surface().add_to_carriers(pressed_[t], gradient_.data());
    return energy;
}

void Slides::add_squared_stiffnesses(std::span<double> squares) const {
    for (const Slide& s : slides_) {
        const AttachmentRest& rest = scene_.description().attachments[at(s.attachment)];
        for (const int body : {rest.source, rest.target})
            if (const int d = scene_.deformable_of(body); d >= 0) squares[at(d)] += stiffness(s) * stiffness(s);
    }
}

} // namespace sinew::solver
