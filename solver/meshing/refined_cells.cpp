// The tets of the final lattice.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/refined_cells.h"

#include "solver/error.h"
#include "solver/meshing/red_green.h"
#include "solver/meshing/refined_count.h"
#include "solver/meshing/tet_quadrature.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::solver {
namespace {

/// A closed surface must fill more than this of a tet for the tet to count.
constexpr double negligible_share = 1e-9;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// States and touching triangles of one level's cells, in the order of RedGreen's cells.
struct CellFacts {
    std::vector<CellState> states;
    /// Around a closed surface, corners of cells that no triangle touches, with 1 inside and 0 outside: a
    /// cell that shares one lies on the same side.
    NumberMap sides;
    std::vector<std::size_t> first{0};
    std::vector<int> triangles;
    std::span<const int> touching(std::size_t i) const {
        return {triangles.data() + first[i], first[i + 1] - first[i]};
    }
};

/// Not asked yet.
constexpr CellState unknown = static_cast<CellState>(-1);

/// A tet that is not cut any more, or a cell with a green cut.
struct Leaf {
    int level, cell;
    unsigned pattern;
};

class Refiner {
  public:
    Refiner(const Solid& solid, const BccGrid& grid, const CoarseCells& coarse, const Paint& paint,
            const RefineOptions& options, const MeshingControl& control)
        : solid_(solid)
        , grid_(grid)
        , coarse_(coarse)
        , paint_(paint)
        , options_(options)
        , control_(control)
        , sides_tell_(solid.is_closed && !options.is_surface_only)
        , corners_(lattice_corners(solid, grid))
        , cells_(grid, coarse.tets) {
        facts_.push_back({coarse.states, {}, coarse.first, coarse.triangles});
    }

    RefinedCells refined() {
        if (paint_.highest() > 0) {
            // Making them would take a minute and gigabytes until they are refused.
            const RefinedCount least{solid_, grid_, coarse_, paint_, corners_, options_.is_surface_only};
            refuse_above_limit(least.at_least(options_.most_tets, control_));
            cells_.refine([this](int level, std::size_t first) { return judge(level, first); },
                          [this] { control_.ask(); });
        }
        std::vector<Leaf> leaves;
        for (std::size_t root = 0; root < cells_.levels()[0].cells.size(); ++root) {
            control_.ask();
            collect(0, static_cast<int>(root), leaves);
        }
        std::vector<std::size_t> place{0};
        for (const Leaf& leaf : leaves) place.push_back(place.back() + green_parts(leaf.pattern).size());
        std::vector<LatticePiece> all(place.back());
        const MeshingPhase phase{control_, 0.55, 1, "measuring the tets"};
        phase.run(leaves.size(), 16, [&](std::size_t i) { measure(leaves[i], all.data() + place[i]); });
        std::erase_if(all, [](const LatticePiece& p) { return p.share < 0; });
        return {std::move(all), static_cast<int>(cells_.levels().size()) - 1, cell_count()};
    }

  private:
    std::vector<RedGreen::Verdict> judge(int level, std::size_t first) {
        const RedGreen::Level& here = cells_.levels()[at(level)];
        const std::size_t count = here.cells.size() - first;
        refuse_above_limit(cell_count());
        if (level > 0) add_facts(level, first);
        std::vector<RedGreen::Verdict> verdicts(count);
        const CellFacts& facts = facts_[at(level)];
        const MeshingPhase phase{control_, 0.5, 0.5, "refining"};
        phase.run(count, 64, [&](std::size_t i) {
            verdicts[i] = facts.states[first + i] == CellState::outside ? RedGreen::Verdict::dead
                          : wants_split(level, here, first + i)         ? RedGreen::Verdict::split
                                                                        : RedGreen::Verdict::keep;
        });
        return verdicts;
    }

    /// Whether to stop, once in a while in loops that run on one thread.
    void ask_at(std::size_t i) const {
        if (i % 4096 == 0) control_.ask();
    }

