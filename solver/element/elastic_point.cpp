// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/elastic_point.h"

#include "solver/element/svd3.h"
#include "solver/element/symmetric3.h"
#include "solver/material/anisotropic.h"
#include "solver/material/formulas.h"
#include "solver/material/viscosity.h"

#include <array>
#include <cmath>

namespace sinew::solver {

namespace {

template <class R>
void add_scaled(const Principal<R>& a, R factor, Principal<R>& out) {
    for (int i = 0; i < 3; ++i) {
        out.first[i] += factor * a.first[i];
        out.diagonal[i] += factor * a.diagonal[i];
        out.off_diagonal[i] += factor * a.off_diagonal[i];
        out.flip[i] += factor * a.flip[i];
        out.twist[i] += factor * a.twist[i];
    }
}

/// The law and, as fixed pressures, the terms on means. Their energies are the element's to add.
void evaluate_point(const PointInputs& in, const Pack* s, Principal<Pack>& q) {
    evaluate_law(in.law, s, Pack::load(in.moduli.mu), Pack::load(in.moduli.lambda), Pack::load(in.moduli.compression),
                 q);
    if (!in.pressures) return;
    Principal<Pack> measure;
    evaluate_measure(in.law, s, measure);
    add_scaled(measure, in.pressures->measure, q);
    const Pack energy = q.energy;
    add_volumetric(s, Pack(0.0), in.pressures->j, Pack(0.0), q);
    q.energy = energy;
}

void load_strain(const double* from, Pack* strain) {
    for (int i = 0; i < 6; ++i) strain[i] = Pack::load(from + i * lanes);
}

void add_viscosity(const PointInputs& in, const Strains<Pack>& e, TensorForm<Pack>& law) {
    Pack reference[6];
    load_strain(in.reference_strain, reference);
    const Pack share(in.viscosity);
    add_viscosity(e, reference, share * Pack::load(in.moduli.mu), share * Pack::load(in.moduli.lambda), law);
}

void evaluate_point(const PointInputs& in, const Strains<Pack>& e, TensorForm<Pack>& law) {
    evaluate_law(in.law, e, Pack::load(in.moduli.mu), Pack::load(in.moduli.lambda), Pack::load(in.moduli.compression),
                 law);
    if (in.viscosity > 0) add_viscosity(in, e, law);
    if (!in.pressures) return;
    TensorForm<Pack> measure;
    evaluate_measure(in.law, e, measure);
    law.uniform += in.pressures->measure * measure.uniform;
    law.by_j += in.pressures->measure * measure.by_j + in.pressures->j;
    law.by_jj += in.pressures->measure * measure.by_jj;
}

/// out = U diag(d) V^T
template <class R>
void recompose(const R* u, const R* d, const R* v, R* out) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[3 * i + j] =
                u[3 * i] * d[0] * v[3 * j] + u[3 * i + 1] * d[1] * v[3 * j + 1] + u[3 * i + 2] * d[2] * v[3 * j + 2];
}

template <class R>
R determinant(const R* f) {
    return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
}

/// out = U k U^T
void rotate_block(const Pack* u, const Pack* k, Pack* out) {
    Pack uk[9];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) uk[3 * i + j] = u[3 * i] * k[j] + u[3 * i + 1] * k[3 + j] + u[3 * i + 2] * k[6 + j];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[3 * i + j] = uk[3 * i] * u[3 * j] + uk[3 * i + 1] * u[3 * j + 1] + uk[3 * i + 2] * u[3 * j + 2];
}

/// g[a] = volume P grad L_a for corners 1…3; corner 0 takes the opposite of their sum.
void add_stress_forces(const TetBatch& batch, Pack volume, const Pack* p, Pack g[4][3]) {
    for (int c = 0; c < 3; ++c)
        for (int a = 1; a < 4; ++a) {
            const Pack f = volume * (p[3 * c] * Pack::load(batch.shape[3 * (a - 1)]) +
                                     p[3 * c + 1] * Pack::load(batch.shape[3 * (a - 1) + 1]) +
                                     p[3 * c + 2] * Pack::load(batch.shape[3 * (a - 1) + 2]));
            g[a][c] += f;
        }
}

/// out = cof F = dJ/dF
template <class R>
void cofactor(const R* f, R* out) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            out[3 * i + j] = f[3 * a + c] * f[3 * b + d] - f[3 * a + d] * f[3 * b + c];
        }
}

