// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/newton/potential.h"

#include "solver/element/linear_tets.h"
#include "solver/error.h"
#include "solver/material/principal.h"
#include "solver/material/stvk.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr std::size_t batch_grain = 32;

bool same(const MaterialValues& a, const MaterialValues& b) {
    return a.youngs_modulus == b.youngs_modulus && a.poissons_ratio == b.poissons_ratio &&
           a.mass_density == b.mass_density && a.envelope == b.envelope;
}

bool same_material(const TissueInputs& a, const TissueInputs& b) {
    return a.compression_resistance == b.compression_resistance &&
           std::equal(a.layers.begin(), a.layers.end(), b.layers.begin(), b.layers.end(), same);
}

/// Layers composited bottom to top: M_N = a m_N + (1 - a) M_{N-1}, a = envelope x weight; the first layer is opaque.
MaterialValues mix_layers(const TissueRest& rest, const TissueInputs& in, std::size_t tet) {
    MaterialValues m = in.layers.front();
    for (std::size_t k = 1; k < in.layers.size(); ++k) {
        const double a = std::clamp(in.layers[k].envelope * rest.layer_weights[k][tet], 0.0, 1.0);
        m.youngs_modulus = a * in.layers[k].youngs_modulus + (1 - a) * m.youngs_modulus;
        m.poissons_ratio = a * in.layers[k].poissons_ratio + (1 - a) * m.poissons_ratio;
        m.mass_density = a * in.layers[k].mass_density + (1 - a) * m.mass_density;
    }
    return m;
}

double fiber_stiffness(const FiberValues& f) { return f.strength * f.envelope * f.excitation; }

} // namespace

double ForceNorms::largest() const { return std::max({elements, fibers, inertia, gravity, loads, attachments, damping}); }

Potential::Potential(const Scene& scene) : scene_(scene), system_(scene.system()) {
    tissue_inputs_.resize(system_.tissues.size());
    moduli_.resize(system_.batches.size());
    gradients_.resize(system_.batches.size());
    hessians_.resize(system_.batches.size());
    mass_.assign(static_cast<std::size_t>(scene.vertex_count()), 0.0);
}

bool Potential::set_anchors(const std::vector<std::vector<Anchor>>& anchors) {
    if (anchors_ && *anchors_ == anchors) return false;
    anchors_ = anchors;
    springs_ = std::make_unique<Springs>(scene_, anchors);
    std::vector<std::pair<int, int>> by_vertex, couplings;
    for (const TetBatch& batch : system_.batches)
        for (int lane = 0; lane < lanes; ++lane)
            for (int b = 0; b < 10; ++b)
                if (batch.volume[lane] > 0)
                    by_vertex.emplace_back(batch.vertex[block_pairs[b][0]][lane], batch.vertex[block_pairs[b][1]][lane]);
    springs_->add_couplings(by_vertex);
    for (const auto& [v, w] : by_vertex) {
        const int i = system_.unknown[static_cast<std::size_t>(v)], j = system_.unknown[static_cast<std::size_t>(w)];
        if (i >= 0 && j >= 0) couplings.emplace_back(i, j);
    }
    pattern_ = std::make_unique<BlockPattern>(make_pattern(static_cast<int>(unknown_count()), std::move(couplings)));
    damping_.reset();

    // Which element entries add up to which block, as a counting sort: first the counts, then the lists.
    const auto for_each_entry = [&](const auto& visit) {
        for (std::size_t e = 0; e < system_.batches.size(); ++e)
            for (int b = 0; b < 10; ++b)
                for (int lane = 0; lane < lanes; ++lane) {
                    const TetBatch& batch = system_.batches[e];
                    const int i = system_.unknown[static_cast<std::size_t>(batch.vertex[block_pairs[b][0]][lane])];
                    const int j = system_.unknown[static_cast<std::size_t>(batch.vertex[block_pairs[b][1]][lane])];
                    if (i < 0 || j < 0 || !(batch.volume[lane] > 0)) continue;
                    const bool transposed = i > j;
                    const int index = pattern_->find(std::min(i, j), std::max(i, j));
                    visit(static_cast<std::size_t>(index),
                          ((static_cast<int>(e) * 10 + b) * 2 + (transposed ? 1 : 0)) * lanes + lane);
                }
    };
    contribution_start_.assign(pattern_->block_count() + 1, 0);
    for_each_entry([&](std::size_t index, int) { ++contribution_start_[index + 1]; });
    for (std::size_t i = 0; i < pattern_->block_count(); ++i) contribution_start_[i + 1] += contribution_start_[i];
    contributions_.resize(static_cast<std::size_t>(contribution_start_.back()));
    std::vector<int> next(contribution_start_.begin(), contribution_start_.end() - 1);
    for_each_entry([&](std::size_t index, int code) { contributions_[static_cast<std::size_t>(next[index]++)] = code; });
    return true;
}

