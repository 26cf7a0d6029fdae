// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/surface_tets.h"

#include <algorithm>
#include <numeric>

namespace sinew::solver {

template <int N>
SurfaceTets<N>::SurfaceTets(const LayeredSurfaces& surfaces) {
    for (std::size_t s = 0; s < surfaces.surfaces().size(); ++s) {
        const LayeredSurfaces::Surface& on = surfaces.surfaces()[s];
        stencil_of_piece.emplace_back();
        if (surfaces.node_count(on) != N) continue;
        std::vector<std::pair<int, int>> tets; // minus the count of pieces, number
        std::vector<int> numbers;
        for (const SurfacePiece& piece : on.clipped.pieces) numbers.push_back(piece.tet);
        std::sort(numbers.begin(), numbers.end());
        for (std::size_t i = 0, next; i < numbers.size(); i = next) {
            for (next = i; next < numbers.size() && numbers[next] == numbers[i];) ++next;
            tets.emplace_back(-static_cast<int>(next - i), numbers[i]);
        }
        std::sort(tets.begin(), tets.end());
        numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
        std::vector<int> place(numbers.size()), vertices, sorted;
        const auto place_of = [](const std::vector<int>& list, int number) {
            return at(std::lower_bound(list.begin(), list.end(), number) - list.begin());
        };
        for (std::size_t t = 0; t < tets.size(); ++t) {
            place[place_of(numbers, tets[t].second)] = static_cast<int>(stencils.size() + t);
            const auto nodes = surfaces.nodes(on, tets[t].second);
            vertices.insert(vertices.end(), nodes.begin(), nodes.begin() + N);
        }
        for (const SurfacePiece& piece : on.clipped.pieces)
            stencil_of_piece.back().push_back(place[place_of(numbers, piece.tet)]);
        sorted = vertices;
        std::sort(sorted.begin(), sorted.end());
        sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
        for (std::size_t t = 0; t < tets.size(); ++t) {
            std::array<int, N>& stencil = stencils.emplace_back();
            for (std::size_t n = 0; n < N; ++n)
                stencil[n] = static_cast<int>(points.size() + place_of(sorted, vertices[N * t + n]));
        }
        for (const int v : sorted) {
            PointWeights p;
            p.count = 1, p.vertex[0] = v, p.weight[0] = 1;
            points.push_back(p);
        }
        surface.resize(stencils.size(), s);
        point_surface.resize(points.size(), s);
    }
}

template <int N>
Stencils<N> SurfaceTets<N>::take_stencils(const Numbering& numbering) {
    std::vector<int> carrier(points.size());
    std::iota(carrier.begin(), carrier.end(), 0);
    return Stencils<N>(numbering, points, carrier, std::move(stencils));
}

template struct SurfaceTets<3>;
template struct SurfaceTets<4>;
template struct SurfaceTets<quadratic_nodes>;

} // namespace sinew::solver
