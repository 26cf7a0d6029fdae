// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/deep_contact.h"

#include "nodes/contact_inputs.h"
#include "nodes/z_solver_attributes.h"
#include "solver/mesh/surface_pieces.h"
#include "solver/terms/contact/contact_rest.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace sinew::nodes {

using namespace engine;
using namespace z_solver;

namespace {

/// Volume by area, in the units of the points: half a plate's thickness, half a rod's radius, a third of a ball's; of
/// each piece of a surface. `part`: the piece of each vertex.
std::vector<double> volumes_by_area(const solver::Points& points, const std::vector<solver::Triangle>& triangles,
                                    const std::vector<int>& part, std::size_t parts) {
    std::vector<double> out(parts, 0.0), areas(parts, 0.0);
    if (points.empty()) return out;
    for (const solver::Triangle& t : triangles) {
        const auto corner = [&](std::size_t i) -> solver::Vec3 {
            return points[static_cast<std::size_t>(t[i])] - points.front();
        };
        const solver::Vec3 a = corner(0), b = corner(1), c = corner(2);
        const auto of = static_cast<std::size_t>(part[static_cast<std::size_t>(t[0])]);
        out[of] += a.dot(b.cross(c)) / 6, areas[of] += 0.5 * (b - a).cross(c - a).norm();
    }
    for (std::size_t k = 0; k < parts; ++k) out[k] = areas[k] > 0 ? std::max(0.0, out[k] / areas[k]) : 0;
    return out;
}

const solver::ContactRest& rest_of(const Body& body) {
    return static_cast<const solver::ContactRest&>(*body.contact->rest);
}

double stiffness_of(const Body& body) {
    return solver::get_fields<solver::ContactValues>(body.contact->values).stiffness;
}

/// A contact is deep beyond this share of the volume by area of what is thinner: three eighths of a plate's thickness,
/// an eighth of a ball's. Of a cloth it is beyond so many thicknesses.
constexpr double deep_share = 0.75, deep_thicknesses = 2;
/// What is advised shall leave this share: what is on its way presses harder later.
constexpr double advised_share = 0.02;

/// How thick what collides of each body is.
class Breadths {
  public:
    /// `meshes`: where the bodies are now. `units` of them in a metre.
    Breadths(const Reads& in, const Setup& setup, const MeshList& meshes, double units)
        : in_(in)
        , setup_(setup)
        , meshes_(meshes)
        , units_(units)
        , kept_(meshes.meshes.size()) {}

    /// Of a body about a place, in metres, such that deep_share of it is deep; infinite where nothing says.
    double at(int body, const solver::Vec3& place) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const auto index = static_cast<std::size_t>(body);
        const Body& b = setup_.bodies[index];
        if (!b.contact) return infinity;
        const solver::ContactRest& rest = rest_of(b);
        if (rest.thickness > 0) return rest.thickness * deep_thicknesses / deep_share;
        if (!rest.is_volume) return infinity;
        Kept& kept = kept_[index];
        const Mesh& mesh = meshes_.meshes[index];
        if (kept.sizes.empty()) measure(b, mesh, kept);
        std::size_t part = 0;
        if (kept.sizes.size() > 1) {
            double least = infinity;
            for (std::size_t v = 0; v < mesh.points->size(); ++v)
                if (const double d = ((*mesh.points)[v] - place).squaredNorm(); kept.part[v] >= 0 && d < least)
                    least = d, part = static_cast<std::size_t>(kept.part[v]);
        }
        return part < kept.sizes.size() && kept.sizes[part] > 0 ? kept.sizes[part] / units_ : infinity;
    }

