// Whatever the bytes, a reader gives a usable mesh or an Error. Run under the address sanitizer this also
// proves that it reads and writes nothing beyond its arrays.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/error.h"
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/primitives.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>

using namespace sinew::solver;

namespace {

struct Sample {
    std::string file, bytes;
    bool is_tets;
};

std::string medit_sample() {
    return "MeshVersionFormatted 2\nDimension 3\nVertices 5\n0 0 0 1\n1 0 0 1\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
           "Triangles 1\n1 2 3 0\nTetrahedra 2\n1 2 3 4 0\n2 3 4 5 0\nEnd\n";
}

std::string vtk_sample(bool offsets) {
    const std::string head = "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                             "POINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n";
    return head +
           (offsets ? "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3\n1 2 3 4\n"
                    : "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\n") +
           "CELL_TYPES 2\n10\n10\n";
}

std::string msh_sample(const std::string& version) {
    if (version == "1")
        return "$NOD\n5\n7 0 0 0\n8 1 0 0\n9 0 1 0\n10 0 0 1\n11 1 1 1\n$ENDNOD\n$ELM\n3\n1 2 0 0 3 7 8 9\n"
               "2 4 0 0 4 7 8 9 10\n3 4 0 0 4 8 9 10 11\n$ENDELM\n";
    const std::string head = "$MeshFormat\n" + version + " 0 8\n$EndMeshFormat\n$Comments\nx\n$EndComments\n";
    if (version == "2.2")
        return head + "$Nodes\n5\n7 0 0 0\n8 1 0 0\n9 0 1 0\n10 0 0 1\n11 1 1 1\n$EndNodes\n$Elements\n3\n"
                      "1 2 2 0 0 7 8 9\n2 4 1 0 7 8 9 10\n3 4 0 8 9 10 11\n$EndElements\n";
    return head + "$Nodes\n2 5 7 11\n2 1 1 2\n7\n8\n0 0 0 0.5 0.5\n1 0 0 0.25 0.5\n3 1 0 3\n9\n10\n11\n0 1 "
                  "0\n0 0 1\n"
                  "1 1 1\n$EndNodes\n$Elements\n2 3 1 3\n2 1 2 1\n1 7 8 9\n3 1 4 2\n2 7 8 9 10\n3 8 9 10 "
                  "11\n$EndElements\n";
}

template <class Number>
void raw(std::string& out, Number value, bool big) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (big) std::reverse(bytes, bytes + sizeof value);
    out.append(bytes, sizeof value);
}

/// The same mesh in bytes.
std::string binary_msh_sample(const std::string& version, bool big) {
    std::string out = "$MeshFormat\n" + version + " 1 8\n";
    const auto i32 = [&](int v) { raw(out, v, big); };
    const auto u64 = [&](std::uint64_t v) { raw(out, v, big); };
    const auto point = [&](double x, double y, double z) {
        for (const double v : {x, y, z}) raw(out, v, big);
    };
    const bool blocks = version == "4.1";
    i32(1);
    out += "\n$EndMeshFormat\n$Nodes\n";
    const std::array<std::array<double, 3>, 5> points{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}};
    if (blocks) {
        for (const std::uint64_t n : {1, 5, 7, 11}) u64(n);
        i32(3), i32(1), i32(0), u64(5);
        for (std::uint64_t n = 7; n < 12; ++n) u64(n);
        for (const auto& p : points) point(p[0], p[1], p[2]);
    } else {
        out += "5\n";
        for (int n = 0; n < 5; ++n) {
            const auto& p = points[static_cast<std::size_t>(n)];
            i32(7 + n), point(p[0], p[1], p[2]);
        }
    }
    out += "\n$EndNodes\n$Elements\n";
    if (blocks) {
        for (const std::uint64_t n : {2, 3, 1, 3}) u64(n);
        i32(2), i32(1), i32(2), u64(1);
        for (const std::uint64_t n : {1, 7, 8, 9}) u64(n);
        i32(3), i32(1), i32(4), u64(2);
        for (const std::uint64_t n : {2, 7, 8, 9, 10, 3, 8, 9, 10, 11}) u64(n);
    } else {
        out += "3\n";
        for (const int n : {2, 1, 1, 1, 0, 7, 8, 9, 4, 2, 0, 2, 7, 8, 9, 10, 3, 8, 9, 10, 11}) i32(n);
    }
    return out + "\n$EndElements\n";
}

