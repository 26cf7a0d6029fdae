// Volume conservation of one tissue of linear tets, on patches of them (element/volume_patches.h): its pressures enter
// the tets' forces as fixed numbers, its Hessian is a sum of outer products over each patch.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/volume_patches.h"
#include "solver/linear/block_matrix.h"
#include "solver/system.h"
#include "solver/term/term.h"

namespace sinew::solver {

class ConservedVolume {
  public:
    ConservedVolume(const Scene& scene, const TissueBatches& batches);

    /// Forgets all stiffnesses; then one call of add_stiffness a tet, with its volume [m^3] and modulus [Pa].
    void clear();
    void add_stiffness(std::size_t tet, double volume, double modulus);
    void add_couplings(Couplings& couplings) const;
    void bind(const BlockPattern& pattern);

    /// Finds the pressures at x; returns the energy [J].
    double set_pressures(const Positions& x);
    /// Of the tets of batch i [Pa].
    const double* pressures(std::size_t i) const { return pressure_.data() + i * lanes; }
    /// Finds what add_hessian adds, at the x of set_pressures. `scratch`: room for the tissue's element gradients.
    void set_slopes(const Positions& x, std::vector<double>& scratch);
    void add_hessian(BlockMatrix& a) const;

    struct Patch {
        std::size_t tet;          ///< one of its tets
        double stiffness, volume; ///< sum of modulus x volume [J], of volumes [m^3]
    };
    std::size_t count() const { return of_.count(); }
    Patch patch(std::size_t p) const {
        return {static_cast<std::size_t>(of_.tets[static_cast<std::size_t>(of_.tet_start[p])]), stiffness_[p],
                volume_[p]};
    }

  private:
    const Scene::System& system_;
    const TissueBatches& batches_;
    int first_vertex_;
    VolumePatches of_;
    std::vector<double> stiffness_, volume_, mean_j_; ///< per patch
    std::vector<double> pressure_;                    ///< per slot of the tissue's batches [Pa]
    std::vector<double> slope_;            ///< sqrt(stiffness) x d mean_j / d vertex, 3 a member of each patch
    std::vector<int> block_start_, pairs_; ///< per block of the pattern: pairs of members (row's, column's)
};

} // namespace sinew::solver