    std::int64_t cell_count() const {
        std::int64_t count = 0;
        for (const RedGreen::Level& l : cells_.levels()) count += std::ssize(l.cells);
        return count;
    }

    void refuse_above_limit(std::int64_t cells) const {
        if (cells > options_.most_tets)
            throw Error("FE210",
                        "the refined lattice would have more than " + std::to_string(options_.most_tets) + " tets",
                        "raise the tet size, or refine less or on a smaller part");
    }

    void add_facts(int level, std::size_t first) {
        if (at(level) == facts_.size()) facts_.emplace_back();
        const RedGreen::Level& here = cells_.levels()[at(level)];
        const std::size_t count = here.cells.size() - first;
        std::vector<CellState> states(count);
        std::vector<std::vector<int>> touching(count);
        const MeshingPhase phase{control_, 0.5, 0.5, "refining"};
        phase.run(count, 64, [&](std::size_t i) {
            const RedGreen::Cell& cell = here.cells[first + i];
            const CellFacts& above = facts_[at(level - 1)];
            for (int t : above.touching(at(cell.parent)))
                if (touches_tet(seen_from(here.grid, cell.number, scaled(t, level)), touch_slack))
                    touching[i].push_back(t);
            // Closed surfaces are asked below, once for cells that hang together.
            const CellState whole = above.states[at(cell.parent)];
            const bool is_asked_later = touching[i].empty() && whole == CellState::touched && sides_tell_;
            states[i] = is_asked_later ? unknown : part_state(whole, !touching[i].empty(), [&] {
                return corner_positions(here.grid, cell.number);
            });
        });
        if (sides_tell_) ask_sides(level, first, states);
        CellFacts& facts = facts_[at(level)];
        facts.states.insert(facts.states.end(), states.begin(), states.end());
        for (const std::vector<int>& list : touching) {
            facts.triangles.insert(facts.triangles.end(), list.begin(), list.end());
            facts.first.push_back(facts.triangles.size());
        }
    }

    /// Fills in the unknown states around a closed surface. Cells that no triangle touches and that share a
    /// corner are on the same side, because a triangle between them would touch one; so one winding number
    /// serves all that hang together.
    void ask_sides(int level, std::size_t first, std::vector<CellState>& states) {
        const RedGreen::Level& here = cells_.levels()[at(level)];
        CellFacts& facts = facts_[at(level)];
        std::vector<std::size_t> queue;
        NumberMap waiting; // corner -> place of its first cell in `next`
        std::vector<std::array<std::int64_t, 4>> corners(states.size());
        struct Link {
            std::size_t cell;
            int next;
        };
        std::vector<Link> links;     // of each corner, the cells about it whose side is not known yet
        std::vector<int> first_link; // by corner
        for (std::size_t i = 0; i < states.size(); ++i) {
            ask_at(i);
            if (states[i] == CellState::touched || states[i] == CellState::mixed) continue;
            const auto keys = here.grid.tet_vertices(here.cells[first + i].number);
            for (std::size_t k = 0; k < 4; ++k) corners[i][k] = here.grid.vertex_number(keys[k]);
            if (states[i] != unknown) {
                for (std::int64_t c : corners[i]) facts.sides.insert(c, states[i] == CellState::inside);
                continue;
            }
            for (std::int64_t c : corners[i]) {
                if (waiting.insert(c, static_cast<int>(first_link.size()))) first_link.push_back(-1);
                int& head = first_link[at(waiting.find(c))];
                links.push_back({i, head});
                head = static_cast<int>(links.size()) - 1;
            }
        }
        const auto settle = [&](std::size_t cell, CellState state) {
            states[cell] = state;
            queue.push_back(cell);
        };
        const auto spread = [&] {
            while (!queue.empty()) {
                const std::size_t cell = queue.back();
                queue.pop_back();
                for (std::int64_t c : corners[cell]) {
                    if (!facts.sides.insert(c, states[cell] == CellState::inside)) continue;
                    for (int l = first_link[at(waiting.find(c))]; l >= 0; l = links[at(l)].next)
                        if (states[links[at(l)].cell] == unknown) settle(links[at(l)].cell, states[cell]);
                }
            }
        };
        for (std::size_t i = 0; i < states.size(); ++i) {
            ask_at(i);
            if (states[i] != unknown) continue;
            int side = -1;
            for (std::int64_t c : corners[i]) side = std::max(side, facts.sides.find(c));
            const CellState state =
                side >= 0 ? (side == 1 ? CellState::inside : CellState::outside)
                          : untouched_state(solid_, corner_positions(here.grid, here.cells[first + i].number));
            settle(i, state);
            spread();
        }
    }

