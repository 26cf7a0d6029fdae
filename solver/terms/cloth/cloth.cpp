// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/cloth/cloth.h"

#include "solver/element/mass_matrix.h"
#include "solver/terms/cloth/check_cloth.h"
#include "solver/terms/cloth/cloth_mix.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace sinew::solver {

namespace {

constexpr Measure measures[] = {
    {"cloth", "max_stretch_percent", "%", "largest stretch of cloth", Combine::most},
    {"cloth", "max_compression_percent", "%", "largest compression of cloth", Combine::most},
    {"cloth", "max_shear_rad", "rad", "largest shear of cloth", Combine::most},
    {"cloth", "max_fold_rad", "rad", "sharpest fold of cloth", Combine::most},
};

const PackVector no_vector{Pack(0.0), Pack(0.0), Pack(0.0)};

Pack squares_of(const PackVector* g, std::size_t count) {
    Pack sum(0.0);
    for (std::size_t i = 0; i < count; ++i) sum += dot(g[i], g[i]);
    return sum;
}

} // namespace

const TermType cloth_type{
    .name = "cloth",
    .numerics = 4,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        for (const Deformable& d : scene.numbering().deformables)
            if (d.is_sheet) return std::make_unique<Cloth>(scene);
        return nullptr;
    },
};

Cloth::Cloth(const Scene& scene)
    : scene_(scene) {
    std::vector<PointWeights> points;
    std::vector<std::array<int, 3>> triangles, beside;
    std::vector<std::array<int, 6>> folds;
    const Numbering& numbering = scene.numbering();
    for (std::size_t d = 0; d < numbering.deformables.size(); ++d) {
        const Deformable& body = numbering.deformables[d];
        if (!body.is_sheet) continue;
        const ClothRest& rest = *scene.cloth(body.body);
        const int first = static_cast<int>(points.size());
        sheets_.push_back({body.body, d, body.first_vertex, triangles.size(), rest.triangles.size()});
        const std::vector<std::array<int, 3>> across = across_from(rest.triangles);
        for (std::size_t t = 0; t < rest.triangles.size(); ++t) {
            const Triangle& c = rest.triangles[t];
            triangles.push_back({c[0] + first, c[1] + first, c[2] + first});
            std::array<int, 6>& fold = folds.emplace_back();
            for (std::size_t i = 0; i < 3; ++i)
                fold[i] = c[i] + first, fold[3 + i] = (across[t][i] < 0 ? c[i] : across[t][i]) + first;
            beside.push_back(across[t]);
        }
        for (std::size_t v = 0; v < rest.surface.size(); ++v)
            points.push_back(scene.carrier_of(body.body, static_cast<int>(v)));
    }
    std::vector<int> carrier(points.size());
    std::iota(carrier.begin(), carrier.end(), 0);
    triangles_ = std::make_unique<Stencils<3>>(numbering, points, carrier, std::move(triangles));
    folds_ = std::make_unique<Stencils<6>>(numbering, points, carrier, std::move(folds));
    membranes_.resize(triangles_->batch_count());
    fold_batches_.resize(folds_->batch_count());
    squares_of_triangles_.assign(lanes * membranes_.size(), 0.0);
    squares_of_folds_.assign(lanes * fold_batches_.size(), 0.0);
    angle_starts_.assign(3 * lanes * fold_batches_.size(), 0.0);
    shown_.assign(3 * lanes * membranes_.size(), 0.0);
    vertex_mass_.assign(numbering.vertex_count(), 0.0);
    inputs_.resize(sheets_.size());
    force_floor_.assign(sheets_.size(), 0.0), squared_stiffness_.assign(sheets_.size(), 0.0);
    set_rest();
    for (const Sheet& sheet : sheets_)
        for (std::size_t t = sheet.first_triangle; t < sheet.first_triangle + sheet.triangle_count; ++t)
            set_fold(t, {beside[t][0] >= 0, beside[t][1] >= 0, beside[t][2] >= 0},
                     scene.cloth(sheet.body)->bend_rest == BendRestAngle::flat);
}

