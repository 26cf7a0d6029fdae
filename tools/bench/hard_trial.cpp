// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/hard_trial.h"

#include "solver/error.h"
#include "solver/terms/cloth/sheet.h"
#include "tools/bench/hard_judge.h"
#include "tools/bench/table.h"

#include <algorithm>

namespace sinew::bench {

using namespace solver;

namespace {

/// What an honest "converged" may leave: forces ten times the tolerance, or, where rounding does not let them get
/// there, a Newton step of this share of the body's size.
constexpr double base_tolerance = 1e-6, honest_residual = 10, honest_move = 1e-5;
/// The trapezoid rule may add energy in a step that is much too long for what happens in it; an explosion adds more.
constexpr double honest_energy = 10;
/// What still moves by this share of the body's size in a step is not at rest.
constexpr double at_rest = 1e-3;
/// Between the engine's least det F and that from the vertices.
constexpr double same_det = 1e-5;

double size_of(const Points& points) {
    Vec3 low = points.front(), high = low;
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return (high - low).maxCoeff();
}

} // namespace

const char* name_of(Outcome outcome) {
    switch (outcome) {
    case Outcome::recovered:
        return "recovered";
    case Outcome::elsewhere:
        return "elsewhere";
    case Outcome::stopped:
        return "stopped";
    case Outcome::wrong:
        break;
    }
    return "wrong";
}

HardTrial::HardTrial(const HardSetting& s, std::stop_token stop)
    : setting(s) {
    in.gravity = Vec3::Zero();
    in.integrator = setting.integrator.integrator;
    in.max_newton_iterations = 100;
    in.max_halvings = 3;
    in.step_size = 1.0 / 24;
    in.stiffness_damping = 0.005;
    in.mass_damping = 8;
    control_.stop = [stop = std::move(stop)] { return stop.stop_requested(); };
}

void HardTrial::make(TetMesh mesh, const TissueInputs& values, const Where& held) {
    const std::size_t tets = mesh.tets.size();
    rest = make_tissue(std::move(mesh), setting.law.law, setting.element.kind);
    nodes = nodes_of(*rest);
    if (!is_linear()) edges_ = edges_of(rest->tets.tets);
    rest->fixed_vertices = vertices_where(nodes, held);
    if (setting.law.law == ElasticLaw::anisotropic) rest->stiff_directions.assign(tets, Vec3::UnitX());
    if (!values.fibers.empty()) rest->fibers = {{Points(tets, Vec3::UnitX()), std::vector<double>(tets, 1.0)}};
    description.bodies = {rest};
    in.bodies = {values};
    if (setting.law.law == ElasticLaw::anisotropic) this->values().transverse_anisotropy = 0.5;
}

void HardTrial::make_cloth(const Points& points, const std::vector<Triangle>& triangles, const ClothInputs& values,
                           const Where& held) {
    auto cloth = std::make_shared<ClothRest>();
    cloth->surface = points, cloth->triangles = triangles;
    cloth->warp = warp_directions(points, triangles, Vec3::UnitX());
    cloth->layer_weights = {std::vector<double>(points.size(), 1.0)};
    cloth->fixed_vertices = vertices_where(points, held);
    nodes = points;
    description.bodies = {std::shared_ptr<const ClothRest>(std::move(cloth))};
    in.bodies = {values};
}

void HardTrial::add_twin(const TissueInputs& values) {
    description.bodies.push_back(rest);
    in.bodies.push_back(values);
    std::get<TissueInputs>(in.bodies.back()).transverse_anisotropy = this->values().transverse_anisotropy;
}

void HardTrial::add_bone(const Points& corners) {
    auto bone = std::make_shared<BoneRest>();
    bone->surface = corners, bone->triangles = {{0, 1, 2}};
    description.bodies.emplace_back(std::shared_ptr<const BoneRest>(std::move(bone)));
    in.bodies.push_back(BoneInputs{corners});
}

void HardTrial::attach_root(int tissue, int bone, double stiffness) {
    AttachmentRest a;
    a.source = tissue, a.target = bone;
    a.source_weights.assign(rest->surface.size(), 0.0);
    for (const int v : vertices_where(rest->surface, [](const Vec3& p) { return p.x() < 1e-9; }))
        a.source_weights[static_cast<std::size_t>(v)] = 1;
    description.attachments.push_back(a);
    in.attachments.push_back({stiffness, 1, 0});
}

void HardTrial::start() {
    scene_ = std::make_shared<const Scene>(description);
    workspace_ = std::make_unique<Workspace>(scene_);
    state = initial_state(*scene_, in);
    most_energy_ = INFINITY;
}

void HardTrial::place(const Where& which, const Map& to) {
    for (std::size_t v = 0; v < nodes.size(); ++v)
        if (which(nodes[v])) set_position(state.x, static_cast<int>(v), to(nodes[v]));
    state.history = {}; // there is no past that leads here
    most_energy_ = INFINITY;
}

void HardTrial::move_bone(int body, const Map& to) {
    for (Vec3& p : std::get<BoneInputs>(in.bodies[static_cast<std::size_t>(body)]).positions) p = to(p);
    most_energy_ = INFINITY;
}

void HardTrial::leave_alone() {
    HoldingForces(*rest, values()).at(state.x, &most_energy_);
    most_energy_ += kinetic_energy();
}

void HardTrial::run(int static_steps, double seconds) {
    const int count = is_static() ? static_steps : static_cast<int>(std::ceil(seconds / in.step_size - 1e-9));
    for (int i = 0; i < count; ++i) step();
}

void HardTrial::come_to_rest() {
    if (is_static()) return;
    const double frame = in.step_size;
    in.step_size = 2;
    for (int i = 0; i < 6; ++i) step();
    in.step_size = frame;
}

void HardTrial::step() {
    const State before = state;
    state = advance(*workspace_, before, {&in, 1}, control_);
    moved_ = 0;
    for (std::size_t v = 0; v < nodes.size(); ++v)
        moved_ =
            std::max(moved_, (position(state.x, static_cast<int>(v)) - position(before.x, static_cast<int>(v))).norm());
    ++steps;
    newton += state.record.newton_iterations, halvings += state.record.halvings;
    unconverged += !state.record.converged;
    judge(before);
    in_a_row_ = state.record.converged ? 0 : in_a_row_ + 1;
    if (in_a_row_ == most_in_a_row) throw Error("FE301", "steps no longer converge");
}

void HardTrial::judge(const State& before) {
    const std::string at = "step " + std::to_string(steps) + ": ";
    if (const std::string odd = not_a_number(state); !odd.empty()) throw WrongAnswer{at + odd};
    const StepRecord& r = state.record;
    if (rest) {
        const double det = least_det(*scene_, state.x) / volume_at_rest;
        const bool same = is_linear() ? std::abs(det - r.min_j) <= same_det * std::max(1.0, std::abs(det))
                                      : r.min_j <= det + same_det * std::max(1.0, std::abs(det));
        if (!same) throw WrongAnswer{at + "least det F is " + number(det) + ", not " + number(r.min_j)};
    }
    if ((r.min_j <= 0) != (r.inverted > 0)) throw WrongAnswer{at + "the count of inverted tets is not that of det F"};
    if (!r.converged) return;
    if (const double energy = r.energy + (std::isfinite(most_energy_) && !is_static() ? kinetic_energy() : 0);
        energy > honest_energy * most_energy_ + 1e-9)
        throw WrongAnswer{at + "energy " + number(energy) + " J came out of " + number(most_energy_)};
    if (r.halvings > 0) return; // several steps: their equations cannot be made again from outside
    const StepCheck check = check_step(*scene_, before, in, state);
    if (!(check.residual <= honest_residual * base_tolerance * in.tolerance_factor) &&
        !(check.move <= honest_move * size_of(nodes)))
        throw WrongAnswer{at + "called converged with forces of " + number(check.residual) +
                          " left over and a Newton step of " + number(check.move) + " m to go"};
    definite_ = check.definite;
}

Vec3 HardTrial::mean_of(const Tet& tet, const std::vector<double>& values) const {
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
        mean += (is_linear() ? 0.25 : -0.05) * position(values, tet[i]);
        for (std::size_t j = 0; j < i && !is_linear(); ++j) {
            const std::array<int, 2> edge{std::min(tet[i], tet[j]), std::max(tet[i], tet[j])};
            const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge) - edges_.begin();
            mean += 0.2 * position(values, static_cast<int>(rest->tets.vertices.size()) + static_cast<int>(found));
        }
    }
    return mean;
}

