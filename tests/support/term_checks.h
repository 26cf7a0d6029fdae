// What every term of solver/terms/all_terms.cpp must pass, run over a table of examples. To add a term: a file of
// examples in tests/solver/terms and a line in term_examples(); a test fails for a term without one.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/type.h"
#include "tests/support/solver_scenes.h"

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace sinew::test {

/// A scene in which a term acts, and what drives its steps.
struct ExampleScene {
    std::shared_ptr<const solver::Scene> scene;
    std::function<solver::StepInputs(int)> inputs; ///< of step 1, 2, …; 0: at the start frame
};

struct TermExample {
    std::string name; ///< "attachment of two tissues, quadratic"
    const solver::TermType* type = nullptr;
    /// 1: few enough vertices for dense matrices. 4: enough work for several threads.
    std::function<ExampleScene(int fineness)> make;

    bool acts = true;             ///< it has forces of its own; a term that only holds has none
    bool has_energy = true;       ///< its forces are the gradient of its energy
    bool forces_cancel = false;   ///< they sum to zero over all bodies that deform
    bool torques_cancel = false;  ///< so do their torques
    bool turns = true;            ///< they turn with the scene when all that is prescribed is turned and shifted
    bool knows_inverted = true;   ///< it is finite where tets are inverted or flat
    bool projects_exactly = true; ///< clamping only adds to the Hessian
    bool small = true;       ///< so few unknowns that CHOLMOD factorises without supernodes, for which it allocates
    bool couples_all = true; ///< the Hessian is whole wherever the vertices are; else near the state alone
};

/// All examples, in the order of all_terms().
std::vector<TermExample> term_examples();
std::vector<TermExample> elastic_examples();
std::vector<TermExample> attachment_examples();
std::vector<TermExample> sliding_examples();
std::vector<TermExample> field_examples();
std::vector<TermExample> pressure_examples();
std::vector<TermExample> surface_tension_examples();
std::vector<TermExample> hold_examples();
std::vector<TermExample> contact_examples();
std::vector<TermExample> cloth_examples();

/// One term by itself: its own pattern, and a stage of backward Euler from the scene's state after two steps.
class TermProbe {
  public:
    /// `turn` and `shift` move everything that is prescribed, and the state.
    explicit TermProbe(const TermExample& example, int fineness = 1,
                       const solver::Mat3& turn = solver::Mat3::Identity(),
                       const solver::Vec3& shift = solver::Vec3::Zero());
    const solver::Numbering& numbering() const { return made_.scene->numbering(); }
    const solver::State& before() const { return before_; }
    solver::Term& term() { return *term_; }
    void widen(const Eigen::VectorXd& x);    ///< takes in all that acts at x
    double energy(const Eigen::VectorXd& x); ///< [J]
    /// Size of the numbers that energies are made of [J].
    double scale(const Eigen::VectorXd& x);
    Eigen::VectorXd gradient(const Eigen::VectorXd& x);              ///< 3 a vertex, held ones too [N]
    Eigen::MatrixXd hessian(const Eigen::VectorXd& x, bool project); ///< 3 an unknown
    solver::BlockMatrix hessian_blocks(const Eigen::VectorXd& x, bool project);
    /// 3 a vertex from 3 an unknown, zero where held, and back.
    Eigen::VectorXd spread(const Eigen::VectorXd& of_unknowns) const;
    Eigen::VectorXd gather(const Eigen::VectorXd& of_vertices) const;

  private:
    ExampleScene made_;
    solver::StepInputs inputs_;
    solver::State before_;
    std::vector<solver::Points> bones_;
    solver::ImplicitForm form_;
    std::unique_ptr<solver::Stage> stage_;
    std::unique_ptr<solver::Term> term_;
    std::unique_ptr<solver::BlockPattern> pattern_;
};

/// Positions to look at a term: near the state of the probe, far from it, mirrored, in a plane, in a point.
struct Pose {
    std::string name;
    Eigen::VectorXd x;
    bool inverted = false; ///< some tets are
    bool smooth = true;    ///< derivatives can be expected to exist
};
std::vector<Pose> poses(const TermProbe& probe);

void check_gradient(const TermExample& example);    ///< against differences of energies, with their order
void check_hessian(const TermExample& example);     ///< against differences of gradients; finite where degenerate
void check_projection(const TermExample& example);  ///< positive semi-definite, and never softer
void check_sums(const TermExample& example);        ///< of forces and torques
void check_turns(const TermExample& example);       ///< and shifts
void check_threads(const TermExample& example);     ///< the same bits for 1 and 2
void check_saving(const TermExample& example);      ///< save, load, advance: the same bits
void check_allocations(const TermExample& example); ///< none in a steady step
void check_values(const TermExample& example);      ///< one that is not finite is named

} // namespace sinew::test
