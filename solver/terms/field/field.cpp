// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/field/field.h"

#include "solver/error.h"
#include "solver/parallel.h"
#include "solver/terms/cloth/cloth_mix.h"
#include "solver/terms/elastic/layer_mix.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace sinew::solver {

namespace {

constexpr std::size_t grain = 128;

constexpr auto value_names = field_names<FieldValues>();
constexpr Measure measures[] = {
    {"field", "force_x_N", "N", "force of fields along x", Combine::last},
    {"field", "force_y_N", "N", "along y", Combine::last},
    {"field", "force_z_N", "N", "along z", Combine::last},
};

bool acts(const Part& part) { return part.type == &field_type && !part.bodies.empty(); }

std::vector<int> reached_bodies(const Scene& scene) {
    std::vector<int> out;
    for (const Part& part : scene.description().parts)
        if (acts(part)) out.insert(out.end(), part.bodies.begin(), part.bodies.end());
    return out;
}

/// Names of the fields, as nodes have them.
constexpr std::string_view names[] = {"airField",     "dragField",   "gravityField",
                                      "newtonField",  "radialField", "turbulenceField",
                                      "uniformField", "vortexField", "volumeAxisField"};

} // namespace

const TermType field_type{
    .name = "field",
    .values = value_names,
    .measures = measures,
    .make = [](const Scene& scene) -> std::unique_ptr<Term> {
        const std::vector<int> bodies = reached_bodies(scene);
        for (const int body : bodies)
            if (!scene.deforms(body)) {
                Error e("FE218", "a field acts on a bone", "bones follow their animation alone: connect tissues");
                e.body = body;
                throw e;
            }
        return bodies.empty() ? nullptr : std::make_unique<BodyFields>(scene);
    },
};

BodyFields::BodyFields(const Scene& scene)
    : scene_(scene)
    , points_(scene, reached_bodies(scene)) {
    const auto& parts = scene.description().parts;
    actions_.resize(points_.bodies().size());
    std::size_t first = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (!acts(parts[p])) continue;
        for (std::size_t b = 0; b < actions_.size(); ++b) {
            const VolumePoints::OfBody& body = points_.bodies()[b];
            if (std::find(parts[p].bodies.begin(), parts[p].bodies.end(), body.body) == parts[p].bodies.end()) continue;
            actions_[b].push_back({static_cast<int>(p), parts_.size(), b, first});
            first += body.count;
        }
        parts_.push_back(static_cast<int>(p));
    }
    kept_.resize(first);
    materials_.resize(actions_.size()), sheets_.resize(actions_.size());
    offset_.assign(points_.count(), Vec3::Zero());
    loads_.resize(points_.count());
    tangents_.assign(points_.count(), Mat3::Zero());
    works_.resize(points_.count());
}

template <class Visit>
void BodyFields::for_each_action(const Visit& visit) const {
    for (const auto& of_body : actions_)
        for (const Action& a : of_body)
            if (fields_[a.field].values.magnitude != 0) visit(a, fields_[a.field], points_.bodies()[a.body]);
}

Changes BodyFields::take(const StepInputs& inputs, const State&) {
    const auto& parts = scene_.description().parts;
    const auto made = [&](std::size_t k) {
        const std::size_t p = static_cast<std::size_t>(parts_[k]);
        try {
            return field_at(static_cast<const FieldRest&>(*parts[p].rest), inputs.parts[p]);
        } catch (Error& e) {
            e.body = parts[p].bodies.front();
            throw;
        }
    };
    for (std::size_t k = 0; k < parts_.size(); ++k) made(k); // all of them before anything is taken
    fields_.resize(parts_.size());
    for (std::size_t k = 0; k < parts_.size(); ++k) fields_[k] = made(k);
    by_mass_ = std::any_of(fields_.begin(), fields_.end(), [](const FieldAt& f) { return f.by_mass(); });
    acts_ = std::any_of(fields_.begin(), fields_.end(), [](const FieldAt& f) { return f.values.magnitude != 0; });
    is_off_.resize(points_.bodies().size());
    for (std::size_t b = 0; b < is_off_.size(); ++b)
        is_off_[b] = is_frozen(inputs.bodies[static_cast<std::size_t>(points_.bodies()[b].body)]);
    take_materials(inputs);
    return {};
}

