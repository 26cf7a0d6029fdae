// Accuracy of what acts on surfaces: bodies under pressure and surface tension that nothing holds. On tets that fit the
// surface some values are exact, others are the limit of finer and finer meshes; in the lattice of zTet the surface
// cuts tets, and virials are exact all the same.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/primitives.h"
#include "solver/mesh/tet_box.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"
#include "tools/bench/accuracy.h"
#include "tools/bench/free_body.h"
#include "tools/bench/models.h"
#include "tools/bench/reference.h"
#include "tools/bench/round_meshes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sinew::bench {

using namespace solver;
using nlohmann::json;

namespace {

/// Spheres are smooth, so both elements have order 2, from tets with straight edges. On the meshes that are run linear
/// ones are on their way there; an order below 1 is an element that locks.
double least_order(const ElementName& element) { return element.kind == ElementKind::linear ? 1 : 1.8; }

std::string words(const LawName& law, const ElementName& element) {
    return std::string(law.catalogue) + ", " + std::string(element.word);
}

/// Mean distance from the body's middle of the nodes that were this far away at rest.
double mean_radius(const FreeBody& body, double at_rest) {
    const Vec3 middle = body.middle();
    double sum = 0;
    int count = 0;
    for (std::size_t v = 0; v < body.rest->tets.vertices.size(); ++v)
        if (std::abs(body.rest->tets.vertices[v].norm() - at_rest) < 1e-9)
            sum += (body.place(static_cast<int>(v)) - middle).norm(), ++count;
    return sum / count;
}

/// Radial displacements of the inner and outer surface of a thick shell under a pressure inside, which is painted on
/// the inner surface as a second layer.
std::array<double, 2> inflate(double inner, double outer, int n, ElasticLaw law, ElementKind element,
                              TissueInputs values, double pressure, const std::stop_token& stop, Work& work) {
    FreeBody body(make_tissue(shell_mesh(inner, outer, n, n / 2), law, element), values);
    std::vector<double> inside;
    for (const Vec3& p : body.rest->surface) inside.push_back(p.norm() < inner + 1e-9 ? 1 : 0);
    body.load(pressure_type, {{0, {}}, {pressure, inside}});
    body.settle(stop);
    work += body.work;
    return {mean_radius(body, inner) - inner, mean_radius(body, outer) - outer};
}

struct ShellCase {
    std::string title;
    ElasticLaw law;
    TissueInputs values;
    double pressure, u_inner, u_outer;
    double share = 1; ///< of the load that is applied; displacements are divided by it
};

std::vector<ShellCase> shell_cases() {
    const json& r = reference_values()["spheres_and_balls"];
    const double inner = r["A"], outer = r["B"];
    std::vector<ShellCase> out;
    for (const auto& [title, e] : r["cases"].items()) {
        char law[32] = {};
        double nu = 0, pressure = 0, stretch = 0;
        if (std::sscanf(title.c_str(), "incompressible NH lambda_inner=%lf", &stretch) == 1) {
            // The shear modulus of the reference, whatever Poisson's ratio: det F = 1 is kept by its own energy.
            const double ratio = 0.3, mu = e["mu"];
            TissueInputs values = material(2 * (1 + ratio) * mu, ratio);
            values.layers[0].volume_conservation = 1e3 * mu; // det F to some 1e-4
            out.push_back({title + " by volume conservation", ElasticLaw::log_neo_hookean, values, e["p"],
                           (stretch - 1) * inner, (double(e["lam_outer"]) - 1) * outer});
            continue;
        }
        if (std::sscanf(title.c_str(), "%31s nu=%lf p=%lf", law, &nu, &pressure) != 3 || !e.contains("u_inner"))
            continue;
        const bool is_linear = std::string_view(law) == "linear";
        const LawName* name = find_law(is_linear ? "stvk" : law);
        if (!name) continue;
        // Linear elasticity is what all laws are for small loads.
        out.push_back(
            {title, name->law, material(r["E"], nu), pressure, e["u_inner"], e["u_outer"], is_linear ? 1e-4 : 1.0});
    }
    return out;
}

void thick_sphere(Book& book, const RunOptions& options) {
    book.open("3", "thick sphere under inner pressure");
    const json& r = reference_values()["spheres_and_balls"];
    const double inner = r["A"], outer = r["B"];
    if (options.quick) return; // coarse meshes say nothing about a limit
    for (const ElementName& element : elements)
        for (const ShellCase& c : shell_cases()) {
            std::vector<double> h, at_inner, at_outer;
            Work work;
            const bool linear = element.kind == ElementKind::linear;
            const auto sizes = linear ? std::vector{4, 6, 8} : std::vector{2, 4, 6};
            for (const int n : sizes) {
                const auto u =
                    inflate(inner, outer, n, c.law, element.kind, c.values, c.share * c.pressure, options.stop, work);
                h.push_back(1.0 / n), at_inner.push_back(u[0] / c.share), at_outer.push_back(u[1] / c.share);
            }
            const std::string setting = c.title + ", " + std::string(element.word);
            const bool may_lock = in_locking_range(element.kind, c.values.layers[0].poissons_ratio);
            book.converge(setting, "u(A) [m]", h, at_inner, c.u_inner, least_order(element), work, may_lock);
            book.converge(setting, "u(B) [m]", h, at_outer, c.u_outer, least_order(element), work, may_lock);
        }
}

/// Bodies of one material under a load on all of their surface.
struct Shape {
    std::string name;
    bool fits; ///< the tets fit the surface
    std::function<std::shared_ptr<TissueRest>(ElasticLaw, ElementKind)> make;
};

std::vector<Shape> shapes(bool quick) {
    const int fine = quick ? 1 : 2;
    const auto uneven_panel = [=] {
        return kuhn_mesh(4 * fine, 3 * fine, 2 * fine, [](double r, double s, double t) {
            return Vec3(0.3 * r + 0.03 * s * s, 0.1 * s + 0.05 * std::sin(3 * r), 0.1 * t * (1 + 0.4 * r));
        });
    };
    const double tet = quick ? 0.03 : 0.015;
    return {{"ball", true,
             [=](ElasticLaw law, ElementKind e) { return make_tissue(ball_mesh(0.05, 2 * fine, fine), law, e); }},
            {"uneven panel", true, [=](ElasticLaw law, ElementKind e) { return make_tissue(uneven_panel(), law, e); }},
            {"ball in the lattice", false,
             [=](ElasticLaw law, ElementKind e) { return lattice_tissue(make_sphere(0.05, 24, 24), tet, law, e); }},
            {"spring in the lattice", false, [=](ElasticLaw law, ElementKind e) {
                 return lattice_tissue(make_helix(0.06, 0.02, 0.08, 1.5, 12, 24), tet, law, e);
             }}};
}

/// Greatest and least stretch of an edge of the tets.
std::array<double, 2> edge_stretches(const FreeBody& body) {
    double least = 1e300, most = 0;
    for (const auto& [a, b] : edges_of(body.rest->tets.tets)) {
        const auto rest = [&](int v) { return body.rest->tets.vertices[static_cast<std::size_t>(v)]; };
        const double stretch = (body.place(a) - body.place(b)).norm() / (rest(a) - rest(b)).norm();
        least = std::min(least, stretch), most = std::max(most, stretch);
    }
    return {least, most};
}

/// One pressure all around makes every body of one material smaller by one stretch, whatever its shape. Tets that fit
/// the surface know it exactly.
void dilation(Book& book, const RunOptions& options) {
    book.open("3", "body of any shape under pressure");
    const json& table = reference_values()["spheres_and_balls"]["ball_E1000_nu0.45"];
    for (const Shape& shape : shapes(options.quick))
        for (const ElementName& element : elements)
            for (const LawName& law : laws) {
                FreeBody body(shape.make(law.law, element.kind), material(1000, 0.45));
                body.load(pressure_type, {{500, {}}});
                const double known = table[std::string(law.catalogue)]["stretch_under_pressure_500"];
                const std::string setting = words(law, element) + ", " + shape.name;
                if (law.law == ElasticLaw::stvk) {
                    // Its shear modulus goes down with the pressure, here to mu l - p < 0: the table's value is a
                    // balance, but one from which a free body runs away.
                    if (shape.fits)
                        book.compare(CaseKind::exact, setting, "imbalance at the stretch", body.imbalance(known), 0,
                                     1e-10, {}, 1);
                    continue;
                }
                const double at_rest = body.volume();
                body.settle(options.stop);
                if (shape.fits) {
                    const auto [least, most] = edge_stretches(body);
                    book.compare(CaseKind::exact, setting, "least stretch", least, known, 1e-7, body.work);
                    book.compare(CaseKind::exact, setting, "greatest stretch", most, known, 1e-7, body.work);
                } else {
                    book.compare(CaseKind::continuum, setting, "stretch by volume", std::cbrt(body.volume() / at_rest),
                                 known, 1e-3, body.work);
                }
            }
}

/// Soft and stiff parts, so that nothing is uniform, under a load: in balance the stresses' mean is known all the same.
void virial(Book& book, const RunOptions& options) {
    book.open("3", "virial theorem");
    for (const Shape& shape : shapes(true))
        for (const ElementName& element : elements)
            for (const LawName& law : laws) {
                if (options.quick && law.law != ElasticLaw::log_neo_hookean) continue;
                const std::string setting = words(law, element) + ", " + shape.name + " of two materials";
                const auto loaded = [&](const TermType& type, double value) {
                    FreeBody body(shape.make(law.law, element.kind), material(1000, 0.45));
                    std::vector<double> stiff;
                    for (const Tet& t : body.rest->tets.tets)
                        stiff.push_back(
                            std::clamp(20 * body.rest->tets.vertices[static_cast<std::size_t>(t[0])].x(), 0.0, 1.0));
                    body.add_layer(stiff, material(5000, 0.3).layers[0]);
                    body.load(type, {{value, {}}, {value, {}}});
                    body.settle(options.stop);
                    return body;
                };
                const FreeBody pressed = loaded(pressure_type, 200);
                book.compare(CaseKind::exact, setting, "sum f.x / 3V under pressure [Pa]",
                             pressed.elastic_virial() / (3 * pressed.volume()), -200, 1e-8, pressed.work);
                const FreeBody tense = loaded(surface_tension_type, 0.5);
                book.compare(CaseKind::exact, setting, "sum f.x / 2A under tension [N/m]",
                             tense.elastic_virial() / (2 * tense.area()), -0.5, 1e-8, tense.work);
            }
}

void laplace(Book& book, const RunOptions& options) {
    book.open("3", "ball under surface tension, Laplace's law");
    const json& table = reference_values()["spheres_and_balls"]["ball_E1000_nu0.45"];
    const double radius = 0.05, modulus = 1000, ratio = 0.45;
    if (options.quick) return; // coarse meshes say nothing about a limit
    for (const ElementName& element : elements)
        for (const LawName& law : laws)
            for (const bool fits : {true, false}) {
                double tension = 25, known = table[std::string(law.catalogue)]["stretch_under_surface_tension_25"];
                // Under that much, these shear away from the ball of the table. A tenth of it, by the equations that
                // give its values too: s = 3 lambda + 2 mu times (l^2 - 1)/(2 l), or (l - 1)/l^2, is -2 g/(R l).
                const double s = modulus / (1 - 2 * ratio);
                if (law.law == ElasticLaw::stvk || law.law == ElasticLaw::corotational) {
                    tension = 2.5;
                    const double load = 2 * tension / (radius * s);
                    known = law.law == ElasticLaw::stvk ? std::sqrt(1 - 2 * load) : 1 / (1 + load);
                }
                std::vector<double> h, values;
                Work work;
                const bool linear = element.kind == ElementKind::linear;
                for (const int n : linear ? std::vector{4, 8, 12} : std::vector{2, 4, 8}) {
                    FreeBody body(
                        fits ? make_tissue(ball_mesh(radius, n, n / 2), law.law, element.kind)
                             : lattice_tissue(make_sphere(radius, 4 * n, 4 * n), 0.16 / n, law.law, element.kind),
                        material(1000, 0.45));
                    body.load(surface_tension_type, {{tension, {}}});
                    const double before = body.volume();
                    body.settle(options.stop);
                    h.push_back(1.0 / n), values.push_back(std::cbrt(body.volume() / before));
                    work += body.work;
                }
                book.converge(words(law, element) + ", tension " + number(tension) + " N/m" +
                                  (fits ? "" : ", in the lattice"),
                              "stretch by volume", h, values, known, least_order(element), work);
            }
}

/// The cube's strain has no bound at its edges, so displacements converge more slowly there.
void cube_rounding(Book& book, const RunOptions& options) {
    book.open("7", "rounding of a cube by surface tension");
    const auto only = reference_values()["surface_tension_cube"].begin();
    const std::string& title = only.key();
    const nlohmann::json& e = *only;
    const double half = 0.05, ratio = 0.45, modulus = 2 * (1 + ratio) * double(e["mu"]);
    if (options.quick) return; // coarse meshes say nothing about a limit
    // Denser towards the faces.
    const auto graded = [=](double s) {
        return half * (2 * (s - 0.7 * std::sin(2 * std::numbers::pi * s) / (2 * std::numbers::pi)) - 1);
    };
    constexpr std::array quantities{"face_radius", "edge_radius", "corner_radius", "volume", "area", "strain_energy"};
    constexpr std::array units{" [m]", " [m]", " [m]", " [m^3]", " [m^2]", " [J]"};
    for (const ElementName& element : elements) {
        std::vector<double> h;
        std::array<std::vector<double>, quantities.size()> values;
        Work work;
        const bool linear = element.kind == ElementKind::linear;
        for (const int n : linear ? std::vector{8, 12, 20} : std::vector{4, 6, 10}) {
            TetMesh mesh =
                kuhn_mesh(n, n, n, [&](double r, double s, double t) { return Vec3(graded(r), graded(s), graded(t)); });
            FreeBody body(make_tissue(std::move(mesh), ElasticLaw::log_neo_hookean, element.kind),
                          material(modulus, ratio));
            body.load(surface_tension_type, {{e["gamma"], {}}});
            body.settle(options.stop);
            work += body.work;
            // By number of coordinates at the cube's faces, half the distance to the vertex across the middle.
            double sum[3] = {}, count[3] = {};
            for (int x = -1; x <= 1; ++x)
                for (int y = -1; y <= 1; ++y)
                    for (int z = -1; z <= 1; ++z) {
                        const int faces = std::abs(x) + std::abs(y) + std::abs(z);
                        if (faces == 0) continue;
                        const Vec3 p = half * Vec3(x, y, z);
                        const Points& rest = body.rest->tets.vertices;
                        sum[faces - 1] +=
                            0.5 * (body.place(vertex_at(rest, p)) - body.place(vertex_at(rest, -p))).norm();
                        ++count[faces - 1];
                    }
            h.push_back(1.0 / n);
            for (std::size_t k = 0; k < 3; ++k) values[k].push_back(sum[k] / count[k]);
            values[3].push_back(body.volume());
            values[4].push_back(body.area());
            values[5].push_back(body.elastic_energy());
        }
        for (std::size_t q = 0; q < quantities.size(); ++q) {
            std::string name = quantities[q];
            std::replace(name.begin(), name.end(), '_', ' ');
            const std::string setting = "nh, " + title + ", " + std::string(element.word);
            // Volume and energy pass through their limits on the way, so orders say nothing about them.
            const bool has_order = !linear && q != 3 && q != 5;
            if (has_order) book.converge(setting, name + units[q], h, values[q], e[quantities[q]]["value"], 1, work);
            book.compare(CaseKind::continuum, setting + ", finest mesh", name + units[q], values[q].back(),
                         e[quantities[q]]["value"],
                         linear   ? 2e-2
                         : q == 5 ? 1e-2
                                  : 3e-3,
                         work);
        }
    }
}

} // namespace

std::vector<AccuracyCase> surface_cases() {
    return {{"thick sphere under inner pressure", thick_sphere},
            {"body of any shape under pressure", dilation},
            {"virial theorem", virial},
            {"ball under surface tension, Laplace's law", laplace},
            {"rounding of a cube by surface tension", cube_rounding}};
}

} // namespace sinew::bench
