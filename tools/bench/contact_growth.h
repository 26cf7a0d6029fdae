// How the time that contact takes grows with the number of points: two bodies of few tets with finer and finer
// surfaces.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/bench/run_options.h"
#include "tools/bench/table.h"

#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace sinew::bench {

struct ContactGrowthRow {
    int points = 0, triangles = 0; ///< of both surfaces
    int contacts = 0, unconverged = 0;
    double newton = 0;     ///< iterations a step, mean
    double without_ms = 0; ///< a step with the collisions of both bodies off, median
    double contact_ms = 0; ///< what a step takes longer with them, median
    /// How fast that grows since the row before: the exponent p of points^p; n log n has 1.1 to 1.15 here. NaN in the
    /// first row.
    double exponent = 0;
    double per_point_ns = 0; ///< of contact_ms, over n log2 n
};

/// A cube of 1,296 tets slides over a slab of bone at 0.5 m/s, pressed by its weight; its surface and the slab's top
/// have a thousand to 200,000 points in all. On one thread. Throws solver::Error and solver::Stopped.
std::vector<ContactGrowthRow> run_contact_growth(const RunOptions& options);

Table contact_growth_table(const std::vector<ContactGrowthRow>& rows);
nlohmann::ordered_json contact_growth_json(const std::vector<ContactGrowthRow>& rows);

} // namespace sinew::bench