void Potential::update_moduli(const StepInputs& inputs) {
    bool changed = false;
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueElements& elements = system_.tissues[t];
        const auto& in = std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(elements.body)]);
        if (!tissue_inputs_[t].layers.empty() && same_material(tissue_inputs_[t], in)) {
            tissue_inputs_[t] = in;
            continue;
        }
        tissue_inputs_[t] = in;
        changed = true;
        const TissueRest& rest = *scene_.tissue(elements.body);
        const int first = scene_.first_vertex(elements.body);
        std::fill_n(mass_.begin() + first, rest.tets.vertices.size(), 0.0);
        for (std::size_t slot = 0; slot < elements.batch_count * lanes; ++slot) {
            const std::size_t tet = std::min(slot, elements.tet_count - 1), lane = slot % lanes;
            const TetBatch& batch = system_.batches[elements.first_batch + slot / lanes];
            TetModuli& moduli = moduli_[elements.first_batch + slot / lanes];
            const MaterialValues m = mix_layers(rest, in, tet);
            const Lame l = lame(m.youngs_modulus, m.poissons_ratio);
            moduli.mu[lane] = l.mu;
            moduli.lambda[lane] = l.lambda;
            moduli.compression[lane] =
                compression_coefficient(in.compression_resistance, m.youngs_modulus, m.poissons_ratio);
            for (int corner = 0; corner < 4; ++corner)
                mass_[static_cast<std::size_t>(batch.vertex[corner][lane])] += 0.25 * m.mass_density * batch.volume[lane];
        }
    }
    if (!changed) return;
    double sum = 0, stiffness = 0;
    elastic_scale_ = 0;
    for (std::size_t e = 0; e < system_.batches.size(); ++e)
        for (int lane = 0; lane < lanes; ++lane) {
            const TetBatch& b = system_.batches[e];
            double squares = 0;
            for (const auto& row : b.shape) squares += row[lane] * row[lane];
            const double scale = (2 * moduli_[e].mu[lane] + std::min(moduli_[e].lambda[lane], 2 * moduli_[e].mu[lane])) * b.volume[lane];
            const double modulus_volume = (2 * moduli_[e].mu[lane] + moduli_[e].lambda[lane]) * b.volume[lane];
            sum += scale * scale * squares;
            elastic_scale_ += modulus_volume;
            stiffness += modulus_volume * modulus_volume * squares * squares;
        }
    force_floor_ = 1e-6 * std::sqrt(sum);
    stiffness_scale_ = std::sqrt(stiffness);
}

void Potential::update_loads(const StepInputs& inputs) {
    loads_.clear();
    for (const TissueElements& elements : system_.tissues) {
        const Points& forces = std::get<TissueInputs>(inputs.bodies[static_cast<std::size_t>(elements.body)]).forces;
        if (forces.empty()) continue;
        loads_.resize(3 * static_cast<std::size_t>(scene_.vertex_count()), 0.0);
        double* out = loads_.data() + 3 * static_cast<std::size_t>(scene_.first_vertex(elements.body));
        for (std::size_t v = 0; v < forces.size(); ++v)
            for (std::size_t c = 0; c < 3; ++c) out[3 * v + c] = forces[v][static_cast<Eigen::Index>(c)];
    }
}

void Potential::begin_step(const State& before, const StepInputs& inputs) {
    inputs_ = inputs;
    x_before_ = before.x;
    update_moduli(inputs);
    update_loads(inputs);
    if (inputs.stiffness_damping > 0 && inputs.integrator != Integrator::quasi_static) {
        if (!damping_) damping_ = std::make_unique<BlockMatrix>(*pattern_);
        run_hessian_pass(before.x, true);
        gather_hessian(*damping_);
    }
}