    /// State of a part of a tet.
    template <class Corners>
    CellState part_state(CellState whole, bool is_touched, const Corners& corners) const {
        if (is_touched) return CellState::touched;
        if (whole == CellState::inside) return whole;
        // Of the shell at the surface, what the surface does not pass through goes.
        return options_.is_surface_only ? CellState::outside : untouched_state(solid_, corners());
    }

    std::array<Vec3, 3> scaled(int triangle, int level) const {
        const double scale = static_cast<double>(std::int64_t{1} << level);
        const auto& c = corners_[at(triangle)];
        return {scale * c[0], scale * c[1], scale * c[2]};
    }

    bool wants_split(int level, const RedGreen::Level& here, std::size_t cell) const {
        if (level >= paint_.highest()) return false;
        const CellFacts& facts = facts_[at(level)];
        const std::int64_t number = here.cells[cell].number;
        if (facts.states[cell] != CellState::touched) {
            const auto c = corner_positions(here.grid, number);
            return paint_.wants_more_inside(level, (c[0] + c[1] + c[2] + c[3]) / 4);
        }
        const auto triangles = facts.touching(cell);
        return std::any_of(triangles.begin(), triangles.end(), [&](int t) {
            return paint_.wants_more(level, t, seen_from(here.grid, number, scaled(t, level)));
        });
    }

    void collect(int level, int index, std::vector<Leaf>& leaves) const {
        const RedGreen::Cell& cell = cells_.levels()[at(level)].cells[at(index)];
        if (cell.is_red)
            for (int child = 0; child < 8; ++child) collect(level + 1, cell.first_child + child, leaves);
        else if (facts_[at(level)].states[at(index)] != CellState::outside)
            leaves.push_back({level, index, cells_.pattern(level, cell)});
    }

    void measure(const Leaf& leaf, LatticePiece* out) const {
        const RedGreen::Level& here = cells_.levels()[at(leaf.level)];
        const CellFacts& facts = facts_[at(leaf.level)];
        const std::int64_t number = here.cells[at(leaf.cell)].number;
        const auto touching = facts.touching(at(leaf.cell));
        const CellState state = facts.states[at(leaf.cell)];
        const int finest = static_cast<int>(cells_.levels().size()) - 1;
        const auto keys = here.grid.tet_vertices(number);
        if (leaf.pattern == 0) {
            for (std::size_t k = 0; k < 4; ++k) out->corners[k] = times(keys[k], 1 << (finest - leaf.level));
            set_share(state, corner_positions(here.grid, number), {touching.begin(), touching.end()}, *out);
            return;
        }
        // Corners and midpoints in the coordinates of the next level.
        const BccGrid fine = here.grid.finer();
        std::array<BccGrid::Key, 10> points;
        for (std::size_t k = 0; k < 4; ++k) points[k] = times(keys[k], 2);
        std::size_t edge = 4;
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j, ++edge)
                for (std::size_t d = 0; d < 3; ++d) points[edge][d] = keys[i][d] + keys[j][d];
        const NumberMap& finer_sides = facts_[at(leaf.level + 1)].sides;
        for (const GreenPart& part : green_parts(leaf.pattern)) {
            std::array<Vec3, 4> lattice_corners, corners;
            for (std::size_t k = 0; k < 4; ++k) {
                const BccGrid::Key& key = points[at(part[k])];
                out->corners[k] = times(key, 1 << (finest - leaf.level - 1));
                lattice_corners[k] = Vec3(key[0], key[1], key[2]);
                corners[k] = fine.position(key);
            }
            const std::vector<int> inner = touching_part(lattice_corners, touching, leaf.level + 1);
            int side = -1;
            if (sides_tell_ && inner.empty() && state == CellState::touched)
                for (int v : part) side = std::max(side, finer_sides.find(fine.vertex_number(points[at(v)])));
            const CellState part_is = side >= 0 ? (side == 1 ? CellState::inside : CellState::outside)
                                                : part_state(state, !inner.empty(), [&] { return corners; });
            set_share(part_is, corners, inner, *out);
            ++out;
        }
    }

