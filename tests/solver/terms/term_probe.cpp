// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/integrate/implicit_form.h"
#include "tests/support/grid_matrix.h"
#include "tests/support/term_checks.h"

#include <catch2/catch.hpp>

namespace sinew::test {

using namespace solver;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int steps_before = 2;

Positions positions(const VectorXd& x) { return {x.data(), x.data() + x.size()}; }

void move(Points& points, const Mat3& turn, const Vec3& shift) {
    for (Vec3& p : points) p = turn * p + shift;
}

void move(std::vector<double>& x, const Mat3& turn, const Vec3& shift) {
    for (std::size_t i = 0; i < x.size(); i += 3) {
        Eigen::Map<Vec3> p(x.data() + i);
        p = Vec3(turn * p + shift);
    }
}

void move(StepInputs& in, const Mat3& turn, const Vec3& shift) {
    in.gravity = turn * in.gravity;
    for (BodyInputs& b : in.bodies) {
        if (auto* t = std::get_if<TissueInputs>(&b)) move(t->forces, turn, Vec3::Zero());
        if (auto* bone = std::get_if<BoneInputs>(&b)) move(bone->positions, turn, shift);
    }
}

void move(State& s, const Mat3& turn, const Vec3& shift) {
    move(s.x, turn, shift);
    move(s.v, turn, Vec3::Zero());
    for (Points& b : s.bones) move(b, turn, shift);
    move(s.history.x, turn, shift);
    move(s.history.v, turn, Vec3::Zero());
    move(s.history.acceleration, turn, Vec3::Zero());
    for (Points& b : s.history.bones) move(b, turn, shift);
}

} // namespace

TermProbe::TermProbe(const TermExample& example, int fineness, const Mat3& turn, const Vec3& shift)
    : made_(example.make(fineness)) {
    const Scene& scene = *made_.scene;
    Workspace workspace(made_.scene);
    before_ = initial_state(scene, made_.inputs(0));
    for (int k = 1; k <= steps_before; ++k) {
        const StepInputs in = made_.inputs(k);
        before_ = advance(workspace, before_, std::span(&in, 1));
    }
    inputs_ = made_.inputs(steps_before + 1);
    move(inputs_, turn, shift);
    move(before_, turn, shift);
    bones_.resize(inputs_.bodies.size());
    for (std::size_t b = 0; b < bones_.size(); ++b)
        if (const auto* bone = std::get_if<BoneInputs>(&inputs_.bodies[b])) bones_[b] = bone->positions;

    term_ = example.type->make(scene);
    REQUIRE(term_);
    term_->take(inputs_, before_);
    Couplings by_vertex, couplings;
    term_->add_couplings(by_vertex);
    for (const auto& [v, w] : by_vertex) {
        const int i = numbering().unknown[std::size_t(v)], j = numbering().unknown[std::size_t(w)];
        if (i >= 0 && j >= 0) couplings.emplace_back(i, j);
    }
    pattern_ = std::make_unique<BlockPattern>(make_pattern(int(numbering().unknown_count()), std::move(couplings)));
    term_->bind(*pattern_);
    backward_euler_form(before_, inputs_.step_size, form_);
    stage_ = std::make_unique<Stage>(Stage{inputs_, before_, form_, bones_});
    term_->begin_stage(*stage_);
}

void TermProbe::widen(const VectorXd& x) { term_->widen(positions(x)); }

double TermProbe::energy(const VectorXd& x) { return term_->energy(positions(x), false); }

double TermProbe::scale(const VectorXd& x) { return std::max(std::abs(energy(x)), term_->energy_scale()); }

VectorXd TermProbe::gradient(const VectorXd& x) {
    term_->energy(positions(x), true);
    VectorXd of_unknowns = VectorXd::Zero(Eigen::Index(3 * numbering().unknown_count()));
    term_->add_gradient({of_unknowns.data(), std::size_t(of_unknowns.size())});
    VectorXd out = VectorXd::Zero(x.size());
    term_->add_held_gradient({out.data(), std::size_t(out.size())});
    return out + spread(of_unknowns);
}

BlockMatrix TermProbe::hessian_blocks(const VectorXd& x, bool project) {
    BlockMatrix a(*pattern_);
    const Positions at = positions(x);
    term_->energy(at, true);
    term_->add_hessian(at, project, a);
    a.overlay.finish(pattern_->rows);
    return a;
}

MatrixXd TermProbe::hessian(const VectorXd& x, bool project) { return dense(hessian_blocks(x, project)); }

VectorXd TermProbe::spread(const VectorXd& of_unknowns) const {
    VectorXd out = VectorXd::Zero(Eigen::Index(3 * numbering().vertex_count()));
    for (std::size_t u = 0; u < numbering().unknown_count(); ++u)
        out.segment<3>(3 * numbering().vertex_of_unknown[u]) = of_unknowns.segment<3>(Eigen::Index(3 * u));
    return out;
}

VectorXd TermProbe::gather(const VectorXd& of_vertices) const {
    VectorXd out(Eigen::Index(3 * numbering().unknown_count()));
    for (std::size_t u = 0; u < numbering().unknown_count(); ++u)
        out.segment<3>(Eigen::Index(3 * u)) = of_vertices.segment<3>(3 * numbering().vertex_of_unknown[u]);
    return out;
}

std::vector<Pose> poses(const TermProbe& probe) {
    const Numbering& numbering = probe.numbering();
    const VectorXd rest = as_vector(numbering.rest), start = as_vector(probe.before().x);
    VectorXd noise = as_vector(random_numbers(std::size_t(rest.size()), 7)), mirrored = start, flat = start,
             point = start;
    for (const Deformable& d : numbering.deformables) {
        Vec3 centre = Vec3::Zero();
        for (std::size_t v = d.first_vertex; v < d.first_vertex + d.vertex_count; ++v)
            centre += start.segment<3>(Eigen::Index(3 * v)) / double(d.vertex_count);
        for (std::size_t v = d.first_vertex; v < d.first_vertex + d.vertex_count; ++v) {
            const auto i = Eigen::Index(3 * v);
            noise.segment<3>(i) *= d.spacing;
            mirrored[i] = 2 * centre.x() - start[i];
            flat[i + 2] = centre.z();
            point.segment<3>(i) = centre;
        }
    }
    return {{"near", start + 0.05 * noise},
            {"far", start + 0.6 * noise, true},
            {"mirrored", mirrored + 0.05 * noise, true},
            {"in a plane", flat, true, false},
            {"in a point", point, true, false}};
}

} // namespace sinew::test
