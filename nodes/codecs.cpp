// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/codecs.h"

#include "nodes/contacts.h"
#include "nodes/marks.h"
#include "nodes/values.h"
#include "solver/error.h"
#include "solver/mesh/coordinates.h"

#include <algorithm>
#include <cstring>

namespace sinew::nodes {

using engine::BadBytes;
using engine::ByteReader;
using engine::ByteWriter;

namespace {

void put_points(ByteWriter& out, const solver::Points& points) {
    static_assert(sizeof(solver::Vec3) == 3 * sizeof(double));
    out.put_list(std::span<const double>(points.empty() ? nullptr : points.front().data(), 3 * points.size()));
}

solver::Points points_of(std::span<const std::byte> bytes) {
    if (bytes.size() % sizeof(solver::Vec3) != 0) throw BadBytes("its points are not whole");
    solver::Points out(bytes.size() / sizeof(solver::Vec3));
    if (!out.empty()) std::memcpy(static_cast<void*>(out.data()), bytes.data(), bytes.size());
    return out;
}
solver::Points get_points(ByteReader& in) { return points_of(in.get_bytes_of_list<double>()); }

/// Whoever reads a mesh goes by its numbers without looking, so they are looked at here.
Mesh checked(solver::SurfaceMesh mesh) {
    const auto is_vertex = [&](int v) { return v >= 0 && static_cast<std::size_t>(v) < mesh.points.size(); };
    std::size_t corners = 0, triangles = 0;
    for (const int size : mesh.face_sizes) {
        if (size < 3) throw BadBytes("it has a face of less than three corners");
        corners += static_cast<std::size_t>(size), triangles += static_cast<std::size_t>(size) - 2;
    }
    if (corners != mesh.face_vertices.size() || triangles != mesh.triangles.size())
        throw BadBytes("its faces are not whole");
    bool fits = std::all_of(mesh.face_vertices.begin(), mesh.face_vertices.end(), is_vertex);
    for (const solver::Triangle& t : mesh.triangles) fits = fits && std::all_of(t.begin(), t.end(), is_vertex);
    if (!fits) throw BadBytes("a face of it uses a vertex that it does not have");
    return Mesh::from(std::move(mesh));
}

void check(const solver::TetMesh& mesh) {
    const auto is_one_of = [](std::size_t count) {
        return [count](int i) { return i >= 0 && static_cast<std::size_t>(i) < count; };
    };
    for (const solver::Tet& t : mesh.tets)
        if (!std::all_of(t.begin(), t.end(), is_one_of(mesh.vertices.size())))
            throw BadBytes("a tet of it uses a vertex that it does not have");
    if (!mesh.coverage.empty() && mesh.coverage.size() != mesh.tets.size())
        throw BadBytes("its coverage is not that of its tets");
    if (!std::all_of(mesh.cut.tets.begin(), mesh.cut.tets.end(), is_one_of(mesh.tets.size())))
        throw BadBytes("it has moments of a tet that it does not have");
}

/// What a value cannot be made of is no fault of the graph's.
template <class T, T (*read)(ByteReader&)>
T read_as_bytes(ByteReader& in) {
    try {
        return read(in);
    } catch (const solver::Error& e) {
        throw BadBytes(e.what());
    }
}
template <class T, T (*read)(ByteReader&, const T*)>
T read_as_bytes(ByteReader& in, const T* like) {
    try {
        return read(in, like);
    } catch (const solver::Error& e) {
        throw BadBytes(e.what());
    }
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
    return checked(std::move(mesh));
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
    check(mesh);
    return TetMeshValue::from(std::move(mesh))
        .with_element(quadratic ? solver::ElementKind::quadratic : solver::ElementKind::linear);
}

void write_mesh_list(const MeshList& list, ByteWriter& out) {
    out.put<std::uint64_t>(list.meshes.size());
    // All connectivity before all points: it stays the same from frame to frame, where it stands too.
    for (const Mesh& mesh : list.meshes) {
        out.put_list(mesh.topology->face_sizes);
        out.put_list(mesh.topology->face_vertices);
        out.put_list(mesh.topology->triangles);
    }
    for (const Mesh& mesh : list.meshes) put_points(out, *mesh.points);
}

bool same_bytes(std::span<const std::byte> a, std::span<const std::byte> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size()) == 0);
}
template <class T>
bool is_next(ByteReader& in, const std::vector<T>& list) {
    return same_bytes(in.get_bytes_of_list<T>(), std::as_bytes(std::span(list)));
}