    static BccGrid::Key times(const BccGrid::Key& k, int factor) {
        return {k[0] * factor, k[1] * factor, k[2] * factor};
    }

    std::vector<int> touching_part(const std::array<Vec3, 4>& corners, std::span<const int> triangles,
                                   int level) const {
        Mat3 edges;
        edges << corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0];
        const Mat3 inverse = edges.inverse();
        std::vector<int> result;
        for (int t : triangles) {
            const std::array<Vec3, 3> triangle = scaled(t, level);
            BarycentricTriangle seen;
            for (std::size_t c = 0; c < 3; ++c) {
                const Vec3 b = inverse * (triangle[c] - corners[0]);
                seen[c] = {1 - b[0] - b[1] - b[2], b[0], b[1], b[2]};
            }
            if (touches_tet(seen, touch_slack)) result.push_back(t);
        }
        return result;
    }

    void set_share(CellState state, const std::array<Vec3, 4>& corners, const std::vector<int>& touching,
                   LatticePiece& out) const {
        TetMoments moments;
        moments.degree = options_.degree;
        out.share = share(state, corners, touching, moments);
        if (!(out.share >= 0 && out.share < 1) || options_.is_estimate) return;
        out.moments = std::make_unique<double[]>(moment_count(options_.degree));
        std::copy_n(moments.value.begin(), moment_count(options_.degree), out.moments.get());
    }

    double share(CellState state, const std::array<Vec3, 4>& corners, const std::vector<int>& touching,
                 TetMoments& moments) const {
        constexpr double left_out = -1;
        if (state == CellState::outside) return left_out;
        if (state != CellState::touched && options_.is_surface_only) return left_out;
        if (state == CellState::inside) return 1;
        if (!solid_.is_closed) {
            const auto exact = share_away_from_holes(solid_, corners, touching, &moments);
            return exact ? *exact : quadrature_share(solid_, corners, state == CellState::touched, &moments);
        }
        const double result = options_.is_estimate ? share_of_simple(solid_, corners, touching)
                                                   : closed_share(solid_, corners, touching, &moments);
        return result < negligible_share ? left_out : result;
    }

    const Solid& solid_;
    const BccGrid& grid_;
    const CoarseCells& coarse_;
    const Paint& paint_;
    const RefineOptions& options_;
    const MeshingControl& control_;
    const bool sides_tell_; ///< whether cells away from the surface are kept or not by their side of it
    std::vector<std::array<Vec3, 3>> corners_; ///< of the triangles, in the coarse lattice's coordinates
    RedGreen cells_;
    std::vector<CellFacts> facts_; ///< by level
};

} // namespace

RefinedCells refine_cells(const Solid& solid, const BccGrid& grid, const CoarseCells& coarse, const Paint& paint,
                          const RefineOptions& options, const MeshingControl& control) {
    return Refiner(solid, grid, coarse, paint, options, control).refined();
}

} // namespace sinew::solver
