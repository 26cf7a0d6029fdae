// Layered drawing after Sugiyama, Tagawa, Toda, "Methods for visual understanding of hierarchical system
// structures", IEEE Trans. SMC 11 (1981): layers by longest path, order by repeated medians, then places.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/graph_layout.h"

#include "tools/viewer/graph_rows.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sinew::viewer {

namespace {

constexpr double column_gap = 70, row_gap = 16, margin = 24;

struct Layering {
    std::vector<int> column;            ///< of each box; 0 = leftmost
    std::vector<std::vector<int>> rows; ///< boxes of each column from top to bottom
};

struct Neighbours {
    std::vector<std::vector<int>> left, right; ///< with repeats: two wires pull twice
};

Neighbours neighbours(const GraphDrawing& d) {
    Neighbours n{std::vector<std::vector<int>>(d.boxes.size()), std::vector<std::vector<int>>(d.boxes.size())};
    for (const GraphWire& w : d.wires) {
        if (w.from == w.to) continue;
        n.left[static_cast<std::size_t>(w.to)].push_back(w.from);
        n.right[static_cast<std::size_t>(w.from)].push_back(w.to);
    }
    return n;
}

/// Distance to the right end, by relaxation; as many rounds as boxes at most, so that a cycle ends too.
std::vector<int> columns(const GraphDrawing& d) {
    std::vector<int> from_right(d.boxes.size(), 0);
    bool changed = true;
    for (std::size_t round = 0; changed && round < d.boxes.size(); ++round) {
        changed = false;
        for (const GraphWire& w : d.wires) {
            int& from = from_right[static_cast<std::size_t>(w.from)];
            const int wanted = from_right[static_cast<std::size_t>(w.to)] + 1;
            if (w.from == w.to || from >= wanted || wanted >= static_cast<int>(d.boxes.size())) continue;
            from = wanted;
            changed = true;
        }
    }
    const int most = from_right.empty() ? 0 : *std::max_element(from_right.begin(), from_right.end());
    for (int& c : from_right) c = most - c;
    return from_right;
}

/// Right to left in the order in which the wires enter their boxes: what feeds one box stands together.
Layering first_order(const GraphDrawing& d, const Neighbours& n) {
    Layering l{columns(d), {}};
    const int count = l.column.empty() ? 0 : 1 + *std::max_element(l.column.begin(), l.column.end());
    l.rows.resize(static_cast<std::size_t>(count));
    std::vector<char> placed(d.boxes.size(), 0);
    std::vector<int> open;
    for (std::size_t start = d.boxes.size(); start-- > 0;)
        if (n.right[start].empty()) open.push_back(static_cast<int>(start));
    while (!open.empty()) {
        const auto box = static_cast<std::size_t>(open.back());
        open.pop_back();
        if (placed[box]) continue;
        placed[box] = 1;
        l.rows[static_cast<std::size_t>(l.column[box])].push_back(static_cast<int>(box));
        for (auto it = n.left[box].rbegin(); it != n.left[box].rend(); ++it) open.push_back(*it);
    }
    for (std::size_t box = 0; box < d.boxes.size(); ++box) // on a cycle: reached from no end
        if (!placed[box]) l.rows[static_cast<std::size_t>(l.column[box])].push_back(static_cast<int>(box));
    return l;
}

double centre(const GraphBox& b) { return b.y + b.height / 2; }

double height_of(const GraphDrawing& d, const std::vector<int>& column) {
    double sum = -row_gap;
    for (const int b : column) sum += d.boxes[static_cast<std::size_t>(b)].height + row_gap;
    return std::max(0.0, sum);
}

/// Puts each box where it wants to be, unless its neighbour is there already, between 0 and `bottom`.
void stack(std::vector<GraphBox>& boxes, const std::vector<int>& column, const std::vector<double>& wanted,
           double bottom) {
    double y = 0;
    for (const int b : column) {
        GraphBox& box = boxes[static_cast<std::size_t>(b)];
        box.y = std::max(y, wanted[static_cast<std::size_t>(b)] - box.height / 2);
        y = box.y + box.height + row_gap;
    }
    double limit = bottom;
    for (auto it = column.rbegin(); it != column.rend(); ++it) {
        GraphBox& box = boxes[static_cast<std::size_t>(*it)];
        box.y = std::min(box.y, limit - box.height);
        limit = box.y - row_gap;
    }
}

/// Long columns become several side by side, so that the drawing is wider than tall, as screens are.
void fold(const GraphDrawing& d, Layering& l) {
    double area = 0, tallest = 0;
    for (const GraphBox& b : d.boxes) {
        area += (b.width + column_gap) * (b.height + row_gap);
        tallest = std::max(tallest, b.height);
    }
    constexpr double width_to_height = 1.2,
                     fits_a_screen = 900; // before folding spends room on half-full columns
    const double most = std::max({tallest, fits_a_screen, std::sqrt(area / width_to_height)});
    std::vector<std::vector<int>> rows;
    for (const auto& column : l.rows) {
        const double parts = std::ceil(height_of(d, column) / most),
                     share = height_of(d, column) / std::max(1.0, parts);
        rows.emplace_back();
        for (const int b : column) {
            const double height = d.boxes[static_cast<std::size_t>(b)].height;
            if (!rows.back().empty() && height_of(d, rows.back()) + row_gap + height / 2 > share) rows.emplace_back();
            rows.back().push_back(b);
        }
    }
    l.rows = std::move(rows);
}

/// Wanted middle of each box: the mean of those that it is wired to on one side.
double pull(const GraphDrawing& d, const std::vector<int>& others, double otherwise) {
    if (others.empty()) return otherwise;
    double sum = 0;
    for (const int o : others) sum += centre(d.boxes[static_cast<std::size_t>(o)]);
    return sum / static_cast<double>(others.size());
}

void sweep(GraphDrawing& d, Layering& l, const Neighbours& n, bool rightwards, bool reorder) {
    std::vector<double> wanted(d.boxes.size());
    double bottom = 0;
    for (const auto& column : l.rows) bottom = std::max(bottom, height_of(d, column));
    for (std::size_t step = 0; step < l.rows.size(); ++step) {
        auto& column = l.rows[rightwards ? step : l.rows.size() - 1 - step];
        for (const int b : column) {
            const auto i = static_cast<std::size_t>(b);
            const auto& first = rightwards ? n.left[i] : n.right[i];
            const auto& second = rightwards ? n.right[i] : n.left[i];
            wanted[i] = pull(d, first.empty() ? second : first, centre(d.boxes[i]));
        }
        if (reorder)
            std::stable_sort(column.begin(), column.end(), [&](int a, int b) {
                return wanted[static_cast<std::size_t>(a)] < wanted[static_cast<std::size_t>(b)];
            });
        stack(d.boxes, column, wanted, bottom);
    }
}

/// Columns about one middle line.
void spread(GraphDrawing& d, const Layering& l) {
    double bottom = 0;
    for (const auto& column : l.rows) bottom = std::max(bottom, height_of(d, column));
    for (const auto& column : l.rows) {
        double y = (bottom - height_of(d, column)) / 2;
        for (const int b : column) {
            d.boxes[static_cast<std::size_t>(b)].y = y;
            y += d.boxes[static_cast<std::size_t>(b)].height + row_gap;
        }
    }
}

void place_in_columns(GraphDrawing& d) {
    const Neighbours n = neighbours(d);
    Layering l = first_order(d, n);
    spread(d, l);
    for (int round = 0; round < 6; ++round) sweep(d, l, n, round % 2 == 1, true);
    fold(d, l);
    spread(d, l);
    for (int round = 0; round < 8; ++round) sweep(d, l, n, round % 2 == 1, true);
    for (int round = 0; round < 4; ++round) sweep(d, l, n, round % 2 == 1, false);
    double x = 0;
    for (const auto& column : l.rows) {
        double widest = 0;
        for (const int b : column) widest = std::max(widest, d.boxes[static_cast<std::size_t>(b)].width);
        for (const int b : column) {
            d.boxes[static_cast<std::size_t>(b)].x = x;
            d.boxes[static_cast<std::size_t>(b)].width = widest; // ports of a column on one line
        }
        x += widest + column_gap;
    }
}

/// True if the editor has a place for every box.
bool place_as_edited(GraphDrawing& d, const std::string& editor_json) {
    const auto editor = nlohmann::json::parse(editor_json, nullptr, false, true);
    if (!editor.is_object() || !editor.contains("positions") || d.boxes.empty()) return false;
    const auto& positions = editor["positions"];
    for (GraphBox& box : d.boxes) {
        if (!positions.is_object() || !positions.contains(box.name)) return false;
        const auto& p = positions[box.name];
        if (!p.is_array() || p.size() < 2 || !p[0].is_number() || !p[1].is_number()) return false;
        box.x = p[0], box.y = p[1];
    }
    return true;
}

void move_to_origin(GraphDrawing& d) {
    if (d.boxes.empty()) return;
    double left = d.boxes.front().x, top = d.boxes.front().y;
    for (const GraphBox& b : d.boxes) left = std::min(left, b.x), top = std::min(top, b.y);
    for (GraphBox& b : d.boxes) {
        b.x = std::round(b.x - left + margin), b.y = std::round(b.y - top + margin);
        d.width = std::max(d.width, b.x + b.width + margin);
        d.height = std::max(d.height, b.y + b.height + margin);
    }
}

} // namespace

GraphDrawing layout_graph(const engine::Graph& graph) {
    GraphDrawing d = graph_boxes(graph);
    if (!place_as_edited(d, graph.editor_json())) place_in_columns(d);
    move_to_origin(d);
    return d;
}

} // namespace sinew::viewer
