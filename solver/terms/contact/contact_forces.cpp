// Contact within a stage: who may touch, energy, gradient and Hessian.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/index.h"
#include "solver/parallel.h"
#include "solver/terms/contact/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::solver {

namespace {

/// Bodies are looked at as if they came nearer by this share of the mean edge, so that what rests on something keeps
/// the same touches, and what moves about as expected needs no second look.
constexpr double resting_share = 0.25;

/// Whether a stiffness ties what carries a contact so firmly to each other that a factor which does not know of it is
/// of little use.
bool is_strong(const PointTriangleElement& element, const Vec3& place, double stiffness, const BlockMatrix& a) {
    constexpr double strong = 0.7;
    const auto [source, target] = element.stiffness_below(corner_weights_of(place), a);
    const double one = source > 0 ? stiffness / (source + stiffness) : 1,
                 other = target > 0 ? stiffness / (target + stiffness) : 1;
    return one * other > strong * strong;
}

/// Second derivatives of half the squared depth in a surface that pushes from a range on. With the gap g = range -
/// depth they are n n^T - depth g'', where g g'' + n n^T is what the squared distance has.
PointTriangleBlocks thick_hessian(const std::array<Vec3, 3>& corners, const Vec3& place, const Vec3& away,
                                  const Vec3& out, double depth, double range, bool project) {
    constexpr double least_gap = 1e-6; // of the range; nearer than that rounding is all that g'' would be made of
    PointTriangleBlocks along;
    for (Mat3& block : along) block.setZero();
    add_square(place, out * out.transpose(), along);
    const double gap = range - depth;
    if (project || std::abs(gap) < least_gap * range) return along;
    PointTriangleBlocks blocks = point_triangle_hessian(corners, place, away, false);
    for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b] = along[b] - depth / gap * (blocks[b] - along[b]);
    return blocks;
}

double largest_move(const double* a, const double* b, std::size_t vertices) {
    double largest = 0;
    for (std::size_t v = 0; v < vertices; ++v)
        largest =
            std::max(largest, (Eigen::Map<const Vec3>(a + 3 * v) - Eigen::Map<const Vec3>(b + 3 * v)).squaredNorm());
    return std::sqrt(largest);
}

} // namespace

const double* Contacts::carriers_before(int body) const {
    const CollisionBody& b = bodies_[body];
    return b.deforms() ? stage_->before.x.data() : stage_->before.bones[at(b.body())].data()->data();
}

const double* Contacts::carriers_expected(int body) const {
    if (!bodies_[body].deforms()) return bones_[at(body)].data()->data();
    return stage_->form.mass_factor > 0 ? stage_->form.target.data() : carriers_before(body);
}

bool Contacts::stands(int body) const {
    return bodies_[body].deforms() && is_frozen(stage_->inputs.bodies[at(scene_.carrier_of(bodies_[body].body()))]);
}

Vec3 Contacts::place_at(int target, int triangle, const Vec3& place) const {
    const std::array<Vec3, 3> c = bodies_[target].corners(triangle, places_[at(target)]);
    return place[0] * c[0] + place[1] * c[1] + place[2] * c[2];
}

ClosestFeature Contacts::feature_at(std::size_t i) const {
    const Touch& t = touches_[i];
    return follow_feature(bodies_[t.target], places_[at(t.target)], starts_[i], point_at(t));
}

Vec3 Contacts::offset_of(const ContactPair& pair, int side, const ClosestFeature& f) const {
    if (pair.slides || !(pair.range > 0)) return Vec3::Zero(); // sliding contacts are held along the surface alone
    return (side < 0 ? -pair.range : pair.range) * f.normal.normalized();
}

void Contacts::place_points(int body, const double* carriers) const {
    Points& places = places_[at(body)];
    places.resize(bodies_[body].point_count());
    parallel_for(places.size(), 512,
                 [&](std::size_t p) { places[p] = bodies_[body].place(static_cast<int>(p), carriers); });
}

void Contacts::look_at(const Positions& x) const {
    parallel_for(bodies_.count(), 1, [&](std::size_t b) {
        if (!bodies_[static_cast<int>(b)].deforms()) return;
        place_points(static_cast<int>(b), x.data());
        // Until it is known what touches nobody asks; what is found later has it looked at anew.
        if (!touches_.empty()) moves_[b] = search_.farthest_way(static_cast<int>(b), places_[b]);
    });
}

