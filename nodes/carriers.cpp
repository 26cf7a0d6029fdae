// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/carriers.h"

#include "solver/element/quadratic_tets.h"
#include "solver/error.h"

namespace sinew::nodes {

namespace {

CarriedPoints carriers_of(const solver::TissueRest& tissue, const solver::Embedding& embedding) {
    const bool quadratic = tissue.element == solver::ElementKind::quadratic;
    std::vector<std::array<int, 6>> middles;
    if (quadratic)
        middles = solver::edge_vertices(tissue.tets.tets, solver::edges_of(tissue.tets.tets),
                                        static_cast<int>(tissue.tets.vertices.size()));
    CarriedPoints out;
    out.reserve(embedding.size());
    for (std::size_t i = 0; i < embedding.size(); ++i) {
        const std::size_t tet = static_cast<std::size_t>(embedding.tet[i]);
        out.push_back(solver::embedded_point(tissue.tets.tets[tet], quadratic ? &middles[tet] : nullptr,
                                             embedding.barycentric[i]));
    }
    return out;
}

} // namespace

CarriedPoints find_carriers(const solver::TissueRest& tissue, const solver::Points& points) {
    return carriers_of(tissue, solver::embed(tissue.tets, points));
}

solver::Points carried(const CarriedPoints& points, const solver::Points& corners, const solver::Points& midpoints) {
    solver::Points out;
    out.reserve(points.size());
    for (const solver::PointWeights& w : points) {
        solver::Vec3 p = solver::Vec3::Zero();
        for (int k = 0; k < w.count; ++k) {
            const std::size_t v = static_cast<std::size_t>(w.vertex[k]);
            p += w.weight[k] * (v < corners.size() ? corners[v] : midpoints[v - corners.size()]);
        }
        out.push_back(p);
    }
    return out;
}

PlacedPoints place(const solver::TissueRest& tissue, const Mesh& mesh, const std::string& whose) {
    const solver::Embedding embedding = solver::embed(tissue.tets, *mesh.points);
    PlacedPoints out;
    for (const double widths : solver::widths_outside(tissue.tets, embedding))
        if (widths > 1) ++out.far_vertices;
    if (out.far_vertices > 0 && out.far_vertices == mesh.points->size())
        throw solver::Error("FE239",
                            "no vertex of " + whose + " lies in the tissue's tets or within a tet's width of them",
                            "Model the mesh where the tissue is at rest, in the same units.");
    out.carriers = carriers_of(tissue, embedding);
    return out;
}

void warn_of_far_vertices(const engine::Reads& in, std::string_view attribute, const PlacedPoints& placed,
                          const std::string& whose) {
    if (placed.far_vertices == 0) return;
    in.warn(attribute, "FE239",
            std::to_string(placed.far_vertices) + " of " + std::to_string(placed.carriers.size()) + " vertices of " +
                whose +
                " lie more than a tet's width outside of the tissue's tets and will swing about with the nearest",
            "Keep the mesh near the tissue, or make the tets larger.");
}

} // namespace sinew::nodes
