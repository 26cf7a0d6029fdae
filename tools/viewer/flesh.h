// Tets are larger than what they carry: a lattice reaches beyond its flesh, most where the flesh is thin. What is drawn
// of tets and fibres keeps to the flesh.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/digest.h"
#include "tools/viewer/view_data.h"

#include <map>

namespace sinew::viewer {

/// What was found out about shapes at rest, for who shows a run again and again while it goes on and its graph changes.
class FleshMemory {
  public:
    struct Found {
        std::vector<ViewSkinPoint> skin;
        std::vector<ViewFibres> fibres; ///< without their excitation
    };
    const Found* find(const engine::Digest& shapes) const;
    const Found& keep(const engine::Digest& shapes, Found found);

  private:
    std::map<engine::Digest, Found> found_;
};

/// Fills ViewLattice::skin and the fibres' `centre` and `reach`, from the shapes at rest. Fibres of tets that hold
/// nothing of the flesh are left out. An open surface has no inside: there all is drawn as it is in the tets.
/// \param memory what is in it is not found out again
void keep_to_flesh(ViewBody& body, FleshMemory* memory = nullptr);

/// Where a lattice's vertices are drawn at `frame`: those beside the flesh on its skin. The body must be there.
Coordinates drawn_lattice(const ViewBody& body, std::size_t frame);

} // namespace sinew::viewer
