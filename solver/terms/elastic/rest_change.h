// Rest shapes that change: targets, restScale and muscle growth. A tet whose material has grown by G is at rest where
// its deformation gradient is G, so its law sees Fe = F G^-1 on a volume that is det G as large: the same element with
// the shape gradients B G^-1 and the volume V det G. Laws and fibres know nothing of it; masses stay the model's.
//   G = s^e x product over the fibres k of (a a^T + g_k^(w_k) (I - a a^T)) x U, the first fibre's factor first
// with U the stretch of the blend of targets (rest_shape.h), s the layers' restScale, composited (where subtissues
// share a tet the geometric mean of their s^e), e restScaleEnvelope, a the fibre's direction, g its muscleGrowthScale,
// w envelope x weight (multiplicative growth: Rodriguez, Hoger and McCulloch 1994). Fibres are lines of the flesh:
// targets turn them, and a law's stiff direction, along U a; so a tissue in a target's shape acts as if modelled so.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/step_inputs.h"
#include "solver/system.h"
#include "solver/terms/elastic/rest_shape.h"

#include <memory>
#include <span>
#include <vector>

namespace sinew::solver {

/// Whether these values change the rest shape anywhere.
bool changes_rest(const TissueInputs& in);
/// Whether both give the same rest shape.
bool same_rest_change(const TissueInputs& a, const TissueInputs& b);
/// G of a tet.
Mat3 rest_change(const TissueRest& rest, const TissueInputs& in, std::size_t tet, const RestShapes& shapes = {});
/// Throw Error FE247 where lengths at rest would become zero or negative, or more than a thousand times larger or
/// smaller: tets of a volume that is none. The message says which value does it.
void check_rest_scale(const TissueInputs& in);
void check_growth(const TissueInputs& in);

/// The tets of one tissue as the change leaves them.
class ChangedRest {
  public:
    ChangedRest(const Scene::System& system, const TissueBatches& batches);
    void set(const TissueRest& rest, const TissueInputs& in, const RestShapes& shapes);

    /// Batch i of the tissue.
    const TetBatch& tets(std::size_t i) const { return tets_[i]; }
    /// Of quadratic tets.
    const EdgeBatch& edges(std::size_t i) const { return edges_[i]; }
    /// Of fibre field k, batch i, where it runs now.
    const FiberBatch& fiber(std::size_t k, std::size_t i) const {
        return fibers_.empty() ? batches_.fibers[k][i] : fibers_[k][i];
    }
    /// Likewise of the law's stiff direction; its root is the scene's.
    const Anisotropy& stiff(std::size_t i) const { return stiff_.empty() ? batches_.anisotropy[i] : stiff_[i]; }
    /// Rates of the Green strain at all points of batch i, listed: from those of F to those of Fe, and back.
    void to_changed(std::size_t i, double* strains) const { pull(inverse_[i], strains); }
    void to_model(std::size_t i, double* strains) const { pull(change_[i], strains); }

  private:
    struct Matrices {
        double m[9][lanes];
    };
    void turn_directions(const Mat3& stretch, std::size_t batch, std::size_t lane);
    /// E -> M^T E M
    void pull(const Matrices& m, double* strains) const;

    const Scene::System& system_;
    const TissueBatches& batches_;
    std::vector<TetBatch> tets_;
    std::vector<EdgeBatch> edges_;
    std::vector<std::shared_ptr<PointPlaces>> places_; ///< per edge batch; null where all tets are whole
    std::vector<Matrices> change_, inverse_;           ///< G, G^-1 per batch
    std::vector<std::vector<FiberBatch>> fibers_;      ///< as targets turn them; empty without
    std::vector<Anisotropy> stiff_;                    ///< likewise
};

} // namespace sinew::solver
