// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/volume_patches.h"

#include <algorithm>
#include <array>
#include <map>

namespace sinew::solver {

namespace {

constexpr std::size_t patch_size = 7;

/// Tets across each of the four faces; -1 at the border.
std::vector<std::array<int, 4>> neighbours(const std::vector<Tet>& tets) {
    struct Face {
        std::array<int, 3> corners;
        int tet, side;
    };
    std::vector<Face> faces;
    faces.reserve(4 * tets.size());
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int side = 0; side < 4; ++side) {
            Face f{{}, static_cast<int>(t), side};
            for (int i = 0, k = 0; i < 4; ++i)
                if (i != side) f.corners[static_cast<std::size_t>(k++)] = tets[t][static_cast<std::size_t>(i)];
            std::sort(f.corners.begin(), f.corners.end());
            faces.push_back(f);
        }
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
        return a.corners != b.corners ? a.corners < b.corners : a.tet < b.tet;
    });
    std::vector<std::array<int, 4>> out(tets.size(), {-1, -1, -1, -1});
    for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
        const Face &a = faces[i], &b = faces[i + 1];
        if (a.corners != b.corners) continue;
        out[static_cast<std::size_t>(a.tet)][static_cast<std::size_t>(a.side)] = b.tet;
        out[static_cast<std::size_t>(b.tet)][static_cast<std::size_t>(b.side)] = a.tet;
    }
    return out;
}

int new_vertices(const Tet& tet, const std::vector<int>& have) {
    return static_cast<int>(std::count_if(tet.begin(), tet.end(),
                                          [&](int v) { return std::find(have.begin(), have.end(), v) == have.end(); }));
}

std::vector<std::vector<int>> grow(const std::vector<Tet>& tets) {
    const std::vector<std::array<int, 4>> across = neighbours(tets);
    std::vector<int> patch_of(tets.size(), -1);
    std::vector<std::vector<int>> patches;
    for (std::size_t seed = 0; seed < tets.size(); ++seed) {
        if (patch_of[seed] >= 0) continue;
        const int patch = static_cast<int>(patches.size());
        std::vector<int> members{static_cast<int>(seed)}, vertices(tets[seed].begin(), tets[seed].end());
        patch_of[seed] = patch;
        while (members.size() < patch_size) {
            int best = -1, best_new = 5;
            for (const int member : members)
                for (const int next : across[static_cast<std::size_t>(member)]) {
                    if (next < 0 || patch_of[static_cast<std::size_t>(next)] >= 0) continue;
                    const int added = new_vertices(tets[static_cast<std::size_t>(next)], vertices);
                    if (added < best_new || (added == best_new && next < best)) best = next, best_new = added;
                }
            if (best < 0) break;
            members.push_back(best);
            patch_of[static_cast<std::size_t>(best)] = patch;
            for (const int v : tets[static_cast<std::size_t>(best)])
                if (std::find(vertices.begin(), vertices.end(), v) == vertices.end()) vertices.push_back(v);
        }
        patches.push_back(std::move(members));
    }
    // Small leftovers join the neighbour with which they share the most faces.
    for (std::size_t p = 0; p < patches.size(); ++p) {
        if (patches[p].size() > patch_size / 2) continue;
        std::map<int, int> shared;
        for (const int member : patches[p])
            for (const int next : across[static_cast<std::size_t>(member)])
                if (next >= 0 && patch_of[static_cast<std::size_t>(next)] != static_cast<int>(p))
                    ++shared[patch_of[static_cast<std::size_t>(next)]];
        int best = -1;
        for (const auto& [patch, faces] : shared)
            if (best < 0 || faces > shared[best]) best = patch;
        if (best < 0) continue;
        for (const int member : patches[p]) {
            patch_of[static_cast<std::size_t>(member)] = best;
            patches[static_cast<std::size_t>(best)].push_back(member);
        }
        patches[p].clear();
    }
    std::erase_if(patches, [](const std::vector<int>& p) { return p.empty(); });
    return patches;
}

} // namespace

VolumePatches make_volume_patches(const TetMesh& mesh) {
    VolumePatches out;
    out.patch_of_tet.assign(mesh.tets.size(), -1);
    out.tet_start = out.member_start = out.corner_start = {0};
    for (std::vector<int>& tets : grow(mesh.tets)) {
        std::sort(tets.begin(), tets.end());
        std::map<int, std::vector<int>> corners; // by vertex
        for (const int t : tets) {
            out.patch_of_tet[static_cast<std::size_t>(t)] = static_cast<int>(out.tet_start.size()) - 1;
            out.tets.push_back(t);
            for (int c = 0; c < 4; ++c)
                corners[mesh.tets[static_cast<std::size_t>(t)][static_cast<std::size_t>(c)]].push_back(4 * t + c);
        }
        out.tet_start.push_back(static_cast<int>(out.tets.size()));
        for (const auto& [vertex, at] : corners) {
            out.vertex.push_back(vertex);
            out.corners.insert(out.corners.end(), at.begin(), at.end());
            out.corner_start.push_back(static_cast<int>(out.corners.size()));
        }
        out.member_start.push_back(static_cast<int>(out.vertex.size()));
    }
    return out;
}

} // namespace sinew::solver
