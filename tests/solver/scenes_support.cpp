// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/solver_scenes.h"

#include "solver/mesh/tet_box.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace sinew::test {

using namespace solver;

TetMesh box_mesh(const Vec3& size, int nx, int ny, int nz) {
    return kuhn_mesh(nx, ny, nz,
                     [&](double r, double s, double t) { return Vec3(r * size.x(), s * size.y(), t * size.z()); });
}

TetMesh regular_tet(double edge) {
    TetMesh mesh;
    const double a = edge / std::sqrt(8.0);
    mesh.vertices = {{a, a, a}, {a, -a, -a}, {-a, a, -a}, {-a, -a, a}};
    mesh.tets = {{0, 1, 2, 3}};
    mesh.coverage = {1};
    check_and_orient(mesh);
    return mesh;
}

std::shared_ptr<TissueRest> tissue(const TetMesh& mesh, ElasticLaw law) {
    auto t = std::make_shared<TissueRest>();
    t->tets = mesh;
    t->triangles = boundary_triangles(mesh.tets);
    t->surface = mesh.vertices; // vertex i of the surface is vertex i of the tets
    std::vector<int> host(mesh.vertices.size(), -1);
    for (std::size_t k = 0; k < mesh.tets.size(); ++k)
        for (const int v : mesh.tets[k]) host[static_cast<std::size_t>(v)] = static_cast<int>(k);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        std::array<double, 4> b{};
        for (std::size_t c = 0; c < 4; ++c)
            b[c] = mesh.tets[static_cast<std::size_t>(host[v])][c] == static_cast<int>(v);
        t->embedding.tet.push_back(host[v]);
        t->embedding.barycentric.push_back(b);
    }
    t->law = law;
    t->layer_weights = {std::vector<double>(mesh.tets.size(), 1.0)};
    return t;
}

std::vector<int> vertices_where(const Points& points, const std::function<bool(const Vec3&)>& at) {
    std::vector<int> out;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (at(points[i])) out.push_back(static_cast<int>(i));
    return out;
}

std::shared_ptr<BoneRest> bone(const Points& points, const std::vector<Triangle>& triangles) {
    auto b = std::make_shared<BoneRest>();
    b->surface = points;
    b->triangles = triangles;
    return b;
}

TissueInputs material(double youngs_modulus, double poissons_ratio, double density) {
    TissueInputs t;
    t.compression_resistance = 0;
    t.layers = {{youngs_modulus, poissons_ratio, density, 1}};
    return t;
}

StepInputs still_inputs() {
    StepInputs in;
    in.gravity = Vec3::Zero();
    in.max_newton_iterations = 60;
    in.tolerance_factor = 1e-4;
    return in;
}

std::string data_file(const std::string& name) { return std::string(SINEW_SOURCE_DIR) + "/tests/solver/data/" + name; }

nlohmann::json accuracy() {
    std::ifstream in(data_file("accuracy.json"));
    REQUIRE(in);
    return nlohmann::json::parse(in);
}

Points read_positions(const std::string& path) {
    std::ifstream in(path);
    REQUIRE(in);
    Points out;
    double x, y, z;
    while (in >> x >> y >> z) out.emplace_back(x, y, z);
    return out;
}

State settle(Workspace& workspace, State state, const StepInputs& inputs, int steps) {
    for (int i = 0; i < steps; ++i) {
        state = advance(workspace, state, std::span(&inputs, 1));
        INFO("step " << i << ": residual " << state.record.residual << " after " << state.record.newton_iterations);
        REQUIRE(state.record.converged);
    }
    return state;
}

Vec3 position(const State& state, int vertex) {
    const double* p = state.x.data() + 3 * static_cast<std::size_t>(vertex);
    return {p[0], p[1], p[2]};
}

void set_position(State& state, int vertex, const Vec3& p) {
    for (int c = 0; c < 3; ++c) state.x[3 * static_cast<std::size_t>(vertex) + static_cast<std::size_t>(c)] = p[c];
}

} // namespace sinew::test
