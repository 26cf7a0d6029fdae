// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/mass_matrix.h"

#include "solver/parallel.h"

#include <algorithm>

namespace sinew::solver {

namespace {

/// Entry (a, b) of the consistent mass matrix of a ten-node tet with straight edges and mass 1.
double quadratic_entry(int a, int b) {
    if (a > b) std::swap(a, b);
    double n = 0;
    if (b < 4) {
        n = a == b ? 6 : 1;
    } else {
        const int* e = tet_edge_corners[b - 4];
        if (a < 4) {
            n = e[0] == a || e[1] == a ? -4 : -6;
        } else {
            const int* f = tet_edge_corners[a - 4];
            const int shared = (e[0] == f[0]) + (e[0] == f[1]) + (e[1] == f[0]) + (e[1] == f[1]);
            n = shared == 2 ? 32 : shared == 1 ? 16 : 8;
        }
    }
    return n / 420;
}

} // namespace

void MassMatrix::start(const Numbering& numbering, const BlockPattern& pattern) {
    numbering_ = &numbering;
    pattern_ = &pattern;
    diagonal_ = true;
    weight_.assign(numbering.vertex_count(), 0.0);
    value_.assign(pattern.block_count(), 0.0);
    held_.clear();
    held_pairs_.clear();
}

void MassMatrix::add_lumped(int vertex, double mass) {
    weight_[static_cast<std::size_t>(vertex)] += mass;
    const int i = numbering_->unknown[static_cast<std::size_t>(vertex)];
    if (i >= 0)
        value_[static_cast<std::size_t>(pattern_->row_start[static_cast<std::size_t>(i)])] += mass;
    else
        held_pairs_.push_back({vertex, vertex, mass});
}

void MassMatrix::add(int vertex, int other, double mass) {
    diagonal_ = false;
    weight_[static_cast<std::size_t>(vertex)] += mass;
    if (vertex != other) weight_[static_cast<std::size_t>(other)] += mass;
    int i = numbering_->unknown[static_cast<std::size_t>(vertex)];
    int j = numbering_->unknown[static_cast<std::size_t>(other)];
    if (i < 0 && j < 0) return held_pairs_.push_back({vertex, other, mass});
    if (i < 0) std::swap(i, j), std::swap(vertex, other);
    if (j < 0)
        held_.push_back({i, other, mass});
    else
        value_[static_cast<std::size_t>(pattern_->find(std::min(i, j), std::max(i, j)))] += mass;
}

void MassMatrix::add_tets(const Scene::System& system, const std::vector<double>& of_tet) {
    for (const TissueBatches& t : system.tissues) {
        const bool linear = t.kind == ElementKind::linear;
        std::size_t next = 0;
        for (std::size_t slot = 0; slot < t.tet_count; ++slot) {
            const double mass = t.cut.mass_factor * of_tet[t.first_batch * lanes + slot];
            const auto vertex = [&](int n) { return system.node(t, slot / lanes, n)[slot % lanes]; };
            const double* entry = nullptr; // of a tet that is solid in part
            if (next < t.cut.tets.size() && t.cut.tets[next] == static_cast<int>(slot))
                entry = t.cut.mass.data() + (linear ? 4 : quadratic_mass_entries) * next++;
            for (int a = 0; a < t.nodes(); ++a) {
                if (linear) {
                    add_lumped(vertex(a), (entry ? entry[a] : 0.25) * mass);
                    continue;
                }
                for (int b = a; b < t.nodes(); ++b)
                    add(vertex(a), vertex(b), (entry ? *entry++ : quadratic_entry(a, b)) * mass);
            }
        }
    }
}

double MassMatrix::add_held(const std::vector<double>& h, const std::vector<double>& u,
                            std::vector<double>& m_u) const {
    double work = 0;
    for (const Held& e : held_)
        for (std::size_t c = 0; c < 3; ++c) {
            const double f = e.mass * h[3 * static_cast<std::size_t>(e.vertex) + c];
            work += f * u[3 * static_cast<std::size_t>(e.unknown) + c];
            m_u[3 * static_cast<std::size_t>(e.unknown) + c] += f;
        }
    return work;
}

void MassMatrix::add_held_rows(double factor, const std::vector<double>& u, const std::vector<double>& h,
                               std::span<double> out) const {
    const auto add = [&](int row, double mass, const std::vector<double>& of, int column) {
        for (std::size_t c = 0; c < 3; ++c)
            out[3 * static_cast<std::size_t>(row) + c] += factor * mass * of[3 * static_cast<std::size_t>(column) + c];
    };
    for (const Held& e : held_) add(e.vertex, e.mass, u, e.unknown);
    for (const HeldPair& e : held_pairs_) {
        add(e.vertex, e.mass, h, e.other);
        if (e.vertex != e.other) add(e.other, e.mass, h, e.vertex);
    }
}

void MassMatrix::multiply(const std::vector<double>& u, std::vector<double>& out) const {
    const BlockPattern& p = *pattern_;
    out.resize(u.size());
    if (diagonal_)
        return parallel_for(static_cast<std::size_t>(p.rows), 4096, [&](std::size_t i) {
            const double m = value_[static_cast<std::size_t>(p.row_start[i])];
            for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) out[c] = m * u[c];
        });
    parallel_for(static_cast<std::size_t>(p.rows), 512, [&](std::size_t i) {
        double sum[3] = {};
        const auto add = [&](double m, std::size_t j) {
            for (std::size_t c = 0; c < 3; ++c) sum[c] += m * u[3 * j + c];
        };
        for (int e = p.lower_start[i]; e < p.lower_start[i + 1]; ++e) {
            const auto [index, column] = p.lower[static_cast<std::size_t>(e)];
            add(value_[static_cast<std::size_t>(index)], static_cast<std::size_t>(column));
        }
        for (int e = p.row_start[i]; e < p.row_start[i + 1]; ++e)
            add(value_[static_cast<std::size_t>(e)], static_cast<std::size_t>(p.column[static_cast<std::size_t>(e)]));
        std::copy_n(sum, 3, out.begin() + static_cast<std::ptrdiff_t>(3 * i));
    });
}

