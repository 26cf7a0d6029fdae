// Kept meshes and tets whose numbers do not fit are bytes of nothing, not values that others trip over.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "nodes/codecs.h"

#include <limits>

using namespace bench;

namespace {

const engine::Codec& codec_of(std::type_index type) {
    static const auto types = nodes::make_registry();
    return *types->find_codec(type);
}

void put_points(engine::ByteWriter& out, const std::vector<double>& numbers) { out.put_list(numbers); }

const std::vector<double> corners{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

/// What the codec says of a mesh of these numbers; "" if it takes them.
std::string mesh(const std::vector<double>& points, const std::vector<int>& sizes, const std::vector<int>& vertices,
                 const std::vector<solver::Triangle>& triangles) {
    engine::ByteWriter out;
    put_points(out, points);
    out.put_list(sizes), out.put_list(vertices), out.put_list(triangles);
    engine::ByteReader in(out.bytes);
    try {
        codec_of(typeid(nodes::Mesh)).read(in, nullptr);
        return "";
    } catch (const engine::BadBytes& bad) {
        return bad.what();
    }
}

std::string tets(const std::vector<solver::Tet>& all, const std::vector<double>& coverage,
                 const std::vector<int>& cut) {
    engine::ByteWriter out;
    put_points(out, corners);
    out.put_list(all), out.put_list(coverage);
    out.put<std::uint8_t>(1);
    out.put_list(cut), out.put_list(std::vector<double>(solver::moment_count(1) * cut.size(), 0.1));
    out.put<std::uint8_t>(0);
    engine::ByteReader in(out.bytes);
    try {
        codec_of(typeid(nodes::TetMeshValue)).read(in, nullptr);
        return "";
    } catch (const engine::BadBytes& bad) {
        return bad.what();
    }
}

} // namespace

TEST_CASE("kept meshes whose faces do not fit are not read", "[nodes]") {
    CHECK(mesh(corners, {3}, {0, 1, 2}, {{0, 1, 2}}) == "");
    CHECK(mesh(corners, {4}, {0, 1, 2, 3}, {{0, 1, 2}, {0, 2, 3}}) == "");
    const std::string beyond = "a face of it uses a vertex that it does not have";
    CHECK(mesh(corners, {3}, {0, 1, 4}, {{0, 1, 2}}) == beyond);
    CHECK(mesh(corners, {3}, {0, 1, 2}, {{0, 1, -1}}) == beyond);
    CHECK(mesh(corners, {3}, {0, 1, 2, 3}, {{0, 1, 2}}) == "its faces are not whole");
    CHECK(mesh(corners, {3}, {0, 1, 2}, {}) == "its faces are not whole");
    CHECK(mesh(corners, {3, 2}, {0, 1, 2, 0, 1}, {{0, 1, 2}}) == "it has a face of less than three corners");
    CHECK(mesh({0, 0, 0, 1}, {}, {}, {}) == "its points are not whole");
    auto nowhere = corners;
    nowhere[4] = std::numeric_limits<double>::quiet_NaN();
    CHECK(mesh(nowhere, {3}, {0, 1, 2}, {{0, 1, 2}}).find("vertex 1") != std::string::npos);
}

TEST_CASE("kept bodies share with those of another frame what is as it was there", "[nodes]") {
    solver::SurfaceMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {3}, {0, 1, 2}, {{0, 1, 2}}};
    solver::SurfaceMesh turned = triangle;
    turned.face_vertices = {0, 2, 1}, turned.triangles = {{0, 2, 1}};
    nodes::MeshList before;
    before.meshes = {nodes::Mesh::from(triangle), nodes::Mesh::from(triangle), nodes::Mesh::from(triangle)};
    nodes::MeshList after = before;
    after.meshes[1] = before.meshes[1].with_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 1}});
    after.meshes[2] = nodes::Mesh::from(turned);
    after.meshes.push_back(nodes::Mesh::from(triangle));
    const engine::Codec& codec = codec_of(typeid(nodes::MeshList));
    const auto like = engine::Value::of(before), given = engine::Value::of(after);
    engine::ByteWriter out;
    codec.write(given, out);
    engine::ByteReader in(out.bytes);
    const engine::Value value = codec.read(in, &like);
    CHECK(in.rest.empty());
    CHECK(value.digest() == given.digest());
    const auto& meshes = value.as<nodes::MeshList>().meshes;
    REQUIRE(meshes.size() == 4);
    const auto shares = [&](std::size_t i) {
        return std::pair(meshes[i].topology == before.meshes[i].topology, meshes[i].points == before.meshes[i].points);
    };
    CHECK(shares(0) == std::pair(true, true));
    CHECK(shares(1) == std::pair(true, false));
    CHECK(shares(2) == std::pair(false, false));
    CHECK(*meshes[1].points == *after.meshes[1].points);
    CHECK(meshes[2].topology->triangles == turned.triangles);
    // Faces that are shared are not looked at again; that they fit the points is.
    const auto said = [&](const solver::Points& points) {
        nodes::MeshList wrong;
        wrong.meshes = {before.meshes[0]};
        wrong.meshes[0].points = std::make_shared<const solver::Points>(points);
        engine::ByteWriter bytes;
        codec.write(engine::Value::of(wrong), bytes);
        engine::ByteReader reader(bytes.bytes);
        try {
            codec.read(reader, &like);
            return std::string();
        } catch (const engine::BadBytes& bad) {
            return std::string(bad.what());
        }
    };
    CHECK(said({{0, 0, 0}, {1, 0, 0}}) == "its faces are those of other points");
    CHECK(said({{0, 0, 0}, {1, 0, 0}, {0, 1e200, 0}}).find("vertex 2") != std::string::npos);
}

TEST_CASE("kept tets whose numbers do not fit are not read", "[nodes]") {
    CHECK(tets({{0, 1, 2, 3}}, {}, {}) == "");
    CHECK(tets({{0, 1, 2, 3}}, {0.5}, {0}) == "");
    CHECK(tets({{0, 1, 2, 4}}, {}, {}) == "a tet of it uses a vertex that it does not have");
    CHECK(tets({{0, 1, 2, 3}}, {1, 1}, {}) == "its coverage is not that of its tets");
    CHECK(tets({{0, 1, 2, 3}}, {0.5}, {1}) == "it has moments of a tet that it does not have");
}
