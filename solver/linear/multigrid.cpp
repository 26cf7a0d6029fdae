// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/multigrid.h"

#include "solver/index.h"
#include "solver/parallel.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace sinew::solver {

namespace {

/// Levels end where a dense factorisation costs less than a sweep over the finest.
constexpr int coarsest_rows = 64;
/// Gauss-Seidel sweeps run through chunks of rows without a break: at least so many rows, and no more chunks than this.
constexpr std::size_t least_chunk = 1024, most_chunks = 16;
/// So many rows are fetched ahead of a sweep backward.
constexpr int ahead = 8;
/// Rows of a slice of T, some three megabytes.
constexpr std::size_t slice = 1024;

/// What one fine unknown takes from coarse ones: up to four, weights sum to 1.
struct Interpolation {
    int count = 0;
    std::array<int, 4> coarse{};
    std::array<float, 4> weight{};
};

using GridPoint = std::array<int, 4>; // body, then the grid's indices

/// Corners and weights of the simplex of a unit cube's Kuhn subdivision that holds a point: walk from the lowest corner
/// to the highest along the axes in the order of falling fractions.
void kuhn_weights(int body, const Vec3& point, std::vector<std::pair<GridPoint, double>>& out) {
    GridPoint corner{body, 0, 0, 0};
    std::array<double, 3> fraction{};
    std::array<std::size_t, 3> order{0, 1, 2};
    for (std::size_t c = 0; c < 3; ++c) {
        const double base = std::floor(point[static_cast<Eigen::Index>(c)]);
        corner[c + 1] = static_cast<int>(base);
        fraction[c] = point[static_cast<Eigen::Index>(c)] - base;
    }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return fraction[a] != fraction[b] ? fraction[a] > fraction[b] : a < b;
    });
    out.clear();
    double left = 1;
    for (std::size_t k = 0; k < 4; ++k) {
        const double next = k < 3 ? fraction[order[k]] : 0;
        if (left - next > 1e-6) out.emplace_back(corner, left - next);
        if (k < 3) ++corner[order[k] + 1];
        left = next;
    }
}

/// The first grid is usually twice as wide as the mesh. In bodies a few tets thick that leaves a third and more of the
/// points, each with so many neighbours that the grid has as many blocks as the mesh; a wider one has half of them and
/// costs a tenth more iterations.
constexpr double usual_width = 2, thin_width = 2.5, thin_share = 0.3;

/// Spacing of each body's first grid [m].
std::vector<double> first_spacings(const UnknownPlaces& places) {
    std::vector<double> out = places.spacing;
    for (double& s : out) s *= usual_width;
    std::vector<std::set<GridPoint>> taken(out.size());
    std::vector<std::size_t> count(out.size(), 0);
    std::vector<std::pair<GridPoint, double>> weights;
    for (std::size_t i = 0; i < places.points.size(); ++i) {
        if (!places.left_out.empty() && places.left_out[i]) continue;
        const std::size_t body = at(places.body[i]);
        kuhn_weights(places.body[i], places.points[i] / out[body], weights);
        ++count[body];
        for (const auto& [point, w] : weights) taken[body].insert(point);
    }
    for (std::size_t b = 0; b < out.size(); ++b)
        if (static_cast<double>(taken[b].size()) > thin_share * static_cast<double>(count[b]))
            out[b] *= thin_width / usual_width;
    return out;
}

} // namespace

struct Multigrid::Level {
    const RowBlocks* a = nullptr; ///< of this level
    RowBlocks own;                ///< if it is not the finest
    std::vector<FloatBlock> inverse;
    /// Half the norms of a row's blocks outside its chunk, added to the diagonal: with it a sweep up and down is a
    /// positive definite operator however the rows are numbered (Baker, Falgout, Kolev, Yang 2011, "l1" smoothers).
    std::vector<float> outside;
    std::size_t chunk = least_chunk;
    std::vector<float> r, x, old, rest; ///< right side, result, result before a sweep, residual; one number of padding

    // To the next level: T = A P, then P^T T. Only a slice of T's rows is there at a time: each coarse row takes what
    // it needs of them, in the order of the fine rows, while they are in the cache.
    std::vector<Interpolation> up;
    std::vector<int> t_start;                           ///< of T's rows, and one past the end
    std::vector<FloatBlock> t_blocks;                   ///< of one slice after another
    std::vector<std::array<std::uint16_t, 4>> t_target; ///< per entry of A: where its products go in the row of T
    std::vector<int> member_start;                      ///< per coarse row: fine rows that it reaches, ascending
    std::vector<std::pair<int, float>> members;
    std::vector<int> product_start;            ///< per member, in product_target
    std::vector<std::uint16_t> product_target; ///< where the entries of its T row go in the coarse row
    /// What a coarse row takes from a slice.
    struct Taking {
        int coarse, first, end; ///< members
    };
    std::vector<Taking> takings;
    std::vector<std::size_t> taking_start; ///< per slice and one past the end

