// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/dynamics.h"

#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace sinew::solver {

void Dynamics::set_masses(const BlockPattern& pattern, const std::vector<std::unique_ptr<Term>>& terms) {
    masses_.start(numbering_, pattern);
    for (const auto& term : terms) term->add_masses(masses_);
}

void Dynamics::take(const StepInputs& inputs) {
    inputs_ = &inputs;
    loads_.clear();
    for (const Deformable& d : numbering_.deformables) {
        const BodyInputs& body = inputs.bodies[static_cast<std::size_t>(d.body)];
        const auto* cloth = std::get_if<ClothInputs>(&body);
        const Points& forces = cloth ? cloth->forces : std::get<TissueInputs>(body).forces;
        if (forces.empty()) continue;
        loads_.resize(3 * numbering_.vertex_count(), 0.0);
        double* out = loads_.data() + 3 * d.first_vertex;
        for (std::size_t v = 0; v < forces.size(); ++v)
            for (std::size_t c = 0; c < 3; ++c) out[3 * v + c] = forces[v][static_cast<Eigen::Index>(c)];
    }
}

void Dynamics::begin_step(const Positions& x_before, const StepInputs& inputs) {
    x_before_ = x_before;
    take(inputs);
}

double Dynamics::energy(const Positions& x, double& scale) {
    const std::size_t n = numbering_.unknown_count();
    const double alpha = mass_damping();
    // Inertia and mass damping: M (m (x - target) + alpha v).
    offset_.resize(3 * n);
    parallel_for(n, 4096, [&](std::size_t u) {
        for (std::size_t c = 0; c < 3; ++c)
            offset_[3 * u + c] = x[3 * vertex(u) + c] - form_->target[3 * vertex(u) + c];
    });
    const auto held = [&](std::vector<double>& of_vertex, double factor, const std::vector<double>& shift,
                          double shift_factor) {
        if (masses_.held().empty()) return;
        of_vertex.resize(x.size());
        for (const MassMatrix::Held& h : masses_.held())
            for (std::size_t c = 3 * static_cast<std::size_t>(h.vertex), k = 0; k < 3; ++k, ++c)
                of_vertex[c] = factor * x[c] + shift_factor * shift[c];
    };
    // Of 1/2 (u + h) M (u + h), h what held vertices do, the part that depends on u; its gradient is M (u + h).
    const auto half_square = [&](const std::vector<double>& u, const std::vector<double>& of_held,
                                 std::vector<double>& m_u) {
        masses_.multiply(u, m_u);
        const double own = 0.5 * ordered_sum(3 * n, [&](std::size_t i) { return u[i] * m_u[i]; });
        return own + masses_.add_held(of_held, u, m_u);
    };
    double total = 0;
    if (form_->mass_factor > 0) {
        held(held_offset_, 1, form_->target, -1);
        total += form_->mass_factor * half_square(offset_, held_offset_, inertia_);
    }
    if (alpha > 0) {
        velocity_.resize(3 * n);
        parallel_for(n, 4096, [&](std::size_t u) {
            const std::size_t v = 3 * vertex(u);
            for (std::size_t c = 0; c < 3; ++c)
                velocity_[3 * u + c] = form_->velocity_factor * x[v + c] + form_->velocity_offset[v + c];
        });
        held(held_speed_, form_->velocity_factor, form_->velocity_offset, 1);
        total += alpha / form_->velocity_factor * half_square(velocity_, held_speed_, drag_);
    }
    const std::vector<double>& weight = masses_.weight();
    const double gravity = -ordered_sum(n, [&](std::size_t u) {
        const std::size_t v = vertex(u);
        double w = 0;
        for (std::size_t c = 0; c < 3; ++c)
            w += inputs_->gravity[static_cast<Eigen::Index>(c)] * (x[3 * v + c] - x_before_[3 * v + c]);
        return weight[v] * w;
    });
    const double load = loads_.empty() ? 0 : -ordered_sum(n, [&](std::size_t u) {
        const std::size_t v = 3 * vertex(u);
        double w = 0;
        for (std::size_t c = v; c < v + 3; ++c) w += loads_[c] * (x[c] - x_before_[c]);
        return w;
    });
    scale += std::abs(total) + std::abs(gravity) + std::abs(load);
    return total + gravity + load;
}

