// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/potential.h"

#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::solver {

Potential::Potential(const Scene& scene)
    : scene_(scene)
    , system_(scene.system())
    , tissues_(scene) {}

bool Potential::set_structure(const std::vector<std::vector<Anchor>>& anchors, const StepInputs& inputs) {
    const bool new_couplings = tissues_.set_values(inputs);
    if (!new_couplings && anchors_ && *anchors_ == anchors) return false;
    anchors_ = anchors;
    springs_ = std::make_unique<Springs>(scene_, anchors);
    std::vector<std::pair<int, int>> by_vertex, couplings;
    tissues_.add_couplings(by_vertex);
    springs_->add_couplings(by_vertex);
    for (const auto& [v, w] : by_vertex) {
        const int i = system_.unknown[static_cast<std::size_t>(v)], j = system_.unknown[static_cast<std::size_t>(w)];
        if (i >= 0 && j >= 0) couplings.emplace_back(i, j);
    }
    pattern_ = std::make_unique<BlockPattern>(make_pattern(static_cast<int>(unknown_count()), std::move(couplings)));
    tissues_.set_pattern(*pattern_);
    springs_->set_pattern(*pattern_, system_.unknown);
    return true;
}

UnknownPlaces Potential::places() const {
    UnknownPlaces out;
    for (const TissueBatches& t : system_.tissues) {
        double volume = 0;
        const TissueRest& rest = *scene_.tissue(t.body);
        for (const Tet& tet : rest.tets.tets)
            volume += tet_volume(rest.tets.vertices[static_cast<std::size_t>(tet[0])],
                                 rest.tets.vertices[static_cast<std::size_t>(tet[1])],
                                 rest.tets.vertices[static_cast<std::size_t>(tet[2])],
                                 rest.tets.vertices[static_cast<std::size_t>(tet[3])]);
        out.spacing.push_back(std::cbrt(volume / static_cast<double>(scene_.vertex_count(t.body))));
    }
    std::size_t tissue = 0;
    for (const int v : system_.vertex_of_unknown) {
        while (v >= scene_.first_vertex(system_.tissues[tissue].body) +
                        static_cast<int>(scene_.vertex_count(system_.tissues[tissue].body)))
            ++tissue;
        const double* x = system_.rest.data() + 3 * static_cast<std::size_t>(v);
        out.points.emplace_back(x[0], x[1], x[2]);
        out.body.push_back(static_cast<int>(tissue));
    }
    return out;
}

void Potential::update_loads(const StepInputs& inputs) {
    loads_.clear();
    for (const TissueBatches& elements : system_.tissues) {
        const Points& forces = std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(elements.body)]).forces;
        if (forces.empty()) continue;
        loads_.resize(3 * static_cast<std::size_t>(scene_.vertex_count()), 0.0);
        double* out = loads_.data() + 3 * static_cast<std::size_t>(scene_.first_vertex(elements.body));
        for (std::size_t v = 0; v < forces.size(); ++v)
            for (std::size_t c = 0; c < 3; ++c) out[3 * v + c] = forces[v][static_cast<Eigen::Index>(c)];
    }
}

void Potential::begin_step(const State& before, const StepInputs& inputs) {
    inputs_ = &inputs;
    x_before_ = before.x;
    update_loads(inputs);
}

void Potential::set_values(const StepInputs& inputs) {
    if (tissues_.set_values(inputs)) throw std::logic_error("values within a step may not change what is coupled");
    inputs_ = &inputs;
    update_loads(inputs);
}

void Potential::begin_stage(const State& before, const ImplicitForm& form, const std::vector<Points>& bones_after) {
    form_ = &form;
    tissues_.set_damping(inputs_->stiffness_damping * form.velocity_factor, form.strain);
    springs_->begin_stage(*inputs_, before, bones_after, form);
}

void Potential::strain_rates(const std::vector<double>& x, std::vector<double>& out) const {
    if (inputs_->stiffness_damping > 0 && form_->velocity_factor > 0)
        tissues_.strain_rates(x, form_->velocity_factor, out);
    else
        out.clear();
}

void Potential::accelerations(const State& before, std::vector<double>& out) {
    // A stage without inertia that ends where it starts, with the velocities of `before`: its gradient is the force.
    ImplicitForm now;
    now.velocity_factor = 1;
    now.target = before.x;
    now.velocity_offset.resize(before.x.size());
    for (std::size_t i = 0; i < before.x.size(); ++i) now.velocity_offset[i] = before.v[i] - before.x[i];
    now.strain = {.x = &before.x, .v = &before.v, .rate = -1};
    now.bone_position = {0, 1, 0};
    if (const double h = before.history.step_size; h > 0 && !before.history.bones.empty())
        now.bone_velocity = {-1 / h, 1 / h, 0};
    begin_stage(before, now, before.bones);
    std::vector<double> gradient, solved;
    evaluate(before.x, &gradient, nullptr);
    for (double& g : gradient) g = -g;
    tissues_.mass().solve(gradient, solved);
    out.assign(before.x.size(), 0.0);
    for (std::size_t u = 0; u < unknown_count(); ++u)
        for (std::size_t c = 0; c < 3; ++c)
            out[3 * static_cast<std::size_t>(system_.vertex_of_unknown[u]) + c] = solved[3 * u + c];
    form_ = nullptr;
}