void Contacts::bind(const BlockPattern& pattern) {
    pattern_ = &pattern;
    for (PointTriangleElement& e : elements_) e.forget();
    for (PointTriangleElement& e : tether_elements_) e.forget();
}

/// Stiffens what collides to how many times it counts in the stage.
void Contacts::count_presses(std::vector<ContactPair>& pairs) const {
    const double times = stage_->form.press;
    if (times == 0) pairs.clear();
    for (ContactPair& pair : pairs) pair.stiffness *= times, pair.damping *= times;
}

void Contacts::begin_stage(const Stage& stage) {
    stage_ = &stage;
    bodies_.find_pairs(stage.inputs.parts, pairs_);
    count_presses(pairs_);
    held_.resize(pairs_.size());
    for (std::size_t p = 0; p < pairs_.size(); ++p) attached_.find(pairs_[p], stage.inputs.attachments, held_[p]);
    begin_cloth();
    const auto weighed = bones_weighed(stage.form, stage.before, stage.bones_after);
    before_.clear();
    expected_.clear();
    for (std::size_t b = 0; b < bodies_.count(); ++b) {
        const CollisionBody& body = bodies_[static_cast<int>(b)];
        before_.push_back(carriers_before(static_cast<int>(b)));
        if (!body.deforms()) {
            Points& places = bones_[b];
            place_bone(stage.form, weighed, at(body.body()), places);
            place_points(static_cast<int>(b), places.data()->data());
        }
        expected_.push_back(carriers_expected(static_cast<int>(b)));
    }
    found_ = false;
    looked_at_.clear();
    one_ago_.clear(), two_ago_.clear(), tried_.clear(), edges_.clear(), tries_ = on_edges_ = by_edges_ = false;
}

/// Who may touch, once somebody asks for forces: marks need no search.
void Contacts::find_all_touches() {
    if (found_) return;
    found_ = true;
    search_.begin(before_);
    sweep(expected_);
    touches_.clear(), pair_of_touch_.clear(), clearance_.clear(), areas_.clear(), starts_.clear();
    now_.clear(), forces_.clear(); // where no pair is left nothing else does
    for (PointTriangleElement& e : elements_) e.forget();
    strong_.assign(pairs_.size(), 0);
    dropped_ = 0;
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        const std::size_t first = touches_.size();
        dropped_ += search_.take_kept(pairs_[p], kept_.contacts, held_[p], touches_);
        find_touches(p, first);
    }
    make_tethers();
    begin_cloth_search();
}

void Contacts::sweep(const std::vector<const double*>& later) {
    swept_.resize(bodies_.count());
    for (std::size_t b = 0; b < bodies_.count(); ++b) {
        const std::span<const double> own = bodies_[static_cast<int>(b)].own(later[b]);
        swept_[b].assign(own.begin(), own.end());
    }
    search_.sweep(later);
    for (std::size_t b = 0; b < bodies_.count(); ++b)
        if (!bodies_[static_cast<int>(b)].deforms()) moves_[b] = search_.farthest_swept(static_cast<int>(b));
}

/// Takes in the points of a pair whose way crosses that of the surface. Its touches so far are all from `first` on.
void Contacts::find_touches(std::size_t p, std::size_t first) {
    search_.find_near(pairs_[p], resting_share * bodies_[pairs_[p].target].mean_edge(), held_[p], first, touches_);
    pair_of_touch_.resize(touches_.size(), p), areas_.resize(touches_.size(), -1);
    for (std::size_t t = clearance_.size(); t < touches_.size(); ++t) {
        const ClosestFeature& f = touches_[t].feature;
        const CollisionBody& target = bodies_[touches_[t].target];
        starts_.push_back(start_of(f, target.corners(f.triangle, before_[at(touches_[t].target)])));
        // Nothing is sure where the place was followed: it may not be the nearest of all.
        const double depth = press(t, f).depth;
        clearance_.push_back(depth > 0 || touches_[t].kept >= 0 ? -1 : -depth);
    }
    now_.resize(touches_.size()), forces_.resize(touches_.size());
    looked_at_.clear();
    if (elements_.size() < touches_.size()) elements_.resize(touches_.size());
}

