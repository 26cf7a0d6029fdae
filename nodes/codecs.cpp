// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/codecs.h"

#include "nodes/values.h"

namespace sinew::nodes {

using engine::BadBytes;
using engine::ByteReader;
using engine::ByteWriter;

namespace {

void put_points(ByteWriter& out, const solver::Points& points) {
    static_assert(sizeof(solver::Vec3) == 3 * sizeof(double));
    out.put_list(std::span<const double>(points.empty() ? nullptr : points.front().data(), 3 * points.size()));
}

solver::Points get_points(ByteReader& in) {
    const std::vector<double> numbers = in.get_list<double>();
    if (numbers.size() % 3 != 0) throw BadBytes("its points are not whole");
    solver::Points out;
    out.reserve(numbers.size() / 3);
    for (std::size_t i = 0; i < numbers.size(); i += 3) out.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return out;
}

void write_mesh(const Mesh& mesh, ByteWriter& out) {
    put_points(out, *mesh.points);
    out.put_list(mesh.topology->face_sizes);
    out.put_list(mesh.topology->face_vertices);
    out.put_list(mesh.topology->triangles);
}

Mesh read_mesh(ByteReader& in) {
    solver::SurfaceMesh mesh;
    mesh.points = get_points(in);
    mesh.face_sizes = in.get_list<int>();
    mesh.face_vertices = in.get_list<int>();
    mesh.triangles = in.get_list<solver::Triangle>();
    return Mesh::from(std::move(mesh));
}

void write_tets(const TetMeshValue& tets, ByteWriter& out) {
    put_points(out, tets.mesh->vertices);
    out.put_list(tets.mesh->tets);
    out.put_list(tets.mesh->coverage);
    out.put<std::uint8_t>(static_cast<std::uint8_t>(tets.mesh->cut.degree));
    out.put_list(tets.mesh->cut.tets);
    out.put_list(tets.mesh->cut.moments);
    out.put<std::uint8_t>(tets.element == solver::ElementKind::quadratic);
}

TetMeshValue read_tets(ByteReader& in) {
    solver::TetMesh mesh;
    mesh.vertices = get_points(in);
    mesh.tets = in.get_list<solver::Tet>();
    mesh.coverage = in.get_list<double>();
    mesh.cut.degree = in.get<std::uint8_t>();
    if (mesh.cut.degree != 1 && mesh.cut.degree != 4) throw BadBytes("its moments are of no degree that there is");
    mesh.cut.tets = in.get_list<int>();
    mesh.cut.moments = in.get_list<double>();
    if (mesh.cut.moments.size() != solver::moment_count(mesh.cut.degree) * mesh.cut.tets.size())
        throw BadBytes("its moments are not whole");
    const bool quadratic = in.get<std::uint8_t>() != 0;
    return TetMeshValue::from(std::move(mesh))
        .with_element(quadratic ? solver::ElementKind::quadratic : solver::ElementKind::linear);
}

} // namespace

void add_codecs(engine::Registry& registry) {
    registry.add(engine::make_codec<Mesh>(1, write_mesh, read_mesh));
    registry.add(engine::make_codec<TetMeshValue>(2, write_tets, read_tets));
}

} // namespace sinew::nodes