/// Whether the point's energy has a part in principal stretches.
bool has_principal_part(const PointInputs& in) { return !needs_direction(in.law) || in.pressures; }

/// Whether damping is added to a part in principal stretches; tensor forms and the anisotropic law take it in.
bool damps_alone(const PointInputs& in) { return in.viscosity > 0 && !needs_direction(in.law); }

std::array<Pack, 3> load_direction(const Anisotropy& a) {
    return {Pack::load(a.direction[0]), Pack::load(a.direction[1]), Pack::load(a.direction[2])};
}

/// Blocks of corners 1…3 from the part in principal stretches.
void principal_blocks(const PointInputs& in, const Pack* f, Pack volume, bool project, Pack blocks[6][9]) {
    const TetBatch& batch = in.batch;
    Svd3<Pack> svd;
    svd3(f, svd);
    Principal<Pack> q;
    evaluate_point(in, svd.s, q);
    if (project) {
        clamp_symmetric3(q.diagonal, q.off_diagonal);
        for (int k = 0; k < 3; ++k) {
            q.flip[k] = max(q.flip[k], Pack(0.0));
            q.twist[k] = max(q.twist[k], Pack(0.0));
        }
    }
    // In the frame of U and V: same[k] on (dF_ij)^2 and (dF_ji)^2, cross[k] on dF_ij dF_ji, pair k = (i, j).
    Pack same[3], cross[3];
    for (int k = 0; k < 3; ++k) {
        same[k] = Pack(0.5) * volume * (q.flip[k] + q.twist[k]);
        cross[k] = Pack(0.5) * volume * (q.flip[k] - q.twist[k]);
        q.diagonal[k] *= volume;
        q.off_diagonal[k] *= volume;
    }
    Pack n[3][3]; // V^T grad L_a
    for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i)
            n[a][i] = svd.v[i] * Pack::load(batch.shape[3 * a]) + svd.v[3 + i] * Pack::load(batch.shape[3 * a + 1]) +
                      svd.v[6 + i] * Pack::load(batch.shape[3 * a + 2]);
    int index = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) {
            Pack k[9];
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, m = (i + 2) % 3;
                k[4 * i] =
                    q.diagonal[i] * n[a][i] * n[b][i] + same[m] * n[a][j] * n[b][j] + same[j] * n[a][m] * n[b][m];
                k[3 * j + m] = q.off_diagonal[i] * n[a][j] * n[b][m] + cross[i] * n[a][m] * n[b][j];
                k[3 * m + j] = q.off_diagonal[i] * n[a][m] * n[b][j] + cross[i] * n[a][j] * n[b][m];
            }
            rotate_block(svd.u, k, blocks[index++]);
        }
}

/// The same without projection, for laws with a tensor form.
void exact_blocks(const PointInputs& in, const Pack* f, Pack volume, Pack blocks[6][9]) {
    Strains<Pack> strains;
    set_strains(f, strains);
    TensorForm<Pack> law;
    evaluate_point(in, strains, law);
    Pack n[3][3];
    for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i) n[a][i] = Pack::load(in.batch.shape[3 * a + i]);
    tensor_blocks(strains, law, n, volume, blocks);
}

/// Adds the blocks of damping alone, for laws without a tensor form and for projection.
void add_viscous_blocks(const PointInputs& in, const Pack* f, Pack volume, bool project, Pack blocks[6][9]) {
    Strains<Pack> strains;
    set_strains(f, strains);
    TensorForm<Pack> law;
    clear(law);
    add_viscosity(in, strains, law);
    Pack n[3][3], own[6][9];
    for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i) n[a][i] = Pack::load(in.batch.shape[3 * a + i]);
    if (project)
        tensor_blocks<false>(strains, law, n, volume, own);
    else
        tensor_blocks(strains, law, n, volume, own);
    for (int b = 0; b < 6; ++b)
        for (int e = 0; e < 9; ++e) blocks[b][e] += own[b][e];
}

/// The anisotropic law with its damping.
AnisotropicStVK<Pack> anisotropic_at(const PointInputs& in, const Pack* f) {
    AnisotropicStVK<Pack> law(f, load_direction(*in.anisotropy), Pack::load(in.anisotropy->root),
                              Pack::load(in.moduli.mu), Pack::load(in.moduli.lambda));
    if (in.viscosity > 0) {
        Pack listed[6], reference[9];
        load_strain(in.reference_strain, listed);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            reference[4 * i] = listed[i];
            reference[3 * j + k] = reference[3 * k + j] = listed[3 + i];
        }
        law.add_viscosity(reference, Pack(in.viscosity));
    }
    return law;
}