/// A point's velocity is factor x place + this: of what deforms the form's offset, of bones as they move.
Vec3 Contacts::drift_of(int b, int point) const {
    const ImplicitForm& form = stage_->form;
    const CollisionBody& body = bodies_[b];
    if (body.deforms()) return body.place(point, form.velocity_offset.data());
    const auto weighed = bones_weighed(form, stage_->before, stage_->bones_after);
    Vec3 out = -form.velocity_factor * body.place(point, bones_[at(b)].data()->data());
    for (std::size_t time = 0; time < 3; ++time)
        if (form.bone_velocity[time] != 0)
            out += form.bone_velocity[time] * body.place(point, (*weighed[time])[at(body.body())].data()->data());
    return out;
}

void Contacts::make_tethers() {
    tethers_.clear();
    const ImplicitForm& form = stage_->form;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        const Touch& t = touches_[i];
        const ContactPair& pair = pair_of(i);
        if (t.kept < 0) continue;
        const KeptContact& was = kept_.contacts[at(t.kept)];
        const double k = stiffness(i), c = form.velocity_factor > 0 ? pair.damping * areas_[i] : 0;
        const double length = t.feature.normal.norm();
        const Vec3 n = length > 0 ? Vec3(t.feature.normal / length) : Vec3(Vec3::Zero());
        const Mat3 across = n * n.transpose();
        Tether anchored;
        anchored.touch = i, anchored.triangle = was.anchor_triangle;
        anchored.place = Vec3(was.anchor[0], was.anchor[1], was.anchor[2]);
        anchored.spring.stiffness = k;
        if (!pair.slides) {
            anchored.holds = Mat3::Identity(), anchored.spring.most = std::numeric_limits<double>::infinity();
            anchored.brakes = c * Mat3::Identity();
            anchored.offset = offset_of(pair, t.side, t.feature);
            tethers_.push_back(anchored);
            continue;
        }
        anchored.holds = Mat3::Identity() - across,
        anchored.spring.most = stage_->form.press * pair.friction * was.force;
        if (anchored.spring.most > 0) {
            anchored.followed = FollowedForce(anchored.spring.force(held_before(anchored)));
            tethers_.push_back(anchored);
        }
        if (c > 0) {
            Tether braked;
            braked.touch = i, braked.triangle = t.feature.triangle, braked.place = t.feature.place;
            braked.brakes = c * across;
            tethers_.push_back(braked);
        }
    }
    first_ties_ = tethers_.size();
    tether_forces_.resize(tethers_.size());
    if (tether_elements_.size() < tethers_.size()) tether_elements_.resize(tethers_.size());
    for (PointTriangleElement& e : tether_elements_) e.forget();
    for (Tether& tether : tethers_) {
        if (tether.brakes.isZero(0)) continue;
        const Touch& t = touches_[tether.touch];
        tether.drift = drift_of(t.source, t.point);
        const Triangle& corners = bodies_[t.target].triangles()[at(tether.triangle)];
        for (int c = 0; c < 3; ++c) tether.drift -= tether.place[c] * drift_of(t.target, corners[at(c)]);
    }
}

double Contacts::begin_iteration(const Positions& x) {
    find_all_touches();
    find_features(x);
    if (!cloth_pairs_.empty()) cloth_.accept();
    for (std::size_t i = 0; i < touches_.size(); ++i)
        if (now_[i].triangle >= 0 && press(i, now_[i]).depth > 0) clearance_[i] = -1;
    watch_features();
    follow_friction();
    return 0;
}

bool Contacts::renew(const Positions& x) {
    find_all_touches();
    return renew_friction(x);
}

bool Contacts::widen(const Positions& x) {
    find_all_touches();
    const bool more_cloth = widen_cloth(x), more = look_farther(x);
    return more_cloth || more;
}

/// Looks again for who may touch, now that it is known where bodies are; whether any such point presses.
bool Contacts::look_farther(const Positions& x) {
    // Where nothing is farther from where it was looked for than the margin, all is known.
    expected_.clear();
    off_.resize(bodies_.count());
    for (std::size_t b = 0; b < bodies_.count(); ++b) {
        const CollisionBody& body = bodies_[static_cast<int>(b)];
        expected_.push_back(carriers(static_cast<int>(b), x));
        const std::span<const double> own = body.own(expected_.back());
        off_[b] = body.leverage() * largest_move(own.data(), swept_[b].data(), own.size() / 3);
    }
    if (std::all_of(pairs_.begin(), pairs_.end(), [&](const ContactPair& pair) {
            return off_[at(pair.source)] + off_[at(pair.target)] <= resting_share * bodies_[pair.target].mean_edge();
        }))
        return false;
    sweep(expected_);
    const std::size_t known = touches_.size();
    for (std::size_t p = 0; p < pairs_.size(); ++p) find_touches(p, 0);
    look_at(x);
    for (std::size_t i = known; i < touches_.size(); ++i)
        if (const ClosestFeature f = unfolded(i, feature_at(i)); f.triangle >= 0 && presses(i, press(i, f).depth))
            return true;
    return false;
}