void BodyFields::take_materials(const StepInputs& inputs) {
    if (!by_mass_) return;
    bool changed = false;
    for (std::size_t b = 0; b < materials_.size(); ++b) {
        const VolumePoints::OfBody& body = points_.bodies()[b];
        const BodyInputs& values = inputs.bodies[static_cast<std::size_t>(body.body)];
        if (!body.tissue) {
            const auto& in = std::get<ClothInputs>(values);
            if (!sheets_[b].layers.empty() && std::equal(in.layers.begin(), in.layers.end(), sheets_[b].layers.begin(),
                                                         sheets_[b].layers.end(), same_fields<ClothMaterial>))
                continue;
            sheets_[b] = in;
            changed = true;
            continue;
        }
        const auto& in = std::get<TissueInputs>(values);
        if (!materials_[b].layers.empty() && same_material(materials_[b], in)) continue;
        materials_[b] = in;
        changed = true;
    }
    if (changed && !volumes_.empty()) bind_masses();
}

void BodyFields::bind(const BlockPattern& pattern) {
    points_.bind(pattern);
    const Scene::System& system = scene_.system();
    of_tet_.resize(lanes * system.batches.size());
    for (std::size_t slot = 0; slot < of_tet_.size(); ++slot)
        of_tet_[slot] = system.batches[slot / lanes].volume[slot % lanes];
    points_.share_out(of_tet_, volumes_);
    for (const VolumePoints::OfBody& b : points_.bodies())
        if (!b.tissue) {
            const std::vector<double> areas = vertex_areas(scene_.surface(b.body), scene_.triangles(b.body));
            std::copy(areas.begin(), areas.end(), volumes_.begin() + static_cast<std::ptrdiff_t>(b.first));
        }
    if (by_mass_) bind_masses();
}

void BodyFields::bind_masses() {
    const Scene::System& system = scene_.system();
    for (std::size_t b = 0; b < materials_.size(); ++b) {
        if (!points_.bodies()[b].tissue) continue;
        const TissueBatches& t = *points_.bodies()[b].tissue;
        const TissueRest& rest = *scene_.tissue(t.body);
        for (std::size_t slot = 0; slot < t.tet_count; ++slot)
            of_tet_[t.first_batch * lanes + slot] = mix_layers(rest, materials_[b], slot).mass_density *
                                                    system.batches[t.first_batch + slot / lanes].volume[slot % lanes];
    }
    points_.share_out(of_tet_, masses_);
    for (std::size_t b = 0; b < sheets_.size(); ++b) {
        const VolumePoints::OfBody& body = points_.bodies()[b];
        if (body.tissue) continue;
        const ClothRest& rest = *scene_.cloth(body.body);
        std::vector<ClothMaterial> mixed;
        std::vector<double> mass;
        mix_layers(rest, sheets_[b], mixed);
        cloth_masses(rest, mixed, mass);
        std::copy(mass.begin(), mass.end(), masses_.begin() + static_cast<std::ptrdiff_t>(body.first));
    }
}

void BodyFields::set_places(const Positions& x, std::vector<Vec3>& places) const {
    places.resize(points_.count());
    parallel_for(places.size(), grain, [&](std::size_t i) { places[i] = points_.carried(i, x); });
}

void BodyFields::begin_stage(const Stage& stage) {
    velocity_factor_ = stage.form.velocity_factor;
    energy_scale_ = 0;
    if (!acts_) return;
    set_places(stage.before.x, start_);
    bool moves = false;
    for_each_action([&](const Action&, const FieldAt& f, const VolumePoints::OfBody& b) {
        moves = moves || f.resists();
        if (f.is_central())
            energy_scale_ += ordered_sum(b.count, [&](std::size_t i) {
                return weights(f)[b.first + i] * field_potential_scale(f, start_[b.first + i]);
            });
    });
    if (moves) set_places(stage.form.velocity_offset, offset_);
    kept_at_ = start_;
    keep(start_);
}