std::string veg_sample() {
    return "# c\n*VERTICES\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n*ELEMENTS\nTET\n2 4 0\n1 1 "
           "2 3 4\n"
           "2 2 3 4 5\n*MATERIAL a\nENU, 1, 2, 0.3\n*REGION\nallElements, a\n";
}

std::vector<Sample> samples() {
    const SurfaceMesh mesh = make_cylinder(1, 2, 6, 1, 0);
    std::string big = write_ply(mesh);
    big.replace(big.find("little"), 6, "big"); // same bytes in the wrong order: numbers at random
    const std::string ascii_ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty list uchar float q\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0 1 5\n1 0 0 0\n0 1 0 0\n3 0 1 2\n";
    std::string strips = ascii_ply;
    strips.replace(strips.find("face"), 4, "tristrips");
    strips.replace(strips.find("3 0 1 2"), 7, "6 0 1 2 -1 2 1");
    std::string ascii_stl = "solid a\n";
    for (int i = 0; i < 2; ++i)
        ascii_stl += "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 " + std::to_string(i) +
                     "\nendloop\nendfacet\n";
    ascii_stl += "endsolid a\n";
    return {{"a.obj", "# x\n" + write_obj(mesh) + "f -1 -2/1/2 -3//4 \\\n -4\n", false},
            {"a.off", write_off(mesh), false},
            {"a.ply", write_ply(mesh), false},
            {"a.ply", big, false},
            {"a.ply", ascii_ply, false},
            {"a.ply", strips, false},
            {"a.stl", write_stl(mesh), false},
            {"a.stl", ascii_stl, false},
            {"a.mesh", medit_sample(), true},
            {"a.vtk", vtk_sample(false), true},
            {"a.vtk", vtk_sample(true), true},
            {"a.msh", msh_sample("1"), true},
            {"a.msh", msh_sample("2.2"), true},
            {"a.msh", msh_sample("4.1"), true},
            {"a.msh", binary_msh_sample("2.2", false), true},
            {"a.msh", binary_msh_sample("2.2", true), true},
            {"a.msh", binary_msh_sample("4.1", false), true},
            {"a.msh", binary_msh_sample("4.1", true), true},
            {"a.veg", veg_sample(), true}};
}

/// 1 if a mesh came out; checks that it is usable.
int try_read(const Sample& sample, const std::string& bytes) {
    try {
        if (sample.is_tets) {
            TetMesh mesh = parse_tets(bytes, sample.file);
            check_and_orient(mesh);
        } else {
            const SurfaceMesh mesh = parse_surface(bytes, sample.file);
            check_usable(mesh);
            if (mesh.triangles.size() > 10000) throw std::logic_error("more than the file can hold");
        }
        return 1;
    } catch (const Error& e) {
        if (e.code.size() != 5 || std::string(e.what()).empty())
            throw std::logic_error("an Error without code or text");
        return 0;
    }
}

} // namespace

TEST_CASE("a file cut at any byte is refused or read, never a crash", "[mesh][files][fuzz]") {
    for (const Sample& sample : samples()) {
        INFO(sample.file);
        REQUIRE(try_read(sample, sample.bytes) == (sample.bytes.find("binary_big") == std::string::npos ? 1 : 0));
        int readable = 0;
        for (std::size_t size = 0; size < sample.bytes.size(); ++size)
            readable += try_read(sample, sample.bytes.substr(0, size));
        REQUIRE(readable < static_cast<int>(sample.bytes.size()));
    }
}

