// Adaptive refinement of the BCC lattice that keeps it conforming.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/red_green.h"

#include "solver/index.h"

#include <algorithm>
#include <bit>

namespace sinew::solver {
namespace {

constexpr std::size_t edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
/// Edges opposite each other: 01 and 23, 02 and 13, 03 and 12.
constexpr unsigned opposite_pairs[3] = {0b100001, 0b010010, 0b001100};
/// Edges of the faces opposite corners 0…3.
constexpr unsigned face_edges[4] = {0b111000, 0b100110, 0b010101, 0b001011};

/// Edge between corners i and j.
int edge_between(int i, int j) {
    for (int e = 0; e < 6; ++e)
        if (edge_ends[e][0] == at(std::min(i, j)) && edge_ends[e][1] == at(std::max(i, j))) return e;
    return -1;
}

/// Both halves of a tet cut at the midpoint of an edge between corners of the tet.
std::array<GreenPart, 2> halves(const GreenPart& part, int edge) {
    std::array<GreenPart, 2> result{part, part};
    for (std::size_t end = 0; end < 2; ++end)
        for (int& v : result[end])
            if (v == static_cast<int>(edge_ends[edge][end])) v = 4 + edge;
    return result;
}

std::vector<GreenPart> make_green_parts(unsigned pattern) {
    const GreenPart whole{0, 1, 2, 3};
    const int count = std::popcount(pattern);
    if (count == 0) return {whole};
    const int first = std::countr_zero(pattern);
    if (count == 1) {
        const auto two = halves(whole, first);
        return {two[0], two[1]};
    }
    if (count == 2) {
        const int second = std::countr_zero(pattern & (pattern - 1));
        std::vector<GreenPart> parts;
        for (const GreenPart& half : halves(whole, first))
            for (const GreenPart& quarter : halves(half, second)) parts.push_back(quarter);
        return parts;
    }
    // A face: the tet's fourth corner stays; the face falls into three corner triangles and the middle one.
    const int apex = static_cast<int>(std::find(face_edges, face_edges + 4, pattern) - face_edges);
    std::vector<GreenPart> parts;
    for (int kept = 0; kept < 4; ++kept) {
        GreenPart part = whole;
        for (int v = 0; v < 4; ++v) {
            if (v == apex || v == kept) continue;
            // Corner triangles run from their corner to midpoints. The middle one (`kept` is the apex) takes
            // at each corner's place the midpoint opposite it, on the edge of the face's other two corners.
            int from = kept, to = v;
            if (kept == apex) {
                from = 0;
                while (from == apex || from == v) ++from;
                to = 6 - apex - v - from;
            }
            part[at(v)] = 4 + edge_between(from, to);
        }
        parts.push_back(part);
    }
    return parts;
}

BccGrid::Key sum(const BccGrid::Key& a, const BccGrid::Key& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

} // namespace

unsigned closed_pattern(unsigned pattern) {
    if (std::popcount(pattern) <= 1) return pattern;
    for (unsigned pair : opposite_pairs)
        if ((pattern & ~pair) == 0) return pair;
    for (unsigned face : face_edges)
        if ((pattern & ~face) == 0) return face;
    return all_edges;
}

const std::vector<GreenPart>& green_parts(unsigned pattern) {
    static const std::array<std::vector<GreenPart>, all_edges> table = [] {
        std::array<std::vector<GreenPart>, all_edges> made;
        for (unsigned p = 0; p < all_edges; ++p)
            if (closed_pattern(p) == p) made[p] = make_green_parts(p);
        return made;
    }();
    return table[pattern];
}

RedGreen::RedGreen(const BccGrid& grid, const std::vector<std::int64_t>& roots) {
    Level& first = levels_.emplace_back();
    first.grid = grid;
    first.cells.reserve(roots.size());
    for (std::int64_t tet : roots) {
        first.cell_of.insert(tet, static_cast<int>(first.cells.size()));
        first.cells.emplace_back().number = tet;
    }
}

unsigned RedGreen::pattern(int n, const Cell& cell) const {
    const Level& here = levels_[at(n)];
    if (here.split_edges.size() == 0) return 0;
    const BccGrid fine = here.grid.finer();
    const auto corners = here.grid.tet_vertices(cell.number);
    unsigned result = 0;
    for (std::size_t e = 0; e < 6; ++e) {
        const BccGrid::Key middle = sum(corners[edge_ends[e][0]], corners[edge_ends[e][1]]);
        if (here.split_edges.find(fine.vertex_number(middle)) >= 0) result |= 1u << e;
    }
    return result;
}

void RedGreen::make_red(CellName name) {
    Level& here = level(name.level);
    Cell& cell = here.cells[at(name.cell)];
    if (cell.is_red) return;
    cell.is_red = true;
    new_reds_.push_back(name);
    const auto corners = here.grid.tet_vertices(cell.number);
    for (const auto& ends : edge_ends) split_edge({name.level, corners[ends[0]], corners[ends[1]]});
}

void RedGreen::split_edge(const Edge& edge) {
    Level& here = level(edge.level);
    if (!here.split_edges.insert(here.grid.finer().vertex_number(sum(edge.a, edge.b)), 0)) return;
    const BccGrid::TetRing ring = here.grid.tets_around(edge.a, edge.b);
    for (int i = 0; i < ring.count; ++i) {
        const int cell = here.cell_of.find(ring.tets[at(i)]);
        if (cell >= 0) to_settle_.push_back({edge.level, cell});
    }
    if (!demand_tets_about(edge)) waiting_.push_back(edge);
}

/// Whether all tets about the edge exist that ever will.
bool RedGreen::demand_tets_about(const Edge& edge) {
    const BccGrid::TetRing ring = level(edge.level).grid.tets_around(edge.a, edge.b);
    bool is_complete = true;
    for (int i = 0; i < ring.count; ++i) is_complete = demand(edge.level, ring.tets[at(i)]) && is_complete;
    return is_complete;
}

/// Sees to it that a tet comes into being. False: it is on its way; true: it is there, or it never will be
/// because it lies outside of the mesh.
bool RedGreen::demand(int n, std::int64_t number) {
    if (level(n).cell_of.find(number) >= 0 || n == 0) return true;
    Level& above = level(n - 1);
    const std::int64_t parent_number = above.grid.parent_of(number);
    if (parent_number < 0) return true;
    const int parent = above.cell_of.find(parent_number);
    if (parent < 0) return demand(n - 1, parent_number);
    if (!above.cells[at(parent)].is_alive) return true;
    make_red({n - 1, parent});
    return false;
}

void RedGreen::settle(CellName name) {
    const Level& here = level(name.level);
    const Cell& cell = here.cells[at(name.cell)];
    if (!cell.is_alive || cell.is_red) return;
    const unsigned split = pattern(name.level, cell), closed = closed_pattern(split);
    if (closed == all_edges) return make_red(name);
    const auto corners = here.grid.tet_vertices(cell.number);
    for (std::size_t e = 0; e < 6; ++e)
        if ((closed & ~split) >> e & 1u) split_edge({name.level, corners[edge_ends[e][0]], corners[edge_ends[e][1]]});
}

void RedGreen::drain() {
    while (!to_settle_.empty()) {
        const CellName name = to_settle_.back();
        to_settle_.pop_back();
        count_work();
        settle(name);
    }
}

/// Cuts the new red cells.
/// \return where each level's new cells begin
std::vector<std::size_t> RedGreen::make_children() {
    const std::vector<CellName> reds = std::move(new_reds_);
    new_reds_.clear();
    std::vector<std::size_t> first;
    for (const Level& l : levels_) first.push_back(l.cells.size());
    for (const CellName& red : reds) {
        count_work();
        if (at(red.level) + 1 == levels_.size()) {
            const BccGrid fine = levels_.back().grid.finer();
            levels_.emplace_back().grid = fine;
            first.push_back(0);
        }
        Cell& parent = level(red.level).cells[at(red.cell)];
        Level& below = level(red.level + 1);
        parent.first_child = static_cast<int>(below.cells.size());
        for (std::int64_t child : level(red.level).grid.children(parent.number)) {
            below.cell_of.insert(child, static_cast<int>(below.cells.size()));
            below.cells.push_back({child, red.cell});
        }
    }
    return first;
}

void RedGreen::refine(const Judge& judge, const std::function<void()>& pause) {
    pause_ = pause;
    std::vector<std::size_t> first{0};
    do {
        // All new cells are judged before any is cut: a cell that is not judged yet looks dead.
        std::vector<std::vector<Verdict>> verdicts;
        for (std::size_t n = 0; n < levels_.size(); ++n) {
            verdicts.emplace_back();
            if (first[n] < levels_[n].cells.size()) verdicts[n] = judge(static_cast<int>(n), first[n]);
            for (std::size_t i = 0; i < verdicts[n].size(); ++i)
                levels_[n].cells[first[n] + i].is_alive = verdicts[n][i] != Verdict::dead;
        }
        for (std::size_t n = 0; n < levels_.size(); ++n)
            for (std::size_t i = 0; i < verdicts[n].size(); ++i) {
                const CellName name{static_cast<int>(n), static_cast<int>(first[n] + i)};
                count_work();
                if (verdicts[n][i] == Verdict::split) make_red(name);
                if (verdicts[n][i] == Verdict::keep) to_settle_.push_back(name);
            }
        drain();
        const std::vector<Edge> waiting = std::move(waiting_);
        waiting_.clear();
        for (const Edge& edge : waiting) {
            count_work();
            if (!demand_tets_about(edge)) waiting_.push_back(edge);
        }
        drain();
        first = make_children();
    } while (std::any_of(levels_.begin(), levels_.end(), [&](const Level& l) {
        return l.cells.size() > first[static_cast<std::size_t>(&l - levels_.data())];
    }));
}

} // namespace sinew::solver
