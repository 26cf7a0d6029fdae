// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/beams.h"

#include "solver/mesh/tet_box.h"
#include "solver/terms/hold/hold.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace sinew::bench {

using namespace solver;

namespace {

SceneDescription free_body(TissueRest rest) {
    rest.fixed_vertices.clear();
    return {{std::make_shared<const TissueRest>(std::move(rest))}, {}};
}

} // namespace

TetMesh box_mesh(const Vec3& low, const Vec3& high, int nx, int ny, int nz) {
    const Vec3 size = high - low;
    return kuhn_mesh(nx, ny, nz, [&](double r, double s, double t) {
        return Vec3(low + Vec3(r * size.x(), s * size.y(), t * size.z()));
    });
}

TetMesh cook_mesh(int nx, int ny, int nz) {
    return kuhn_mesh(nx, ny, nz, [](double r, double s, double t) {
        return Vec3(0.48 * r, (1 - s) * 0.44 * r + s * (0.44 + 0.16 * r), 0.1 * (t - 0.5));
    });
}

TetMesh regular_tet(double edge) {
    TetMesh mesh;
    const double a = edge / std::sqrt(8.0);
    mesh.vertices = {{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}};
    mesh.tets = {{0, 1, 2, 3}};
    mesh.coverage = {1};
    check_and_orient(mesh);
    return mesh;
}

std::shared_ptr<TissueRest> make_tissue(TetMesh mesh, ElasticLaw law, ElementKind element) {
    auto t = std::make_shared<TissueRest>();
    t->triangles = boundary_triangles(mesh.tets);
    t->surface = mesh.vertices;
    std::vector<std::pair<int, std::size_t>> host(mesh.vertices.size()); // a tet of each vertex, and its corner there
    for (std::size_t k = 0; k < mesh.tets.size(); ++k)
        for (std::size_t c = 0; c < 4; ++c) host[static_cast<std::size_t>(mesh.tets[k][c])] = {static_cast<int>(k), c};
    for (const auto& [tet, corner] : host) {
        std::array<double, 4> b{};
        b[corner] = 1;
        t->embedding.tet.push_back(tet);
        t->embedding.barycentric.push_back(b);
    }
    t->law = law;
    t->element = element;
    t->layer_weights = {std::vector<double>(mesh.tets.size(), 1.0)};
    t->tets = std::move(mesh);
    return t;
}

Points nodes_of(const TissueRest& rest) {
    Points out = rest.tets.vertices;
    if (rest.element == ElementKind::quadratic)
        for (const auto& [a, b] : edges_of(rest.tets.tets))
            out.emplace_back(0.5 * (out[static_cast<std::size_t>(a)] + out[static_cast<std::size_t>(b)]));
    return out;
}

Points traction_loads(const TissueRest& rest, const std::function<bool(const Vec3&)>& on_face, const Vec3& traction) {
    const bool quadratic = rest.element == ElementKind::quadratic;
    const auto edges = quadratic ? edges_of(rest.tets.tets) : std::vector<std::array<int, 2>>{};
    Points loads(rest.tets.vertices.size() + edges.size(), Vec3::Zero());
    for (const Triangle& t : rest.triangles) {
        const auto corner = [&](std::size_t c) { return rest.surface[static_cast<std::size_t>(t[c])]; };
        if (!on_face(corner(0)) || !on_face(corner(1)) || !on_face(corner(2))) continue;
        const Vec3 third = traction * (0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 3);
        // Over a flat triangle linear shape functions integrate to a third each, quadratic ones to nothing at the
        // corners and a third at each edge.
        for (std::size_t c = 0; c < 3; ++c) {
            const int a = t[c], b = t[(c + 1) % 3];
            const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
            const auto node =
                quadratic
                    ? rest.tets.vertices.size() +
                          static_cast<std::size_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin())
                    : static_cast<std::size_t>(a);
            loads[node] += third;
        }
    }
    return loads;
}

std::vector<int> vertices_where(const Points& points, const std::function<bool(const Vec3&)>& at) {
    std::vector<int> out;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (at(points[i])) out.push_back(static_cast<int>(i));
    return out;
}

