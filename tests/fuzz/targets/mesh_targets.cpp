// Meshes, tets and point caches from files.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/read_glb.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/point_cache.h"
#include "tests/fuzz/targets/refused.h"
#include "tests/fuzz/targets/targets.h"

namespace sinew::fuzz {

namespace {

void check(const solver::SurfaceMesh& mesh) {
    solver::check_usable(mesh);
    std::size_t corners = 0, triangles = 0;
    for (const int size : mesh.face_sizes) {
        promise(size >= 3, "a face of less than three corners");
        corners += static_cast<std::size_t>(size), triangles += static_cast<std::size_t>(size) - 2;
    }
    promise(corners == mesh.face_vertices.size(), "corners that no face has");
    promise(triangles == mesh.triangles.size(), "triangles that no face has");
    for (const int v : mesh.face_vertices)
        promise(v >= 0 && static_cast<std::size_t>(v) < mesh.points.size(), "a corner beyond the vertices");
}

void check(solver::TetMesh mesh) {
    const std::size_t tets = mesh.tets.size();
    solver::check_and_orient(mesh);
    promise(mesh.coverage.empty() || mesh.coverage.size() == tets, "another number of coverages than tets");
    for (const double share : mesh.coverage) promise(share > 0 && share <= 1, "a coverage that is none");
}

} // namespace

void read_surface_as(std::string_view bytes, const std::string& file) {
    refused_or_read([&] { check(solver::parse_surface(bytes, file)); });
}

void read_tets_as(std::string_view bytes, const std::string& file) {
    refused_or_read([&] { check(solver::parse_tets(bytes, file)); });
}

void read_tetgen_files(std::string_view bytes) {
    const auto files = files_in(bytes);
    refused_or_read(
        [&] { check(solver::parse_tetgen(files[0], "a.node", files.size() > 1 ? files[1] : "", "a.ele")); });
}

void read_glb_file(std::string_view bytes) {
    refused_or_read([&] { check(nodes::read_glb(bytes, "a.glb")); });
}

void read_point_cache_as(std::string_view bytes, const std::string& file) {
    refused_or_read([&] {
        const auto cache = solver::PointCache::parse(std::string(bytes), file);
        promise(cache.points > 0 && cache.samples > 0, "a point cache of nothing");
        promise(12 * cache.points * cache.samples <= bytes.size(), "a point cache of more than its bytes");
        for (std::size_t k = 0; k < cache.samples; ++k) {
            promise(cache.at(k).size() == cache.points, "another number of points than the cache has");
            cache.frame_of(k, 24);
        }
    });
}

} // namespace sinew::fuzz