void Dynamics::add_gradient(std::span<double> gradient) const {
    const std::vector<double>& weight = masses_.weight();
    const double alpha = mass_damping();
    parallel_for(numbering_.unknown_count(), 2048, [&](std::size_t u) {
        const std::size_t v = vertex(u);
        for (std::size_t c = 0; c < 3; ++c) {
            double g = -weight[v] * inputs_->gravity[static_cast<Eigen::Index>(c)];
            if (form_->mass_factor > 0) g += form_->mass_factor * inertia_[3 * u + c];
            if (alpha > 0) g += alpha * drag_[3 * u + c];
            if (!loads_.empty()) g -= loads_[3 * v + c];
            gradient[3 * u + c] += g;
        }
    });
}

void Dynamics::add_held_gradient(const Positions& x, std::span<double> gradient) {
    // As energy does for unknowns: M times the offsets and velocities, those of held vertices too.
    const auto add_inertia = [&](double share, const std::vector<double>& of_unknowns, std::vector<double>& of_held,
                                 double factor, const std::vector<double>& shift, double shift_factor) {
        of_held.resize(x.size());
        for (std::size_t v = 0; v < numbering_.vertex_count(); ++v)
            for (std::size_t c = 3 * v; numbering_.unknown[v] < 0 && c < 3 * v + 3; ++c)
                of_held[c] = factor * x[c] + shift_factor * shift[c];
        masses_.add_held_rows(share, of_unknowns, of_held, gradient);
    };
    const double f = form_->velocity_factor;
    if (form_->mass_factor > 0) add_inertia(form_->mass_factor, offset_, held_offset_, 1, form_->target, -1);
    if (mass_damping() > 0) add_inertia(mass_damping(), velocity_, held_speed_, f, form_->velocity_offset, 1);
    for (std::size_t v = 0; v < numbering_.vertex_count(); ++v) {
        if (numbering_.unknown[v] >= 0) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            gradient[3 * v + c] -= masses_.weight()[v] * inputs_->gravity[static_cast<Eigen::Index>(c)];
            if (!loads_.empty()) gradient[3 * v + c] -= loads_[3 * v + c];
        }
    }
}

void Dynamics::raise_forces_at_work(std::span<double> largest) const {
    const std::vector<double>& weight = masses_.weight();
    const double g = inputs_->gravity.norm();
    for (std::size_t d = 0; d < largest.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        const auto of = [&](std::size_t u) { return vertex(body.first_unknown + u); };
        const auto raise = [&](double squares, double factor) {
            largest[d] = std::max(largest[d], factor * std::sqrt(squares));
        };
        if (g > 0)
            raise(ordered_sum(body.unknown_count, [&](std::size_t u) { return weight[of(u)] * weight[of(u)]; }), g);
        if (!loads_.empty())
            raise(ordered_sum(body.unknown_count,
                              [&](std::size_t u) {
                                  const std::size_t v = 3 * of(u);
                                  return loads_[v] * loads_[v] + loads_[v + 1] * loads_[v + 1] +
                                         loads_[v + 2] * loads_[v + 2];
                              }),
                  1);
        const std::size_t first = 3 * body.first_unknown;
        if (form_->mass_factor > 0)
            raise(ordered_sum(3 * body.unknown_count,
                              [&](std::size_t i) { return inertia_[first + i] * inertia_[first + i]; }),
                  form_->mass_factor);
    }
}

void Dynamics::add_hessian(BlockMatrix& a) const {
    const double f = form_->velocity_factor, factor = form_->mass_factor + (f > 0 ? inputs_->mass_damping * f : 0);
    if (factor > 0) masses_.add_to(a, factor);
}

bool Dynamics::free_flight(const Positions& x, std::vector<double>& direction, std::vector<double>& gain) const {
    if (!(form_->mass_factor > 0)) return false;
    const std::vector<double>& weight = masses_.weight();
    direction.resize(3 * numbering_.unknown_count());
    gain.resize(numbering_.deformables.size());
    bool moves = false;
    for (std::size_t d = 0; d < gain.size(); ++d) {
        const Deformable& body = numbering_.deformables[d];
        gain[d] = ordered_sum(body.unknown_count, [&](std::size_t i) {
            const std::size_t u = body.first_unknown + i, v = vertex(u);
            double squares = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double to = form_->target[3 * v + c] +
                                  inputs_->gravity[static_cast<Eigen::Index>(c)] / form_->mass_factor - x[3 * v + c];
                direction[3 * u + c] = to;
                squares += to * to;
            }
            return 0.5 * form_->mass_factor * weight[v] * squares;
        });
        moves = moves || gain[d] != 0;
    }
    return moves;
}

} // namespace sinew::solver