double HardTrial::volume_of(const Tet& tet) const {
    const auto corner = [&](std::size_t i) { return nodes[static_cast<std::size_t>(tet[i])]; };
    return tet_volume(corner(0), corner(1), corner(2), corner(3));
}

double HardTrial::kinetic_energy() const {
    const double density = std::get<TissueInputs>(in.bodies[0]).layers[0].mass_density;
    double sum = 0;
    for (const Tet& tet : rest->tets.tets) sum += 0.5 * density * volume_of(tet) * mean_of(tet, state.v).squaredNorm();
    return sum;
}

double HardTrial::distance_from(const Map& to) const {
    double worst = 0;
    for (std::size_t v = 0; v < nodes.size(); ++v)
        worst = std::max(worst, (position(state.x, static_cast<int>(v)) - to(nodes[v])).norm());
    return worst;
}

double HardTrial::distance_from(const HardTrial& other) const {
    double worst = 0;
    for (std::size_t v = 0; v < nodes.size(); ++v)
        worst = std::max(
            worst, (position(state.x, static_cast<int>(v)) - position(other.state.x, static_cast<int>(v))).norm());
    return worst;
}

double HardTrial::distortion(const Mat3& to) const {
    double worst = 0;
    for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
            worst = std::max(
                worst,
                std::abs((position(state.x, static_cast<int>(a)) - position(state.x, static_cast<int>(b))).norm() -
                         (to * (nodes[a] - nodes[b])).norm()));
    return worst;
}

Vec3 HardTrial::centre() const {
    Vec3 sum = Vec3::Zero();
    double volume = 0;
    for (const Tet& tet : rest->tets.tets) {
        sum += volume_of(tet) * mean_of(tet, state.x);
        volume += volume_of(tet);
    }
    return sum / volume;
}

void HardTrial::must(bool there, const std::string& what, Equilibria equilibria) {
    const StepRecord& r = state.record;
    const std::string end = "least det F " + number(r.min_j) + ", energy " + number(r.energy) + " J, " + what;
    if (!r.converged) {
        outcome = Outcome::stopped, why = "FE301";
    } else if (!definite_) {
        throw WrongAnswer{"ends on a ridge: the Hessian is not positive definite; " + end};
    } else if (there) {
        outcome = Outcome::recovered;
    } else if (equilibria == Equilibria::several && moved_ <= at_rest * size_of(nodes)) {
        outcome = Outcome::elsewhere, why = end;
    } else {
        throw WrongAnswer{"ends elsewhere, " + end + "; the last step moved by " + number(moved_) + " m"};
    }
}

} // namespace sinew::bench