/// Areas and angles of the mesh as modelled.
void Cloth::set_rest() {
    const std::vector<double>& rest = scene_.numbering().rest;
    triangles_->move(rest);
    const std::span<const double> places = std::as_const(*triangles_).places();
    const auto place = [&](int p) { return Eigen::Map<const Vec3>(places.data() + 3 * at(p)); };
    for (std::size_t slot = 0; slot < lanes * membranes_.size(); ++slot) {
        const auto [a, b, c] = triangles_->corners(slot);
        const double area = 0.5 * (place(b) - place(a)).cross(place(c) - place(a)).norm();
        membranes_[slot / lanes].area[slot % lanes] = area;
        for (auto& least : fold_batches_[slot / lanes].least) least[slot % lanes] = 1e-16 * area * area;
    }
    folds_->move(rest);
    folds_->evaluate(false, [&](std::size_t b, const StencilVectors<6>& x, StencilVectors<6>& g) {
        for (std::size_t i = 0; i < 3; ++i)
            Fold::hinge(x, fold_batches_[b], i).angle().store(fold_batches_[b].rest_angle[i]);
        for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
        return Pack(0.0);
    });
}

/// After set_rest: the curvature that a triangle's angles say, where its neighbours are laid into its plane.
void Cloth::set_fold(std::size_t slot, const std::array<bool, 3>& is_there, bool flat) {
    FoldBatch& batch = fold_batches_[slot / lanes];
    const std::size_t lane = slot % lanes;
    const std::array<int, 6>& corners = folds_->corners(slot);
    const std::span<const double> places = std::as_const(*folds_).places();
    Vec3 p[6];
    for (std::size_t c = 0; c < 6; ++c) p[c] = Eigen::Map<const Vec3>(places.data() + 3 * at(corners[c]));
    const Vec3 along = (p[1] - p[0]).normalized();
    const Vec3 across = (p[1] - p[0]).cross(p[2] - p[0]).normalized().cross(along);
    Eigen::Vector2d q[6];
    for (std::size_t c = 0; c < 3; ++c) q[c] = {(p[c] - p[0]).dot(along), (p[c] - p[0]).dot(across)};
    // Angles by the curvatures of z = 1/2 x^T K x: rows of angles that are there; K by xx, yy and sqrt 2 xy.
    std::vector<std::size_t> there;
    Mat3 by_curvature = Mat3::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
        if (flat) batch.rest_angle[i][lane] = 0;
        batch.is_there[i][lane] = is_there[i];
        if (!is_there[i]) continue;
        const auto& h = Fold::corners[i];
        const Vec3 edge = p[h[1]] - p[h[0]], to = p[h[3]] - p[h[0]];
        const double length = edge.norm(), share = to.dot(edge) / (length * length);
        const double height = (to - share * edge).norm();
        const Eigen::Vector2d flat_edge = q[h[1]] - q[h[0]];
        Eigen::Vector2d out(flat_edge.y(), -flat_edge.x());
        if (out.dot(q[h[2]] - q[h[0]]) > 0) out = -out;
        q[3 + i] = q[h[0]] + share * flat_edge + height / length * out;
        StencilVectors<4> x, slope;
        for (std::size_t c = 0; c < 4; ++c) x[c] = {Pack(q[h[c]].x()), Pack(q[h[c]].y()), Pack(0.0)};
        Hinge(x, Pack(batch.least[i][lane])).gradient(slope);
        for (std::size_t c = 0; c < 4; ++c) {
            const Eigen::Vector2d& at = q[h[c]];
            by_curvature.row(static_cast<Eigen::Index>(i)) +=
                slope[c].z[0] *
                Eigen::RowVector3d(0.5 * at.x() * at.x(), 0.5 * at.y() * at.y(), M_SQRT1_2 * at.x() * at.y());
        }
    }
    // Its inverse, the smallest curvature where angles are missing; where they hardly say one, no stiffer than this.
    constexpr double least_share = 0.15;
    const Eigen::JacobiSVD<Mat3> svd(by_curvature, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vec3 inverse = Vec3::Zero();
    const int known = static_cast<int>(is_there[0]) + is_there[1] + is_there[2];
    for (int k = 0; k < known; ++k)
        inverse[k] = 1 / std::max(svd.singularValues()[k], least_share * svd.singularValues()[0]);
    const Mat3 b = svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
    const Mat3 weight = membranes_[slot / lanes].area[lane] * b.transpose() * b;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j)
            batch.weight[Fold::entry(i, j)][lane] =
                is_there[i] && is_there[j] ? weight(Eigen::Index(i), Eigen::Index(j)) : 0;
}

Changes Cloth::take(const StepInputs& inputs, const State&) {
    const auto values = [&](const Sheet& s) -> const ClothInputs& {
        return std::get<ClothInputs>(inputs.bodies[at(s.body)]);
    };
    for (const Sheet& sheet : sheets_) check_cloth_values(values(sheet), sheet.body);
    bool changed = false;
    for (std::size_t s = 0; s < sheets_.size(); ++s) {
        const ClothInputs& in = values(sheets_[s]);
        const bool same =
            same_fields(inputs_[s], in) && std::equal(inputs_[s].layers.begin(), inputs_[s].layers.end(),
                                                      in.layers.begin(), in.layers.end(), same_fields<ClothMaterial>);
        if (same) continue;
        inputs_[s] = in;
        set_materials(sheets_[s], in);
        changed = true;
    }
    if (changed) set_scales();
    return {.couplings = false, .masses = changed};
}

