// Writers. Text numbers are the shortest that read back to the same bits.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/index.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/text_output.h"

#include <bit>
#include <cstdint>
#include <cstring>

namespace sinew::solver {
namespace {

static_assert(std::endian::native == std::endian::little, "binary files are written without swapping bytes");

template <class Number>
void put_bytes(std::string& out, Number value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    out.append(raw, sizeof value);
}

} // namespace

std::string write_obj(const SurfaceMesh& mesh) {
    std::string out;
    out.reserve(64 * mesh.points.size() + 8 * mesh.face_vertices.size());
    for (const Vec3& p : mesh.points) out += "v ", put(out, p), out += '\n';
    std::size_t k = 0;
    for (int size : mesh.face_sizes) {
        out += 'f';
        for (int c = 0; c < size; ++c) out += ' ', put(out, mesh.face_vertices[k++] + 1);
        out += '\n';
    }
    return out;
}

std::string write_off(const SurfaceMesh& mesh) {
    std::string out = "OFF\n";
    put(out, mesh.points.size()), out += ' ', put(out, mesh.face_sizes.size()), out += " 0\n";
    for (const Vec3& p : mesh.points) put(out, p), out += '\n';
    std::size_t k = 0;
    for (int size : mesh.face_sizes) {
        put(out, size);
        for (int c = 0; c < size; ++c) out += ' ', put(out, mesh.face_vertices[k++]);
        out += '\n';
    }
    return out;
}

std::string write_ply(const SurfaceMesh& mesh) {
    bool small = true;
    for (int size : mesh.face_sizes) small = small && size < 256;
    std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    put(out, mesh.points.size());
    out += "\nproperty double x\nproperty double y\nproperty double z\nelement face ";
    put(out, mesh.face_sizes.size());
    out += small ? "\nproperty list uchar int vertex_indices\nend_header\n"
                 : "\nproperty list int int vertex_indices\nend_header\n";
    for (const Vec3& p : mesh.points)
        for (int d = 0; d < 3; ++d) put_bytes(out, p[d]);
    std::size_t k = 0;
    for (int size : mesh.face_sizes) {
        if (small)
            put_bytes(out, static_cast<std::uint8_t>(size));
        else
            put_bytes(out, static_cast<std::int32_t>(size));
        for (int c = 0; c < size; ++c) put_bytes(out, static_cast<std::int32_t>(mesh.face_vertices[k++]));
    }
    return out;
}

std::string write_stl(const SurfaceMesh& mesh) {
    // Not "solid": that would look like the ascii kind.
    std::string out = "binary STL written by sinew";
    out.resize(80, ' ');
    put_bytes(out, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.points[at(t[0])], &b = mesh.points[at(t[1])], &c = mesh.points[at(t[2])];
        const Vec3 area = (b - a).cross(c - a);
        const double length = area.norm();
        const Vec3 normal = length > 0 ? Vec3(area / length) : Vec3::Zero();
        for (const Vec3& v : {normal, a, b, c})
            for (int d = 0; d < 3; ++d) put_bytes(out, static_cast<float>(v[d]));
        put_bytes(out, std::uint16_t{0});
    }
    return out;
}

} // namespace sinew::solver