void Potential::begin_stage(const State& before, const ImplicitForm& form, const std::vector<Points>& bones_after) {
    form_ = &form;
    springs_->begin_stage(inputs_, before, bones_after, form);
}

void Potential::accelerations(const State& before, std::vector<double>& out) {
    // A stage without inertia that ends where it starts, with the velocities of `before`: its gradient is the force.
    ImplicitForm now;
    now.velocity_factor = 1;
    now.target = before.x;
    now.velocity_offset.resize(before.x.size());
    for (std::size_t i = 0; i < before.x.size(); ++i) now.velocity_offset[i] = before.v[i] - before.x[i];
    now.bone_position = {0, 1, 0};
    if (const double h = before.history.step_size; h > 0 && !before.history.bones.empty())
        now.bone_velocity = {-1 / h, 1 / h, 0};
    begin_stage(before, now, before.bones);
    std::vector<double> gradient;
    evaluate(before.x, &gradient, nullptr);
    out.assign(before.x.size(), 0.0);
    for (std::size_t u = 0; u < unknown_count(); ++u) {
        const std::size_t v = static_cast<std::size_t>(system_.vertex_of_unknown[u]);
        for (std::size_t c = 0; c < 3; ++c) out[3 * v + c] = -gradient[3 * u + c] / mass_[v];
    }
    form_ = nullptr;
}

void Potential::run_gradient_pass(const std::vector<double>& x) {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueElements& elements = system_.tissues[t];
        const std::vector<FiberValues>& fibers = tissue_inputs_[t].fibers;
        parallel_for(elements.batch_count, batch_grain, [&](std::size_t i) {
            const std::size_t e = elements.first_batch + i;
            elastic_gradient(elements.law, system_.batches[e], moduli_[e], x.data(), gradients_[e]);
            for (std::size_t k = 0; k < fibers.size(); ++k)
                if (const double stiffness = fiber_stiffness(fibers[k]); stiffness != 0)
                    add_fiber_gradient(system_.batches[e], elements.fibers[k][i], stiffness, fibers[k].contraction_limit,
                                       x.data(), gradients_[e]);
        });
    }
}

void Potential::run_hessian_pass(const std::vector<double>& x, bool project) {
    for (std::size_t t = 0; t < system_.tissues.size(); ++t) {
        const TissueElements& elements = system_.tissues[t];
        const std::vector<FiberValues>& fibers = tissue_inputs_[t].fibers;
        parallel_for(elements.batch_count, batch_grain, [&](std::size_t i) {
            const std::size_t e = elements.first_batch + i;
            elastic_hessian(elements.law, system_.batches[e], moduli_[e], x.data(), project, hessians_[e]);
            for (std::size_t k = 0; k < fibers.size(); ++k)
                if (const double stiffness = fiber_stiffness(fibers[k]); stiffness != 0)
                    add_fiber_hessian(system_.batches[e], elements.fibers[k][i], stiffness, fibers[k].contraction_limit,
                                      x.data(), hessians_[e]);
        });
    }
}

void Potential::gather_hessian(BlockMatrix& a) const {
    parallel_for(pattern_->block_count(), 512, [&](std::size_t index) {
        double sum[9] = {};
        for (int c = contribution_start_[index]; c < contribution_start_[index + 1]; ++c) {
            const int code = contributions_[static_cast<std::size_t>(c)];
            const int lane = code % lanes, rest = code / lanes;
            const auto& h = hessians_[static_cast<std::size_t>(rest / 20)].h[rest / 2 % 10];
            if (rest % 2)
                for (int r = 0; r < 3; ++r)
                    for (int k = 0; k < 3; ++k) sum[3 * r + k] += h[3 * k + r][lane];
            else
                for (int k = 0; k < 9; ++k) sum[k] += h[k][lane];
        }
        std::copy_n(sum, 9, a.block(index));
    });
}

double Potential::element_energy() const {
    return ordered_sum(gradients_.size(), [&](std::size_t e) {
        const double* w = gradients_[e].energy;
        return (w[0] + w[1]) + (w[2] + w[3]);
    });
}

