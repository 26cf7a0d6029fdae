// A body that nothing holds, loaded on its surface until it is in balance.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/mesh/surface_mesh.h"
#include "solver/term/layered_surfaces.h"
#include "solver/terms/elastic/rest_shape.h"
#include "tools/bench/beams.h"

#include <memory>
#include <optional>

namespace sinew::bench {

/// A tissue in the lattice that zTet makes for its surface.
std::shared_ptr<solver::TissueRest> lattice_tissue(const solver::SurfaceMesh& surface, double tet_size,
                                                   solver::ElasticLaw law, solver::ElementKind element);

class FreeBody {
  public:
    FreeBody(std::shared_ptr<solver::TissueRest> tissue, const solver::TissueInputs& values);
    /// Before `settle`: another material layer, by tets.
    void add_layer(std::vector<double> weights, const solver::MaterialValues& values);
    /// Before `settle`: pressure or tension on the surface. A layer that the tissue lacks becomes one that paints no
    /// tet.
    void load(const solver::TermType& type, std::vector<solver::SurfaceLayers::Layer> layers);
    /// Before `settle`: a target of its rest shape. Energies that are asked for later do not know of it, but for
    /// stored_energy.
    void reshape(std::shared_ptr<const solver::RestShape> shape, double weight);
    /// To balance, by steps so long that inertia has no part in it; the load comes in parts.
    void settle(const std::stop_token& stop);

    /// The greatest force left over at a node under all of the load if the rest shape is stretched alike everywhere, as
    /// a share of the greatest elastic force there.
    double imbalance(double stretch) const;

    solver::Vec3 place(int vertex) const { return position(x(), vertex); }
    solver::Vec3 middle() const; ///< of the vertices
    /// Enclosed by the surface, and of it, as it rides on the tets.
    double volume() const;
    double area() const;
    /// Sum of f.x over all vertices, f the forces that hold the elastic body: the integral of the stress's trace [J].
    double elastic_virial() const;
    double elastic_energy() const; ///< [J]
    double stored_energy() const;  ///< as the solver says after `settle` [J]

    std::shared_ptr<solver::TissueRest> rest;
    Work work;

  private:
    solver::StepInputs inputs(double share_of_load) const;
    const std::vector<double>& x() const { return simulation_ ? simulation_->state.x : at_rest_; }
    template <class Share>
    double sum_over_surface(const Share& share) const;

    solver::TissueInputs values_;
    std::vector<solver::Part> parts_;
    std::vector<double> full_; ///< value of each part under all of the load
    std::vector<double> at_rest_;
    std::unique_ptr<Simulation> simulation_;
};

} // namespace sinew::bench