    std::vector<char> left_out; ///< flags; empty: none

    explicit Level(int rows) {
        for (auto* v : {&r, &x, &old, &rest}) v->assign(3 * at(rows) + 1, 0.0f);
        outside.resize(at(rows));
        chunk = std::max(least_chunk, (at(rows) + most_chunks - 1) / most_chunks);
    }
    std::size_t rows() const { return at(a->rows); }
    void set_outside();
    std::size_t chunks() const { return (rows() + chunk - 1) / chunk; }
    /// False: rows of T, or of the coarse matrix, are longer than can be numbered.
    bool prepare_products(int coarse_rows, RowBlocks& coarse);
    void find_takings();
    void multiply_products(RowBlocks& coarse);
    void sweep_forward_from_zero();
    void residual_after_forward();
    void prefetch_row(std::size_t i) const;
    /// A row's first entry below the diagonal whose column is not before `first`, or one past the last.
    int first_inside(std::size_t i, int first) const {
        int e = a->lower_start[i];
        while (e < a->lower_start[i + 1] && a->column[at(e)] < first) ++e;
        return e;
    }
    void sweep_backward();
};

struct Multigrid::Coarsest {
    Eigen::MatrixXf matrix, shifted;
    Eigen::LLT<Eigen::MatrixXf> factor;
    Eigen::VectorXf x;
};

bool Multigrid::Level::prepare_products(int coarse_rows, RowBlocks& coarse) {
    constexpr std::size_t most = std::numeric_limits<std::uint16_t>::max();
    std::vector<int> t_column;
    t_start = {0};
    t_target.resize(a->column.size());
    for (std::size_t i = 0; i < rows(); ++i) {
        std::vector<int> columns;
        a->for_each_entry(i, [&](std::size_t e) {
            const Interpolation& p = up[at(a->column[e])];
            columns.insert(columns.end(), p.coarse.begin(), p.coarse.begin() + p.count);
        });
        std::sort(columns.begin(), columns.end());
        columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
        if (columns.size() > most) return false;
        a->for_each_entry(i, [&](std::size_t e) {
            const Interpolation& p = up[at(a->column[e])];
            for (int k = 0; k < p.count; ++k)
                t_target[e][at(k)] = static_cast<std::uint16_t>(
                    std::lower_bound(columns.begin(), columns.end(), p.coarse[at(k)]) - columns.begin());
        });
        t_column.insert(t_column.end(), columns.begin(), columns.end());
        t_start.push_back(static_cast<int>(t_column.size()));
    }

    std::vector<std::vector<std::pair<int, float>>> by_coarse(at(coarse_rows));
    std::size_t member_count = 0, product_count = 0;
    for (std::size_t i = 0; i < rows(); ++i)
        for (int k = 0; k < up[i].count; ++k) {
            by_coarse[at(up[i].coarse[at(k)])].emplace_back(static_cast<int>(i), up[i].weight[at(k)]);
            ++member_count, product_count += at(t_start[i + 1] - t_start[i]);
        }
    members.reserve(member_count), product_start.reserve(member_count + 1), product_target.reserve(product_count);
    coarse.rows = coarse_rows;
    coarse.lower_start = coarse.upper_start = member_start = product_start = {0};
    std::vector<int> upper; // columns from the diagonal on, of all rows
    for (int c = 0; c < coarse_rows; ++c) {
        std::vector<int> columns;
        for (const auto& [i, w] : by_coarse[at(c)])
            columns.insert(columns.end(), t_column.begin() + t_start[at(i)], t_column.begin() + t_start[at(i) + 1]);
        std::sort(columns.begin(), columns.end());
        columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
        if (columns.size() > most) return false;
        const auto place_of = [&](int column) {
            return std::lower_bound(columns.begin(), columns.end(), column) - columns.begin();
        };
        for (const auto& member : by_coarse[at(c)]) {
            members.push_back(member);
            for (int t = t_start[at(member.first)]; t < t_start[at(member.first) + 1]; ++t)
                product_target.push_back(static_cast<std::uint16_t>(place_of(t_column[at(t)])));
            product_start.push_back(static_cast<int>(product_target.size()));
        }
        member_start.push_back(static_cast<int>(members.size()));
        const auto diagonal = columns.begin() + place_of(c);
        coarse.column.insert(coarse.column.end(), columns.begin(), diagonal);
        coarse.lower_start.push_back(static_cast<int>(coarse.column.size()));
        upper.insert(upper.end(), diagonal, columns.end());
        coarse.upper_start.push_back(static_cast<int>(upper.size()));
    }
    for (int& start : coarse.upper_start) start += coarse.lower_start.back();
    coarse.column.insert(coarse.column.end(), upper.begin(), upper.end());
    coarse.column.shrink_to_fit();
    coarse.blocks.resize(coarse.column.size());
    find_takings();
    return true;
}