/// Adds the anisotropic law's blocks. Projected: the tension's negative eigenvalues are set to zero, which leaves a sum
/// of two positive semi-definite parts.
void add_anisotropic_blocks(const PointInputs& in, const Pack* f, Pack volume, bool project, Pack blocks[6][9]) {
    AnisotropicStVK<Pack> law = anisotropic_at(in, f);
    if (project) {
        Pack diagonal[3], off_diagonal[3];
        law.tension(diagonal, off_diagonal);
        clamp_symmetric3(diagonal, off_diagonal);
        law.set_tension(diagonal, off_diagonal);
    }
    Pack h[3][3];
    for (int a = 0; a < 3; ++a) {
        Pack g[3];
        for (int i = 0; i < 3; ++i) g[i] = Pack::load(in.batch.shape[3 * a + i]);
        law.weigh(g, h[a]);
    }
    int index = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) law.add_block(h[a], h[b], volume, blocks[index++]);
}

} // namespace

void reference_strain(const TetBatch& batch, const StrainReference& reference, const Corners& x,
                      const Corners& x_between, const Corners& v, double* out) {
    Pack f[9], sum[6], listed[6];
    Strains<Pack> strains;
    deformation_gradient(batch, x, f);
    set_strains(f, strains);
    list_strain(strains.green, sum);
    for (Pack& s : sum) s *= Pack(reference.start);
    if (reference.v) {
        Pack rate[9];
        deformation_gradient(batch, v, rate);
        strain_rate(f, rate, listed);
        for (int i = 0; i < 6; ++i) sum[i] += Pack(reference.rate) * listed[i];
    }
    if (reference.x_between) {
        deformation_gradient(batch, x_between, f);
        set_strains(f, strains);
        list_strain(strains.green, listed);
        for (int i = 0; i < 6; ++i) sum[i] += Pack(reference.between) * listed[i];
    }
    for (int i = 0; i < 6; ++i) sum[i].store(out + i * lanes);
}

void point_gradient(const PointInputs& in, const Corners& corners, double* out, ElementSummary& summary) {
    const TetBatch& batch = in.batch;
    Pack f[9];
    deformation_gradient(batch, corners, f);
    const Pack volume = Pack::load(batch.volume) * Pack(in.share);
    Pack g[4][3];
    for (auto& corner : g)
        for (Pack& component : corner) component = Pack(0.0);
    Pack energy(0.0);
    if (has_tensor_form(in.law)) {
        Strains<Pack> strains;
        set_strains(f, strains);
        TensorForm<Pack> law;
        evaluate_point(in, strains, law);
        energy = law.energy;
        Pack p[9];
        tensor_stress(strains, law, p);
        add_stress_forces(batch, volume, p, g);
    } else if (has_principal_part(in)) {
        Svd3<Pack> svd;
        svd3(f, svd);
        Principal<Pack> q;
        evaluate_point(in, svd.s, q);
        energy = q.energy;
        Pack p[9];
        recompose(svd.u, q.first, svd.v, p);
        if (damps_alone(in)) {
            Strains<Pack> strains;
            set_strains(f, strains);
            TensorForm<Pack> damping;
            clear(damping);
            add_viscosity(in, strains, damping);
            energy += damping.energy;
            Pack viscous[9];
            tensor_stress(strains, damping, viscous);
            for (int i = 0; i < 9; ++i) p[i] += viscous[i];
        }
        add_stress_forces(batch, volume, p, g);
    }
    if (needs_direction(in.law)) {
        const AnisotropicStVK<Pack> law = anisotropic_at(in, f);
        Pack p[9];
        law.stress(p);
        energy += law.energy();
        add_stress_forces(batch, volume, p, g);
    }
    for (int c = 0; c < 3; ++c) g[0][c] = -(g[1][c] + g[2][c] + g[3][c]);
    energy *= volume;
    Pack squares(0.0);
    for (const ActiveFiber& fiber : in.fibers) add_fiber_gradient(batch, fiber, f, volume, g, energy, squares);
    for (int corner = 0; corner < 4; ++corner)
        for (int c = 0; c < 3; ++c) g[corner][c].store(out + (3 * corner + c) * lanes);
    energy.store(summary.energy);
    determinant(f).store(summary.j);
    squares.store(summary.fiber_squares);
}