TEST_CASE("the samples of Gmsh and VegaFEM files hold the same two tets", "[mesh][files][fuzz]") {
    int found = 0;
    for (const Sample& sample : samples()) {
        if (sample.file != "a.msh" && sample.file != "a.veg") continue;
        INFO(sample.bytes);
        const TetMesh mesh = parse_tets(sample.bytes, sample.file);
        REQUIRE(mesh.vertices == Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
        REQUIRE(mesh.tets == std::vector<Tet>{{0, 1, 2, 3}, {1, 2, 3, 4}});
        ++found;
    }
    REQUIRE(found == 8);
}

TEST_CASE("a file without any one of its lines is refused or read, never a crash", "[mesh][files][fuzz]") {
    for (const Sample& sample : samples()) {
        INFO(sample.file);
        for (std::size_t first = 0; first < sample.bytes.size();) {
            const std::size_t end = std::min(sample.bytes.find('\n', first), sample.bytes.size() - 1) + 1;
            std::string without = sample.bytes, twice = sample.bytes;
            without.erase(first, end - first);
            twice.insert(first, sample.bytes.substr(first, end - first));
            try_read(sample, without);
            try_read(sample, twice);
            first = end;
        }
        SUCCEED();
    }
}

TEST_CASE("files with random bytes changed are refused or read, never a crash", "[mesh][files][fuzz]") {
    std::mt19937 random(20240607);
    const std::string likely = "0123456789-+.e \n/\\nainf,\t\r#";
    for (const Sample& sample : samples()) {
        INFO(sample.file);
        for (int trial = 0; trial < 1500; ++trial) {
            std::string bytes = sample.bytes;
            const int changes = 1 + static_cast<int>(random() % 4);
            for (int c = 0; c < changes; ++c) {
                const std::size_t at = random() % bytes.size();
                const char byte = trial % 2 ? likely[random() % likely.size()] : static_cast<char>(random() & 255);
                switch (random() % 3) {
                case 0:
                    bytes[at] = byte;
                    break;
                case 1:
                    bytes.insert(at, 1, byte);
                    break;
                default:
                    bytes.erase(at, 1 + random() % 3);
                }
                if (bytes.empty()) break;
            }
            try_read(sample, bytes);
        }
        SUCCEED();
    }
}

TEST_CASE("random junk is refused by every reader", "[mesh][files][fuzz]") {
    std::mt19937 random(99);
    for (const Sample& sample : samples())
        for (int trial = 0; trial < 200; ++trial) {
            std::string bytes(random() % 2000, ' ');
            for (char& c : bytes) c = static_cast<char>(random() & 255);
            if (sample.file == "a.stl" && bytes.size() >= 84) bytes[83] = '\x7f'; // two billion triangles
            REQUIRE(try_read(sample, bytes) == 0);
        }
}

TEST_CASE("counts beyond the file are refused before memory is asked for", "[mesh][files][fuzz]") {
    const std::string many = "1000000000";
    const Sample surface{"", "", false}, tets{"", "", true};
    const auto refused = [&](const Sample& kind, const std::string& file, const std::string& bytes) {
        Sample s = kind;
        s.file = file;
        return try_read(s, bytes) == 0;
    };
    REQUIRE(refused(surface, "a.off", "OFF\n" + many + " " + many + " 0\n"));
    REQUIRE(refused(surface, "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n" + many + " 0 1 2\n"));
    REQUIRE(refused(surface, "a.ply",
                    "ply\nformat binary_little_endian 1.0\nelement vertex " + many +
                        "\nproperty double x\nproperty double y\nproperty double z\nend_header\n"));
    REQUIRE(refused(surface, "a.ply", "ply\nformat ascii 1.0\nelement junk " + many + "\nend_header\n"));
    const std::string head = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    REQUIRE(refused(tets, "a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + many + "\n"));
    REQUIRE(refused(tets, "a.msh", head + "$Nodes\n" + many + " 1 1 1\n"));
    REQUIRE(refused(tets, "a.msh", head + "$Nodes\n1 1 1 1\n3 1 0 " + many + "\n"));
    REQUIRE(refused(tets, "a.msh", head + "$Elements\n1 1 1 1\n3 1 4 " + many + "\n"));
    REQUIRE(refused(tets, "a.veg", "*VERTICES\n" + many + " 3 0 0\n"));
    REQUIRE(refused(tets, "a.mesh", "MeshVersionFormatted 1\nTetrahedra " + many + "\n"));
    REQUIRE(refused(tets, "a.vtk",
                    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nCELLS " + many + " 5\n"));
}