void MassMatrix::solve(const std::vector<double>& f, std::vector<double>& u) const {
    // Conjugate gradients with the diagonal: mass matrices are well conditioned, some thirty iterations reach rounding.
    const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
        return ordered_sum(a.size(), [&](std::size_t i) { return a[i] * b[i]; });
    };
    const auto precondition = [&](const std::vector<double>& r, std::vector<double>& z) {
        for (std::size_t i = 0; i < r.size(); ++i)
            z[i] = r[i] / value_[static_cast<std::size_t>(pattern_->row_start[i / 3])];
    };
    std::vector<double> r = f, z(f.size()), ap;
    u.assign(f.size(), 0.0);
    precondition(r, z);
    std::vector<double> p = z;
    double rz = dot(r, z);
    const double goal = 1e-30 * rz;
    for (int iteration = 0; iteration < 200 && rz > goal; ++iteration) {
        multiply(p, ap);
        const double alpha = rz / dot(p, ap);
        for (std::size_t i = 0; i < r.size(); ++i) u[i] += alpha * p[i], r[i] -= alpha * ap[i];
        precondition(r, z);
        const double next = dot(r, z);
        for (std::size_t i = 0; i < r.size(); ++i) p[i] = z[i] + next / rz * p[i];
        rz = next;
    }
}

void MassMatrix::add_to(BlockMatrix& a, double factor) const {
    if (diagonal_)
        return parallel_for(static_cast<std::size_t>(pattern_->rows), 1024, [&](std::size_t i) {
            const std::size_t index = static_cast<std::size_t>(pattern_->row_start[i]);
            for (int c = 0; c < 3; ++c) a.block(index)[4 * c] += factor * value_[index];
        });
    parallel_for(pattern_->block_count(), 2048, [&](std::size_t index) {
        for (int c = 0; c < 3; ++c) a.block(index)[4 * c] += factor * value_[index];
    });
}

} // namespace sinew::solver