void point_hessian(const PointInputs& in, const Corners& corners, bool project, double* out) {
    const TetBatch& batch = in.batch;
    Pack f[9];
    deformation_gradient(batch, corners, f);
    const Pack volume = Pack::load(batch.volume) * Pack(in.share);
    Pack blocks[6][9]; // of corners a <= b in 1…3: 11 12 13 22 23 33
    if (has_tensor_form(in.law) && !project)
        exact_blocks(in, f, volume, blocks);
    else if (has_principal_part(in)) {
        principal_blocks(in, f, volume, project, blocks);
        if (damps_alone(in)) add_viscous_blocks(in, f, volume, project, blocks);
    } else
        for (auto& block : blocks)
            for (Pack& entry : block) entry = Pack(0.0);
    if (needs_direction(in.law)) add_anisotropic_blocks(in, f, volume, project, blocks);
    for (const ActiveFiber& fiber : in.fibers) add_fiber_hessian(batch, fiber, f, volume, blocks);

    // Barycentric coordinates sum to one, so every row of blocks sums to zero: those of corner 0 follow from the
    // others.
    constexpr int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const auto entry = [&](int a, int b, int r, int c) { return blocks[at[a][b]][a <= b ? 3 * r + c : 3 * c + r]; };
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            const int e = 3 * r + c;
            Pack corner(0.0);
            for (int b = 0; b < 3; ++b) {
                const Pack sum = entry(0, b, r, c) + entry(1, b, r, c) + entry(2, b, r, c);
                (-sum).store(out + ((1 + b) * 9 + e) * lanes);
                corner += sum;
            }
            corner.store(out + e * lanes);
            for (int k = 0; k < 6; ++k) blocks[k][e].store(out + ((4 + k) * 9 + e) * lanes);
        }
}

void point_measures(LawInUse law, const TetBatch& batch, const Corners& corners, bool with_measure,
                    PointMeasures& out) {
    Pack f[9], by_f[9];
    deformation_gradient(batch, corners, f);
    const auto by_corners = [&](Pack g[4][3]) {
        for (int c = 0; c < 3; ++c) {
            for (int a = 1; a < 4; ++a) g[a][c] = Pack(0.0);
        }
        add_stress_forces(batch, Pack(1.0), by_f, g);
        for (int c = 0; c < 3; ++c) g[0][c] = -(g[1][c] + g[2][c] + g[3][c]);
    };
    out.j = determinant(f);
    cofactor(f, by_f);
    by_corners(out.d_j);
    if (!with_measure) return;
    if (has_tensor_form(law)) {
        Strains<Pack> strains;
        set_strains(f, strains);
        TensorForm<Pack> form;
        evaluate_measure(law, strains, form);
        out.measure = form.energy;
        tensor_stress(strains, form, by_f);
        by_corners(out.d_measure);
        return;
    }
    Svd3<Pack> svd;
    svd3(f, svd);
    Principal<Pack> q;
    evaluate_measure(law, svd.s, q);
    out.measure = q.energy;
    recompose(svd.u, q.first, svd.v, by_f);
    by_corners(out.d_measure);
}

void elastic_stress(ElasticLaw law, double mu, double lambda, double compression, const double* f, double* p,
                    double* energy, const double* direction, double transverse) {
    if (needs_direction(law)) {
        const AnisotropicStVK<double> a(f, {direction[0], direction[1], direction[2]}, std::pow(transverse, 0.25), mu,
                                        lambda);
        a.stress(p);
        *energy = a.energy();
        return;
    }
    if (has_tensor_form(law)) {
        Strains<double> strains;
        set_strains(f, strains);
        TensorForm<double> form{};
        evaluate_law(law, strains, mu, lambda, compression, form);
        tensor_stress(strains, form, p);
        *energy = form.energy;
        return;
    }
    Svd3<double> svd;
    svd3(f, svd);
    Principal<double> q{};
    evaluate_law(law, &svd.s[0], mu, lambda, compression, q);
    recompose(svd.u, q.first, svd.v, p);
    *energy = q.energy;
}

} // namespace sinew::solver