void Cloth::set_materials(const Sheet& sheet, const ClothInputs& in) {
    const ClothRest& rest = *scene_.cloth(sheet.body);
    // Composited at vertices, as it is painted; a triangle takes the mean of its corners.
    mix_layers(rest, in, mixed_);
    cloth_masses(rest, mixed_, masses_);
    std::copy(masses_.begin(), masses_.end(), vertex_mass_.begin() + static_cast<std::ptrdiff_t>(sheet.first_vertex));
    for (std::size_t t = 0; t < sheet.triangle_count; ++t) {
        const Triangle& corners = rest.triangles[t];
        const auto mean = [&](double ClothMaterial::*value) {
            return (mixed_[at(corners[0])].*value + mixed_[at(corners[1])].*value + mixed_[at(corners[2])].*value) / 3;
        };
        const std::size_t slot = sheet.first_triangle + t, lane = slot % lanes;
        MembraneBatch& batch = membranes_[slot / lanes];
        const double scale = std::pow(mean(&ClothMaterial::rest_scale), in.rest_scale_envelope);
        const Vec3 &origin = rest.surface[at(corners[0])], &along = rest.warp[t];
        const Vec3 e1 = rest.surface[at(corners[1])] - origin, e2 = rest.surface[at(corners[2])] - origin;
        const Vec3 across = e1.cross(e2).normalized().cross(along);
        // w_u = u_1 e_1 + u_2 e_2 is `along` at rest, w_v `across`: rows of the inverse of their coordinates.
        const double a = e1.dot(along), b = e2.dot(along), c = e1.dot(across), d = e2.dot(across), det = a * d - b * c;
        batch.u[0][lane] = d / det / scale, batch.u[1][lane] = -c / det / scale;
        batch.v[0][lane] = -b / det / scale, batch.v[1][lane] = a / det / scale;
        const double area = batch.area[lane];
        batch.stretch[lane] = mean(&ClothMaterial::tensile_stiffness) * area * scale * scale;
        batch.shear[lane] = mean(&ClothMaterial::shear_stiffness) * area * scale * scale;
        fold_batches_[slot / lanes].stiffness[lane] = mean(&ClothMaterial::bend_stiffness);
    }
    // Slots after the last repeat it, and count nowhere.
    for (std::size_t slot = triangles_->count(); slot < lanes * membranes_.size(); ++slot) {
        const std::size_t last = triangles_->count() - 1;
        MembraneBatch& batch = membranes_[slot / lanes];
        for (auto* row : {&batch.u[0], &batch.u[1], &batch.v[0], &batch.v[1], &batch.stretch, &batch.shear})
            (*row)[slot % lanes] = (*row)[last % lanes];
    }
}

void Cloth::set_scales() {
    energy_scale_ = 0;
    for (std::size_t s = 0; s < sheets_.size(); ++s) {
        const Sheet& sheet = sheets_[s];
        double floor = 0, stiffness = 0;
        for (std::size_t t = sheet.first_triangle; t < sheet.first_triangle + sheet.triangle_count; ++t) {
            const MembraneBatch& b = membranes_[t / lanes];
            const std::size_t lane = t % lanes;
            double squares = 0;
            for (const auto* row : {&b.u, &b.v})
                squares += std::pow((*row)[0][lane], 2) + std::pow((*row)[1][lane], 2) +
                           std::pow((*row)[0][lane] + (*row)[1][lane], 2);
            const double k = b.stretch[lane] + b.shear[lane];
            floor += k * k * squares, stiffness += k * k * squares * squares;
            energy_scale_ += k + fold_batches_[t / lanes].stiffness[lane];
        }
        // Far below what stretch can do: bending is up to 1e9 times as soft, and must be at rest, too.
        force_floor_[s] = 1e-9 * std::sqrt(floor);
        squared_stiffness_[s] = stiffness;
    }
}

void Cloth::add_couplings(Couplings& couplings) const {
    triangles_->add_couplings(couplings);
    folds_->add_couplings(couplings);
}

void Cloth::bind(const BlockPattern& pattern) {
    triangles_->bind(pattern);
    folds_->bind(pattern);
}

