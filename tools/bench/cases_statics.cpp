// Accuracy of equilibria: beams and panels on finer and finer meshes, blocks on beds of springs.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/surface_mesh.h"
#include "tools/bench/accuracy.h"
#include "tools/bench/models.h"
#include "tools/bench/reference.h"
#include "tools/bench/studies.h"

#include <algorithm>
#include <cmath>

namespace sinew::bench {

using namespace solver;
using nlohmann::json;

namespace {

/// Both elements would converge at order 2 and more if the solutions were smooth. They are not at the clamped edges,
/// where the strain grows like r^(a-1) with 1/2 < a < 1 (as for every clamped edge that meets a free face), and then
/// displacements converge at order 2a. An order below 1 is no such edge but an element that locks.
constexpr double least_order = 1;

/// Another code's values on the same mesh are given to more digits than this.
constexpr double same_mesh_tolerance = 1e-4;

void judge_study(Book& book, const MeshStudy& study, const std::vector<LevelValues>& levels) {
    book.open(study.section, study.name);
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
        const Quantity& quantity = study.quantities[q];
        std::vector<double> h, values;
        Work work;
        for (std::size_t l = 0; l < levels.size(); ++l) {
            const LevelValues& level = levels[l];
            h.push_back(level.level.h), values.push_back(level.values[q]);
            work += level.work;
            if (std::isfinite(quantity.same_mesh[l]))
                book.compare(CaseKind::same_mesh, study.setting + ", " + level.level.name(), quantity.name,
                             level.values[q], quantity.same_mesh[l], same_mesh_tolerance, level.work);
        }
        // On the coarse meshes of a quick run linear tets still lock, and the order says nothing.
        if (std::isfinite(quantity.continuum) && levels.size() == study.levels.size())
            book.converge(study.setting + ", to " + levels.back().level.name(), quantity.name, h, values,
                          quantity.continuum, least_order, work, study.may_lock);
    }
}

/// A block hangs by its top face from springs to a plate.
struct HangingBlock {
    Vec3 size{0.2, 0.1, 0.3};
    double stiffness = 4e5, density = 1100, g = 9.81; // N/m^3, kg/m^3, m/s^2

