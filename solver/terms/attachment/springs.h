// Attachment energy: 1/2 k A w |x_source - x_target|^2 per sample of the source's surface, k [N/m^3] x envelope, plus a
// viscous part from the relative velocity. Both ends are linear in the unknowns (through embeddings) or prescribed
// (bones), so the Hessian is constant over a step, and what one side gets the other gives.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/integrate/implicit_form.h"
#include "solver/linear/block_matrix.h"
#include "solver/scene.h"
#include "solver/state.h"
#include "solver/step_inputs.h"
#include "solver/terms/attachment/anchors.h"

namespace sinew::solver {

class Springs {
  public:
    /// Springs of all attachments that pull; bone to bone ones have no effect and are left out.
    Springs(const Scene& scene, std::vector<std::vector<Anchor>> anchors);
    /// Pairs of vertices that springs couple.
    void add_couplings(std::vector<std::pair<int, int>>& couplings) const;
    /// Finds where the Hessian's entries go. `unknown[vertex]` = row or -1.
    void set_pattern(const BlockPattern& pattern, const std::vector<int>& unknown);
    /// Values of the coming stage of a step from `before`; `bones_after`: bone positions at the end of the step.
    void begin_stage(const StepInputs& inputs, const State& before, const std::vector<Points>& bones_after,
                     const ImplicitForm& form);
    bool empty() const { return springs_.empty(); }
    /// Energy [J] with its gradient added to `gradient` (3 a vertex) unless that is null.
    double energy(const std::vector<double>& x, double* gradient);
    /// Adds the Hessian to a matrix of the pattern of set_pattern.
    void add_hessian(BlockMatrix& a) const;
    /// Adds the squared elastic force on each vertex [N^2], or its squared stiffness [N^2/m^2], to that of its body.
    void add_squared_forces(const std::vector<double>& x, std::vector<double>& of_body);
    void add_squared_stiffnesses(std::vector<double>& of_body) const;
    double longest(const std::vector<double>& x) const; ///< [m]
    /// Energy without the viscous part.
    double stored_energy(const std::vector<double>& x) const;

  private:
    /// |sum_i c_i x_i - anchor|: up to two embedded points against each other or against a bone.
    struct Spring {
        int attachment, anchor; ///< places in anchors_
        std::size_t first_term; ///< of terms_
        int count;              ///< of its terms
        double area_weight;     ///< [m^2]
    };
    struct Term {
        int vertex;
        double coefficient;
    };
    /// Springs with the same attachment and vertices, which have the same blocks: places in springs_.
    using Group = std::vector<int>;
    /// What a vertex gets from springs.
    struct Share {
        int spring;
        double coefficient;
    };
    /// A vertex that springs reach.
    struct Node {
        int vertex, body;
        std::size_t first_share, first_load;
    };
    /// How much area of an attachment pulls at a vertex [m^2].
    struct Load {
        int attachment;
        double area;
    };
    /// Stiffness per area of one attachment in this stage [N/m^3].
    struct Pull {
        double stiffness = 0, viscous = 0; ///< viscous = damping x velocity factor
    };
    /// The attachment's stiffness times this goes to the diagonal of a block.
    struct Entry {
        int attachment;
        double product; ///< sum of area x coefficients of the block's row and column [m^2]
    };
    void add_end(const AnchorEnd& end, int body, double sign);
    void make_nodes();
    void make_groups();
    Vec3 stretch(std::size_t spring, const std::vector<double>& x) const;
    Vec3 gathered(std::size_t node) const; ///< sum of coefficient x force_ at a vertex

    const Scene& scene_;
    std::vector<std::vector<Anchor>> anchors_; ///< per attachment
    std::vector<Spring> springs_;
    std::vector<Term> terms_;
    std::vector<Group> groups_;
    std::vector<Node> nodes_; ///< by rising vertex, and one past the end
    std::vector<Share> shares_;
    std::vector<Load> loads_;
    // Of the stage:
    std::vector<Pull> pulls_;         ///< per attachment
    std::vector<Vec3> places_;        ///< prescribed points, 0 where both ends are free
    std::vector<Vec3> references_;    ///< the stretch at which the relative velocity would be zero
    std::vector<Vec3> forces_;        ///< scratch: of each spring
    std::vector<double> node_square_; ///< scratch
    // Of the pattern:
    std::vector<int> blocks_;              ///< those that springs reach
    std::vector<std::size_t> entry_start_; ///< per such block
    std::vector<Entry> entries_;
};

} // namespace sinew::solver
