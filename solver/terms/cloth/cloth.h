// Cloth: stretch along warp and weft, shear (membrane.h) and bending (fold.h) of sheets, and their mass. A sheet whose
// rest shape is scaled by s has s^2 times the energy of the sheet as modelled, of deformations measured from the scaled
// one; its mass stays. stiffnessDamping acts on all three alike: it brakes the rates of stretch, shear and angles.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/type.h"
#include "solver/terms/cloth/fold.h"
#include "solver/terms/cloth/membrane.h"
#include "solver/terms/cloth/sheet.h"

#include <memory>

namespace sinew::solver {

/// In scenes with cloth; no parts.
extern const TermType cloth_type;

class Cloth final : public Term {
  public:
    explicit Cloth(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override;
    void bind(const BlockPattern& pattern) override;
    void add_masses(MassMatrix& masses) const override;
    void begin_stage(const Stage& stage) override;
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override;
    void add_held_gradient(std::span<double> gradient) const override;
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    void raise_forces_at_work(const Positions& x, std::span<double> largest) const override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    double energy_scale() const override { return energy_scale_; }
    void add_vertex_stiffness(std::span<double> stiffness) const override;
    double stored_energy(const Positions& x) override;
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;

  private:
    struct Sheet {
        int body;
        std::size_t deformable, first_vertex;
        std::size_t first_triangle, triangle_count;
    };
    using References = double[3][lanes];

    void set_rest();
    void set_fold(std::size_t slot, const std::array<bool, 3>& is_there, bool flat);
    void set_materials(const Sheet& sheet, const ClothInputs& inputs);
    void set_scales();
    Membrane membrane(std::size_t batch, const StencilVectors<3>& x, double damping) const;
    void start_angles(const Positions& x);
    Fold fold(std::size_t batch, const StencilVectors<6>& x, double damping) const;

    const Scene& scene_;
    std::vector<Sheet> sheets_;
    std::vector<ClothInputs> inputs_;
    // Their buffers are not what the term is.
    mutable std::unique_ptr<Stencils<3>> triangles_;
    mutable std::unique_ptr<Stencils<6>> folds_; ///< as many, with their neighbours
    std::vector<MembraneBatch> membranes_;
    std::vector<FoldBatch> fold_batches_;
    std::vector<double> vertex_mass_; ///< per vertex of the scene [kg]
    double damping_ = 0;
    struct TriangleReferences {
        References c;
    };
    std::vector<TriangleReferences> references_;  ///< per batch; empty without damping
    std::vector<double> angle_starts_;            ///< per batch, angle and lane, see Fold
    std::vector<double> angle_references_;        ///< 3 packs a batch
    std::vector<StencilVectors<3>> triangles_at_; ///< of begin_stage
    std::vector<StencilVectors<6>> folds_at_;
    mutable std::vector<double> shown_;                           ///< of measure
    std::vector<ClothMaterial> mixed_;                            ///< of set_materials
    std::vector<double> masses_;                                  ///< likewise
    std::vector<double> squares_of_triangles_, squares_of_folds_; ///< of the last evaluation's gradients, per slot
    std::vector<double> force_floor_, squared_stiffness_;         ///< per sheet
    double energy_scale_ = 0;
};

} // namespace sinew::solver
