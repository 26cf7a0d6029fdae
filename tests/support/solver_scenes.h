// Small scenes for solver tests: boxes of tets, tissues whose surface is the tet mesh's own border, default inputs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/step.h"

#include <array>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sinew::test {

/// Every law there is.
inline constexpr auto all_laws = [] {
    std::array<solver::ElasticLaw, std::size(solver::elastic_laws)> out{};
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = solver::elastic_laws[i].law;
    return out;
}();

/// nx x ny x nz cubes of six Kuhn tets each, filling [0, size].
solver::TetMesh box_mesh(const solver::Vec3& size, int nx, int ny, int nz);
/// One regular tet of the given edge.
solver::TetMesh regular_tet(double edge);

/// A tissue that uses the mesh as it is, with one material layer; the surface is the mesh's border, point by point.
std::shared_ptr<solver::TissueRest> tissue(const solver::TetMesh& mesh, solver::ElasticLaw law);
/// Vertices for which `at` holds.
std::vector<int> vertices_where(const solver::Points& points, const std::function<bool(const solver::Vec3&)>& at);
/// A bone with this surface.
std::shared_ptr<solver::BoneRest> bone(const solver::Points& points, const std::vector<solver::Triangle>& triangles);

solver::TissueInputs material(double youngs_modulus, double poissons_ratio, double density = 1000);
/// One step's inputs: no gravity, no damping, no compression resistance, tight Newton.
solver::StepInputs still_inputs();

std::string data_file(const std::string& name); ///< tests/solver/data/name
/// The trusted values of the accuracy catalogue (data/accuracy.json).
nlohmann::json accuracy();
/// Rows of three numbers.
solver::Points read_positions(const std::string& path);

/// Moves to equilibrium; fails the test if Newton does not converge.
solver::State settle(solver::Workspace& workspace, solver::State state, const solver::StepInputs& inputs,
                     int steps = 1);

solver::Vec3 position(const solver::State& state, int vertex);
void set_position(solver::State& state, int vertex, const solver::Vec3& p);

} // namespace sinew::test
