// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/turned_bodies.h"

#include "solver/index.h"
#include "solver/mesh/primitives.h"
#include "tools/bench/free_body.h"
#include "tools/bench/models.h"
#include "tools/bench/reference.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <numbers>

namespace sinew::bench {

using namespace solver;

namespace {

/// Stiff enough to clamp to far less than the errors here, by the catalogue's moduli [N/m^3].
constexpr double clamp_stiffness = 1e10;
/// Squares of the surface along its longest side: finer than any tets here.
constexpr int squares = 64;
constexpr int load_steps = 4;

struct TurnedCase {
    std::string name;
    Vec3 size; ///< of the box that `shape` makes the body from; that has its corner at 0
    std::function<Vec3(const Vec3&)> shape;
    ElasticLaw law;
    TissueInputs values;
    Vec3 gravity = Vec3::Zero();  ///< in the body's own axes [m/s^2]
    Vec3 traction = Vec3::Zero(); ///< dead, on the end at the largest x [Pa]
    Vec3 probe;                   ///< a point of the body at rest
    Eigen::Index along;           ///< the displacement that is known
    double reference;
    std::vector<double> linear_sizes, quadratic_sizes; ///< of tets, falling [m]
};

const Mat3& askew() {
    using Eigen::AngleAxisd;
    constexpr double angle = std::numbers::pi / 6;
    static const Mat3 turn = (AngleAxisd(angle, Vec3::UnitY()) * AngleAxisd(angle, Vec3::UnitX())).toRotationMatrix();
    return turn;
}

SurfaceMesh surface_of(const TurnedCase& c) {
    const double step = c.size.maxCoeff() / squares;
    const auto count = [&](double side) { return std::max(1, static_cast<int>(std::ceil(side / step - 1e-9))); };
    SurfaceMesh mesh =
        make_cube(c.size.x(), c.size.y(), c.size.z(), count(c.size.x()), count(c.size.y()), count(c.size.z()));
    const Vec3 low = bounding_box(mesh.points).min;
    for (Vec3& p : mesh.points) p = askew() * c.shape(p - low);
    return mesh;
}

/// Dead loads of a traction on the triangles at the end, carried to the tets' vertices.
Points end_loads(const Scene& scene, const TissueRest& rest, double end, const Vec3& traction) {
    Points loads(scene.vertex_count(0), Vec3::Zero());
    for (const Triangle& t : rest.triangles) {
        const auto p = [&](std::size_t corner) { return rest.surface[at(t[corner])]; };
        const auto at_end = [&](std::size_t corner) { return (askew().transpose() * p(corner)).x() > end - 1e-9; };
        if (!at_end(0) || !at_end(1) || !at_end(2)) continue;
        const double third = (p(1) - p(0)).cross(p(2) - p(0)).norm() / 6;
        for (const int v : t) {
            const PointWeights carrier =
                scene.embedded(0, rest.embedding.tet[at(v)], rest.embedding.barycentric[at(v)]);
            for (int k = 0; k < carrier.count; ++k)
                loads[at(carrier.vertex[k])] += third * carrier.weight[k] * (askew() * traction);
        }
    }
    return loads;
}

TurnedRow run_case(const TurnedCase& c, const ElementName& element, double tet_size, const RunOptions& options) {
    options.tell(c.name + ", " + std::string(element.word) + ", tets of " + number(tet_size, 3) + " m");
    const auto rest = lattice_tissue(surface_of(c), tet_size, c.law, element.kind);
    const auto own = [](const Vec3& p) { return Vec3(askew().transpose() * p); };
    auto plate = std::make_shared<BoneRest>();
    plate->surface = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, plate->triangles = {{0, 1, 2}};
    AttachmentRest clamp;
    clamp.source = 0, clamp.target = 1;
    for (const Vec3& p : rest->surface) clamp.source_weights.push_back(own(p).x() < 1e-9 ? 1 : 0);
    StepInputs in = tight_inputs();
    in.integrator = Integrator::quasi_static;
    in.tolerance_factor = 1;
    in.bodies = {c.values, BoneInputs{plate->surface}};
    AttachmentInputs springs;
    springs.stiffness = clamp_stiffness;
    in.attachments = {springs};

    TurnedRow row{c.name, std::string(element.word), tet_size, rest->tets.tets.size()};
    Simulation sim({{rest, plate}, {clamp}}, in, options.stop);
    row.unknowns = 3 * sim.scene().numbering().unknown_count();
    const double end = c.shape(c.size).x();
    const Points loads = end_loads(sim.scene(), *rest, end, c.traction);
    const std::clock_t start = std::clock();
    for (int step = 1; step <= load_steps; ++step) {
        const double share = static_cast<double>(step) / load_steps;
        sim.inputs.gravity = share * (askew() * c.gravity);
        auto& values = std::get<TissueInputs>(sim.inputs.bodies[0]);
        values.forces = loads;
        for (Vec3& f : values.forces) f *= share;
        sim.step();
    }
    row.cpu_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    row.unconverged = sim.work.unconverged, row.inverted = sim.state.record.inverted;
    const auto probe = std::find_if(rest->surface.begin(), rest->surface.end(),
                                    [&](const Vec3& p) { return (own(p) - c.probe).norm() < 1e-6; });
    if (probe == rest->surface.end()) throw std::logic_error("no vertex at the probed point of " + c.name);
    const auto v = static_cast<std::size_t>(probe - rest->surface.begin());
    const PointWeights carrier = sim.scene().embedded(0, rest->embedding.tet[v], rest->embedding.barycentric[v]);
    Vec3 now = Vec3::Zero();
    for (int k = 0; k < carrier.count; ++k) now += carrier.weight[k] * position(sim.state.x, carrier.vertex[k]);
    row.value = own(now - *probe)[c.along], row.reference = c.reference;
    return row;
}

std::vector<TurnedCase> turned_cases(bool quick) {
    const nlohmann::json &beam = reference_values()["cantilever_gravity"], &cook = reference_values()["cook_3d"];
    const auto straight = [](const Vec3& p) { return p; };
    const auto panel = [](const Vec3& p) {
        return Vec3(0.48 * p.x(), 0.44 * p.x() * (1 - p.y()) + p.y() * (0.44 + 0.16 * p.x()), 0.4 * p.z() - 0.05);
    };
    const std::vector<double> beam_linear = quick ? std::vector{0.05} : std::vector{0.05, 0.035, 0.025, 0.0175, 0.0125},
                              beam_quadratic = quick ? std::vector{0.1} : std::vector{0.15, 0.1, 0.07, 0.05, 0.035},
                              panel_linear = quick ? std::vector{0.06} : std::vector{0.06, 0.04, 0.03, 0.02, 0.015},
                              panel_quadratic = quick ? std::vector{0.12} : std::vector{0.17, 0.12, 0.085, 0.06, 0.04};
    std::vector<TurnedCase> out;
    out.push_back({"gravity cantilever, log neo-Hookean",
                   {0.8, 0.1, 0.1},
                   straight,
                   ElasticLaw::log_neo_hookean,
                   material(1e6, 0.4),
                   {0, 0, -9.81},
                   Vec3::Zero(),
                   {0.8, 0.05, 0.05},
                   2,
                   beam["continuum"]["nh"]["tip_uz"]["value"],
                   beam_linear,
                   beam_quadratic});
    for (const char* nu : {"0.3", "0.49"})
        out.push_back({std::string("Cook's panel, nu ") + nu,
                       {1, 1, 0.25},
                       panel,
                       ElasticLaw::log_neo_hookean,
                       material(1e5, std::stod(nu)),
                       Vec3::Zero(),
                       {0, 3125, 0},
                       {0.48, 0.6, 0},
                       1,
                       cook["continuum"][std::string("nu=") + nu]["uy_mid"]["value"],
                       panel_linear,
                       panel_quadratic});
    return out;
}

} // namespace

std::vector<TurnedRow> run_turned_bodies(const RunOptions& options) {
    std::vector<TurnedRow> out;
    for (const TurnedCase& c : turned_cases(options.quick)) {
        if (!options.wants(c.name)) continue;
        for (const ElementName& element : elements)
            for (const double size : element.kind == ElementKind::linear ? c.linear_sizes : c.quadratic_sizes)
                out.push_back(run_case(c, element, size, options));
    }
    return out;
}

Table turned_table(const std::vector<TurnedRow>& rows) {
    Table t{{"case", "element", "tet size [m]", "tets", "unknowns", "CPU s", "value [m]", "reference [m]", "error [%]",
             "unconverged", "inverted"},
            {}};
    for (const TurnedRow& r : rows)
        t.rows.push_back({r.name, r.element, number(r.tet_size, 3), std::to_string(r.tets), std::to_string(r.unknowns),
                          number(r.cpu_seconds, 3), number(r.value, 6), number(r.reference, 6),
                          number(100 * r.error(), 2), std::to_string(r.unconverged), std::to_string(r.inverted)});
    return t;
}

nlohmann::ordered_json turned_json(const std::vector<TurnedRow>& rows) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const TurnedRow& r : rows)
        out.push_back({{"case", r.name},
                       {"element", r.element},
                       {"tet_size", r.tet_size},
                       {"tets", r.tets},
                       {"unknowns", r.unknowns},
                       {"cpu_seconds", r.cpu_seconds},
                       {"value", r.value},
                       {"reference", r.reference},
                       {"error", r.error()},
                       {"unconverged", r.unconverged},
                       {"inverted", r.inverted}});
    return out;
}

std::vector<NamedPlot> turned_plots(const std::vector<TurnedRow>& rows) {
    std::vector<NamedPlot> out;
    for (const TurnedRow& r : rows) {
        const std::string title = r.name + ", askew in the lattice";
        if (out.empty() || out.back().plot.title != title)
            out.push_back({"elements_" + std::to_string(out.size()),
                           {title, "CPU time [s]", "error [%]", {{"linear", {}}, {"quadratic", {}}}, false, {}}});
        out.back().plot.series[r.element == "quadratic"].points.push_back(
            {r.cpu_seconds, 100 * r.error(), std::to_string(r.tets) + " tets", number(1e3 * r.tet_size, 3) + " mm"});
    }
    return out;
}

} // namespace sinew::bench
