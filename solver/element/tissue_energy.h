// All tets of a scene as one term of the potential: elasticity, volume conservation and active fibres. Element entries
// are computed batch by batch in parallel into places of their own, then gathered vertex by vertex and block by block
// in a fixed order, so that sums have the same bits for any number of threads.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/mass_matrix.h"
#include "solver/element/volume_patches.h"
#include "solver/linear/block_matrix.h"
#include "solver/step_inputs.h"
#include "solver/system.h"

#include <memory>

namespace sinew::solver {

class TissueEnergy {
  public:
    explicit TissueEnergy(const Scene& scene);
    ~TissueEnergy();

    /// Takes the material and fibre values of a step. Returns true if the couplings changed: volume conservation came
    /// or went on a tissue of linear tets, whose patches couple more vertices. Throws Error FE304 with the body where a
    /// value is not a finite number; then nothing is taken.
    bool set_values(const StepInputs& inputs);
    /// How many tenfold steps the stiffness on means and patches lies above a hundred times the shear modulus.
    int volume_levels() const { return volume_levels_; }
    /// Takes 10^-level of that stiffness for what follows; 0 = all of it.
    void relax_volume(int level);
    /// Pairs of vertices that elements and patches couple.
    void add_couplings(std::vector<std::pair<int, int>>& couplings) const;
    /// Finds where each entry goes and sets the masses. The pattern must outlive this.
    void set_pattern(const BlockPattern& pattern);

    /// Damping of the coming stage: `share` times the laws' small-strain stiffness acts on E - E_ref; 0 = none. What
    /// acts on means and patches is left out.
    void set_damping(double share, const StrainReference& reference);
    /// The rates of strain at the end of the stage, at x: velocity_factor (E(x) - E_ref), by points, with set_damping's
    /// E_ref.
    void strain_rates(const std::vector<double>& x, double velocity_factor, std::vector<double>& out) const;
    /// Energy at x (3 a vertex) [J], damping included; keeps the gradient for the functions below.
    double evaluate(const std::vector<double>& x);
    /// Adds the gradient of the last evaluation at one unknown to g[3] [N].
    void add_gradient(std::size_t unknown, double* g) const {
        for (int k = system_.node_start[unknown]; k < system_.node_start[unknown + 1]; ++k) {
            const double* e = gradients_.data() + system_.nodes[static_cast<std::size_t>(k)];
            for (int c = 0; c < 3; ++c) g[c] += e[c * lanes];
        }
    }
    /// Norms of the last evaluation's forces of a tissue's single elements, and of its fibres, before they cancel [N].
    double force_norm(std::size_t tissue) const;
    double fiber_norm(std::size_t tissue) const;
    /// Least det F and number of tets with det F <= 0 in the last evaluation: where the energy is taken, or, with the
    /// `x` of that evaluation, at the corners of quadratic tets too.
    void count_inverted(const std::vector<double>* x, double& least_j, int& inverted) const;

    /// Hessian at x into `a`, over whatever stood there. `project` clamps each element's eigenvalues at zero.
    void assemble(const std::vector<double>& x, bool project, BlockMatrix& a);

    const MassMatrix& mass() const { return mass_; }
    double elastic_scale() const { return (1 + damping_share_) * elastic_scale_; } ///< sum of modulus x volume [J]
    const std::vector<double>& vertex_stiffness() const {
        return vertex_stiffness_;
    } ///< the same shared out to vertices
    /// Of one tissue: forces that would strain every tet by 1e-6 [N], and the root of its tets' summed squared
    /// stiffnesses [N/m].
    double force_floor(std::size_t tissue) const { return force_floor_[tissue]; }
    double stiffness_scale(std::size_t tissue) const { return (1 + damping_share_) * stiffness_scale_[tissue]; }

  private:
    struct Patches; // of one tissue
    void set_materials(std::size_t tissue, const TissueInputs& in);
    void set_scales();
    void set_strains_of(const StrainReference& reference, std::vector<double>& strains) const;
    PointInputs point_inputs(std::size_t tissue, std::size_t i) const;
    double set_patch_pressures(std::size_t tissue, const std::vector<double>& x);
    void set_patch_gradients(std::size_t tissue, const std::vector<double>& x);
    void gather_patches(BlockMatrix& a) const;

    const Scene& scene_;
    const Scene::System& system_;
    std::vector<TissueInputs> inputs_;                ///< per tissue: what moduli and masses were made from
    std::vector<TetModuli> moduli_;                   ///< per batch, as all below unless said
    std::vector<std::vector<Anisotropy>> anisotropy_; ///< [tissue][batch]
    std::vector<char> has_means_;                     ///< per tissue
    std::vector<std::vector<ActiveFiber>> fibers_;    ///< per tissue, batch by batch, `active_count_` each
    std::vector<std::size_t> active_count_;
    std::vector<std::unique_ptr<Patches>> patches_; ///< per tissue; null where none are used
    std::vector<double> tet_mass_;                  ///< per slot of all batches [kg]
    MassMatrix mass_;
    double damping_share_ = 0;
    std::vector<double> reference_strains_; ///< of every point; empty without damping
    int volume_levels_ = 0;
    double volume_share_ = 1;
    double elastic_scale_ = 0;
    std::vector<double> vertex_stiffness_;
    std::vector<double> force_floor_, stiffness_scale_; ///< per tissue

    const BlockPattern* pattern_ = nullptr;
    std::vector<int> contribution_start_, contributions_; ///< per block: element entries in fixed order
    std::vector<double> gradients_, hessians_;
    std::vector<ElementSummary> summaries_;
};

} // namespace sinew::solver
