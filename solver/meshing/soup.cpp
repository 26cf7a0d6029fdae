// Polygon soups made ready.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/soup.h"

#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/meshing/shells.h"
#include "solver/meshing/welding.h"

#include <algorithm>

namespace sinew::solver {
namespace {

void find_open_edges(Soup& soup) {
    const auto border = border_edges_of(soup.triangles);
    soup.open_edges = 0;
    for (std::size_t i = 0; i < border.size(); ++i) {
        // An edge is named once for each use too many.
        const std::array<int, 2> edge{std::min(border[i][0], border[i][1]), std::max(border[i][0], border[i][1])};
        if (i > 0 && (border[i] == border[i - 1])) continue;
        if (soup.open_edges++ == 0) soup.first_open = edge;
    }
    soup.is_closed = soup.open_edges == 0;
}

/// Renumbers the vertices that are used, in their order.
/// \return the old number of each
std::vector<int> compact(Soup& soup, const Points& all) {
    std::vector<char> used(all.size(), 0);
    for (const Triangle& t : soup.triangles)
        for (const int v : t) used[at(v)] = 1;
    std::vector<int> number(all.size(), -1), old;
    for (std::size_t v = 0; v < all.size(); ++v)
        if (used[v]) {
            number[v] = static_cast<int>(soup.points.size());
            soup.points.push_back(all[v]);
            old.push_back(static_cast<int>(v));
        }
    for (Triangle& t : soup.triangles)
        for (int& v : t) v = number[at(v)];
    return old;
}

} // namespace

Soup make_soup(const Points& points, const std::vector<Triangle>& triangles) {
    check_usable(SurfaceMesh::from_triangles(points, triangles));
    Soup soup;
    soup.triangles = weld(points, triangles).triangles;
    if (soup.triangles.empty())
        throw Error("FE201", "all " + std::to_string(triangles.size()) + " triangles have two corners in one place",
                    "Give a mesh with at least one triangle that has an area.");
    const std::vector<int> old = compact(soup, points);
    find_open_edges(soup);
    if (!soup.is_closed) {
        const std::vector<Triangle> as_given = soup.triangles;
        turn_alike(soup.points, soup.triangles);
        find_open_edges(soup);
        if (!soup.is_closed) {
            soup.triangles = as_given;
            find_open_edges(soup);
            for (int& v : soup.first_open) v = old[at(v)];
        }
    }
    return soup;
}

bool is_closed_once_welded(const Points& points, const std::vector<Triangle>& triangles) {
    try {
        return make_soup(points, triangles).is_closed;
    } catch (const Error&) {
        return false; // nothing with an area
    }
}

} // namespace sinew::solver