double Potential::evaluate(const std::vector<double>& x, std::vector<double>* gradient,
                           std::vector<BodyForces>* forces) {
    const double elastic = tissues_.evaluate(x);
    const MassMatrix& masses = tissues_.mass();
    const std::vector<double>& weight = masses.weight();
    const bool moving = form_->velocity_factor > 0;
    const double alpha = moving ? inputs_->mass_damping : 0;
    const std::size_t n = unknown_count();

    double spring_energy = 0;
    if (!springs_->empty()) {
        if (gradient) spring_gradient_.assign(x.size(), 0.0);
        spring_energy = springs_->energy(x, gradient ? spring_gradient_.data() : nullptr);
    }
    const auto vertex = [&](std::size_t u) { return static_cast<std::size_t>(system_.vertex_of_unknown[u]); };
    // Inertia and mass damping: M (m (x - target) + alpha v), its energy on the way.
    offset_.resize(3 * n);
    parallel_for(n, 4096, [&](std::size_t u) {
        for (std::size_t c = 0; c < 3; ++c)
            offset_[3 * u + c] = x[3 * vertex(u) + c] - form_->target[3 * vertex(u) + c];
    });
    double inertia_energy = 0;
    if (form_->mass_factor > 0) {
        masses.multiply(offset_, inertia_);
        inertia_energy =
            0.5 * form_->mass_factor * ordered_sum(3 * n, [&](std::size_t i) { return offset_[i] * inertia_[i]; });
    }
    if (alpha > 0) {
        velocity_.resize(3 * n);
        parallel_for(n, 4096, [&](std::size_t u) {
            const std::size_t v = 3 * vertex(u);
            for (std::size_t c = 0; c < 3; ++c)
                velocity_[3 * u + c] = form_->velocity_factor * x[v + c] + form_->velocity_offset[v + c];
        });
        masses.multiply(velocity_, drag_);
        inertia_energy += 0.5 * alpha / form_->velocity_factor *
                          ordered_sum(3 * n, [&](std::size_t i) { return velocity_[i] * drag_[i]; });
    }
    const double gravity_energy = -ordered_sum(n, [&](std::size_t u) {
        const std::size_t v = vertex(u);
        double w = 0;
        for (std::size_t c = 0; c < 3; ++c)
            w += inputs_->gravity[static_cast<Eigen::Index>(c)] * (x[3 * v + c] - x_before_[3 * v + c]);
        return weight[v] * w;
    });
    const double load_energy = loads_.empty() ? 0 : -ordered_sum(n, [&](std::size_t u) {
        const std::size_t v = 3 * vertex(u);
        double w = 0;
        for (std::size_t c = v; c < v + 3; ++c) w += loads_[c] * (x[c] - x_before_[c]);
        return w;
    });
    energy_scale_ =
        std::abs(elastic) + spring_energy + inertia_energy + std::abs(gravity_energy) + std::abs(load_energy);
    const double total = elastic + spring_energy + inertia_energy + gravity_energy + load_energy;
    if (!gradient) return total;

    gradient->resize(3 * n);
    parallel_for(n, 512, [&](std::size_t u) {
        double g[3] = {};
        tissues_.add_gradient(u, g);
        const std::size_t v = vertex(u);
        for (std::size_t c = 0; c < 3; ++c) {
            g[c] -= weight[v] * inputs_->gravity[static_cast<Eigen::Index>(c)];
            if (form_->mass_factor > 0) g[c] += form_->mass_factor * inertia_[3 * u + c];
            if (alpha > 0) g[c] += alpha * drag_[3 * u + c];
            if (!springs_->empty()) g[c] += spring_gradient_[3 * v + c];
            if (!loads_.empty()) g[c] -= loads_[3 * v + c];
            (*gradient)[3 * u + c] = g[c];
        }
    });
    if (forces) set_forces(x, *gradient, *forces);
    return total;
}

