// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/free_body.h"

#include "solver/meshing/lattice.h"
#include "solver/surface/clipped_surface.h"
#include "solver/surface/triangle_rule.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sinew::bench {

using namespace solver;

namespace {

/// Of points and tangents of quadratic tets' surfaces, whose volume has degree 4.
constexpr int degree_of_surface = 4;

} // namespace

std::shared_ptr<TissueRest> lattice_tissue(const SurfaceMesh& surface, double tet_size, ElasticLaw law,
                                           ElementKind element) {
    auto t = std::make_shared<TissueRest>();
    t->surface = surface.points;
    t->triangles = surface.triangles;
    LatticeOptions options;
    options.tet_size = tet_size;
    options.moments = element == ElementKind::quadratic ? 4 : 1;
    t->tets = make_lattice(t->surface, t->triangles, options);
    t->embedding = embed(t->tets, t->surface);
    t->law = law;
    t->element = element;
    t->layer_weights = {std::vector<double>(t->tets.tets.size(), 1.0)};
    return t;
}

FreeBody::FreeBody(std::shared_ptr<TissueRest> tissue, const TissueInputs& values)
    : rest(std::move(tissue))
    , values_(values) {
    for (const Vec3& p : nodes_of(*rest)) at_rest_.insert(at_rest_.end(), p.data(), p.data() + 3);
}

void FreeBody::add_layer(std::vector<double> weights, const MaterialValues& values) {
    rest->layer_weights.push_back(std::move(weights));
    values_.layers.push_back(values);
}

void FreeBody::load(const TermType& type, std::vector<SurfaceLayers::Layer> layers) {
    while (values_.layers.size() < layers.size())
        add_layer(std::vector<double>(rest->tets.tets.size(), 0.0), values_.layers.front());
    auto made = std::make_shared<SurfaceLayers>();
    made->layers = std::move(layers);
    parts_.push_back({&type, {0}, made});
    full_.push_back(1);
}

void FreeBody::reshape(std::shared_ptr<const RestShape> shape, double weight) {
    parts_.push_back({&rest_shape_type, {0}, std::move(shape)});
    full_.push_back(weight);
}

StepInputs FreeBody::inputs(double share_of_load) const {
    StepInputs in = tight_inputs();
    in.step_size = 10;
    in.bodies = {values_};
    for (const double full : full_) in.parts.push_back({share_of_load * full});
    return in;
}

void FreeBody::settle(const std::stop_token& stop) {
    simulation_ = std::make_unique<Simulation>(SceneDescription{{rest}, {}, parts_}, inputs(0), stop);
    constexpr int loading = 3, more = 2;
    for (int step = 1; step <= loading + more; ++step) {
        simulation_->inputs = inputs(std::min(1.0, static_cast<double>(step) / loading));
        simulation_->step();
    }
    work = simulation_->work;
}

double FreeBody::imbalance(double stretch) const {
    const Scene scene({{rest}, {}, parts_});
    const StepInputs in = inputs(1);
    State state = initial_state(scene, in);
    for (double& c : state.x) c *= stretch;
    ImplicitForm form;
    quasi_static_form(state, form);
    Potential potential(scene);
    potential.take(state, in);
    potential.begin_step(state, in);
    potential.begin_stage(state, form, state.bones);
    std::vector<double> left;
    potential.evaluate(state.x, &left, nullptr);
    const auto greatest = [](double most, double force) { return std::max(most, std::abs(force)); };
    double elastic = 0;
    for (const Vec3& f : HoldingForces(*rest, values_).at(state.x))
        elastic = greatest(elastic, f.lpNorm<Eigen::Infinity>());
    return std::accumulate(left.begin(), left.end(), 0.0, greatest) / elastic;
}

Vec3 FreeBody::middle() const {
    Vec3 sum = Vec3::Zero();
    const int count = static_cast<int>(rest->tets.vertices.size());
    for (int v = 0; v < count; ++v) sum += place(v) / count;
    return sum;
}

template <class Share>
double FreeBody::sum_over_surface(const Share& share) const {
    const ClippedSurface surface = clip_surface(rest->surface, rest->triangles, CarrierTets(rest->tets));
    const Scene scene({{rest}, {}, {}});
    double sum = 0;
    for (const SurfacePiece& piece : surface.pieces) {
        // A quadratic function over the piece, by its values at corners and middles of edges.
        const auto point = [&](std::size_t i, std::size_t j) {
            std::array<double, 4> place;
            for (std::size_t k = 0; k < 4; ++k) place[k] = 0.5 * (piece.inside[i][k] + piece.inside[j][k]);
            const PointWeights w = scene.embedded(0, piece.tet, place);
            Vec3 p = Vec3::Zero();
            for (int k = 0; k < w.count; ++k) p += w.weight[k] * position(x(), w.vertex[k]);
            return p;
        };
        Vec3 at_corner[3], at_edge[3]; // edge i across from corner i
        for (std::size_t i = 0; i < 3; ++i) at_corner[i] = point(i, i), at_edge[i] = point((i + 1) % 3, (i + 2) % 3);
        for (const RulePoint& q : triangle_rule(degree_of_surface)) {
            Vec3 p = Vec3::Zero(), u = Vec3::Zero(), v = Vec3::Zero();
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                const auto slope = [&](int corner) {
                    return corner == 0 ? Vec3(-1, -1, 0) : Vec3(corner == 1, corner == 2, 0);
                };
                const double own = 4 * q.place[i] - 1;
                p += q.place[i] * (2 * q.place[i] - 1) * at_corner[i] + 4 * q.place[j] * q.place[k] * at_edge[i];
                u += own * slope(i).x() * at_corner[i] +
                     4 * (q.place[j] * slope(k).x() + q.place[k] * slope(j).x()) * at_edge[i];
                v += own * slope(i).y() * at_corner[i] +
                     4 * (q.place[j] * slope(k).y() + q.place[k] * slope(j).y()) * at_edge[i];
            }
            sum += 0.5 * q.share * share(p, u.cross(v));
        }
    }
    return sum;
}

double FreeBody::volume() const {
    const Vec3 o = middle();
    return sum_over_surface([&](const Vec3& p, const Vec3& area) { return (p - o).dot(area) / 3; });
}

double FreeBody::area() const {
    return sum_over_surface([](const Vec3&, const Vec3& area) { return area.norm(); });
}

double FreeBody::elastic_virial() const {
    const Points forces = HoldingForces(*rest, values_).at(x());
    double sum = 0;
    for (std::size_t v = 0; v < forces.size(); ++v) sum += forces[v].dot(position(x(), static_cast<int>(v)));
    return sum;
}

double FreeBody::elastic_energy() const {
    double energy = 0;
    HoldingForces(*rest, values_).at(x(), &energy);
    return energy;
}

double FreeBody::stored_energy() const { return simulation_->state.record.energy; }

} // namespace sinew::bench