void Cloth::add_masses(MassMatrix& masses) const {
    for (const Sheet& sheet : sheets_)
        for (std::size_t v = 0; v < scene_.cloth(sheet.body)->surface.size(); ++v)
            masses.add_lumped(static_cast<int>(sheet.first_vertex + v), vertex_mass_[sheet.first_vertex + v]);
}

Membrane Cloth::membrane(std::size_t batch, const StencilVectors<3>& x, double damping) const {
    return Membrane(membranes_[batch], x, damping, damping > 0 ? references_[batch].c : nullptr);
}

Fold Cloth::fold(std::size_t batch, const StencilVectors<6>& x, double damping) const {
    const double* start = angle_starts_.data() + 3 * batch * lanes;
    return Fold(fold_batches_[batch], x, start, damping,
                damping > 0 ? angle_references_.data() + 3 * batch * lanes : nullptr);
}

/// From where folds go on within a stage: at its start, by the way round that is nearer to how they are at rest.
void Cloth::start_angles(const Positions& x) {
    folds_->move(x);
    folds_->evaluate(false, [&](std::size_t b, const StencilVectors<6>& at, StencilVectors<6>& g) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Pack angle = Fold::hinge(at, fold_batches_[b], i).angle();
            turned_to(angle, Pack::load(fold_batches_[b].rest_angle[i]))
                .store(angle_starts_.data() + (3 * b + i) * lanes);
        }
        for (PackVector& v : g) v = no_vector;
        return Pack(0.0);
    });
}

void Cloth::begin_stage(const Stage& stage) {
    start_angles(stage.before.x);
    damping_ = stage.inputs.stiffness_damping * stage.form.velocity_factor;
    if (!(damping_ > 0)) return;
    const StrainReference& strain = stage.form.strain;
    references_.assign(membranes_.size(), {});
    angle_references_.assign(3 * lanes * fold_batches_.size(), 0.0);
    // Adds `share` times what the numbers are for vertices at x, or, where v is given, their rates there.
    triangles_at_.resize(strain.v ? membranes_.size() : 0);
    folds_at_.resize(strain.v ? fold_batches_.size() : 0);
    const auto add = [&](const std::vector<double>& x, double share, bool rates) {
        const auto none = [](auto& g) {
            for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
            return Pack(0.0);
        };
        triangles_->move(x);
        triangles_->evaluate(false, [&](std::size_t b, const StencilVectors<3>& at, StencilVectors<3>& g) {
            const Membrane m = membrane(b, rates ? triangles_at_[b] : at, 0);
            Pack change[3] = {m.number(0), m.number(1), m.number(2)};
            if (rates) m.rates(at, change);
            for (std::size_t i = 0; i < 3; ++i) {
                double* out = references_[b].c[i];
                (Pack::load(out) + Pack(share) * change[i]).store(out);
            }
            if (!triangles_at_.empty() && !rates) triangles_at_[b] = at;
            return none(g);
        });
        folds_->move(x);
        folds_->evaluate(false, [&](std::size_t b, const StencilVectors<6>& at, StencilVectors<6>& g) {
            const Fold f = fold(b, rates ? folds_at_[b] : at, 0);
            Pack change[3] = {f.angle(0), f.angle(1), f.angle(2)};
            if (rates) f.rates(at, change);
            for (std::size_t i = 0; i < 3; ++i) {
                double* out = angle_references_.data() + (3 * b + i) * lanes;
                (Pack::load(out) + Pack(share) * change[i]).store(out);
            }
            if (!folds_at_.empty() && !rates) folds_at_[b] = at;
            return none(g);
        });
    };
    if (strain.x_between && strain.between != 0) add(*strain.x_between, strain.between, false);
    add(*strain.x, strain.start, false); // last, for the rates are those there
    if (strain.v && strain.rate != 0) add(*strain.v, strain.rate, true);
}

double Cloth::energy(const Positions& x, bool with_forces) {
    triangles_->move(x);
    double total =
        triangles_->evaluate(with_forces, [&](std::size_t b, const StencilVectors<3>& at, StencilVectors<3>& g) {
            const Membrane m = membrane(b, at, damping_);
            if (with_forces) {
                m.gradient(g);
                squares_of(g.data(), 3).store(squares_of_triangles_.data() + b * lanes);
            } else {
                g.fill(no_vector);
            }
            return m.energy();
        });
    if (with_forces) triangles_->carry_gradient();
    folds_->move(x);
    total += folds_->evaluate(with_forces, [&](std::size_t b, const StencilVectors<6>& at, StencilVectors<6>& g) {
        const Fold f = fold(b, at, damping_);
        if (with_forces) {
            f.gradient(g);
            squares_of(g.data(), 6).store(squares_of_folds_.data() + b * lanes);
        } else {
            g.fill(no_vector);
        }
        return f.energy();
    });
    if (with_forces) folds_->carry_gradient();
    return total;
}

