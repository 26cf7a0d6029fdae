// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/deep_contact.h"

#include "nodes/contact_inputs.h"
#include "nodes/z_solver_attributes.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/terms/contact/contact_rest.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

namespace sinew::nodes {

using namespace engine;
using namespace z_solver;

namespace {

/// Volume by area, in the units of the points: half a plate's thickness, half a rod's radius, a third of a ball's.
double volume_by_area(const solver::Points& points, const std::vector<solver::Triangle>& triangles) {
    const std::vector<double> areas = solver::vertex_areas(points, triangles);
    const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
    return area > 0 ? std::max(0.0, solver::enclosed_volume(points, triangles) / area) : 0;
}

const solver::ContactRest& rest_of(const Body& body) {
    return static_cast<const solver::ContactRest&>(*body.contact->rest);
}

/// Of what collides of a body, in scene units; infinite where that bounds no solid. `mesh`: where it is now.
double breadth_of(const Body& body, const Mesh& mesh) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if (!body.contact || !rest_of(body).is_volume) return infinity;
    const auto& shape = rest_of(body).shape; // as modelled, which it keeps nearly
    const double size = shape ? volume_by_area(shape->surface, shape->triangles)
                              : volume_by_area(*mesh.points, mesh.topology->triangles);
    return size > 0 ? size : infinity;
}

/// A contact is deep beyond this share of the volume by area of what is thinner: three eighths of a plate's thickness,
/// an eighth of a ball's.
constexpr double deep_share = 0.75;
/// What is advised shall leave this share.
constexpr double advised_share = 0.1;

/// The contactStiffness, a power of ten, that leaves a contact as deep as advised if what presses stays the same
/// [N/m^3].
double advised_stiffness(const Body& one, const Body& other, double share) {
    const auto of = [](const Body& b) {
        return solver::get_fields<solver::ContactValues>(b.contact->values).stiffness;
    };
    const double now = 2 / (1 / of(one) + 1 / of(other));
    return std::pow(10, std::ceil(std::log10(now * share / advised_share)));
}

} // namespace

void find_deep(const Reads& in, const Setup& setup, const MeshList& meshes, const ContactList& contacts,
               SolveReport& report) {
    if (report.record.substeps == 0) return; // what is modelled into each other is another matter (FE341)
    const auto body = [&](int place) -> const Body& { return setup.bodies[static_cast<std::size_t>(place)]; };
    const double units = setup.space.units * setup.space.stretch;
    std::vector<double> breadths(meshes.meshes.size(), -1); // [m], found when they are asked for
    const auto breadth = [&](int place) {
        double& b = breadths[static_cast<std::size_t>(place)];
        if (b < 0) b = breadth_of(body(place), meshes.meshes[static_cast<std::size_t>(place)]) / units;
        return b;
    };
    const solver::ContactPoint* worst = nullptr;
    double share = deep_share;
    for (const ContactSum& sum : sums_of(contacts)) {
        const solver::ContactPoint& c = contacts.contacts[sum.deepest];
        const double of = c.depth / std::min(breadth(c.source), breadth(c.target));
        if (c.slides && of > share) worst = &c, share = of;
    }
    if (!worst) return;
    report.worst.deep_body = worst->source, report.worst.deep_target = worst->target;
    report.worst.deep = worst->depth, report.worst.deep_share = share;
    report.worst.deep_place = {worst->place.x(), worst->place.y(), worst->place.z()};
    if (!report.record.converged) return; // that is told
    const bool itself = worst->source == worst->target;
    const std::string one = in.source_name(bodies.name, static_cast<std::size_t>(worst->source)),
                      other = in.source_name(bodies.name, static_cast<std::size_t>(worst->target));
    char text[200];
    std::snprintf(text, sizeof text,
                  " %.3g scene units deep in %s, near (%.4g, %.4g, %.4g): contact is too soft for what presses there",
                  worst->depth * units, itself ? "itself" : "each other", worst->place.x(), worst->place.y(),
                  worst->place.z());
    std::string hint = "Take more substeps if they come fast, or look whether they are modelled into each other.";
    if (const double k = advised_stiffness(body(worst->source), body(worst->target), share);
        k <= most_contact_stiffness) {
        char number[32];
        std::snprintf(number, sizeof number, "%.0e", k);
        hint = "Raise contactStiffness of " + std::string(itself ? "it" : "both") + " to " + number +
               " N/m^3 or more. Else t" + hint.substr(1);
    }
    in.warn(collision_detection.name, "FE307", "the frame ends with " + (itself ? one : one + " and " + other) + text,
            hint);
}

} // namespace sinew::nodes
