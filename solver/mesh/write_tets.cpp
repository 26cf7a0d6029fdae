// Writers of tet meshes.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/mesh_files.h"
#include "solver/mesh/text_output.h"

namespace sinew::solver {
namespace {

/// Lines "number a b c d", numbers from 1; with `number` false the corners alone.
void put_tets(std::string& out, const TetMesh& mesh, bool number, const char* tail) {
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const char* space = "";
        if (number) put(out, t + 1), space = " ";
        for (const int v : mesh.tets[t]) out += space, put(out, v + 1), space = " ";
        out += tail;
    }
}

void put_numbered_points(std::string& out, const TetMesh& mesh) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        put(out, v + 1), out += ' ', put(out, mesh.vertices[v]), out += '\n';
}

} // namespace

std::string write_vtk(const TetMesh& mesh) {
    std::string out = "# vtk DataFile Version 3.0\nsinew tet mesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS ";
    put(out, mesh.vertices.size()), out += " double\n";
    for (const Vec3& p : mesh.vertices) put(out, p), out += '\n';
    out += "CELLS ", put(out, mesh.tets.size()), out += ' ', put(out, 5 * mesh.tets.size()), out += '\n';
    for (const Tet& t : mesh.tets) {
        out += '4';
        for (int v : t) out += ' ', put(out, v);
        out += '\n';
    }
    out += "CELL_TYPES ", put(out, mesh.tets.size()), out += '\n';
    for (std::size_t i = 0; i < mesh.tets.size(); ++i) out += "10\n";
    if (mesh.coverage.size() == mesh.tets.size()) {
        out += "CELL_DATA ", put(out, mesh.tets.size()), out += "\nSCALARS coverage double 1\nLOOKUP_TABLE default\n";
        for (double c : mesh.coverage) put(out, c), out += '\n';
    }
    return out;
}

std::string write_medit(const TetMesh& mesh) {
    std::string out = "MeshVersionFormatted 2\nDimension 3\nVertices\n";
    put(out, mesh.vertices.size()), out += '\n';
    for (const Vec3& p : mesh.vertices) put(out, p), out += " 0\n";
    out += "Tetrahedra\n", put(out, mesh.tets.size()), out += '\n';
    put_tets(out, mesh, false, " 0\n");
    return out + "End\n";
}

std::string write_gmsh(const TetMesh& mesh) {
    // One volume that everything belongs to.
    const std::size_t nodes = mesh.vertices.size(), tets = mesh.tets.size();
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    if (nodes > 0) low = high = mesh.vertices.front();
    for (const Vec3& p : mesh.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
    std::string out = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 ";
    put(out, low), out += ' ', put(out, high), out += " 0 0\n$EndEntities\n$Nodes\n1 ";
    put(out, nodes), out += " 1 ", put(out, nodes), out += "\n3 1 0 ", put(out, nodes), out += '\n';
    for (std::size_t v = 0; v < nodes; ++v) put(out, v + 1), out += '\n';
    for (const Vec3& p : mesh.vertices) put(out, p), out += '\n';
    out += "$EndNodes\n$Elements\n1 ";
    put(out, tets), out += " 1 ", put(out, tets), out += "\n3 1 4 ", put(out, tets), out += '\n';
    put_tets(out, mesh, true, "\n");
    return out + "$EndElements\n";
}

std::string write_veg(const TetMesh& mesh) {
    std::string out = "*VERTICES\n";
    put(out, mesh.vertices.size()), out += " 3 0 0\n";
    put_numbered_points(out, mesh);
    out += "*ELEMENTS\nTET\n", put(out, mesh.tets.size()), out += " 4 0\n";
    put_tets(out, mesh, true, "\n");
    return out;
}

std::string write_node(const TetMesh& mesh) {
    std::string out;
    put(out, mesh.vertices.size()), out += " 3 0 0\n";
    put_numbered_points(out, mesh);
    return out;
}

std::string write_ele(const TetMesh& mesh) {
    std::string out;
    put(out, mesh.tets.size()), out += " 4 0\n";
    put_tets(out, mesh, true, "\n");
    return out;
}

} // namespace sinew::solver