double Cloth::stored_energy(const Positions& x) {
    const double damping = std::exchange(damping_, 0);
    const double total = energy(x, true);
    damping_ = damping;
    return total;
}

void Cloth::add_gradient(std::span<double> gradient) const {
    triangles_->add_gradient(gradient);
    folds_->add_gradient(gradient);
}

void Cloth::add_held_gradient(std::span<double> gradient) const {
    triangles_->add_held_gradient(gradient);
    folds_->add_held_gradient(gradient);
}

void Cloth::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    triangles_->move(x);
    triangles_->add_hessian([&](std::size_t b, const StencilVectors<3>& at,
                                StencilBlocks<3>& h) { membrane(b, at, damping_).hessian(project, h); },
                            a);
    folds_->move(x);
    folds_->add_hessian([&](std::size_t b, const StencilVectors<6>& at,
                            StencilBlocks<6>& h) { fold(b, at, damping_).hessian(project, h); },
                        a);
}

void Cloth::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    for (std::size_t s = 0; s < sheets_.size(); ++s) {
        const Sheet& sheet = sheets_[s];
        const auto norm = [](const std::vector<double>& squares, std::size_t first, std::size_t count) {
            return std::sqrt(ordered_sum(count, [&](std::size_t i) { return squares[first + i]; }));
        };
        double& most = largest[sheet.deformable];
        most = std::max({most, norm(squares_of_triangles_, sheet.first_triangle, sheet.triangle_count),
                         norm(squares_of_folds_, sheet.first_triangle, sheet.triangle_count), force_floor_[s]});
    }
}

void Cloth::add_squared_stiffnesses(std::span<double> squares) const {
    for (std::size_t s = 0; s < sheets_.size(); ++s)
        squares[sheets_[s].deformable] += (1 + damping_) * (1 + damping_) * squared_stiffness_[s];
}

void Cloth::add_vertex_stiffness(std::span<double> stiffness) const {
    for (const Sheet& sheet : sheets_) {
        const ClothRest& rest = *scene_.cloth(sheet.body);
        for (std::size_t t = 0; t < sheet.triangle_count; ++t) {
            const std::size_t slot = sheet.first_triangle + t;
            const double share = membranes_[slot / lanes].stretch[slot % lanes] / 3;
            for (const int v : rest.triangles[t]) stiffness[sheet.first_vertex + at(v)] += share;
        }
    }
}

void Cloth::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    double stretch = 0, compression = 0, shear = 0, sharpest = 0;
    triangles_->move(x);
    triangles_->evaluate(false, [&](std::size_t b, const StencilVectors<3>& at, StencilVectors<3>& g) {
        const Membrane m = membrane(b, at, 0);
        for (std::size_t i = 0; i < 3; ++i) m.number(i).store(shown_.data() + (3 * b + i) * lanes);
        for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
        return Pack(0.0);
    });
    for (std::size_t slot = 0; slot < triangles_->count(); ++slot) {
        const auto number = [&](std::size_t i) { return shown_[(3 * (slot / lanes) + i) * lanes + slot % lanes]; };
        for (const std::size_t i : {std::size_t{0}, std::size_t{1}})
            stretch = std::max(stretch, number(i)), compression = std::max(compression, -number(i));
        const double lengths = (1 + number(0)) * (1 + number(1));
        if (lengths > 0) shear = std::max(shear, std::abs(std::asin(std::clamp(number(2) / lengths, -1.0, 1.0))));
    }
    folds_->move(x);
    folds_->evaluate(false, [&](std::size_t b, const StencilVectors<6>& at, StencilVectors<6>& g) {
        for (std::size_t i = 0; i < 3; ++i)
            Fold::hinge(at, fold_batches_[b], i).angle().store(shown_.data() + (3 * b + i) * lanes);
        for (PackVector& v : g) v = {Pack(0.0), Pack(0.0), Pack(0.0)};
        return Pack(0.0);
    });
    for (std::size_t slot = 0; slot < folds_->count(); ++slot)
        for (std::size_t i = 0; i < 3; ++i)
            if (fold_batches_[slot / lanes].is_there[i][slot % lanes])
                sharpest = std::max(sharpest, std::abs(shown_[(3 * (slot / lanes) + i) * lanes + slot % lanes]));
    const double values[] = {100 * stretch, 100 * compression, shear, sharpest};
    for (std::size_t i = 0; i < 4; ++i) out.push_back({&measures[i], values[i]});
}

} // namespace sinew::solver