/// The tether's way at the start of the step, as its spring sees it.
Vec3 Contacts::held_before(const Tether& tether) const {
    const Touch& t = touches_[tether.touch];
    const CollisionBody &source = bodies_[t.source], &target = bodies_[t.target];
    Vec3 way = source.place(t.point, before_[at(t.source)]) - tether.offset;
    const Triangle& corners = target.triangles()[at(tether.triangle)];
    for (int c = 0; c < 3; ++c) way -= tether.place[c] * target.place(corners[at(c)], before_[at(t.target)]);
    return tether.holds * way;
}

Vec3 Contacts::reach(const Tether& tether) const {
    const Touch& t = touches_[tether.touch];
    return point_at(t) - place_at(t.target, tether.triangle, tether.place) - tether.offset;
}

/// With `stored` only what it stores, there.
Contacts::Force Contacts::tether_force(const Tether& tether, double* stored) const {
    const Vec3 way = reach(tether), held = tether.holds * way;
    Force out{tether.spring.energy(held), tether.spring.force(held)};
    if (stored) *stored = out.energy;
    const double factor = stage_->form.velocity_factor;
    if (factor > 0 && !tether.brakes.isZero(0)) {
        const Vec3 velocity = factor * way + tether.drift, force = tether.brakes * velocity;
        out.energy += 0.5 * force.dot(velocity) / factor;
        out.by_point += force;
    }
    return out;
}

/// The nearest places at x, of all touches that are not surely outside.
void Contacts::find_features(const Positions& x) const {
    if (x == looked_at_ && !x.empty()) return;
    look_at(x);
    parallel_for(touches_.size(), 64, [&](std::size_t i) {
        if (surely_outside(i))
            now_[i].triangle = -1;
        else
            now_[i] = unfolded(i, feature_at(i));
        if (on_edges_ && edges_[i][0] >= 0) now_[i] = on_edge(i);
    });
    if (tries_ && !on_edges_) tried_ = now_, tries_ = false;
    cloth_.find_presses(places_, presses_);
    looked_at_ = x;
}

double Contacts::evaluate(const Positions& x, bool with_damping) {
    find_all_touches();
    find_features(x);
    parallel_for(touches_.size(), 64, [&](std::size_t i) {
        forces_[i] = {};
        if (now_[i].triangle < 0) return;
        const Press pressed = press(i, now_[i]);
        if (!presses(i, pressed.depth)) return;
        const double k = stiffness(i);
        forces_[i] = {0.5 * k * pressed.depth * pressed.depth, -k * pressed.depth * pressed.out};
    });
    parallel_for(tethers_.size(), 64, [&](std::size_t i) {
        double stored = 0;
        tether_forces_[i] = tether_force(tethers_[i], &stored);
        if (!with_damping) tether_forces_[i].energy = stored;
    });
    return ordered_sum(forces_.size(), [&](std::size_t i) { return forces_[i].energy; }) +
           ordered_sum(tether_forces_.size(), [&](std::size_t i) { return tether_forces_[i].energy; }) +
           evaluate_cloth(with_damping);
}

double Contacts::stored_energy(const Positions& x) { return evaluate(x, false); }

void Contacts::add_tether_forces() {
    for (std::size_t i = 0; i < tethers_.size(); ++i) {
        const Tether& tether = tethers_[i];
        const Touch& t = touches_[tether.touch];
        tether_elements_[i].set_nodes(bodies_[t.source].free_ride(t.point), bodies_[t.target], tether.triangle,
                                      scene_.numbering());
        tether_elements_[i].add_gradient(corner_weights_of(tether.place), tether_forces_[i].by_point, gradient_.data());
    }
}

