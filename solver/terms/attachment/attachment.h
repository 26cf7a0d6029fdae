// Attachments as a term: springs per area between the surfaces of two bodies (springs.h), held where they found each
// other at the start frame (anchors.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/term/type.h"
#include "solver/term/vertex_gradient.h"
#include "solver/terms/attachment/springs.h"

#include <memory>

namespace sinew::solver {

extern const TermType attachment_type;

class Attachments final : public Term {
  public:
    explicit Attachments(const Scene& scene);

    Changes take(const StepInputs& inputs, const State& before) override;
    void keep_couplings(bool on) override { keeps_couplings_ = on; }
    void add_couplings(Couplings& couplings) const override { springs_->add_couplings(couplings); }
    void bind(const BlockPattern& pattern) override { springs_->set_pattern(pattern, scene_.numbering().unknown); }
    void begin_stage(const Stage& stage) override {
        springs_->begin_stage(stage.inputs, stage.before, stage.bones_after, stage.form);
    }
    double energy(const Positions& x, bool with_forces) override;
    double energy_scale() const override { return springs_->energy_scale(); }
    void add_gradient(std::span<double> gradient) const override {
        gradient_.add_to_unknowns(scene_.numbering(), gradient);
    }
    void add_held_gradient(std::span<double> by_vertices) const override {
        gradient_.add_held(scene_.numbering(), by_vertices);
    }
    void add_hessian(const Positions&, bool, BlockMatrix& a) override { springs_->add_hessian(a); }
    void add_springs(std::span<double> blocks) const override { springs_->add_springs(blocks); }
    void raise_forces_at_work(const Positions& x, std::span<double> largest) const override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    double stored_energy(const Positions& x) override { return springs_->stored_energy(x); }
    void measure(const Positions& x, std::span<const double> reactions, std::vector<Measured>& out) const override;

  private:
    /// Finds most_single_ anew where what it follows from has changed.
    void limit_single(const StepInputs& inputs, const State& before, bool same_anchors);

    const Scene& scene_;
    TermMemory memory_; ///< that the springs are made of
    std::unique_ptr<Springs> springs_;
    enum : char { off, by_springs, by_patches };
    std::vector<char> held_, wanted_;                  ///< per attachment: how it is held, and how it shall be
    std::vector<double> edges_;                        ///< of tets, per body
    std::vector<std::array<HeldTets, 2>> held_tets_;   ///< per attachment
    std::vector<std::vector<TissueInputs>> materials_; ///< per body: none, or what most_single_ was found for
    std::vector<double> most_single_; ///< per attachment: stiffness of single springs of patches [N/m^3]
    bool keeps_couplings_ = false;
    VertexGradient gradient_;
    mutable std::vector<double> of_body_; ///< squares, per body of the scene
};

} // namespace sinew::solver
