// Scenes for benchmarks: boxes of Kuhn tets, tissues that use a mesh as it is, a simulation that counts its work.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/rigid_motion.h"
#include "solver/newton/potential.h"
#include "solver/step.h"

#include <functional>
#include <memory>
#include <stop_token>

namespace sinew::bench {

/// The box from `low` to `high` in nx x ny x nz cells, each cut along its long diagonal into 6 Kuhn tets; vertices by
/// x, then y, then z. These are the meshes of the reference values.
solver::TetMesh box_mesh(const solver::Vec3& low, const solver::Vec3& high, int nx, int ny, int nz);
/// Cook's panel: the quadrilateral (0,0), (.48,.44), (.48,.60), (0,.44) m, 0.1 m thick about z = 0.
solver::TetMesh cook_mesh(int nx, int ny, int nz);
/// One regular tet of the given edge [m].
solver::TetMesh regular_tet(double edge);

/// A tissue with one material layer whose surface is the mesh's border; vertex i of the surface is vertex i of the
/// tets.
std::shared_ptr<solver::TissueRest> make_tissue(solver::TetMesh mesh, solver::ElasticLaw law,
                                                solver::ElementKind element = solver::ElementKind::linear);
/// Rest positions of all that a tissue has in the state: its vertices, and of quadratic tets the middles of the edges.
solver::Points nodes_of(const solver::TissueRest& rest);
/// Dead loads of a uniform traction [Pa] on the part of the border where `on_face` holds, one a node [N].
solver::Points traction_loads(const solver::TissueRest& rest, const std::function<bool(const solver::Vec3&)>& on_face,
                              const solver::Vec3& traction);
std::vector<int> vertices_where(const solver::Points& points, const std::function<bool(const solver::Vec3&)>& at);
/// The vertex at `p` to 1e-9 m. Throws std::logic_error if there is none.
int vertex_at(const solver::Points& points, const solver::Vec3& p);

/// A hold of the part of a tissue's surface between the vertices where `at` holds; `body` is the tissue's.
solver::Part hold_where(const solver::TissueRest& rest, int body, const std::function<bool(const solver::Vec3&)>& at);
/// Its values where it has moved like this, with its moment about the origin.
solver::PartValues hold_values(const solver::RigidMotion& motion = {});

/// One layer, no compression resistance.
solver::TissueInputs material(double youngs_modulus, double poissons_ratio, double density = 1000);
/// No gravity, no damping, Newton to 1e-10 of the forces at work.
solver::StepInputs tight_inputs();

solver::Vec3 position(const std::vector<double>& x, int vertex);
void set_position(std::vector<double>& x, int vertex, const solver::Vec3& p);

/// What a run did, beside its result.
struct Work {
    double seconds = 0; ///< in advance()
    int steps = 0, newton = 0, unconverged = 0;
    long long linear_iterations = 0;
    void add(const solver::StepRecord& record, double step_seconds);
    Work& operator+=(const Work& other);
};

/// A scene on its way.
class Simulation {
  public:
    /// `motions`: as initial_state takes them.
    Simulation(solver::SceneDescription description, solver::StepInputs first, std::stop_token stop = {},
               std::span<const solver::InitialMotion> motions = {});
    /// One step with `inputs`. Throws solver::Error and solver::Stopped.
    void step();
    solver::StepInputs inputs;
    solver::State state;
    Work work;
    const solver::Scene& scene() const { return *scene_; }

  private:
    std::shared_ptr<const solver::Scene> scene_;
    solver::Workspace workspace_;
    solver::StepControl control_;
};

/// What must act from outside to hold a tissue at given positions, vertex by vertex, held ones included.
class HoldingForces {
  public:
    HoldingForces(const solver::TissueRest& rest, const solver::TissueInputs& values);
    /// Forces [N] at x (3 numbers a vertex [m]); `energy` is the stored energy there [J].
    solver::Points at(const std::vector<double>& x, double* energy = nullptr);

  private:
    std::shared_ptr<const solver::Scene> scene_;
    solver::StepInputs inputs_;
    solver::State state_;
    solver::ImplicitForm form_;
    solver::Potential potential_;
};

/// Median; 0 for none.
double median(std::vector<double> values);

} // namespace sinew::bench
