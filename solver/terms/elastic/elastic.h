// All tets of a scene as one term: elasticity, active fibres, volume conservation, stiffness damping. Element entries
// are computed batch by batch in parallel into places of their own, then gathered vertex by vertex and block by block
// in a fixed order, so that sums have the same bits for any number of threads; Hessians chunk by chunk, each while it
// is still in the cache.
//   elastic.cpp    values, stages, energy and forces     materials.cpp  moduli, masses, scales
//   assembly.cpp   couplings and the Hessian             layer_mix, conserved_volume, rest_change: its parts
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/elastic_point.h"
#include "solver/system.h"
#include "solver/term/type.h"
#include "solver/terms/elastic/conserved_volume.h"
#include "solver/terms/elastic/hessian_chunk.h"
#include "solver/terms/elastic/rest_change.h"

#include <memory>

namespace sinew::solver {

extern const TermType elastic_type;

class Elastic final : public Term {
  public:
    explicit Elastic(const Scene& scene);

    /// Couplings change where volume conservation comes or goes on a tissue of linear tets, whose patches couple more
    /// vertices.
    Changes take(const StepInputs& inputs, const State& before) override;
    void add_couplings(Couplings& couplings) const override;
    void bind(const BlockPattern& pattern) override;
    void add_masses(MassMatrix& masses) const override;
    /// Damping of the coming stage: stiffness damping x velocity factor times the laws' small-strain stiffness acts on
    /// E - E_ref. What acts on means and patches is left out.
    void begin_stage(const Stage& stage) override;
    double energy(const Positions& x, bool with_forces) override;
    void add_gradient(std::span<double> gradient) const override;
    void add_held_gradient(std::span<double> gradient) const override;
    void add_hessian(const Positions& x, bool project, BlockMatrix& a) override;
    bool writes_all_blocks() const override { return true; }
    void raise_forces_at_work(const Positions& x, std::span<double> largest) const override;
    void add_squared_stiffnesses(std::span<double> squares) const override;
    void rest(std::span<const char> deformables) override;
    double energy_scale() const override { return (1 + damping_share_) * elastic_scale_; }
    void add_vertex_stiffness(std::span<double> stiffness) const override;
    void add_quality(const Positions* x, ShapeQuality& quality) const override;
    /// How many tenfold steps the stiffness on means and patches lies above a hundred times the shear modulus.
    int levels() const override { return volume_levels_; }
    void relax(int level) override;
    void continue_laws(bool on) override { laws_continued_ = on; }
    /// The rates of strain at the end of the stage, where it is damped.
    void remember(const Positions& x, bool keeps_history, TermMemory& memory) const override;
    double stored_energy(const Positions& x) override;

  private:
    /// Takes the change of the rest shape that the values make; false: it is the one that is there.
    bool take_rest_change(std::size_t tissue, const TissueInputs& in, const RestShapes& shapes);
    void set_materials(std::size_t tissue, const TissueInputs& in);
    void set_scales();
    void set_strains_of(const StrainReference& reference, std::span<const double> known_rates,
                        std::span<double> strains) const;
    PointInputs point_inputs(std::size_t tissue, std::size_t i) const;
    /// Batch i of a tissue at rest, as its rest shape is now.
    const TetBatch& tets(std::size_t tissue, std::size_t i) const {
        return changed_[tissue] ? changed_[tissue]->tets(i) : system_.batches[system_.tissues[tissue].first_batch + i];
    }
    /// Of quadratic tets.
    const EdgeBatch& edges(std::size_t tissue, std::size_t i) const {
        return changed_[tissue] ? changed_[tissue]->edges(i)
                                : system_.edge_batches[system_.tissues[tissue].first_edge_batch + i];
    }
    void find_chunks();
    /// Element Hessians of a chunk's part into their places.
    void set_entries(const HessianChunk& chunk, const HessianChunk::Part& part, const Positions& x, bool project);
    /// Norms of the last evaluation's forces of a tissue's single elements, and of its fibres, before they cancel [N].
    double force_norm(std::size_t tissue) const;
    double fiber_norm(std::size_t tissue) const;

    const Scene& scene_;
    const Scene::System& system_;
    std::vector<TissueInputs> inputs_;                ///< per tissue: what moduli and masses were made from
    std::vector<RestShapes> shapes_;                  ///< per tissue: what its rest shape was made from
    std::vector<RestShapes> wanted_shapes_;           ///< scratch
    std::vector<TetModuli> moduli_;                   ///< per batch, as all below unless said
    std::vector<std::vector<Anisotropy>> anisotropy_; ///< [tissue][batch]
    std::vector<char> has_means_;                     ///< per tissue
    std::vector<std::vector<ActiveFiber>> fibers_;    ///< per tissue, batch by batch, `active_count_` each
    std::vector<std::size_t> active_count_;
    std::vector<std::unique_ptr<ConservedVolume>> patches_; ///< per tissue; null where none are used
    std::vector<std::unique_ptr<ChangedRest>> changed_;     ///< per tissue; null where the rest shape is the model's
    std::vector<double> tet_mass_;                          ///< per slot of all batches [kg]
    std::vector<double> patch_energy_;                      ///< per tissue [J]
    std::vector<char> resting_; ///< per tissue: gradients_ and summaries_ are those of where it stays
    double damping_share_ = 0, velocity_factor_ = 0;
    std::vector<double> reference_strains_; ///< of every point; empty without damping
    int volume_levels_ = 0;
    double volume_share_ = 1;
    bool laws_continued_ = false; ///< continue_laws
    double elastic_scale_ = 0;    ///< sum of modulus x volume [J]
    /// Of one tissue: forces that would strain every tet by 1e-6 [N], and the root of its tets' summed squared
    /// stiffnesses [N/m].
    std::vector<double> force_floor_, stiffness_scale_;

    const BlockPattern* pattern_ = nullptr;
    std::vector<HessianChunk> chunks_; ///< all batches, in order
    std::vector<double> entries_;      ///< element Hessians of one chunk after another
    std::vector<double> gradients_;
    std::vector<ElementSummary> summaries_;
};

} // namespace sinew::solver
