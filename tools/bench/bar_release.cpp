// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/bar_release.h"

#include "tools/bench/reference.h"

#include <algorithm>
#include <cmath>

namespace sinew::bench {

using namespace solver;
using nlohmann::json;

namespace {

constexpr int frames = 24;

const json& values_of(const LawName& law) { return bar_release_values()["references"][std::string(law.catalogue)]; }

/// The law itself if its trajectories are known, else the one that it differs least from: it takes that one's material.
const LawName& known_kin(const LawName& law) {
    return bar_is_known(law) ? law : *find_law(law.law == ElasticLaw::anisotropic ? "stvk" : "nh");
}

Points points(const json& rows) {
    Points out;
    for (const json& r : rows) out.emplace_back(r[0], r[1], r[2]);
    return out;
}

} // namespace

BarTrajectory run_bar(const BarRelease& bar, const std::stop_token& stop) {
    const json& m = values_of(known_kin(bar.law))["material"];
    const int across = std::max(1, bar.cells / 4);
    auto rest =
        make_tissue(box_mesh({0, 0, 0}, {0.4, 0.1, 0.1}, bar.cells, across, across), bar.law.law, bar.element.kind);
    if (bar.law.law == ElasticLaw::anisotropic) rest->stiff_directions.assign(rest->tets.tets.size(), Vec3::UnitX());
    rest->fixed_vertices = vertices_where(nodes_of(*rest), [](const Vec3& p) { return p.x() < 1e-9; });
    const int tip = vertex_at(rest->tets.vertices, {0.4, 0.1, 0.1});
    StepInputs in = tight_inputs();
    in.tolerance_factor = bar.tolerance_factor;
    in.gravity = Vec3(0, 0, -9.81);
    in.integrator = bar.integrator.integrator;
    in.linear_method = bar.linear;
    in.step_size = 1.0 / (frames * bar.substeps);
    TissueInputs values = material(m["E"], m["nu"], m["rho"]);
    values.transverse_anisotropy = bar_anisotropy;
    in.bodies = {values};
    Simulation sim({{rest}, {}}, in, stop);
    BarTrajectory out;
    out.tip.push_back(position(sim.state.x, tip));
    for (int frame = 0; frame < frames; ++frame) {
        for (int k = 0; k < bar.substeps; ++k) sim.step();
        out.tip.push_back(position(sim.state.x, tip));
    }
    out.work = sim.work;
    return out;
}

bool bar_is_known(const LawName& law) {
    return bar_release_values()["references"].contains(std::string(law.catalogue));
}

Points bar_on_mesh(const LawName& law, int cells) {
    if (!bar_is_known(law) || (cells != 8 && cells != 16)) return {};
    const char* mesh = cells == 8 ? "PUB_D1_coarse" : "PUB_D1_fine";
    return points(values_of(law)["p1"][mesh]["lumped"]["trajectories"]["tip"]);
}

Points bar_continuum(const LawName& law) {
    return bar_is_known(law) ? points(values_of(law)["continuum"]["trajectories"]["tip"]) : Points{};
}

Points bar_scheme(const LawName& law, const IntegratorName& integrator, int substeps) {
    if (!bar_is_known(law) || !values_of(law).contains("discrete_schemes")) return {};
    const json& schemes = values_of(law)["discrete_schemes"]["PUB_D1_coarse"]["results"];
    const std::string name(integrator.bar_release), step = "dt=1/" + std::to_string(frames * substeps);
    if (!schemes.contains(name) || !schemes[name].contains(step)) return {};
    return points(schemes[name][step]["trajectory"]);
}

double rms_distance(const Points& a, const Points& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(a.size()));
}

double largest_distance(const Points& a, const Points& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
    return most;
}

} // namespace sinew::bench