void Multigrid::Level::find_takings() {
    const auto for_each_taking = [&](const auto& visit) {
        for (int c = 0; c + 1 < static_cast<int>(member_start.size()); ++c)
            for (int m = member_start[at(c)]; m < member_start[at(c) + 1];) {
                const std::size_t s = at(members[at(m)].first) / slice;
                const int first = m;
                while (m < member_start[at(c) + 1] && at(members[at(m)].first) / slice == s) ++m;
                visit(s, Taking{c, first, m});
            }
    };
    const std::size_t slices = (rows() + slice - 1) / slice;
    taking_start.assign(slices + 1, 0);
    for_each_taking([&](std::size_t s, const Taking&) { ++taking_start[s + 1]; });
    std::partial_sum(taking_start.begin(), taking_start.end(), taking_start.begin());
    takings.resize(taking_start.back());
    std::vector<std::size_t> next(taking_start.begin(), taking_start.end() - 1);
    for_each_taking([&](std::size_t s, const Taking& taking) { takings[next[s]++] = taking; });
    int longest = 0;
    for (std::size_t s = 0; s < slices; ++s)
        longest = std::max(longest, t_start[std::min((s + 1) * slice, rows())] - t_start[s * slice]);
    t_blocks.resize(at(longest));
}

void Multigrid::Level::multiply_products(RowBlocks& coarse) {
    parallel_for(coarse.blocks.size(), 4096, [&](std::size_t e) { coarse.blocks[e] = {}; });
    for (std::size_t s = 0; s + 1 < taking_start.size(); ++s) {
        const std::size_t first = s * slice, count = std::min(slice, rows() - first);
        const auto row_of_t = [&](std::size_t i) { return t_blocks.data() + (t_start[i] - t_start[first]); };
        parallel_for(count, 256, [&](std::size_t k) {
            const std::size_t i = first + k;
            FloatBlock* row = row_of_t(i);
            std::fill_n(row, t_start[i + 1] - t_start[i], FloatBlock{});
            a->for_each_entry(i, [&](std::size_t e) {
                const Interpolation& p = up[at(a->column[e])];
                for (std::size_t n = 0; n < at(p.count); ++n)
                    add_scaled(a->blocks[e], p.weight[n], row[t_target[e][n]]);
            });
        });
        parallel_for(taking_start[s + 1] - taking_start[s], 64, [&](std::size_t k) {
            const Taking& taking = takings[taking_start[s] + k];
            const std::size_t c = at(taking.coarse);
            const int below = coarse.lower_start[c + 1] - coarse.lower_start[c];
            FloatBlock* const lower = coarse.blocks.data() + coarse.lower_start[c];
            FloatBlock* const upper = coarse.blocks.data() + (coarse.upper_start[c] - below);
            for (int m = taking.first; m < taking.end; ++m) {
                const auto [i, weight] = members[at(m)];
                const FloatBlock* row = row_of_t(at(i));
                const std::uint16_t* target = product_target.data() + product_start[at(m)];
                for (int t = 0; t < t_start[at(i) + 1] - t_start[at(i)]; ++t)
                    add_scaled(row[t], weight, (target[t] < below ? lower : upper)[target[t]]);
            }
        });
    }
}

void Multigrid::Level::set_outside() {
    parallel_for(rows(), 512, [&](std::size_t i) {
        const int first = static_cast<int>(i / chunk * chunk), last = first + static_cast<int>(chunk);
        float sum = 0;
        a->for_each_entry(i, [&](std::size_t e) {
            const int j = a->column[e];
            if (j >= first && j < last) return;
            const FloatBlock& b = a->blocks[e];
            const Float4 squares = b.col(0) * b.col(0) + b.col(1) * b.col(1) + b.col(2) * b.col(2);
            sum += 0.5f * std::sqrt(squares[0] + squares[1] + squares[2]);
        });
        outside[i] = sum;
    });
}

