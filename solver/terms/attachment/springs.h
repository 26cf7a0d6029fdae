// Attachment energy: 1/2 k A w |x_source - x_target|^2 per sample of the source's surface, k [N/m^3] x envelope, or of
// means by patches where that is stiffer than a lattice bears at every sample (spring_patches.h), plus a viscous part
// from the relative velocity. Both ends are linear in the unknowns (through embeddings) or prescribed (bones), so what
// one side gets the other gives, and the energy of a stage is a quadratic function of the positions of the vertices
// that springs reach. There are some twenty samples to such a vertex: they are visited where the stage begins and where
// Newton has come much nearer to the minimum; between, the energy is the exact expansion about the last place of visit,
// by vertices.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/integrate/implicit_form.h"
#include "solver/linear/block_matrix.h"
#include "solver/scene.h"
#include "solver/state.h"
#include "solver/step_inputs.h"
#include "solver/terms/attachment/anchors.h"
#include "solver/terms/attachment/spring_bundles.h"
#include "solver/terms/attachment/spring_coupling.h"
#include "solver/terms/attachment/spring_patches.h"

namespace sinew::solver {

class Springs {
  public:
    /// Springs of all attachments that pull; bone to bone ones have no effect and are left out. Those with a body in
    /// `sides`, one an attachment or -1, are held by patches (spring_patches.h); empty: none.
    Springs(const Scene& scene, AttachmentView kept, std::span<const int> sides = {});
    /// How stiff single springs of patches are at most [N/m^3], one an attachment; until then there is no limit.
    void limit_single(const std::vector<double>& stiffnesses) { most_single_ = stiffnesses; }
    /// Pairs of vertices that springs couple.
    void add_couplings(std::vector<std::pair<int, int>>& couplings) const { coupling_.add_couplings(couplings); }
    /// Finds where the Hessian's entries go. `unknown[vertex]` = row or -1.
    void set_pattern(const BlockPattern& pattern, const std::vector<int>& unknown) {
        coupling_.set_pattern(pattern, unknown);
    }
    /// Values of the coming stage of a step from `before`; `bones_after`: bone positions at the end of the step.
    void begin_stage(const StepInputs& inputs, const State& before, const std::vector<Points>& bones_after,
                     const ImplicitForm& form);
    /// What the energy's terms were where the expansion is made [J]: its rounding is that of such numbers.
    double energy_scale() const { return energy_; }
    /// Energy [J] with its gradient added to `gradient` (3 a vertex) unless that is null.
    double energy(const std::vector<double>& x, double* gradient);
    /// Adds the Hessian to a matrix of the pattern of set_pattern.
    void add_hessian(BlockMatrix& a) const { coupling_.add_hessian(a); }
    /// Likewise, a number a block of the pattern [N/m].
    void add_springs(std::span<double> blocks) const { coupling_.add_springs(blocks); }
    /// Adds the squared elastic force on each vertex [N^2], or its squared stiffness [N^2/m^2], to that of its body.
    void add_squared_forces(const std::vector<double>& x, std::vector<double>& of_body);
    void add_squared_stiffnesses(std::vector<double>& of_body) const { coupling_.add_squared_stiffnesses(of_body); }
    double longest(const std::vector<double>& x) const; ///< [m]
    /// Energy without the viscous part.
    double stored_energy(const std::vector<double>& x) const;

  private:
    /// visit(spring, its stretch) for a bundle's springs, in order.
    template <class Visit>
    void for_each_stretch(std::size_t bundle, const std::vector<double>& x, const Visit& visit) const;
    /// Sums of the springs' forces at each node: elastic ones, and all.
    void gather(const std::vector<Vec3>& of_springs, std::vector<Vec3>& at_nodes) const;
    /// Visits all springs at x.
    void expand(const std::vector<double>& x);
    /// Of the patches' stretches at x.
    void find_means(const std::vector<double>& x) const;
    /// How far the nodes are from where the expansion is made.
    void set_moves(const std::vector<double>& x);
    bool viscous() const { return !references_.empty(); }

    const Scene& scene_;
    const AttachmentView kept_; ///< without those of attachments that are off or slide
    SpringBundles bundles_;
    SpringPatches patches_;
    SpringCoupling coupling_;
    std::vector<double> most_single_;
    // Of the stage:
    /// Per attachment: of single springs; and then again per attachment: of patches' means, beside that.
    std::vector<SpringPull> pulls_;
    std::vector<Vec3> places_;     ///< prescribed points, 0 where both ends are free
    std::vector<Vec3> references_; ///< the stretch at which the relative velocity would be zero; empty: none is damped
    std::vector<Vec3> place_means_, reference_means_; ///< by patches
    // Of the expansion, by nodes:
    double energy_ = 0; ///< where it is made [J]
    std::vector<Vec3> base_, forces_, elastic_forces_;
    std::vector<Vec3> moves_, products_;                ///< scratch
    std::vector<Vec3> of_springs_, elastic_of_springs_; ///< scratch, by springs
    mutable std::vector<Vec3> means_;                   ///< scratch, by patches: of stretches
    std::vector<double> node_square_;                   ///< scratch
};

} // namespace sinew::solver
