// What is painted on a surface, in the tets that carry it: weights of layers, weights and directions of fibres.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"
#include "solver/mesh/embedding.h"
#include "solver/meshing/meshing_control.h"

#include <functional>
#include <vector>

namespace sinew::nodes {

using Layers = std::vector<std::reference_wrapper<const Material>>;
using Fibers = std::vector<std::reference_wrapper<const Fiber>>;

/// Painted fibre ends: up to 0.1 the source, from 0.9 on the sink.
bool is_source(double end_point);
bool is_sink(double end_point);

/// A surface in tets, and what is painted on it.
struct PaintedIn {
    const solver::TetMesh& tets;
    const solver::Points& surface;
    const std::vector<solver::Triangle>& triangles;
    const solver::Embedding& embedding;
};

/// The layers' weights and the fibres of a body or a part of one.
struct Painted {
    std::vector<std::vector<double>> layers;
    std::vector<solver::FiberRest> fibers;
};

/// Maps are extended harmonically into the volume; fibres follow a harmonic field on smaller tets (finer_tets.h).
/// \param parent tet of the given `count` that each of the tets is a part of: what directions are given for
Painted painted_in(const PaintedIn& t, const Layers& materials, const Fibers& fibers, const std::vector<int>& parent,
                   std::size_t count, const solver::MeshingControl& control);

/// Tets with less of a part than this are left out where its maps are extended: slivers would only make the equations
/// stiff.
inline constexpr double least_part_share = 1e-3;

/// The same of a part of a tissue, found within the tets that it holds something of, and zero in all others.
/// \param shares of each of the tissue's tets; one at least of least_part_share
Painted painted_in_part(const solver::TissueRest& tissue, const Subtissue& part, const std::vector<double>& shares,
                        const std::vector<int>& parent, std::size_t count, const solver::MeshingControl& control);

/// References to all of them.
template <class T>
std::vector<std::reference_wrapper<const T>> references(const std::vector<T>& all) {
    return {all.begin(), all.end()};
}

} // namespace sinew::nodes