void Potential::set_forces(const std::vector<double>& x, const std::vector<double>& gradient,
                           std::vector<BodyForces>& forces) {
    const std::vector<double>& weight = tissues_.mass().weight();
    const double g = inputs_->gravity.norm();
    of_body_.assign(static_cast<std::size_t>(scene_.body_count()), 0.0);
    springs_->add_squared_forces(x, of_body_);
    forces.resize(system_.tissues.size());
    for (std::size_t t = 0; t < forces.size(); ++t) {
        const TissueBatches& tissue = system_.tissues[t];
        const std::size_t first = 3 * tissue.first_unknown, count = 3 * tissue.unknown_count;
        const auto norm = [&](const std::vector<double>& v) {
            return std::sqrt(ordered_sum(count, [&](std::size_t i) { return v[first + i] * v[first + i]; }));
        };
        const auto vertex = [&](std::size_t u) {
            return static_cast<std::size_t>(system_.vertex_of_unknown[tissue.first_unknown + u]);
        };
        const double gravity =
            g > 0 ? g * std::sqrt(ordered_sum(tissue.unknown_count,
                                              [&](std::size_t u) { return weight[vertex(u)] * weight[vertex(u)]; }))
                  : 0;
        const double loads = loads_.empty() ? 0 : std::sqrt(ordered_sum(tissue.unknown_count, [&](std::size_t u) {
            const std::size_t v = 3 * vertex(u);
            return loads_[v] * loads_[v] + loads_[v + 1] * loads_[v + 1] + loads_[v + 2] * loads_[v + 2];
        }));
        forces[t].sum = norm(gradient);
        forces[t].at_work =
            std::max({tissues_.force_norm(t), tissues_.fiber_norm(t), gravity, loads,
                      form_->mass_factor > 0 ? form_->mass_factor * norm(inertia_) : 0,
                      std::sqrt(of_body_[static_cast<std::size_t>(tissue.body)]), tissues_.force_floor(t)});
    }
}

Balance Potential::balance(const std::vector<double>& x, const std::vector<BodyForces>& forces, double tolerance) {
    double largest = 0;
    for (const double c : x) largest = std::max(largest, std::abs(c));
    of_body_.assign(static_cast<std::size_t>(scene_.body_count()), 0.0);
    springs_->add_squared_stiffnesses(of_body_);
    Balance out{0, true};
    for (std::size_t t = 0; t < forces.size(); ++t) {
        const double residual = forces[t].sum / forces[t].at_work;
        // What rounding of positions does to the forces [N]: no gradient can be made smaller. It excuses a small
        // residual, never one of the size of the forces themselves.
        const double rounding =
            2.3e-16 * largest *
            (tissues_.stiffness_scale(t) + std::sqrt(of_body_[static_cast<std::size_t>(system_.tissues[t].body)]));
        out.reached = out.reached && (residual <= tolerance || (residual <= 1e-3 && forces[t].sum <= rounding));
        // Written so that a residual that is no number is kept.
        if (!(residual <= out.residual)) out.residual = residual;
    }
    return out;
}

bool Potential::free_flight(const std::vector<double>& x, std::vector<double>& direction,
                            std::vector<double>& gain) const {
    if (!(form_->mass_factor > 0)) return false;
    const std::vector<double>& weight = tissues_.mass().weight();
    direction.resize(3 * unknown_count());
    gain.resize(tissue_count());
    bool moves = false;
    for (std::size_t t = 0; t < tissue_count(); ++t) {
        const auto [first, count] = unknowns_of(t);
        gain[t] = ordered_sum(count, [&](std::size_t i) {
            const std::size_t u = first + i, v = static_cast<std::size_t>(system_.vertex_of_unknown[u]);
            double squares = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double d = form_->target[3 * v + c] +
                                 inputs_->gravity[static_cast<Eigen::Index>(c)] / form_->mass_factor - x[3 * v + c];
                direction[3 * u + c] = d;
                squares += d * d;
            }
            return 0.5 * form_->mass_factor * weight[v] * squares;
        });
        moves = moves || gain[t] != 0;
    }
    return moves;
}

void Potential::work(const std::vector<double>& force, const std::vector<double>& direction,
                     std::vector<double>& out) const {
    out.resize(tissue_count());
    for (std::size_t t = 0; t < tissue_count(); ++t) {
        const auto [first, count] = unknowns_of(t);
        out[t] =
            ordered_sum(3 * count, [&](std::size_t i) { return -force[3 * first + i] * direction[3 * first + i]; });
    }
}

void Potential::assemble(const std::vector<double>& x, bool project, BlockMatrix& a) {
    tissues_.assemble(x, project, a);
    if (!springs_->empty()) springs_->add_hessian(a);
    const double f = form_->velocity_factor;
    const double factor = form_->mass_factor + (f > 0 ? inputs_->mass_damping * f : 0);
    if (factor > 0) tissues_.mass().add_to(a, factor);
}

void Potential::describe(const std::vector<double>& x, StepRecord& record) {
    tissues_.set_damping(0, {}); // nothing of it is stored
    record.energy = tissues_.evaluate(x) + springs_->stored_energy(x);
    record.max_stretch = springs_->longest(x);
    tissues_.count_inverted(&x, record.min_j, record.inverted);
}

double Potential::least_j(const std::vector<double>& x) {
    double out = 1;
    int inverted = 0;
    tissues_.evaluate(x);
    tissues_.count_inverted(nullptr, out, inverted);
    return out;
}

} // namespace sinew::solver
