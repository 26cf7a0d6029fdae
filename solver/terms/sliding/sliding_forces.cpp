// Sliding attachments within a stage: nearest places, energy, gradient and Hessian.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/terms/sliding/sliding.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

std::array<double, 4> corner_weights_of(const Vec3& place) { return {1, -place[0], -place[1], -place[2]}; }

/// Blocks of the product of two gradients, weights x normal.
void add_square(const Vec3& place, const Vec3& normal, PointTriangleBlocks& blocks) {
    const std::array<double, 4> weights = corner_weights_of(place);
    std::size_t entry = 0;
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t d = c; d < 4; ++d, ++entry)
            blocks[entry] += weights[c] * weights[d] * normal * normal.transpose();
}

void scale(double factor, PointTriangleBlocks& blocks) {
    for (Mat3& block : blocks) block *= factor;
}

} // namespace

void Slides::begin_stage(const Stage& stage) {
    stage_ = &stage;
    looked_at_.clear(), rounds_ = 0;
    if (slides_.empty()) return;
    const auto& rests = scene_.description().attachments;
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
    std::vector<std::size_t>& next = next_;
    next.assign(rests.size(), 0);
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const Slide& s = slides_[i];
        const SlidingTarget& target = *targets_[s.target];
        const SlidingMemory::Place& kept = kept_.places[at(s.attachment)][next[at(s.attachment)]++];
        heights_[i] = kept.height;
        const ClosestFeature f =
            follow_feature(target.surface(), target.places(), kept.triangle,
                           point_of(s, stage.before.x, stage.before.bones), Vec3::Zero(), allowed(s));
        starts_[i] = start_of(f, target.surface().corners(f.triangle, target.places()));
        nearest_[i] = find_nearest(i, point_of(s, stage.before.x, stage.before.bones));
    }
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
        brake.normal = target.height_over(target.feature_of(f), p).normal;
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
        if (heights_[i] != 0) now_[i].height = target.height_over(nearest_[i].any, points_[i]);
    });
    looked_at_ = x;
}

bool Slides::widen(const Positions& x) {
    constexpr int most_rounds = 6;
    if (slides_.empty() || rounds_ >= most_rounds) return false;
    ++rounds_;
    look_at(x);
    bool changed = false;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const Nearest now = find_nearest(i, points_[i]);
        changed = changed || !(now == nearest_[i]);
        nearest_[i] = now;
    }
    if (changed) looked_at_.clear();
    return changed;
}

Vec3 Slides::way_of_brake(std::size_t i) const {
    const Slide& s = slides_[i];
    const SlidingTarget& target = *targets_[s.target];
    const std::array<Vec3, 3> c = target.surface().corners(brakes_[i].triangle, target.places());
    return points_[i] - brakes_[i].place[0] * c[0] - brakes_[i].place[1] * c[1] - brakes_[i].place[2] * c[2];
}

double Slides::residual(std::size_t i) const {
    const double g = heights_[i], square = now_[i].allowed.away.squaredNorm();
    return g == 0 ? std::sqrt(square) : std::sqrt(std::max(0.0, square + g * (g - 2 * now_[i].height.value)));
}

double Slides::evaluate(const Positions& x, bool with_damping) const {
    if (slides_.empty()) return 0;
    look_at(x);
    const double factor = stage_->form.velocity_factor;
    return ordered_sum(slides_.size(), [&](std::size_t i) {
        const double off = residual(i);
        double energy = 0.5 * stiffness(slides_[i]) * off * off;
        if (with_damping && !brakes_.empty()) {
            const double speed = brakes_[i].normal.dot(factor * way_of_brake(i) + brakes_[i].drift);
            const Slide& s = slides_[i];
            energy += 0.5 * pulls_[at(s.attachment)].viscous * s.area_weight * speed * speed / (factor * factor);
        }
        return energy;
    });
}

double Slides::stored_energy(const Positions& x) { return evaluate(x, false); }