void BodyFields::keep(const std::vector<Vec3>& places) {
    for_each_action([&](const Action& a, const FieldAt& f, const VolumePoints::OfBody& b) {
        const bool force = keeps_force(f), resistance = keeps_resistance(f);
        if (!force && !resistance) return;
        parallel_for(b.count, grain, [&](std::size_t i) {
            const std::size_t p = b.first + i;
            Kept& kept = kept_[a.first + i];
            if (force) kept.force = field_force(f, places[p], velocity(p, places[p]));
            if (resistance) kept.resistance = field_resistance(f, places[p]);
        });
    });
}

double BodyFields::begin_iteration(const Positions& x) {
    bool keeps = false;
    for (const FieldAt& f : fields_) keeps = keeps || keeps_force(f) || (keeps_resistance(f) && f.varies());
    if (!keeps || !acts_) return 0;
    set_places(x, at_);
    const double before = total_work();
    kept_at_ = at_;
    keep(at_);
    return total_work() - before;
}

double BodyFields::work(const FieldAt& f, const Kept& kept, std::size_t p) const {
    const double weight = weights(f)[p];
    if (f.is_conservative()) return weight * field_potential(f, at_[p], start_[p]);
    if (keeps_force(f)) return -weight * kept.force.dot(at_[p] - kept_at_[p]);
    return weight * kept.resistance / velocity_factor_ * field_dissipation(f, velocity(p, at_[p]));
}

double BodyFields::total_work() {
    std::fill(works_.begin(), works_.end(), 0.0);
    for_each_action([&](const Action& a, const FieldAt& f, const VolumePoints::OfBody& b) {
        parallel_for(b.count, grain,
                     [&](std::size_t i) { works_[b.first + i] += work(f, kept_[a.first + i], b.first + i); });
    });
    return ordered_sum(works_.size(), [&](std::size_t p) { return works_[p]; });
}

double BodyFields::energy(const Positions& x, bool with_forces) {
    if (!acts_) return 0;
    set_places(x, at_);
    if (with_forces) {
        std::fill(loads_.begin(), loads_.end(), Vec3::Zero());
        for_each_action([&](const Action&, const FieldAt& f, const VolumePoints::OfBody& b) {
            const std::vector<double>& weight = weights(f);
            parallel_for(b.count, grain, [&](std::size_t i) {
                const std::size_t p = b.first + i;
                loads_[p] += weight[p] * field_force(f, at_[p], velocity(p, at_[p]));
            });
        });
        at_vertices_.assign(x.size(), 0.0);
        points_.add_to_vertices(loads_, at_vertices_);
    }
    return total_work();
}

void BodyFields::add_gradient(std::span<double> gradient) const {
    if (!acts_) return;
    const Numbering& n = scene_.numbering();
    for (const VolumePoints::OfBody& b : points_.bodies()) {
        const Deformable& d = n.deformables[b.deformable];
        for (std::size_t u = d.first_unknown; u < d.first_unknown + d.unknown_count; ++u)
            for (std::size_t c = 0; c < 3; ++c)
                gradient[3 * u + c] -= at_vertices_[3 * static_cast<std::size_t>(n.vertex_of_unknown[u]) + c];
    }
}

void BodyFields::add_held_gradient(std::span<double> gradient) const {
    if (!acts_) return;
    const std::vector<int>& unknown = scene_.numbering().unknown;
    for (std::size_t v = 0; v < unknown.size(); ++v)
        for (std::size_t c = 3 * v; unknown[v] < 0 && c < 3 * v + 3; ++c) gradient[c] -= at_vertices_[c];
}

