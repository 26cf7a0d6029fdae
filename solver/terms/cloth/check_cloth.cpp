// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/cloth/check_cloth.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/mesh_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

namespace sinew::solver {

namespace {

[[noreturn]] void refuse(int body, const std::string& code, const std::string& message, const std::string& hint) {
    Error e(code, message, hint);
    e.body = body;
    throw e;
}

std::string number(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
}

std::string near(const Vec3& p) {
    return " near (" + number(p.x()) + ", " + number(p.y()) + ", " + number(p.z()) + ")";
}

} // namespace

void check_cloth(const ClothRest& cloth, int body) {
    const std::size_t vertices = cloth.surface.size();
    if (cloth.triangles.empty()) refuse(body, "FE201", "the cloth has no faces", "its mesh must not be empty");
    for (std::size_t v = 0; v < vertices; ++v)
        if (!cloth.surface[v].allFinite())
            refuse(body, "FE202", "vertex " + std::to_string(v) + " of the cloth is not a finite number",
                   "repair the mesh");
    for (const Triangle& t : cloth.triangles)
        for (const int v : t)
            if (v < 0 || at(v) >= vertices)
                refuse(body, "FE203",
                       "a face of the cloth names vertex " + std::to_string(v) + " of " + std::to_string(vertices),
                       "vertex numbers count from 0");
    if (cloth.layer_weights.empty())
        refuse(body, "FE206", "the cloth has no material", "connect at least one zMaterial");
    for (const auto& weights : cloth.layer_weights) {
        if (weights.size() != vertices)
            refuse(body, "FE204",
                   "a material layer has " + std::to_string(weights.size()) + " weights for " +
                       std::to_string(vertices) + " vertices",
                   "one weight per vertex");
        if (!std::all_of(weights.begin(), weights.end(), [](double w) { return std::isfinite(w); }))
            refuse(body, "FE202", "a weight of a material layer is not a finite number", "check the painted map");
    }
    if (cloth.warp.size() != cloth.triangles.size())
        refuse(body, "FE204",
               "the cloth has " + std::to_string(cloth.warp.size()) + " directions of its warp for " +
                   std::to_string(cloth.triangles.size()) + " triangles",
               "one for each triangle");
    const MeshCheck check = check_mesh(cloth.surface, cloth.triangles);
    if (check.non_manifold_edges) {
        const auto [a, b] = check.non_manifold_edges.edges.front();
        refuse(body, "FE270",
               describe(check.non_manifold_edges, "edge", "edges") + " of the cloth with more than two faces," +
                   near(0.5 * (cloth.surface[at(a)] + cloth.surface[at(b)])),
               "a sheet has at most two faces at an edge: split the mesh there, and sew the parts by a zAttachment");
    }
    if (check.unused_vertices) {
        const int v = check.unused_vertices.first.front();
        refuse(body, "FE271",
               describe(check.unused_vertices, "vertex", "vertices") + " of the cloth in no face," +
                   near(cloth.surface[at(v)]),
               "remove unused vertices from the mesh: nothing would hold them");
    }
    if (check.degenerate_triangles) {
        const auto& t = cloth.triangles[at(check.degenerate_triangles.first.front())];
        refuse(body, "FE272",
               describe(check.degenerate_triangles, "face", "faces") + " of the cloth without area," +
                   near(cloth.surface[at(t[0])]),
               "remove or merge them: stretch is measured against a face's size at rest");
    }
}

void check_cloth_values(const ClothInputs& in, int body) {
    const auto refuse_value = [&](const std::string& what) {
        refuse(body, "FE304", what + " is not a finite number", "check the attribute and what it is connected to");
    };
    if (const auto* f = not_finite(in)) refuse_value(std::string("the ") + f->name + " of a cloth");
    for (const ClothMaterial& m : in.layers) {
        if (const auto* f = not_finite(m)) refuse_value(std::string("the ") + f->name + " of a cloth's material");
        for (const auto& [name, value] : {std::pair("tensileStiffness", m.tensile_stiffness),
                                          {"shearStiffness", m.shear_stiffness},
                                          {"bendStiffness", m.bend_stiffness},
                                          {"clothMassDensity", m.mass_density}})
            if (value < 0)
                refuse(body, "FE273", std::string(name) + " of a cloth's material is " + number(value),
                       "stiffnesses and densities are not negative");
        const double scale = std::pow(m.rest_scale, in.rest_scale_envelope);
        constexpr double most_change = 1e3; // as of tissues
        if (!(m.rest_scale > 0) || !(scale >= 1 / most_change) || !(scale <= most_change))
            refuse(body, "FE247",
                   "restScale " + number(m.rest_scale) + " to the power of restScaleEnvelope " +
                       number(in.rest_scale_envelope) + " is " + number(scale),
                   "lengths at rest may become 1000 times smaller to 1000 times larger");
    }
    if (!(in.layers.front().mass_density > 0))
        refuse(body, "FE273", "clothMassDensity of a cloth's first material is 0", "a cloth needs mass");
    if (!(in.layers.front().tensile_stiffness > 0))
        refuse(body, "FE273", "tensileStiffness of a cloth's first material is 0",
               "a cloth that nothing keeps together has no shape: give it some");
    if (!std::all_of(in.forces.begin(), in.forces.end(), [](const Vec3& f) { return f.allFinite(); }))
        refuse_value("a load on a cloth");
}

} // namespace sinew::solver
