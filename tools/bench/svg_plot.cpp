// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <sstream>

namespace sinew::bench {

namespace {

constexpr double width = 840, height = 500, left = 84, right = 250, top = 46, bottom = 62;
// Colours that stay apart for colour-blind readers (Okabe and Ito), then again with hollow markers.
constexpr const char* colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#444444"};

/// One decimal of a pixel.
std::string px(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f", v);
    return text;
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

bool drawable(const PlotPoint& p) { return p.x > 0 && p.y > 0 && std::isfinite(p.x) && std::isfinite(p.y); }

/// One axis: decades of the data with a little room, from `from` to `to` on the page.
struct Axis {
    double low = 0, high = 1; ///< decimal logarithms
    double from = 0, to = 1;  ///< pixels
    double at(double v) const { return from + (to - from) * (std::log10(v) - low) / (high - low); }
    void fit(std::vector<double> values) {
        if (values.empty()) values = {1, 10};
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        low = std::log10(*least), high = std::log10(*most);
        // At least 0.8 decades, so that there is more than one tick.
        const double room = std::max({0.06 * (high - low), 0.08, 0.5 * (0.8 - (high - low))});
        low -= room, high += room;
    }
    /// 1, 2 and 5 of each decade where there are few decades, else the powers of ten.
    std::vector<double> ticks() const {
        std::vector<double> out;
        const bool fine = high - low < 2.2;
        for (int e = static_cast<int>(std::floor(low)); e <= static_cast<int>(std::ceil(high)); ++e)
            for (const double m : {1.0, 2.0, 5.0}) {
                const double v = m * std::pow(10.0, e);
                if ((m == 1 || fine) && std::log10(v) >= low && std::log10(v) <= high) out.push_back(v);
            }
        return out;
    }
};

std::string tick_label(double v) {
    char text[32];
    std::snprintf(text, sizeof text, v < 1e-3 || v >= 1e5 ? "%.0e" : "%.4g", v);
    return text;
}

void marker(std::ostringstream& out, std::size_t shape, const char* colour, bool hollow, double x, double y,
            const std::string& title) {
    const std::string style =
        std::string("\" fill=\"") + (hollow ? "#ffffff" : colour) + "\" stroke=\"" + colour + "\"";
    const auto path = [&](std::initializer_list<std::pair<double, double>> corners) {
        out << "<path d=\"M";
        for (const auto& [dx, dy] : corners) out << px(x + dx) << ' ' << px(y + dy) << ' ';
        out << "Z" << style;
    };
    switch (shape % 4) {
    case 0:
        out << "<circle cx=\"" << px(x) << "\" cy=\"" << px(y) << "\" r=\"4.2" << style;
        break;
    case 1:
        path({{-4, -4}, {4, -4}, {4, 4}, {-4, 4}});
        break;
    case 2:
        path({{0, -5.2}, {5, 4}, {-5, 4}});
        break;
    default:
        path({{0, -5.6}, {5.6, 0}, {0, 5.6}, {-5.6, 0}});
        break;
    }
    if (title.empty())
        out << "/>\n";
    else
        out << "><title>" << escaped(title) << "</title></" << (shape % 4 == 0 ? "circle" : "path") << ">\n";
}

void text(std::ostringstream& out, double x, double y, const char* anchor, const std::string& words, int size = 12,
          const std::string& more = "") {
    out << "<text x=\"" << px(x) << "\" y=\"" << px(y) << "\" text-anchor=\"" << anchor << "\" font-size=\"" << size
        << "\"" << more << ">" << escaped(words) << "</text>\n";
}

void polyline(std::ostringstream& out, const std::vector<std::pair<double, double>>& points, const std::string& style) {
    out << "<polyline points=\"";
    for (const auto& [x, y] : points) out << px(x) << ',' << px(y) << ' ';
    out << "\" fill=\"none\" " << style << "/>\n";
}

void draw_axes(std::ostringstream& out, const Plot& plot, const Axis& x, const Axis& y) {
    for (const double v : x.ticks()) {
        polyline(out, {{x.at(v), y.from}, {x.at(v), y.to}}, "stroke=\"#dddddd\"");
        text(out, x.at(v), y.from + 18, "middle", tick_label(v));
    }
    for (const double v : y.ticks()) {
        polyline(out, {{x.from, y.at(v)}, {x.to, y.at(v)}}, "stroke=\"#dddddd\"");
        text(out, x.from - 8, y.at(v) + 4, "end", tick_label(v));
    }
    out << "<rect x=\"" << px(x.from) << "\" y=\"" << px(y.to) << "\" width=\"" << px(x.to - x.from) << "\" height=\""
        << px(y.from - y.to) << "\" fill=\"none\" stroke=\"#333333\"/>\n";
    text(out, 0.5 * (x.from + x.to), height - 18, "middle", plot.x_axis, 13);
    text(out, 0, 0, "middle", plot.y_axis, 13,
         " transform=\"translate(20 " + px(0.5 * (y.from + y.to)) + ") rotate(-90)\"");
    text(out, x.from, 26, "start", plot.title, 15, " font-weight=\"bold\"");
}

} // namespace

std::vector<std::size_t> pareto_front(const std::vector<PlotPoint>& points) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (drawable(points[i])) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return points[a].x != points[b].x ? points[a].x < points[b].x : points[a].y < points[b].y;
    });
    std::vector<std::size_t> front;
    for (const std::size_t i : order)
        if (front.empty() || points[i].y < points[front.back()].y) front.push_back(i);
    return front;
}

