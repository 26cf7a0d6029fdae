// The meshing benchmark: one mesh through zTet's lattice, with what came out of it and how long it took.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/meshing/shells.h"

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace sinew::bench {

constexpr std::array<solver::Fill, 3> all_fills{solver::Fill::surface_only, solver::Fill::filled_cavities,
                                                solver::Fill::empty_cavities};

struct MeshingResult {
    std::string file;
    solver::Fill fill = solver::Fill::filled_cavities;
    double parts = 0;          ///< cubes along the longest side
    int refine = 0;            ///< how often the size is halved at the surface
    std::string code, message; ///< why there is no lattice; empty if there is one
    std::size_t triangles = 0, tets = 0, whole = 0;
    int border_edges = -1; ///< -1: not known, the mesh was refused
    int crossings = 0;     ///< triangles that do not part 1 from 0 all over: other parts cross or cover them
    double least_angle = 0, most_angle = 0; ///< dihedral [degrees]
    double covered_volume = 0;              ///< sum of coverage * volume [scene units^3]
    /// Signed volume of the surface, as the fill mode reads it and with its small holes closed; 0 if large
    /// holes leave it without one. Parts that overlap count twice in it, but once in the covered volume.
    double surface_volume = 0;
    std::vector<std::pair<std::string, double>> phases; ///< name and wall time [s]
    double seconds = 0;
};

/// Files among `paths` and below the folders among them that end like a mesh file; sorted within a folder.
/// Throws solver::Error IO401 for a path that does not exist.
std::vector<std::string> mesh_files_under(const std::vector<std::string>& paths);

/// The lattice with cubes of the longest side / `parts`, halved `refine` times all over the surface, on the
/// calling thread's TBB arena; of tet files their border. Refusals are results. Throws solver::Stopped.
MeshingResult run_meshing(const std::string& file, solver::Fill fill, double parts, int refine,
                          std::stop_token stop = {});

nlohmann::ordered_json as_json(const MeshingResult& result);
/// A Markdown table: head, and one row a result.
std::string meshing_table_head();
std::string as_table_row(const MeshingResult& result);

} // namespace sinew::bench
