// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/layer_place.h"

#include "solver/error.h"
#include "solver/meshing/triangle_finder.h"
#include "solver/meshing/welding.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sinew::solver {

double known_share(const CutTets& cut, std::size_t place) {
    TetMoments inside;
    inside.degree = cut.degree;
    std::copy_n(cut.of(place), moment_count(cut.degree), inside.value.begin());
    return inside.volume();
}

Solid make_layer_place(const Points& points, const std::vector<Triangle>& triangles, const MeshingControl& control) {
    SurfaceMesh view;
    view.points = points;
    view.triangles = triangles;
    check_usable(view);
    std::vector<Triangle> kept = weld(points, triangles).triangles;
    turn_alike(points, kept);
    if (const auto border = border_edges_of(kept); !border.empty())
        throw Error("FE230",
                    "a layer's mesh must be closed; this one is open at " + std::to_string(border.size()) +
                        " edges, the first between vertices " + std::to_string(border.front()[0]) + " and " +
                        std::to_string(border.front()[1]),
                    "Close the mesh, or remesh it by zIsoMesh with isoValue > 0.");
    return make_solid(points, triangles, Fill::empty_cavities, control);
}

std::optional<Solid> tissue_solid(const Points& points, const std::vector<Triangle>& triangles,
                                  const MeshingControl& control) {
    try {
        Solid solid = make_solid(points, triangles, Fill::filled_cavities, control);
        if (solid.is_closed) return solid;
    } catch (const Error&) { // the tets were made for another surface
    }
    return {};
}

std::vector<double> layer_shares(const TetMesh& tets, const Solid& place, const Points& surface,
                                 const std::vector<Triangle>& triangles, const MeshingControl& control,
                                 const Solid* tissue) {
    const TriangleFinder finder(place);
    std::vector<double> shares(tets.tets.size(), 0.0);
    MeshingPhase{control, 0, 0.5, "finding layers"}.run(tets.tets.size(), 64, [&](std::size_t tet) {
        const std::array<Vec3, 4> corners = corners_of(tets.vertices, tets.tets[tet]);
        shares[tet] = std::clamp(closed_share(place, corners, finder.touching(corners)), 0.0, 1.0);
    });

    std::vector<std::size_t> at_border; // places in tets.cut
    for (std::size_t k = 0; k < tets.cut.tets.size(); ++k) {
        const double share = shares[at(tets.cut.tets[k])];
        if (share > 0 && share < 1) at_border.push_back(k);
    }
    if (at_border.empty()) return shares;
    const std::optional<Solid> made = tissue ? std::optional<Solid>() : tissue_solid(surface, triangles, control);
    if (made) tissue = &*made;
    if (!tissue) return shares;
    const TriangleFinder skin(*tissue);
    MeshingPhase{control, 0.5, 1, "finding layers"}.run(at_border.size(), 4, [&](std::size_t i) {
        const std::size_t tet = at(tets.cut.tets[at_border[i]]);
        const std::array<Vec3, 4> corners = corners_of(tets.vertices, tets.tets[tet]);
        const std::vector<int> own = skin.touching(corners);
        const double solid = closed_share(*tissue, corners, own);
        constexpr double alike = 1e-6, some_part = 1e-9;
        if (!(solid > some_part) || std::abs(solid - known_share(tets.cut, at_border[i])) > alike) return;
        const double both = share_of_both(*tissue, place, corners, own, finder.touching(corners));
        shares[tet] = std::clamp(both / solid, 0.0, 1.0);
    });
    return shares;
}

std::vector<double> points_in_layer(const Points& points, const Solid& place) {
    const double on = 1e-6 * place.box.size().maxCoeff();
    std::vector<double> inside(points.size());
    parallel_for(points.size(), 64, [&](std::size_t i) {
        inside[i] = place.tree.closest(points[i], on).triangle >= 0 || place.tree.inside_either_way(points[i]) ? 1 : 0;
    });
    return inside;
}

} // namespace sinew::solver
