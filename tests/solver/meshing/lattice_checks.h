// What must hold for any lattice, however it is refined.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/tet_mesh.h"
#include "solver/meshing/lattice.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

namespace lattice_checks {

using namespace sinew::solver;

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

inline std::array<Vec3, 4> corners_of(const TetMesh& mesh, std::size_t t) {
    const Tet& tet = mesh.tets[t];
    return {mesh.vertices[at(tet[0])], mesh.vertices[at(tet[1])], mesh.vertices[at(tet[2])], mesh.vertices[at(tet[3])]};
}

inline double volume_of(const TetMesh& mesh, std::size_t t) {
    const auto c = corners_of(mesh, t);
    return tet_volume(c[0], c[1], c[2], c[3]);
}

inline double covered_volume(const TetMesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) sum += mesh.coverage[t] * volume_of(mesh, t);
    return sum;
}

inline double longest_edge(const std::array<Vec3, 4>& c) {
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, (c[i] - c[j]).norm());
    return longest;
}

struct Angles {
    double least = 180, most = 0; ///< degrees
};

/// Widens `angles` by the six dihedral angles of a tet.
inline void add_dihedral_angles(const std::array<Vec3, 4>& c, Angles& angles) {
    constexpr std::size_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    Vec3 normals[4];
    for (std::size_t f = 0; f < 4; ++f)
        normals[f] = (c[faces[f][1]] - c[faces[f][0]]).cross(c[faces[f][2]] - c[faces[f][0]]).normalized();
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const double cosine = std::clamp(-normals[i].dot(normals[j]), -1.0, 1.0);
            const double angle = std::acos(cosine) * 180 / std::numbers::pi;
            angles.least = std::min(angles.least, angle);
            angles.most = std::max(angles.most, angle);
        }
}

inline Angles dihedral_angles(const TetMesh& mesh) {
    Angles angles;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) add_dihedral_angles(corners_of(mesh, t), angles);
    return angles;
}

struct ByPlace {
    bool operator()(const Vec3& a, const Vec3& b) const {
        return std::tuple(a.z(), a.y(), a.x()) < std::tuple(b.z(), b.y(), b.x());
    }
};

/// Positive volumes, every vertex used once, faces shared by two tets at most and from opposite sides, no
/// vertex in the middle of an edge, angles within their bound, coverage in (0, 1].
inline void require_sound(const TetMesh& mesh) {
    REQUIRE(mesh.coverage.size() == mesh.tets.size());
    std::vector<char> used(mesh.vertices.size(), 0);
    std::map<std::array<int, 3>, int> faces; // sum of orientations, and twice the count in steps of 16
    std::set<std::array<int, 2>> edges;
    double least_volume = 1e300, least_coverage = 2, most_coverage = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const Tet& tet = mesh.tets[t];
        least_volume = std::min(least_volume, volume_of(mesh, t) / std::pow(longest_edge(corners_of(mesh, t)), 3));
        least_coverage = std::min(least_coverage, mesh.coverage[t]);
        most_coverage = std::max(most_coverage, mesh.coverage[t]);
        constexpr std::size_t outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
        for (const auto& f : outward) {
            std::array<int, 3> key{tet[f[0]], tet[f[1]], tet[f[2]]};
            std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
            const int sign = key[1] < key[2] ? 1 : -1;
            std::sort(key.begin(), key.end());
            faces[key] += 16 + sign;
        }
        for (std::size_t i = 0; i < 4; ++i) {
            used[at(tet[i])] = 1;
            for (std::size_t j = 0; j < i; ++j) edges.insert({std::min(tet[i], tet[j]), std::max(tet[i], tet[j])});
        }
    }
    REQUIRE(least_volume > 0.01);
    REQUIRE(least_coverage > 0);
    REQUIRE(most_coverage <= 1);
    REQUIRE(std::count(used.begin(), used.end(), 0) == 0);
    // Alone (from either side), or two from opposite sides.
    REQUIRE(std::all_of(faces.begin(), faces.end(),
                        [](const auto& f) { return f.second == 15 || f.second == 17 || f.second == 32; }));
    const std::set<Vec3, ByPlace> places(mesh.vertices.begin(), mesh.vertices.end());
    REQUIRE(places.size() == mesh.vertices.size());
    // Midpoints are exact but for the rounding of the coordinates.
    const auto is_vertex_near = [&](const Vec3& p, double slack) {
        for (auto it = places.lower_bound(p - Vec3(0, 0, slack)); it != places.end() && it->z() <= p.z() + slack; ++it)
            if ((*it - p).norm() < slack) return true;
        return false;
    };
    int hanging = 0;
    for (const auto& e : edges) {
        const Vec3 &a = mesh.vertices[at(e[0])], &b = mesh.vertices[at(e[1])];
        const Vec3 middle = 0.5 * (a + b);
        hanging +=
            places.count(middle) > 0 || (mesh.vertices.size() < 3000 && is_vertex_near(middle, 1e-6 * (a - b).norm()));
    }
    REQUIRE(hanging == 0);
    const Angles angles = dihedral_angles(mesh);
    REQUIRE(angles.least > 29.9999);
    REQUIRE(angles.most < 116.5652);
}

/// That no tet lies beyond a face which only one tet has: slow, and the whole of what conforming means.
inline void require_no_hidden_border(const TetMesh& mesh) {
    std::vector<Mat3> inverses;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto c = corners_of(mesh, t);
        Mat3 edges;
        edges << c[1] - c[0], c[2] - c[0], c[3] - c[0];
        inverses.push_back(edges.inverse());
    }
    int hidden = 0;
    for (const Triangle& f : boundary_triangles(mesh.tets)) {
        const Vec3 &a = mesh.vertices[at(f[0])], &b = mesh.vertices[at(f[1])], &c = mesh.vertices[at(f[2])];
        const Vec3 normal = (b - a).cross(c - a);
        const Vec3 beyond = (0.4 * a + 0.35 * b + 0.25 * c) + 1e-4 / std::sqrt(normal.norm()) * normal;
        for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
            const Vec3 l = inverses[t] * (beyond - mesh.vertices[at(mesh.tets[t][0])]);
            hidden += l.minCoeff() > 0 && l.sum() < 1;
        }
    }
    REQUIRE(hidden == 0);
}

} // namespace lattice_checks