double Potential::evaluate(const std::vector<double>& x, std::vector<double>* gradient, ForceNorms* norms) {
    static_assert(lanes == 4);
    run_gradient_pass(x);
    const double elastic = element_energy();
    const bool moving = form_->velocity_factor > 0;
    const double alpha = moving ? inputs_.mass_damping : 0, beta = moving ? inputs_.stiffness_damping : 0;
    const std::size_t n = unknown_count();

    double spring_energy = 0;
    if (!springs_->empty()) {
        if (gradient) spring_gradient_.assign(x.size(), 0.0);
        spring_energy = springs_->energy(x, gradient ? spring_gradient_.data() : nullptr);
    }
    double damping_energy = 0;
    if (beta > 0) {
        velocity_.resize(3 * n);
        damping_force_.resize(3 * n);
        parallel_for(n, 4096, [&](std::size_t u) {
            const std::size_t v = 3 * static_cast<std::size_t>(system_.vertex_of_unknown[u]);
            for (std::size_t c = 0; c < 3; ++c)
                velocity_[3 * u + c] = form_->velocity_factor * x[v + c] + form_->velocity_offset[v + c];
        });
        multiply(*damping_, velocity_.data(), damping_force_.data());
        damping_energy = beta / (2 * form_->velocity_factor) *
                         ordered_sum(3 * n, [&](std::size_t i) { return velocity_[i] * damping_force_[i]; });
    }
    // Inertia, gravity and mass damping are diagonal: one loop for their energies.
    const auto vertex = [&](std::size_t u) { return static_cast<std::size_t>(system_.vertex_of_unknown[u]); };
    double inertia_energy = ordered_sum(n, [&](std::size_t u) {
        double w = 0;
        const std::size_t v = vertex(u);
        for (std::size_t c = 0; c < 3; ++c) {
            const double d = x[3 * v + c] - form_->target[3 * v + c];
            w += 0.5 * form_->mass_factor * d * d;
            if (alpha > 0) {
                const double velocity = form_->velocity_factor * x[3 * v + c] + form_->velocity_offset[3 * v + c];
                w += 0.5 * alpha / form_->velocity_factor * velocity * velocity;
            }
        }
        return mass_[v] * w;
    });
    const double gravity_energy = -ordered_sum(n, [&](std::size_t u) {
        const std::size_t v = vertex(u);
        double w = 0;
        for (std::size_t c = 0; c < 3; ++c)
            w += inputs_.gravity[static_cast<Eigen::Index>(c)] * (x[3 * v + c] - x_before_[3 * v + c]);
        return mass_[v] * w;
    });
    const double load_energy = loads_.empty() ? 0 : -ordered_sum(n, [&](std::size_t u) {
        const std::size_t v = 3 * vertex(u);
        double w = 0;
        for (std::size_t c = v; c < v + 3; ++c) w += loads_[c] * (x[c] - x_before_[c]);
        return w;
    });
    energy_scale_ = std::abs(elastic) + spring_energy + damping_energy + inertia_energy + std::abs(gravity_energy) + std::abs(load_energy);
    const double total = elastic + spring_energy + damping_energy + inertia_energy + gravity_energy + load_energy;
    if (!gradient) return total;

    gradient->resize(3 * n);
    parallel_for(n, 512, [&](std::size_t u) {
        double g[3] = {};
        for (int k = system_.corner_start[u]; k < system_.corner_start[u + 1]; ++k) {
            const int slot = system_.corners[static_cast<std::size_t>(k)];
            const int lane = slot % lanes, corner = slot / lanes % 4;
            const TetGradient& e = gradients_[static_cast<std::size_t>(slot / (4 * lanes))];
            for (int c = 0; c < 3; ++c) g[c] += e.g[corner][c][lane];
        }
        const std::size_t v = vertex(u);
        for (std::size_t c = 0; c < 3; ++c) {
            const double xi = x[3 * v + c];
            g[c] += mass_[v] * (form_->mass_factor * (xi - form_->target[3 * v + c]) -
                                inputs_.gravity[static_cast<Eigen::Index>(c)]);
            if (alpha > 0)
                g[c] += mass_[v] * alpha * (form_->velocity_factor * xi + form_->velocity_offset[3 * v + c]);
            if (beta > 0) g[c] += beta * damping_force_[3 * u + c];
            if (!springs_->empty()) g[c] += spring_gradient_[3 * v + c];
            if (!loads_.empty()) g[c] -= loads_[3 * v + c];
            (*gradient)[3 * u + c] = g[c];
        }
    });
    if (norms) {
        norms->elements = std::sqrt(ordered_sum(gradients_.size(), [&](std::size_t e) {
            double squares = 0;
            for (const auto& corner : gradients_[e].g)
                for (const auto& component : corner)
                    for (const double f : component) squares += f * f;
            return squares;
        }));
        norms->fibers = std::sqrt(ordered_sum(gradients_.size(), [&](std::size_t e) {
            const double* q = gradients_[e].fiber_squares;
            return (q[0] + q[1]) + (q[2] + q[3]);
        }));
        norms->inertia = std::sqrt(ordered_sum(n, [&](std::size_t u) {
            const std::size_t v = vertex(u);
            double squares = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double f = mass_[v] * form_->mass_factor * (x[3 * v + c] - form_->target[3 * v + c]);
                squares += f * f;
            }
            return squares;
        }));
        const double g = inputs_.gravity.norm();
        norms->gravity = g * std::sqrt(ordered_sum(n, [&](std::size_t u) { return mass_[vertex(u)] * mass_[vertex(u)]; }));
        norms->loads = loads_.empty() ? 0 : std::sqrt(ordered_sum(n, [&](std::size_t u) {
            const std::size_t v = 3 * vertex(u);
            return loads_[v] * loads_[v] + loads_[v + 1] * loads_[v + 1] + loads_[v + 2] * loads_[v + 2];
        }));
        norms->attachments = springs_->empty() ? 0 : springs_->force_norm(x);
        norms->damping = beta > 0 ? beta * std::sqrt(ordered_sum(3 * n, [&](std::size_t i) {
            return damping_force_[i] * damping_force_[i];
        })) : 0;
    }
    return total;
}