double Slides::energy(const Positions& x, bool with_forces) {
    const double energy = evaluate(x, true);
    if (!with_forces) return energy;
    gradient_.assign(x.size(), 0.0);
    const double factor = stage_->form.velocity_factor;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const Slide& s = slides_[i];
        const double k = stiffness(s);
        const CarriedSurface& target = targets_[s.target]->surface();
        const auto add = [&](PointTriangleElement& element, int triangle, const Vec3& place, const Vec3& force) {
            element.set(ride(s), static_cast<int>(i), target, triangle, scene_.numbering(), *pattern_);
            element.add_gradient(corner_weights_of(place), force, gradient_.data());
        };
        add(elements_[i], now_[i].allowed.triangle, now_[i].allowed.place, k * now_[i].allowed.away);
        if (heights_[i] != 0) {
            const Height& h = now_[i].height;
            add(height_elements_[i], h.triangle, h.place, -k * heights_[i] * h.normal);
        }
        if (brakes_.empty()) continue;
        const Brake& b = brakes_[i];
        const double speed = b.normal.dot(factor * way_of_brake(i) + b.drift);
        add(brake_elements_[i], b.triangle, b.place,
            pulls_[at(s.attachment)].viscous * s.area_weight * speed / factor * b.normal);
    }
    return energy;
}

void Slides::add_gradient(std::span<double> gradient) const {
    if (slides_.empty()) return;
    const std::vector<int>& vertex_of = scene_.numbering().vertex_of_unknown;
    for (std::size_t u = 0; u < vertex_of.size(); ++u)
        for (std::size_t c = 0; c < 3; ++c) gradient[3 * u + c] += gradient_[3 * at(vertex_of[u]) + c];
}

void Slides::add_held_gradient(std::span<double> by_vertices) const {
    if (slides_.empty()) return;
    const std::vector<int>& unknown = scene_.numbering().unknown;
    for (std::size_t v = 0; v < unknown.size(); ++v)
        for (std::size_t c = 3 * v; unknown[v] < 0 && c < 3 * v + 3; ++c) by_vertices[c] += gradient_[c];
}

void Slides::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (slides_.empty()) return;
    look_at(x);
    for (std::size_t i = 0; i < slides_.size(); ++i) {
        const Slide& s = slides_[i];
        const SlidingTarget& target = *targets_[s.target];
        const ClosestFeature& f = now_[i].allowed;
        const Height& h = now_[i].height;
        const double g = heights_[i], k = stiffness(s);
        const auto set = [&](PointTriangleElement& element, int triangle) {
            element.set(ride(s), static_cast<int>(i), target.surface(), triangle, scene_.numbering(), *pattern_);
        };
        set(elements_[i], f.triangle);
        const bool apart = g != 0 && nearest_[i].apart;
        PointTriangleBlocks blocks;
        const bool on_face = (f.place.array() != 0).all();
        if ((g == 0 || apart) && project && on_face) {
            for (Mat3& block : blocks) block.setZero();
            add_square(f.place, face_normal(target.surface(), target.places(), f.triangle), blocks);
        } else if (g == 0 || apart) {
            blocks =
                point_triangle_hessian(target.surface().corners(f.triangle, target.places()), f.place, f.away, project);
        } else {
            // Distance and height are one and the same.
            blocks = target.bend(h, project);
            const double factor = h.value != 0 ? 1 - g / h.value : 0;
            scale(project ? std::max(0.0, factor) : factor, blocks);
            add_square(h.place, h.normal, blocks);
        }
        elements_[i].add_hessian(blocks, k, a);
        if (apart && h.value != 0) {
            set(height_elements_[i], h.triangle);
            const double factor = project ? std::max(0.0, -g / h.value) : -g / h.value;
            if (factor != 0) height_elements_[i].add_hessian(target.bend(h, project), k * factor, a);
        }
        if (brakes_.empty()) continue;
        const Brake& b = brakes_[i];
        set(brake_elements_[i], b.triangle);
        for (Mat3& block : blocks) block.setZero();
        add_square(b.place, b.normal, blocks);
        brake_elements_[i].add_hessian(blocks, pulls_[at(s.attachment)].viscous * s.area_weight, a);
    }
}

void Slides::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    if (slides_.empty()) return;
    const auto& bodies = scene_.numbering().deformables;
    for (std::size_t d = 0; d < bodies.size(); ++d) {
        double square = 0;
        for (std::size_t i = 3 * bodies[d].first_vertex; i < 3 * (bodies[d].first_vertex + bodies[d].vertex_count); ++i)
            square += gradient_[i] * gradient_[i];
        largest[d] = std::max(largest[d], std::sqrt(square));
    }
}

void Slides::add_squared_stiffnesses(std::span<double> squares) const {
    for (const Slide& s : slides_) {
        const AttachmentRest& rest = scene_.description().attachments[at(s.attachment)];
        for (const int body : {rest.source, rest.target})
            if (const int d = scene_.numbering().deformable_of(body); d >= 0)
                squares[at(d)] += stiffness(s) * stiffness(s);
    }
}

} // namespace sinew::solver
