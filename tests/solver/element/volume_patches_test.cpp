// Patches of tets over which volume is conserved: which tets they hold, that they hang together, and their lists.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/element/volume_patches.h"
#include "tests/support/solver_scenes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

/// A chain of tets, each sharing a face with the next.
TetMesh chain(int count) {
    TetMesh mesh;
    for (int i = 0; i < count + 3; ++i) mesh.vertices.emplace_back(i, std::cos(2.3 * i), std::sin(2.3 * i));
    for (int i = 0; i < count; ++i) mesh.tets.push_back({i, i + 1, i + 2, i + 3});
    return mesh;
}

bool share_a_face(const Tet& a, const Tet& b) {
    int shared = 0;
    for (const int v : a) shared += std::count(b.begin(), b.end(), v);
    return shared == 3;
}

std::vector<int> members(const VolumePatches& p, std::size_t patch) {
    return {p.tets.begin() + p.tet_start[patch], p.tets.begin() + p.tet_start[patch + 1]};
}

/// Whether each tet of a patch is reached from its first over faces within the patch.
bool hangs_together(const TetMesh& mesh, const std::vector<int>& tets) {
    std::set<int> reached{tets.front()};
    for (bool grows = true; grows;) {
        grows = false;
        for (const int t : tets)
            for (const int r : std::set<int>(reached))
                if (!reached.contains(t) && share_a_face(mesh.tets[std::size_t(t)], mesh.tets[std::size_t(r)]))
                    grows = reached.insert(t).second;
    }
    return reached.size() == tets.size();
}

} // namespace

TEST_CASE("a chain of tets falls into runs of seven, and what is left over joins its neighbour", "[patches]") {
    // Seven at a time from the lowest; rests of up to three join the patch before them.
    const std::vector<std::pair<int, std::vector<std::size_t>>> cases = {
        {1, {1}}, {3, {3}}, {7, {7}}, {8, {8}}, {10, {10}}, {11, {7, 4}}, {14, {7, 7}}, {17, {7, 10}}, {18, {7, 7, 4}}};
    for (const auto& [count, sizes] : cases) {
        const VolumePatches p = make_volume_patches(chain(count));
        INFO(count << " tets");
        REQUIRE(p.count() == sizes.size());
        int first = 0;
        for (std::size_t k = 0; k < sizes.size(); ++k) {
            std::vector<int> run(sizes[k]);
            for (std::size_t i = 0; i < run.size(); ++i) run[i] = first + static_cast<int>(i);
            CHECK(members(p, k) == run);
            first += static_cast<int>(sizes[k]);
        }
    }
}

TEST_CASE("pieces that no face joins keep to themselves", "[patches]") {
    TetMesh mesh = chain(2);
    mesh.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 5, 6, 7}}; // the third shares a vertex only
    mesh.vertices.resize(8, Vec3::Zero());
    const VolumePatches p = make_volume_patches(mesh);
    REQUIRE(p.count() == 2);
    CHECK(members(p, 0) == std::vector<int>{0, 1});
    CHECK(members(p, 1) == std::vector<int>{2});
}

TEST_CASE("in a box every tet is in one patch, patches hang together, and their lists agree with the mesh",
          "[patches]") {
    const TetMesh mesh = box_mesh({1, 0.8, 0.6}, 5, 4, 3);
    const VolumePatches p = make_volume_patches(mesh);
    REQUIRE(p.patch_of_tet.size() == mesh.tets.size());
    REQUIRE(p.tets.size() == mesh.tets.size());
    CHECK(std::set<int>(p.tets.begin(), p.tets.end()).size() == mesh.tets.size());
    // About seven each: at least four where a patch has neighbours.
    CHECK(static_cast<double>(mesh.tets.size()) / static_cast<double>(p.count()) > 6);
    CHECK(static_cast<double>(mesh.tets.size()) / static_cast<double>(p.count()) < 9);
    for (std::size_t k = 0; k < p.count(); ++k) {
        const std::vector<int> tets = members(p, k);
        INFO("patch " << k);
        CHECK(tets.size() >= 4);
        CHECK(std::is_sorted(tets.begin(), tets.end()));
        CHECK(hangs_together(mesh, tets));
        std::set<int> vertices;
        for (const int t : tets) {
            CHECK(p.patch_of_tet[std::size_t(t)] == static_cast<int>(k));
            vertices.insert(mesh.tets[std::size_t(t)].begin(), mesh.tets[std::size_t(t)].end());
        }
        const auto from = p.vertex.begin() + p.member_start[k], to = p.vertex.begin() + p.member_start[k + 1];
        CHECK(std::equal(from, to, vertices.begin(), vertices.end()));
        // Each member lists just the corners of the patch's tets that lie there.
        std::size_t corners = 0;
        for (int m = p.member_start[k]; m < p.member_start[k + 1]; ++m)
            for (int c = p.corner_start[std::size_t(m)]; c < p.corner_start[std::size_t(m) + 1]; ++c, ++corners) {
                const int tet = p.corners[std::size_t(c)] / 4, corner = p.corners[std::size_t(c)] % 4;
                CHECK(p.patch_of_tet[std::size_t(tet)] == static_cast<int>(k));
                CHECK(mesh.tets[std::size_t(tet)][std::size_t(corner)] == p.vertex[std::size_t(m)]);
            }
        CHECK(corners == 4 * tets.size());
    }
}