std::string draw(const Plot& plot) {
    Axis x, y;
    std::vector<double> xs, ys;
    std::vector<PlotPoint> all;
    for (const PlotSeries& s : plot.series)
        for (const PlotPoint& p : s.points)
            if (drawable(p)) xs.push_back(p.x), ys.push_back(p.y), all.push_back(p);
    x.fit(xs), y.fit(ys);
    x.from = left, x.to = width - right, y.from = height - bottom, y.to = top;

    std::ostringstream out;
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << height << "\" width=\""
        << width << "\" height=\"" << height << "\" font-family=\"sans-serif\" fill=\"#222222\">\n"
        << "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        << "<clipPath id=\"inside\"><rect x=\"" << px(x.from) << "\" y=\"" << px(y.to) << "\" width=\""
        << px(x.to - x.from) << "\" height=\"" << px(y.from - y.to) << "\"/></clipPath>\n";
    draw_axes(out, plot, x, y);

    double legend = y.to + 10;
    const double legend_x = x.to + 18;
    const auto legend_line = [&](const std::string& style, const std::string& name) {
        polyline(out, {{legend_x, legend}, {legend_x + 26, legend}}, style);
        text(out, legend_x + 34, legend + 4, "start", name);
        legend += 20;
    };
    for (const double slope : plot.slopes) {
        const double mid_x = 0.5 * (x.low + x.high), mid_y = 0.5 * (y.low + y.high);
        const auto at = [&](double lx) {
            return std::pair(x.at(std::pow(10, lx)), y.at(std::pow(10, mid_y + slope * (lx - mid_x))));
        };
        const std::string style =
            "stroke=\"#999999\" stroke-width=\"1.2\" stroke-dasharray=\"" + px(2 + 3 * slope) + " 4\"";
        out << "<g clip-path=\"url(#inside)\">";
        polyline(out, {at(x.low), at(x.high)}, style);
        out << "</g>\n";
        legend_line(style, "slope " + tick_label(slope));
    }
    for (const auto& [height_at, name] : plot.levels) {
        const std::string style = "stroke=\"#aa3333\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\"";
        out << "<g clip-path=\"url(#inside)\">";
        polyline(out, {{x.from, y.at(height_at)}, {x.to, y.at(height_at)}}, style);
        out << "</g>\n";
        legend_line(style, name);
    }
    if (plot.pareto && !all.empty()) {
        std::vector<std::pair<double, double>> line;
        for (const std::size_t i : pareto_front(all)) line.emplace_back(x.at(all[i].x), y.at(all[i].y));
        const std::string style = "stroke=\"#000000\" stroke-opacity=\"0.28\" stroke-width=\"7\" "
                                  "stroke-linejoin=\"round\" stroke-linecap=\"round\"";
        if (line.size() == 1) line.push_back(line.front());
        polyline(out, line, style);
        legend_line(style, "Pareto line: best known");
    }
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
        const char* colour = colours[s % std::size(colours)];
        const bool hollow = s >= std::size(colours);
        std::vector<std::pair<double, double>> line;
        for (const PlotPoint& p : plot.series[s].points)
            if (drawable(p)) line.emplace_back(x.at(p.x), y.at(p.y));
        const std::string style = std::string("stroke=\"") + colour + "\" stroke-width=\"1.6\"";
        if (plot.series[s].line && line.size() > 1) polyline(out, line, style);
        for (const PlotPoint& p : plot.series[s].points) {
            if (!drawable(p)) continue;
            marker(out, s, colour, hollow, x.at(p.x), y.at(p.y), p.label);
            if (p.note.empty()) continue;
            // To the right and above, where lines that fall do not pass; at the right edge to the left and below.
            const bool at_edge = x.at(p.x) > x.to - 40;
            text(out, x.at(p.x) + (at_edge ? -7 : 7), y.at(p.y) + (at_edge ? 13 : -6), at_edge ? "end" : "start",
                 p.note, 10);
        }
        if (plot.series[s].line) polyline(out, {{legend_x, legend}, {legend_x + 26, legend}}, style);
        marker(out, s, colour, hollow, legend_x + 13, legend, "");
        text(out, legend_x + 34, legend + 4, "start", plot.series[s].name);
        legend += 20;
    }
    out << "</svg>\n";
    return out.str();
}

} // namespace sinew::bench