int vertex_at(const Points& points, const Vec3& p) {
    const std::vector<int> found = vertices_where(points, [&](const Vec3& q) { return (p - q).norm() < 1e-9; });
    if (found.empty()) throw std::logic_error("the mesh has no vertex at the point that is asked for");
    return found.front();
}

Part hold_where(const TissueRest& rest, int body, const std::function<bool(const Vec3&)>& at) {
    std::vector<double> weights;
    for (const Vec3& p : rest.surface) weights.push_back(at(p) ? 1 : 0);
    auto part = std::make_shared<HoldRest>();
    part->part = painted_vertices(rest.triangles, weights);
    return {&hold_type, {body}, std::move(part)};
}

PartValues hold_values(const RigidMotion& motion) {
    HoldValues values;
    values.set_motion(motion);
    PartValues out(hold_type.values.size());
    put_fields(values, out);
    return out;
}

TissueInputs material(double youngs_modulus, double poissons_ratio, double density) {
    TissueInputs t;
    t.compression_resistance = 0;
    MaterialValues m;
    m.youngs_modulus = youngs_modulus;
    m.poissons_ratio = poissons_ratio;
    m.mass_density = density;
    t.layers = {m};
    return t;
}

StepInputs tight_inputs() {
    StepInputs in;
    in.gravity = Vec3::Zero();
    in.max_newton_iterations = 80;
    in.tolerance_factor = 1e-4;
    return in;
}

Vec3 position(const std::vector<double>& x, int vertex) {
    const double* p = x.data() + 3 * static_cast<std::size_t>(vertex);
    return {p[0], p[1], p[2]};
}

void set_position(std::vector<double>& x, int vertex, const Vec3& p) {
    for (int c = 0; c < 3; ++c) x[3 * static_cast<std::size_t>(vertex) + static_cast<std::size_t>(c)] = p[c];
}

void Work::add(const StepRecord& record, double step_seconds) {
    seconds += step_seconds;
    ++steps;
    newton += record.newton_iterations;
    unconverged += !record.converged;
    linear_iterations += record.linear_iterations;
}

Work& Work::operator+=(const Work& other) {
    seconds += other.seconds, steps += other.steps, newton += other.newton;
    unconverged += other.unconverged, linear_iterations += other.linear_iterations;
    return *this;
}

Simulation::Simulation(SceneDescription description, StepInputs first, std::stop_token stop,
                       std::span<const InitialMotion> motions)
    : inputs(std::move(first))
    , scene_(std::make_shared<const Scene>(std::move(description)))
    , workspace_(scene_) {
    state = initial_state(*scene_, inputs, motions);
    control_.stop = [stop = std::move(stop)] { return stop.stop_requested(); };
}

void Simulation::step() {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    state = advance(workspace_, state, {&inputs, 1}, control_);
    work.add(state.record, std::chrono::duration<double>(Clock::now() - start).count());
}

HoldingForces::HoldingForces(const TissueRest& rest, const TissueInputs& values)
    : scene_(std::make_shared<const Scene>(free_body(rest)))
    , potential_(*scene_) {
    inputs_ = tight_inputs();
    inputs_.integrator = Integrator::quasi_static;
    inputs_.bodies = {values};
    state_ = initial_state(*scene_, inputs_);
    potential_.take(state_, inputs_);
    potential_.begin_step(state_, inputs_);
    quasi_static_form(state_, form_);
    potential_.begin_stage(state_, form_, state_.bones);
}

Points HoldingForces::at(const std::vector<double>& x, double* energy) {
    std::vector<double> gradient(3 * potential_.unknown_count());
    potential_.evaluate(x, &gradient, nullptr);
    if (energy) {
        StepRecord record;
        potential_.describe(x, record);
        *energy = record.energy;
    }
    Points out(static_cast<std::size_t>(scene_->vertex_count()), Vec3::Zero());
    for (std::size_t i = 0; i < potential_.unknown_count(); ++i)
        out[static_cast<std::size_t>(potential_.numbering().vertex_of_unknown[i])] =
            position(gradient, static_cast<int>(i));
    return out;
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

} // namespace sinew::bench
