// Attachment energy: 1/2 k A w |x_source - x_target|^2 per attached vertex, k [N/m^3] x envelope, plus a viscous part
// from the relative velocity. Both ends are linear in the unknowns (through embeddings) or prescribed (bones), so the
// Hessian is constant over a step, and what one side gets the other gives.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/integrate/implicit_form.h"
#include "solver/linear/block_matrix.h"
#include "solver/scene.h"
#include "solver/state.h"
#include "solver/step_inputs.h"

namespace sinew::solver {

/// |sum_i c_i x_i - anchor|: up to two embedded points against each other or against a bone.
struct Spring {
    int attachment = -1, anchor_index = -1;
    int count = 0;
    int vertex[20]; ///< of two quadratic tets at most
    double coefficient[20];
    double area_weight = 0; ///< [m^2]
    int body[2] = {-1, -1}; ///< tissues at its ends
};

class Springs {
  public:
    /// Springs of all attachments that pull; bone to bone ones have no effect and are left out.
    Springs(const Scene& scene, const std::vector<std::vector<Anchor>>& anchors);
    /// Pairs of vertices that springs couple.
    void add_couplings(std::vector<std::pair<int, int>>& couplings) const;
    /// Finds where the Hessian's entries go. `unknown[vertex]` = row or -1.
    void set_pattern(const BlockPattern& pattern, const std::vector<int>& unknown);
    /// Values of the coming stage of a step from `before`; `bones_after`: bone positions at the end of the step.
    void begin_stage(const StepInputs& inputs, const State& before, const std::vector<Points>& bones_after,
                     const ImplicitForm& form);
    bool empty() const { return springs_.empty(); }
    /// Energy [J] with its gradient added to `gradient` (3 a vertex) unless that is null.
    double energy(const std::vector<double>& x, double* gradient) const;
    /// Adds the Hessian to a matrix of the pattern of set_pattern.
    void add_hessian(BlockMatrix& a) const;
    /// Adds each spring's squared force [N^2], or squared stiffness [N^2/m^2], to those of the bodies at its ends.
    void add_squared_forces(const std::vector<double>& x, std::vector<double>& of_body) const;
    void add_squared_stiffnesses(std::vector<double>& of_body) const;
    double longest(const std::vector<double>& x) const; ///< [m]
    /// Energy without the viscous part.
    double stored_energy(const std::vector<double>& x) const;

  private:
    struct Values {
        double stiffness, viscous; ///< [N/m]; viscous = damping x velocity factor
        Vec3 anchor;               ///< prescribed point, 0 if both ends are free
        Vec3 reference;            ///< the stretch at which the relative velocity would be zero
    };
    /// The spring's stiffness times this goes to the diagonal of a block.
    struct Entry {
        int spring;
        double product; ///< of the coefficients of the block's row and column
    };
    Vec3 stretch(const Spring& s, const Values& v, const std::vector<double>& x) const;
    const Scene& scene_;
    std::vector<Spring> springs_;
    std::vector<Values> values_;
    std::vector<int> blocks_;              ///< those that springs reach
    std::vector<std::size_t> entry_start_; ///< per such block
    std::vector<Entry> entries_;
};

} // namespace sinew::solver
