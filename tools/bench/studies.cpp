// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/studies.h"

#include "tools/bench/accuracy.h"
#include "tools/bench/models.h"
#include "tools/bench/reference.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace sinew::bench {

using namespace solver;
using nlohmann::json;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// `object[a][b]…`, or NaN where a key is missing.
double lookup(const json& object, std::initializer_list<std::string> keys) {
    const json* at = &object;
    for (const std::string& key : keys) {
        if (!at->is_object() || !at->contains(key)) return nan;
        at = &at->at(key);
    }
    return at->is_number() ? at->get<double>() : nan;
}

double entry(const json& object, const std::string& key, std::size_t index) {
    return object.contains(key) ? object[key][index].get<double>() : nan;
}

StepInputs quasi_static(const TissueInputs& values) {
    StepInputs in = tight_inputs();
    in.integrator = Integrator::quasi_static;
    in.bodies = {values};
    return in;
}

/// A bar [0, length] x [0, width]^2 held at x = 0.
std::shared_ptr<TissueRest> held_bar(const MeshLevel& m, double length, double width, ElasticLaw law,
                                     ElementKind element) {
    auto rest = make_tissue(box_mesh({0, 0, 0}, {length, width, width}, m.nx, m.ny, m.nz), law, element);
    rest->fixed_vertices = vertices_where(nodes_of(*rest), [](const Vec3& p) { return p.x() < 1e-9; });
    return rest;
}

MeshStudy small_strain(const std::string& nu, ElementKind element) {
    const json& r = reference_values()["small_strain_cantilever"]["nu=" + nu]["tip_uz"];
    MeshStudy s{"2.1",
                "small-strain cantilever",
                "nu " + nu,
                {},
                {{8, 2, 2, 0.05}, {16, 4, 4, 0.025}, {32, 8, 8, 0.0125, false}, {64, 16, 16, 0.00625, false}},
                {}};
    s.quantities = {{"tip uz [m]", r["value"], r["errbar"], std::vector<double>(s.levels.size(), nan)}};
    const double share = 1e-4; // of the load: so little that the response is linear
    s.run = [ratio = std::stod(nu), share, element](const MeshLevel& m, const std::stop_token& stop, Work& work) {
        const auto rest = held_bar(m, 0.4, 0.1, ElasticLaw::stvk, element);
        StepInputs in = quasi_static(material(1e5, ratio));
        in.gravity = Vec3(0, 0, -9.81 * share);
        Simulation sim({{rest}, {}}, in, stop);
        sim.step();
        work += sim.work;
        const Vec3 tip(0.4, 0.05, 0.05);
        return std::vector<double>{(position(sim.state.x, vertex_at(nodes_of(*rest), tip)) - tip).z() / share};
    };
    return s;
}

MeshStudy gravity(const LawName& law, ElementKind element) {
    const json& r = reference_values()["cantilever_gravity"];
    const std::string name(law.catalogue);
    MeshStudy s{"2.2", "gravity cantilever", name, {}, {{16, 2, 2, 0.05}, {32, 4, 4, 0.025}, {64, 8, 8, 0.0125, false}},
                {}};
    for (const std::size_t axis : {0, 2}) {
        const std::string key = axis ? "tip_uz" : "tip_ux";
        Quantity q{axis ? "tip uz [m]" : "tip ux [m]",
                   lookup(r, {"continuum", name, key, "value"}),
                   lookup(r, {"continuum", name, key, "errbar"}),
                   {}};
        for (const MeshLevel& m : s.levels)
            q.same_mesh.push_back(entry(r["p1_same_mesh"][name], "bar08_" + m.name(), axis));
        s.quantities.push_back(q);
    }
    s.run = [law = law.law, element](const MeshLevel& m, const std::stop_token& stop, Work& work) {
        const Vec3 u = gravity_tip(m, law, element, material(gravity_modulus, 0.4), stop, work);
        return std::vector<double>{u.x(), u.z()};
    };
    return s;
}