  private:
    struct Kept {
        std::vector<double> sizes; ///< of each part, in scene units
        std::vector<int> part;     ///< of each vertex, where there are several; -1: of none
    };
    void measure(const Body& body, const Mesh& mesh, Kept& kept) const {
        if (const auto& shape = rest_of(body).shape) { // as modelled, which it keeps nearly
            const std::vector<int> one(shape->surface.size(), 0);
            kept.sizes = volumes_by_area(shape->surface, shape->triangles, one, 1);
            return;
        }
        const MeshTopology& topology = *mesh.topology;
        const std::uint64_t vertices = mesh.points->size();
        auto pieces = in_.lease<solver::SurfacePieces>(
            Hasher().add("contact.pieces").add(topology.digest).add(vertices).finish(), [&] {
                return std::make_shared<solver::SurfacePieces>(
                    solver::find_pieces(mesh.points->size(), topology.triangles));
            });
        kept.sizes = volumes_by_area(*mesh.points, topology.triangles, pieces->of_point, pieces->count());
        if (pieces->count() > 1) kept.part = pieces->of_point;
    }
    const Reads& in_;
    const Setup& setup_;
    const MeshList& meshes_;
    double units_;
    std::vector<Kept> kept_;
};

/// "skin to 1e+07 N/m^3": the softer one, or both, to the power of ten that leaves a contact as deep as advised if what
/// presses stays the same. Empty where that is more than there is.
std::string advice(const Reads& in, const Setup& setup, const solver::ContactPoint& c, double share) {
    const auto body = [&](int place) -> const Body& { return setup.bodies[static_cast<std::size_t>(place)]; };
    const auto name = [&](int place) { return in.source_name(bodies.name, static_cast<std::size_t>(place)); };
    const double one = stiffness_of(body(c.source)), other = stiffness_of(body(c.target));
    const double k = std::pow(10, std::ceil(std::log10(2 / (1 / one + 1 / other) * share / advised_share)));
    if (!(k <= most_contact_stiffness)) return {};
    char number[32];
    std::snprintf(number, sizeof number, "%.0e", k);
    std::string which = c.source == c.target || one < k ? name(c.source) : "";
    if (c.source != c.target && other < k) which += (which.empty() ? "" : " and ") + name(c.target);
    return which + " to " + number + " N/m^3";
}

/// A place by a length beside which rounding is nothing.
std::string place_text(const solver::Vec3& place, double length) {
    std::string out;
    for (const double v : place) {
        char number[32];
        std::snprintf(number, sizeof number, "%.4g", std::abs(v) < 1e-6 * length ? 0.0 : v);
        out += (out.empty() ? "" : ", ") + std::string(number);
    }
    return "(" + out + ")";
}

} // namespace

void find_deep(const Reads& in, const Setup& setup, const MeshList& meshes, const ContactList& contacts,
               SolveReport& report) {
    if (report.record.substeps == 0) return; // what is modelled into each other is another matter (FE341)
    const double units = setup.space.units * setup.space.stretch;
    Breadths breadths(in, setup, meshes, units);
    const solver::ContactPoint* worst = nullptr;
    double share = deep_share;
    for (const ContactSum& sum : sums_of(contacts)) {
        const solver::ContactPoint& c = contacts.contacts[sum.deepest];
        const double of = c.depth / std::min(breadths.at(c.source, c.place), breadths.at(c.target, c.place));
        if (of > share) worst = &c, share = of;
    }
    if (!worst) return;
    report.worst.deep_body = worst->source, report.worst.deep_target = worst->target;
    report.worst.deep = worst->depth, report.worst.deep_share = share;
    report.worst.deep_place = {worst->place.x(), worst->place.y(), worst->place.z()};
    if (!report.record.converged) return; // that is told
    const bool itself = worst->source == worst->target;
    const std::string one = in.source_name(bodies.name, static_cast<std::size_t>(worst->source)),
                      other = in.source_name(bodies.name, static_cast<std::size_t>(worst->target));
    char depth[40];
    std::snprintf(depth, sizeof depth, " %.3g scene units deep in ", worst->depth * units);
    const std::string raise = advice(in, setup, *worst, share);
    in.warn(collision_detection.name, "FE307",
            "the frame ends with " + (itself ? one : one + " and " + other) + depth +
                (itself ? "itself" : "each other") + ", near " + place_text(worst->place, worst->depth * units) +
                ": contact is too soft for what presses there, or they were in each other when it began",
            (raise.empty() ? "T" : "Raise contactStiffness of " + raise + " or more. Else t") +
                "ake more substeps if they come fast, or look whether they are modelled into each other.");
}

} // namespace sinew::nodes