/// Whether the next mesh has the faces of `like`; then they are behind `in`, else it stays.
bool has_faces_of(ByteReader& in, const MeshTopology& like) {
    ByteReader ahead = in;
    if (!is_next(ahead, like.face_sizes) || !is_next(ahead, like.face_vertices) || !is_next(ahead, like.triangles))
        return false;
    in = ahead;
    return true;
}

/// From frame to frame most is as it was: it is shared, and neither looked at nor summed again.
MeshList read_mesh_list(ByteReader& in, const MeshList* like) {
    std::vector<solver::SurfaceMesh> meshes;
    std::vector<const Mesh*> shared;
    const auto count = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        solver::SurfaceMesh& mesh = meshes.emplace_back();
        const Mesh* other = like && i < like->meshes.size() ? &like->meshes[i] : nullptr;
        shared.push_back(other && has_faces_of(in, *other->topology) ? other : nullptr);
        if (shared.back()) continue;
        mesh.face_sizes = in.get_list<int>();
        mesh.face_vertices = in.get_list<int>();
        mesh.triangles = in.get_list<solver::Triangle>();
    }
    MeshList out;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const std::span<const std::byte> points = in.get_bytes_of_list<double>();
        if (!shared[i]) {
            meshes[i].points = points_of(points);
            out.meshes.push_back(checked(std::move(meshes[i])));
        } else if (same_bytes(points, std::as_bytes(std::span(*shared[i]->points)))) {
            out.meshes.push_back(*shared[i]);
        } else {
            solver::Points moved = points_of(points);
            if (moved.size() != shared[i]->points->size()) throw BadBytes("its faces are those of other points");
            solver::check_coordinates(moved);
            out.meshes.push_back(shared[i]->with_points(std::move(moved)));
        }
    }
    return out;
}

void put_vector(ByteWriter& out, const solver::Vec3& v) {
    for (int c = 0; c < 3; ++c) out.put(v[c]);
}
solver::Vec3 get_vector(ByteReader& in) {
    solver::Vec3 v;
    for (int c = 0; c < 3; ++c) v[c] = in.get<double>();
    return v;
}

/// Everything but seconds, which are those of the run that made it.
template <class Report, class Visit>
void visit_report(Report& r, const Visit& visit) {
    visit(r.record.residual), visit(r.record.converged), visit(r.record.newton_iterations), visit(r.record.substeps);
    visit(r.record.halvings), visit(r.record.linear_iterations), visit(r.record.factorizations);
    visit(r.record.energy), visit(r.record.min_j), visit(r.record.inverted);
    visit(r.bodies), visit(r.tets), visit(r.triangles), visit(r.dofs), visit(r.attachments);
    visit(r.worst.body), visit(r.worst.tet), visit(r.worst.j), visit(r.worst.tet_place);
    visit(r.worst.attachment), visit(r.worst.source_body), visit(r.worst.vertex), visit(r.worst.stretch);
    visit(r.worst.stretch_place), visit(r.worst.residual_body), visit(r.worst.contact_body);
    visit(r.worst.contact_target), visit(r.worst.depth), visit(r.worst.contact_place);
    visit(r.worst.deep_body), visit(r.worst.deep_target), visit(r.worst.deep);
    visit(r.worst.deep_share), visit(r.worst.deep_place);
}

void write_report(const SolveReport& r, ByteWriter& out) {
    visit_report(r, [&](const auto& field) { out.put(field); });
    out.put<std::uint64_t>(r.terms.size());
    for (const std::string& term : r.terms) out.put_text(term);
    out.put<std::uint64_t>(r.record.measured.size());
    for (const solver::Measured& m : r.record.measured) {
        out.put_text(m.what->term), out.put_text(m.what->name);
        out.put(m.value), out.put(m.part);
    }
    out.put<std::uint64_t>(r.lines.size());
    for (const LineReport& l : r.lines) {
        out.put(l.body), out.put(l.fiber), out.put(l.line);
        out.put(l.excitation), out.put(l.growth);
    }
}