    /// Area-weighted mean of the springs' extension [m].
    double extension(ElasticLaw law, int cells, double weight, const std::stop_token& stop, Work& work) const {
        auto rest = make_tissue(box_mesh({0, 0, 0}, size, cells, cells, cells), law);
        const Points& points = rest->tets.vertices;
        const auto on_top = [&](int v) { return points[static_cast<std::size_t>(v)].z() > size.z() - 1e-9; };
        std::erase_if(rest->triangles, [&](const Triangle& t) { return !std::all_of(t.begin(), t.end(), on_top); });
        const Points plate = {{-1, -1, size.z()}, {2, -1, size.z()}, {2, 2, size.z()}, {-1, 2, size.z()}};
        auto bone = std::make_shared<BoneRest>();
        bone->surface = plate, bone->triangles = {{0, 1, 2}, {0, 2, 3}};
        AttachmentRest a;
        a.source = 0, a.target = 1;
        for (std::size_t v = 0; v < points.size(); ++v)
            a.source_weights.push_back(on_top(static_cast<int>(v)) ? weight : 0);
        StepInputs in = tight_inputs();
        in.integrator = Integrator::quasi_static;
        in.gravity = Vec3(0, 0, -g);
        in.bodies = {material(2e5, 0.4, density), BoneInputs{plate}};
        AttachmentInputs springs;
        springs.stiffness = stiffness;
        in.attachments = {springs};
        Simulation sim({{rest, bone}, {a}}, in, stop);
        sim.step();
        work += sim.work;
        const std::vector<double> areas = vertex_areas(points, rest->triangles);
        double weighted = 0, area = 0;
        for (std::size_t v = 0; v < areas.size(); ++v) {
            weighted += areas[v] * (points[v].z() - position(sim.state.x, static_cast<int>(v)).z());
            area += areas[v];
        }
        return weighted / area;
    }
};

void spring_bed(Book& book, const RunOptions& options) {
    book.open("11", "block on a spring bed");
    const HangingBlock block;
    for (const LawName& law : laws)
        for (const int cells : {2, 5})
            for (const double weight : {1.0, 0.5}) {
                Work work;
                const double value = block.extension(law.law, cells, weight, options.stop, work);
                const double expected = block.density * block.g * block.size.z() / (weight * block.stiffness);
                book.compare(CaseKind::exact,
                             std::string(law.catalogue) + ", " + std::to_string(cells) + " cells a side, weight " +
                                 number(weight),
                             "mean extension [m]", value, expected, 1e-8, work);
            }
}

/// A bar 50 times as long as thick, of quadratic tets, against the exact curve of a thin elastic rod. The rod knows no
/// shear and no thickness; at this slenderness that is worth 3e-4 of the length, and the tolerance is 1e-3 of it.
void elastica(Book& book, const RunOptions& options) {
    book.open("2.3", "elastica: slender cantilever");
    const json& reference = reference_values()["elastica_catenary"];
    const double length = 1, side = 0.02, modulus = 1e6;
    const double bending = modulus * side * side * side * side / 12; // E I [N m^2]
    const auto settle = [&](const LawName& law, const std::string& of,
                            const std::function<void(const TissueRest&, TissueInputs&, StepInputs&, double)>& load,
                            double x, double z) {
        auto rest = make_tissue(box_mesh({0, 0, 0}, {length, side, side}, options.quick ? 20 : 40, 1, 1), law.law,
                                ElementKind::quadratic);
        const Points nodes = nodes_of(*rest);
        rest->fixed_vertices = vertices_where(nodes, [](const Vec3& p) { return p.x() < 1e-9; });
        TissueInputs values = material(modulus, 0);
        StepInputs in = tight_inputs();
        in.integrator = Integrator::quasi_static;
        in.bodies = {values};
        Simulation sim({{rest}, {}}, in, options.stop);
        const int parts = 10;
        for (int part = 1; part <= parts; ++part) {
            load(*rest, values, sim.inputs, static_cast<double>(part) / parts);
            sim.inputs.bodies = {values};
            sim.step();
        }
        const Vec3 tip(length, side / 2, side / 2);
        const Vec3 now = position(sim.state.x, vertex_at(nodes, tip));
        const std::string setting = std::string(law.catalogue) + ", quadratic, " + of;
        book.compare(CaseKind::continuum, setting, "tip x [L]", now.x() / length, x, 1e-3, sim.work, 1);
        book.compare(CaseKind::continuum, setting, "tip z [L]", (now.z() - tip.z()) / length, z, 1e-3, sim.work, 1);
    };
    for (const LawName& law : laws) {
        for (const char* alpha : {"1.0", "5.0"}) {
            const json& e = reference["tip_force"][alpha];
            const double force = std::stod(alpha) * bending / (length * length);
            settle(
                law, std::string("tip force, P L^2/(E I) = ") + alpha,
                [&](const TissueRest& rest, TissueInputs& values, StepInputs&, double share) {
                    values.forces = traction_loads(
                        rest, [&](const Vec3& p) { return p.x() > length - 1e-9; },
                        Vec3(0, 0, share * force / (side * side)));
                },
                1 + e["ux_over_L"].get<double>(), e["uz_over_L"]);
        }
        for (const char* beta : {"2.0", "10.0"}) {
            const json& e = reference["heavy"][beta];
            const double weight = std::stod(beta) * bending / (length * length * length); // per length [N/m]
            settle(
                law, std::string("own weight, q L^3/(E I) = ") + beta,
                [&](const TissueRest&, TissueInputs&, StepInputs& in, double share) {
                    in.gravity = Vec3(0, 0, -share * weight / (1000 * side * side));
                },
                e["x_tip_over_L"], e["z_tip_over_L"]);
        }
    }
}

} // namespace

std::vector<AccuracyCase> static_cases() {
    std::vector<AccuracyCase> out;
    for (const MeshStudy& study : mesh_studies())
        out.push_back({study.name, [study](Book& book, const RunOptions& options) {
                           book.open(study.section, study.name);
                           judge_study(book, study, run_study(study, options));
                       }});
    out.push_back({"elastica: slender cantilever", elastica});
    out.push_back({"block on a spring bed", spring_bed});
    return out;
}

} // namespace sinew::bench