std::vector<double> Potential::free_flight(const std::vector<double>& x) const {
    std::vector<double> out = x;
    if (form_->mass_factor > 0)
        for (const int v : system_.vertex_of_unknown)
            for (std::size_t c = 0; c < 3; ++c) {
                const std::size_t i = 3 * static_cast<std::size_t>(v) + c;
                out[i] = form_->target[i] + inputs_.gravity[static_cast<Eigen::Index>(c)] / form_->mass_factor;
            }
    return out;
}

double Potential::force_rounding(const std::vector<double>& x) const {
    double largest = 0;
    for (const double c : x) largest = std::max(largest, std::abs(c));
    return 2.3e-16 * largest * (stiffness_scale_ + springs_->stiffness_norm());
}

void Potential::assemble(const std::vector<double>& x, bool project, BlockMatrix& a) {
    run_hessian_pass(x, project);
    gather_hessian(a);
    if (!springs_->empty()) springs_->add_hessian(system_.unknown, a);
    const double f = form_->velocity_factor;
    const double diagonal = form_->mass_factor + (f > 0 ? inputs_.mass_damping * f : 0);
    parallel_for(unknown_count(), 1024, [&](std::size_t u) {
        double* block = a.block(static_cast<std::size_t>(pattern_->row_start[u]));
        const double m = mass_[static_cast<std::size_t>(system_.vertex_of_unknown[u])] * diagonal;
        for (int c = 0; c < 3; ++c) block[4 * c] += m;
    });
    if (inputs_.stiffness_damping > 0 && f > 0)
        parallel_for(pattern_->block_count(), 2048, [&](std::size_t index) {
            double* out = a.block(index);
            const double* k = damping_->block(index);
            for (int i = 0; i < 9; ++i) out[i] += inputs_.stiffness_damping * f * k[i];
        });
}

void Potential::describe(const std::vector<double>& x, StepRecord& record) {
    run_gradient_pass(x);
    record.energy = element_energy() + springs_->stored_energy(x);
    record.max_stretch = springs_->longest(x);
    record.min_j = 1;
    record.inverted = 0;
    bool first = true;
    for (std::size_t e = 0; e < gradients_.size(); ++e)
        for (int lane = 0; lane < lanes; ++lane) {
            if (!(system_.batches[e].volume[lane] > 0)) continue;
            const double j = gradients_[e].j[lane];
            record.min_j = first ? j : std::min(record.min_j, j);
            first = false;
            if (!(j > 0)) ++record.inverted;
        }
}

} // namespace sinew::solver