void BodyFields::add_hessian(const Positions& x, bool project, BlockMatrix& a) {
    if (!acts_) return;
    bool any = false;
    for (const FieldAt& f : fields_) any = any || has_tangent(f);
    std::fill(tangents_.begin(), tangents_.end(), Mat3::Zero());
    if (!any) return;
    set_places(x, at_);
    for_each_action([&](const Action&, const FieldAt& f, const VolumePoints::OfBody& b) {
        if (!has_tangent(f)) return;
        const std::vector<double>& weight = weights(f);
        parallel_for(b.count, grain, [&](std::size_t i) {
            const std::size_t p = b.first + i;
            const Mat3 t = field_tangent(f, at_[p], velocity(p, at_[p]), velocity_factor_);
            tangents_[p] -= 0.5 * weight[p] * (t + t.transpose());
        });
    });
    if (project)
        parallel_for(tangents_.size(), grain, [&](std::size_t p) {
            const Eigen::SelfAdjointEigenSolver<Mat3> eigen(tangents_[p]);
            if (eigen.eigenvalues()[0] >= 0) return;
            tangents_[p] = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                           eigen.eigenvectors().transpose();
        });
    points_.add_to_hessian(tangents_, a);
}

void BodyFields::raise_forces_at_work(const Positions&, std::span<double> largest) const {
    if (!acts_) return;
    const Numbering& n = scene_.numbering();
    for (const VolumePoints::OfBody& b : points_.bodies()) {
        const Deformable& d = n.deformables[b.deformable];
        const double squares = ordered_sum(3 * d.unknown_count, [&](std::size_t i) {
            const std::size_t v = static_cast<std::size_t>(n.vertex_of_unknown[d.first_unknown + i / 3]);
            return at_vertices_[3 * v + i % 3] * at_vertices_[3 * v + i % 3];
        });
        largest[b.deformable] = std::max(largest[b.deformable], std::sqrt(squares));
    }
}

void BodyFields::add_squared_stiffnesses(std::span<double> squares) const {
    if (!acts_) return;
    for (const VolumePoints::OfBody& b : points_.bodies())
        squares[b.deformable] +=
            ordered_sum(b.count, [&](std::size_t i) { return tangents_[b.first + i].squaredNorm(); });
}

void BodyFields::measure(const Positions& x, std::span<const double>, std::vector<Measured>& out) const {
    std::array<double, 3> total{};
    for_each_action([&](const Action& a, const FieldAt& f, const VolumePoints::OfBody& b) {
        if (is_off_[a.body]) return;
        const auto sums = ordered_sums<3>(b.count, [&](std::size_t i, std::array<double, 3>& sum) {
            const std::size_t p = b.first + i;
            const Vec3 place = points_.carried(p, x), load = weights(f)[p] * field_force(f, place, velocity(p, place));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += load[static_cast<Eigen::Index>(c)];
        });
        for (std::size_t c = 0; c < 3; ++c) total[c] += sums[c];
    });
    for (std::size_t c = 0; c < 3; ++c) out.push_back({&measures[c], total[c]});
}

void BodyFields::marks(const Positions& x, Marks& out) const {
    constexpr std::size_t most = 300; // arrows a field
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        const FieldAt& f = fields_[k];
        MarkGroup group{
            std::string(field_type.name), std::string(names[static_cast<std::size_t>(f.rest->kind)]), "N/m^3", {}};
        std::size_t points = 0;
        double spacing = 0;
        for_each_action([&](const Action& a, const FieldAt&, const VolumePoints::OfBody& b) {
            if (a.field != k || is_off_[a.body]) return;
            points += b.count;
            spacing = std::max(spacing, scene_.numbering().deformables[b.deformable].spacing);
        });
        double largest = 0;
        for_each_action([&](const Action& a, const FieldAt&, const VolumePoints::OfBody& b) {
            if (a.field != k || is_off_[a.body]) return;
            for (std::size_t i = 0; i < b.count; i += points / most + 1) {
                const std::size_t p = b.first + i;
                const Vec3 from = points_.carried(p, x);
                const Vec3 density = weights(f)[p] / volumes_[p] * field_force(f, from, velocity(p, from));
                group.marks.push_back({a.part, from, density, density.norm()});
                largest = std::max(largest, density.norm());
            }
        });
        // The longest arrow reaches over three tets.
        for (Mark& m : group.marks) m.to = m.from + (largest > 0 ? 3 * spacing / largest : 0) * m.to;
        out.push_back(std::move(group));
    }
}

} // namespace sinew::solver