double Contacts::energy(const Positions& x, bool with_forces) {
    if (as_before_) return carried_energy(x, with_forces);
    const double energy = evaluate(x, true);
    if (!with_forces) return energy;
    gradient_.clear(x.size());
    pressing_.clear();
    for (std::size_t i = 0; i < touches_.size(); ++i)
        if (!forces_[i].by_point.isZero(0)) pressing_.push_back(i);
    parallel_for(pressing_.size(), 64, [&](std::size_t k) {
        const std::size_t i = pressing_[k];
        const Touch& t = touches_[i];
        elements_[i].set_nodes(bodies_[t.source].free_ride(t.point), bodies_[t.target], now_[i].triangle,
                               scene_.numbering());
    });
    for (const std::size_t i : pressing_)
        elements_[i].add_gradient(corner_weights_of(now_[i].place), forces_[i].by_point, gradient_.data());
    add_tether_forces();
    add_cloth_forces();
    return energy;
}

void Contacts::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (as_before_) return add_carried_hessian(x, a);
    find_features(x);
    pressing_.clear();
    for (std::size_t i = 0; i < touches_.size(); ++i)
        if (now_[i].triangle >= 0 && presses(i, press(i, now_[i]).depth)) pressing_.push_back(i);
    blocks_.resize(pressing_.size());
    parallel_for(pressing_.size(), 16, [&](std::size_t k) {
        const std::size_t i = pressing_[k];
        const Touch& t = touches_[i];
        const ClosestFeature& f = now_[i];
        const Press pressed = press(i, f);
        elements_[i].set(bodies_[t.source].free_ride(t.point), bodies_[t.target], f.triangle, scene_.numbering(),
                         *pattern_);
        const std::array<Vec3, 3> corners = bodies_[t.target].corners(f.triangle, places_[at(t.target)]);
        blocks_[k] = pair_of(i).range > 0 ? thick_hessian(corners, f.place, f.away, pressed.out, pressed.depth,
                                                          pair_of(i).range, project)
                                          : point_triangle_hessian(corners, f.place, f.away, project);
    });
    // Touches share entries, and what is strong is so beside what was added before.
    for (std::size_t k = 0; k < pressing_.size(); ++k) {
        const std::size_t i = pressing_[k];
        if (neither_stands(i) && !elements_[i].coupled() && is_strong(elements_[i], now_[i].place, stiffness(i), a))
            strong_[pair_of_touch_[i]] = 1;
        elements_[i].add_hessian(blocks_[k], stiffness(i), a);
    }
    add_tether_hessian(a);
    add_cloth_hessian(project, a);
}

void Contacts::add_tether_hessian(BlockMatrix& a) {
    for (std::size_t i = 0; i < tethers_.size(); ++i) {
        const Tether& tether = tethers_[i];
        const Touch& t = touches_[tether.touch];
        tether_elements_[i].set(bodies_[t.source].free_ride(t.point), bodies_[t.target], tether.triangle,
                                scene_.numbering(), *pattern_);
        const Mat3 by_way = stage_->form.velocity_factor * tether.brakes +
                            tether.followed.stiffness(tether.spring, tether.holds * reach(tether), tether.holds);
        PointTriangleBlocks blocks;
        for (Mat3& block : blocks) block.setZero();
        add_square(tether.place, by_way, blocks);
        if (neither_stands(tether.touch) && !tether_elements_[i].coupled() &&
            is_strong(tether_elements_[i], tether.place, tether.spring.stiffness, a))
            strong_[pair_of_touch_[tether.touch]] = 1;
        tether_elements_[i].add_hessian(blocks, 1, a);
    }
}

void Contacts::add_squared_stiffnesses(std::span<double> squares) const {
    const Numbering& numbering = scene_.numbering();
    const auto add = [&](int body, double k) {
        const int d = numbering.deformable_of(bodies_[body].body());
        if (d >= 0) squares[at(d)] += k * k;
    };
    for (std::size_t i = 0; i < touches_.size(); ++i) {
        if (forces_[i].energy == 0) continue;
        const double k = stiffness(i);
        add(touches_[i].source, k), add(touches_[i].target, k);
    }
    for (const Tether& t : tethers_)
        add(touches_[t.touch].source, t.spring.stiffness), add(touches_[t.touch].target, t.spring.stiffness);
    for (const ClothContact::Press& p : presses_)
        for (const std::size_t c : {std::size_t{0}, std::size_t{3}}) add(cloth_.body_of(p.corners[c]), p.rise());
}

} // namespace sinew::solver