void Multigrid::Level::sweep_forward_from_zero() {
    parallel_for(chunks(), 1, [&](std::size_t k) {
        const int first = static_cast<int>(k * chunk);
        for (std::size_t i = k * chunk; i < std::min((k + 1) * chunk, rows()); ++i) {
            const Float4 s = a->product(first_inside(i, first), a->lower_start[i + 1], x.data());
            const float* right = r.data() + 3 * i;
            const FloatBlock& d = inverse[i];
            const Float4 out =
                d.col(0) * (right[0] - s[0]) + d.col(1) * (right[1] - s[1]) + d.col(2) * (right[2] - s[2]);
            for (std::size_t c = 0; c < 3; ++c) x[3 * i + c] = out[c];
        }
    });
}

void Multigrid::Level::residual_after_forward() {
    // The sweep made row i exact for the columns up to i of its own chunk; what is missing are the others.
    parallel_for(rows(), 256, [&](std::size_t i) {
        const int first = static_cast<int>(i / chunk * chunk);
        const Float4 s = a->product(a->lower_start[i], first_inside(i, first), x.data()) +
                         a->product(a->upper_start[i] + 1, a->upper_start[i + 1], x.data());
        for (std::size_t c = 0; c < 3; ++c) rest[3 * i + c] = outside[i] * x[3 * i + c] - s[c];
    });
}

/// Processors do not foresee rows that come backwards, each of them read forwards.
void Multigrid::Level::prefetch_row(std::size_t i) const {
    constexpr std::ptrdiff_t line = 64; // [bytes]
    for (const std::vector<int>* start : {&a->lower_start, &a->upper_start}) {
        const auto* from = reinterpret_cast<const char*>(a->blocks.data() + (*start)[i]);
        const auto* end = reinterpret_cast<const char*>(a->blocks.data() + (*start)[i + 1]);
        for (; from < end; from += line) __builtin_prefetch(from);
        __builtin_prefetch(a->column.data() + (*start)[i]);
    }
}

void Multigrid::Level::sweep_backward() {
    old = x;
    parallel_for(chunks(), 1, [&](std::size_t k) {
        const int first = static_cast<int>(k * chunk), last = static_cast<int>(std::min((k + 1) * chunk, rows()));
        for (int row = last - 1; row >= first; --row) {
            const std::size_t i = at(row);
            if (row >= first + ahead) prefetch_row(i - ahead);
            const int low = first_inside(i, first);
            int high = a->upper_start[i + 1];
            while (a->column[at(high) - 1] >= last) --high;
            const Float4 below = a->product(low, a->lower_start[i + 1], x.data());
            const Float4 s = a->product(a->lower_start[i], low, old.data()) +
                             a->product(a->upper_start[i], high, x.data(), below) +
                             a->product(high, a->upper_start[i + 1], old.data());
            const float* right = r.data() + 3 * i;
            const FloatBlock& d = inverse[i];
            const Float4 step =
                d.col(0) * (right[0] - s[0]) + d.col(1) * (right[1] - s[1]) + d.col(2) * (right[2] - s[2]);
            for (std::size_t c = 0; c < 3; ++c) x[3 * i + c] += step[c];
        }
    });
}

Multigrid::Multigrid(const RowBlocks& fine, const UnknownPlaces& places)
    : coarsest_(std::make_unique<Coarsest>()) {
    levels_.push_back(std::make_unique<Level>(fine.rows));
    levels_.back()->a = &fine;
    levels_.back()->left_out = places.left_out;
    // Places in units of the first grid's spacing.
    Points points(places.points);
    std::vector<int> body = places.body;
    const std::vector<double> spacing = first_spacings(places);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] /= spacing[at(body[i])];
    while (levels_.back()->a->rows > coarsest_rows) {
        Level& level = *levels_.back();
        level.up.resize(points.size());
        std::map<GridPoint, int> number;
        std::vector<std::vector<std::pair<GridPoint, double>>> weights(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!level.left_out.empty() && level.left_out[i]) continue;
            kuhn_weights(body[i], points[i], weights[i]);
            for (const auto& [point, w] : weights[i]) number.emplace(point, 0);
        }
        // At most half as many: else a mesh of scattered pieces has come to its end.
        if (number.empty() || static_cast<int>(number.size()) > level.a->rows / 2) break;
        Points coarse_points;
        std::vector<int> coarse_body;
        for (auto& [point, n] : number) {
            n = static_cast<int>(coarse_points.size());
            coarse_points.push_back(0.5 * Vec3(point[1], point[2], point[3]));
            coarse_body.push_back(point[0]);
        }
        for (std::size_t i = 0; i < points.size(); ++i) {
            Interpolation& p = level.up[i];
            for (const auto& [point, w] : weights[i]) {
                p.coarse[at(p.count)] = number[point];
                p.weight[at(p.count++)] = static_cast<float>(w);
            }
        }
        auto next = std::make_unique<Level>(static_cast<int>(coarse_points.size()));
        if (!level.prepare_products(static_cast<int>(coarse_points.size()), next->own)) break;
        next->a = &next->own;
        levels_.push_back(std::move(next));
        points = std::move(coarse_points);
        body = std::move(coarse_body);
    }
}