MeshStudy twist(const LawName& law, const std::string& nu, ElementKind element) {
    const json& r = reference_values()["twist_180"];
    const std::string name = std::string(law.catalogue) + " nu=" + nu;
    MeshStudy s{
        "2.4", "bar twisted by 180 degrees", name, {}, {{8, 2, 2, 0.05}, {16, 4, 4, 0.025}, {32, 8, 8, 0.0125, false}},
        {}};
    for (const auto& [title, key, mesh_key] : {std::array{"energy [J]", "energy", "energy"},
                                               {"torque [N m]", "torque", "torque"},
                                               {"axial force [N]", "axial_force", "axial"}}) {
        Quantity q{
            title, lookup(r, {"continuum", name, key, "value"}), lookup(r, {"continuum", name, key, "errbar"}), {}};
        for (const MeshLevel& m : s.levels)
            q.same_mesh.push_back(lookup(r, {"p1_same_mesh", name, "bar04_" + m.name(), mesh_key}));
        s.quantities.push_back(q);
    }
    s.run = [law = law.law, ratio = std::stod(nu), element](const MeshLevel& m, const std::stop_token& stop,
                                                            Work& work) {
        const double length = 0.4;
        auto rest = make_tissue(box_mesh({0, -0.05, -0.05}, {length, 0.05, 0.05}, m.nx, m.ny, m.nz), law, element);
        const auto at_start = [](const Vec3& p) { return p.x() < 1e-9; };
        const auto at_end = [&](const Vec3& p) { return p.x() > length - 1e-9; };
        StepInputs in = quasi_static(material(1e5, ratio));
        in.parts = {hold_values(), hold_values()};
        Simulation sim({{rest}, {}, {hold_where(*rest, 0, at_start), hold_where(*rest, 0, at_end)}}, in, stop);
        const int parts = 12;
        for (int part = 1; part <= parts; ++part) {
            const double angle = M_PI * part / parts;
            sim.inputs.parts[1] =
                hold_values({Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3::UnitX())), Vec3::Zero()});
            sim.step();
        }
        work += sim.work;
        const StepRecord& end = sim.state.record;
        return std::vector<double>{end.energy, value_of(end.measured, "hold", "moment_x_Nm", 1),
                                   value_of(end.measured, "hold", "force_x_N", 1)};
    };
    return s;
}

MeshStudy vibration(ElementKind element) {
    const json& r = reference_values()["free_vibration"];
    MeshStudy s{"4",
                "free vibration",
                element == ElementKind::linear ? "lumped mass" : "consistent mass",
                {},
                {{16, 2, 2, 0.05}, {32, 4, 4, 0.025}, {64, 8, 8, 0.0125, false}},
                {}};
    for (std::size_t mode = 0; mode < 6; ++mode) {
        const json& f = r["P2"]["freq"][mode];
        Quantity q{"f" + std::to_string(mode + 1) + " [Hz]", f["value"], f["errbar"], {}};
        for (const MeshLevel& m : s.levels) {
            const std::string key = "P1 Kuhn (" + std::to_string(m.nx) + ", " + std::to_string(m.ny) + ", " +
                                    std::to_string(m.nz) + ") lumped";
            q.same_mesh.push_back(entry(r, key, mode));
        }
        s.quantities.push_back(q);
    }
    s.run = [element](const MeshLevel& m, const std::stop_token&, Work&) {
        return natural_frequencies(*held_bar(m, 0.8, 0.1, ElasticLaw::stvk, element), material(1e6, 0.4), 6);
    };
    return s;
}

/// Quadratic tets have the nodes of linear ones on cells of half the size; nobody gave values for these meshes.
void coarsen(MeshStudy& study) {
    for (MeshLevel& m : study.levels) m.nx /= 2, m.ny /= 2, m.nz /= 2, m.h *= 2;
    for (Quantity& q : study.quantities) q.same_mesh.assign(study.levels.size(), nan);
}

} // namespace

std::string MeshLevel::name() const { return std::to_string(nx) + "x" + std::to_string(ny) + "x" + std::to_string(nz); }

Vec3 gravity_tip(const MeshLevel& m, ElasticLaw law, ElementKind element, const TissueInputs& values,
                 const std::stop_token& stop, Work& work) {
    const auto rest = held_bar(m, 0.8, 0.1, law, element);
    Simulation sim({{rest}, {}}, quasi_static(values), stop);
    for (const double load : {0.25, 0.5, 0.75, 1.0}) { // the way to the solution is free; the solution is not
        sim.inputs.gravity = Vec3(0, 0, -9.81 * load);
        sim.step();
    }
    work += sim.work;
    const Vec3 tip(0.8, 0.05, 0.05);
    return position(sim.state.x, vertex_at(nodes_of(*rest), tip)) - tip;
}

