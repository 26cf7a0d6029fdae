// Log-log plots as SVG: series of points, joined or not, and a staircase of the best.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace sinew::bench {

struct PlotPoint {
    double x = 0, y = 0;   ///< above 0; others are left out
    std::string label;     ///< shown on hovering
    std::string note = ""; ///< small, beside the point; may be empty
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points;
    bool line = true; ///< joins the points in their order
};

struct Plot {
    std::string title, x_axis, y_axis; ///< axes with their units
    std::vector<PlotSeries> series;
    bool pareto = false; ///< draw the line of the points that no other beats in both x and y
    /// Grey guide lines of these slopes through the middle of the data.
    std::vector<double> slopes;
    std::vector<std::pair<double, std::string>> levels = {}; ///< dashed lines across at these y, with their names
};

struct NamedPlot {
    std::string name; ///< of the file, without ending
    Plot plot;
};

/// Numbers of the points that no other beats: no other is as small in both and smaller in one. By rising x.
std::vector<std::size_t> pareto_front(const std::vector<PlotPoint>& points);

/// A complete SVG document; the same text for the same plot.
std::string draw(const Plot& plot);

} // namespace sinew::bench