Multigrid::~Multigrid() = default;
int Multigrid::level_count() const { return static_cast<int>(levels_.size()); }

bool Multigrid::set_values() {
    for (std::size_t k = 0; k < levels_.size(); ++k) {
        Level& level = *levels_[k];
        if (k + 1 < levels_.size()) level.multiply_products(levels_[k + 1]->own);
        level.set_outside();
        if (!invert_diagonal(*level.a, level.a->upper_start, level.outside, level.inverse)) return false;
        for (std::size_t i = 0; i < level.left_out.size(); ++i)
            if (level.left_out[i]) level.inverse[i] = {};
    }
    Level& last = *levels_.back();
    if (last.a->rows > 4 * coarsest_rows || !last.left_out.empty()) {
        coarsest_->matrix.resize(0, 0); // too many for a dense factor: a sweep up and down serves
        return true;
    }
    const Eigen::Index n = 3 * last.a->rows;
    coarsest_->matrix.setZero(n, n);
    for (Eigen::Index i = 0; i < last.a->rows; ++i)
        last.a->for_each_entry(at(i), [&](std::size_t e) {
            const FloatBlock& b = last.a->blocks[e];
            for (int c = 0; c < 3; ++c)
                for (int r = 0; r < 3; ++r) coarsest_->matrix(3 * i + r, 3 * last.a->column[e] + c) = b(r, c);
        });
    // Grid points that few vertices hang on make the coarsest matrix nearly singular; a small shift keeps it definite.
    for (float shift = 1e-5f; shift < 1; shift *= 10) {
        coarsest_->shifted = coarsest_->matrix;
        coarsest_->shifted.diagonal() *= 1 + shift;
        coarsest_->factor.compute(coarsest_->shifted);
        if (coarsest_->factor.info() == Eigen::Success) return true;
    }
    return false;
}

void Multigrid::cycle(std::size_t k) {
    Level& level = *levels_[k];
    const bool last = k + 1 == levels_.size();
    if (last && coarsest_->matrix.size() > 0) {
        coarsest_->x = Eigen::Map<const Eigen::VectorXf>(level.r.data(), coarsest_->matrix.rows());
        coarsest_->factor.solveInPlace(coarsest_->x);
        std::copy_n(coarsest_->x.data(), coarsest_->x.size(), level.x.begin());
        return;
    }
    std::fill(level.x.begin(), level.x.end(), 0.0f);
    level.sweep_forward_from_zero();
    if (!last) {
        Level& coarse = *levels_[k + 1];
        level.residual_after_forward();
        parallel_for(coarse.rows(), 256, [&](std::size_t c) {
            float sum[3] = {};
            for (int m = level.member_start[c]; m < level.member_start[c + 1]; ++m) {
                const auto [i, weight] = level.members[at(m)];
                for (std::size_t d = 0; d < 3; ++d) sum[d] += weight * level.rest[3 * at(i) + d];
            }
            for (std::size_t d = 0; d < 3; ++d) coarse.r[3 * c + d] = sum[d];
        });
        cycle(k + 1);
        parallel_for(level.rows(), 512, [&](std::size_t i) {
            const Interpolation& p = level.up[i];
            for (std::size_t n = 0; n < at(p.count); ++n)
                for (std::size_t d = 0; d < 3; ++d)
                    level.x[3 * i + d] += p.weight[n] * coarse.x[3 * at(p.coarse[n]) + d];
        });
    }
    level.sweep_backward();
}

void Multigrid::apply(const std::vector<double>& r, std::vector<double>& z) {
    Level& finest = *levels_.front();
    parallel_for(r.size(), 8192, [&](std::size_t i) { finest.r[i] = static_cast<float>(r[i]); });
    cycle(0);
    parallel_for(r.size(), 8192, [&](std::size_t i) { z[i] = static_cast<double>(finest.x[i]); });
}

} // namespace sinew::solver