Vec3 cook_corner(const MeshLevel& m, ElasticLaw law, ElementKind element, TissueInputs values,
                 const std::stop_token& stop, Work& work) {
    auto rest = make_tissue(cook_mesh(m.nx, m.ny, m.nz), law, element);
    const Points points = nodes_of(*rest);
    rest->fixed_vertices = vertices_where(points, [](const Vec3& p) { return p.x() < 1e-9; });
    Simulation sim({{rest}, {}}, quasi_static(values), stop);
    for (const double load : {0.25, 0.5, 0.75, 1.0}) {
        values.forces = traction_loads(
            *rest, [](const Vec3& p) { return p.x() > 0.48 - 1e-9; }, Vec3(0, 3125 * load, 0));
        sim.inputs.bodies = {values};
        sim.step();
    }
    work += sim.work;
    const Vec3 corner(0.48, 0.60, 0);
    return position(sim.state.x, vertex_at(points, corner)) - corner;
}

MeshStudy cook_study(const std::string& nu, ElementKind element) {
    const LawName& law = *find_law("nh"); // the only one that the catalogue knows the panel for
    const json& r = reference_values()["cook_3d"];
    const std::string key = "nu=" + nu;
    MeshStudy s{"2.5",
                "Cook's panel",
                std::string(law.catalogue) + " nu " + nu,
                {},
                {{8, 8, 2, 0.06}, {16, 16, 4, 0.03}, {32, 32, 4, 0.015, false}},
                {}};
    for (const std::size_t axis : {0, 1}) {
        const std::string name = axis ? "uy_mid" : "ux_mid";
        Quantity q{axis ? "uy [m]" : "ux [m]",
                   lookup(r, {"continuum", key, name, "value"}),
                   lookup(r, {"continuum", key, name, "errbar"}),
                   {}};
        for (const MeshLevel& m : s.levels)
            q.same_mesh.push_back(entry(r["p1_same_mesh"][key], "cook_" + m.name(), axis));
        s.quantities.push_back(q);
    }
    s.run = [law = law.law, ratio = std::stod(nu), element](const MeshLevel& m, const std::stop_token& stop,
                                                            Work& work) {
        const Vec3 u = cook_corner(m, law, element, material(cook_modulus, ratio), stop, work);
        return std::vector<double>{u.x(), u.y()};
    };
    s.may_lock = in_locking_range(element, std::stod(nu));
    return s;
}

std::vector<MeshStudy> mesh_studies() {
    std::vector<MeshStudy> out;
    for (const ElementName& element : elements) {
        const std::size_t first = out.size();
        for (const char* nu : {"0.0", "0.3", "0.45"}) out.push_back(small_strain(nu, element.kind));
        for (const LawName& law : laws)
            if (reference_values()["cantilever_gravity"]["continuum"].contains(std::string(law.catalogue)))
                out.push_back(gravity(law, element.kind));
        for (const LawName& law : laws)
            for (const char* nu : {"0.3", "0.45"})
                if (reference_values()["twist_180"]["continuum"].contains(std::string(law.catalogue) + " nu=" + nu))
                    out.push_back(twist(law, nu, element.kind));
        for (const char* nu : {"0.3", "0.45", "0.49", "0.499"}) out.push_back(cook_study(nu, element.kind));
        out.push_back(vibration(element.kind));
        for (std::size_t i = first; i < out.size(); ++i) {
            out[i].setting += ", " + std::string(element.word);
            if (element.kind == ElementKind::quadratic) coarsen(out[i]);
        }
    }
    return out;
}

std::vector<LevelValues> run_study(const MeshStudy& study, const RunOptions& options) {
    const std::string key = study.name + "|" + study.setting;
    if (options.memory && options.memory->levels.contains(key)) return options.memory->levels[key];
    std::vector<LevelValues> out;
    for (const MeshLevel& level : study.levels) {
        if (options.quick && !level.quick) continue;
        options.tell(study.name + ", " + study.setting + ", " + level.name());
        LevelValues v{level, {}, {}};
        v.values = study.run(level, options.stop, v.work);
        out.push_back(std::move(v));
    }
    if (options.memory) options.memory->levels[key] = out;
    return out;
}

} // namespace sinew::bench