SolveReport read_report(ByteReader& in) {
    SolveReport r;
    visit_report(r, [&]<class T>(T& field) { field = in.get<T>(); });
    const auto terms = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < terms; ++i) r.terms.push_back(in.get_text());
    const auto measured = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < measured; ++i) {
        solver::Measured m;
        const std::string term = in.get_text(), name = in.get_text();
        m.what = solver::find_measure(term, name);
        if (!m.what) throw BadBytes("it holds \"" + term + "." + name + "\", which is not known here");
        m.value = in.get<double>(), m.part = in.get<int>();
        r.record.measured.push_back(m);
    }
    const auto lines = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < lines; ++i) {
        LineReport& l = r.lines.emplace_back();
        l.body = in.get<int>(), l.fiber = in.get<int>(), l.line = in.get<solver::LineMemory>();
        l.excitation = in.get<double>(), l.growth = in.get<double>();
    }
    return r;
}

void write_contacts(const ContactList& list, ByteWriter& out) {
    out.put<std::uint64_t>(list.contacts.size());
    for (const solver::ContactPoint& c : list.contacts) {
        out.put(c.source), out.put(c.target), out.put(c.point), out.put(c.slides);
        put_vector(out, c.place), put_vector(out, c.normal);
        out.put(c.depth);
        put_vector(out, c.force);
    }
}

ContactList read_contacts(ByteReader& in) {
    ContactList out;
    const auto count = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        solver::ContactPoint c;
        c.source = in.get<int>(), c.target = in.get<int>(), c.point = in.get<int>(), c.slides = in.get<bool>();
        c.place = get_vector(in), c.normal = get_vector(in);
        c.depth = in.get<double>();
        c.force = get_vector(in);
        out.contacts.push_back(c);
    }
    return out;
}

void write_marks(const MarkList& list, ByteWriter& out) {
    out.put<std::uint64_t>(list.groups.size());
    for (const solver::MarkGroup& group : list.groups) {
        out.put_text(group.term), out.put_text(group.what), out.put_text(group.unit);
        out.put<std::uint64_t>(group.marks.size());
        for (const solver::Mark& m : group.marks) {
            out.put(m.part), put_vector(out, m.from), put_vector(out, m.to);
            out.put(m.value), out.put(m.bodies);
        }
    }
}

MarkList read_marks(ByteReader& in) {
    MarkList out;
    const auto groups = in.get<std::uint64_t>();
    for (std::uint64_t g = 0; g < groups; ++g) {
        solver::MarkGroup& group = out.groups.emplace_back();
        group.term = in.get_text(), group.what = in.get_text(), group.unit = in.get_text();
        const auto count = in.get<std::uint64_t>();
        for (std::uint64_t i = 0; i < count; ++i) {
            solver::Mark m;
            m.part = in.get<int>(), m.from = get_vector(in), m.to = get_vector(in);
            m.value = in.get<double>(), m.bodies = in.get<std::array<int, 2>>();
            group.marks.push_back(m);
        }
    }
    return out;
}

void write_numbers(const engine::NumberList& list, ByteWriter& out) {
    out.put_list(std::span<const double>(list.data(), list.size()));
}
engine::NumberList read_numbers(ByteReader& in) {
    const std::vector<double> list = in.get_list<double>();
    return {list.begin(), list.end()};
}

} // namespace

void add_codecs(engine::Registry& registry) {
    registry.add(engine::make_codec<Mesh>(1, write_mesh, read_as_bytes<Mesh, read_mesh>));
    registry.add(engine::make_codec<TetMeshValue>(2, write_tets, read_as_bytes<TetMeshValue, read_tets>));
    registry.add(engine::make_codec<MeshList>(1, write_mesh_list, read_as_bytes<MeshList, read_mesh_list>));
    registry.add(engine::make_codec<SolveReport>(1, write_report, read_as_bytes<SolveReport, read_report>));
    registry.add(engine::make_codec<ContactList>(1, write_contacts, read_as_bytes<ContactList, read_contacts>));
    registry.add(engine::make_codec<MarkList>(1, write_marks, read_as_bytes<MarkList, read_marks>));
    registry.add(
        engine::make_codec<engine::NumberList>(1, write_numbers, read_as_bytes<engine::NumberList, read_numbers>));
}

} // namespace sinew::nodes
