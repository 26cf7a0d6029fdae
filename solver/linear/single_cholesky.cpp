// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/single_cholesky.h"

#include "solver/index.h"
#include "solver/linear/cholmod_analysis.h"
#include "solver/linear/cholmod_threads.h"
#include "solver/parallel.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <tbb/enumerable_thread_specific.h>

extern "C" {
void sgemm_(const char* transpose_a, const char* transpose_b, const int* m, const int* n, const int* k,
            const float* alpha, const float* a, const int* lda, const float* b, const int* ldb, const float* beta,
            float* c, const int* ldc);
void strsm_(const char* side, const char* triangle, const char* transpose, const char* diagonal, const int* m,
            const int* n, const float* alpha, const float* a, const int* lda, float* b, const int* ldb);
void sgemv_(const char* transpose, const int* m, const int* n, const float* alpha, const float* a, const int* lda,
            const float* x, const int* incx, const float* beta, float* y, const int* incy);
void strsv_(const char* triangle, const char* transpose, const char* diagonal, const int* n, const float* a,
            const int* lda, float* x, const int* incx);
void spotrf_(const char* triangle, const int* n, float* a, const int* lda, int* info);
}

namespace sinew::solver {

namespace {

/// Subtrees of fewer operations than this share of all are one piece of work each.
constexpr double piece_share = 1.0 / 16;
/// Rows of a large supernode that are one piece of work.
constexpr int tile = 96;
/// Columns that are factorised between two updates of the rest of a large supernode.
constexpr int panel = 96;

/// A dense block column: columns first…first+width-1 of the factor, and the rows where they are not zero, the first
/// `width` of which are the columns themselves.
struct Supernode {
    int first = 0, width = 0, rows = 0;
    std::size_t row_start = 0, value_start = 0; ///< in rows_, in values_ (column by column)
};

/// Whether a supernode above the pieces is made by tiles of rows side by side.
bool cut_into_tiles(const Supernode& s) { return s.rows > 2 * tile; }

/// What an earlier supernode takes off a later one: its rows from `from` on times those from `from` to `to`, which are
/// columns of the later one.
struct Update {
    int source, from, to;
};

struct Scratch {
    std::vector<float> product;
    std::vector<int> place; ///< of each row in the supernode at work
};

} // namespace

struct SingleCholesky::Impl {
    std::size_t unknowns = 0, value_count = 0;
    double operations = 0;
    std::vector<int> order; ///< unknown at each place of the factor
    std::vector<Supernode> nodes;
    std::vector<int> rows;
    std::vector<std::size_t> update_start;
    std::vector<Update> updates;
    std::vector<int> place; ///< of each unknown in the factor
    /// A block of the matrix that has entries in a supernode's columns, and its row.
    struct Entry {
        int block, row;
    };
    std::vector<std::size_t> entry_start; ///< per supernode and one past the end
    std::vector<Entry> entries;
    std::vector<std::pair<int, int>> pieces; ///< subtrees: first supernode, one past the last
    std::vector<int> above;                  ///< supernodes above them, ascending
    int most_rows = 0;

    std::vector<float> values, scale, work, below;
    tbb::enumerable_thread_specific<Scratch> scratch;

    explicit Impl(const BlockPattern& pattern);
    void find_updates();
    void find_entries(const BlockPattern& pattern);
    void find_pieces();
    std::size_t largest_product() const;
    bool make(int node, const BlockView& a, bool in_tiles);
    void take_entries(int node, const BlockView& a, const std::vector<int>& place_in_node);
    bool factor_dense(const Supernode& s, bool in_tiles);
    void subtract(const Supernode& s, const Update& u, int first_row, int last_row, Scratch& w);
};

SingleCholesky::Impl::Impl(const BlockPattern& pattern) {
    const CholmodAnalysis analysis(pattern, false);
    const cholmod_factor& f = *analysis.factor;
    unknowns = f.n;
    operations = analysis.operations;
    order.assign(static_cast<const int*>(f.Perm), static_cast<const int*>(f.Perm) + f.n);
    const int *super = static_cast<const int*>(f.super), *pi = static_cast<const int*>(f.pi),
              *px = static_cast<const int*>(f.px), *s = static_cast<const int*>(f.s);
    for (std::size_t k = 0; k < f.nsuper; ++k) {
        nodes.push_back({super[k], super[k + 1] - super[k], pi[k + 1] - pi[k], at(pi[k]), at(px[k])});
        most_rows = std::max(most_rows, nodes.back().rows);
    }
    rows.assign(s, s + f.ssize);
    value_count = f.xsize;
    scale.resize(unknowns), work.resize(unknowns), below.resize(at(most_rows));
    find_updates();
    find_entries(pattern);
    find_pieces();
    scratch = tbb::enumerable_thread_specific<Scratch>([n = unknowns, largest = largest_product()] {
        return Scratch{std::vector<float>(largest), std::vector<int>(n)};
    });
}

/// Numbers of the largest product that `subtract` makes, so that no step has to allocate.
std::size_t SingleCholesky::Impl::largest_product() const {
    std::vector<char> in_tiles(nodes.size(), 0);
    for (const int k : above) in_tiles[at(k)] = cut_into_tiles(nodes[at(k)]);
    std::size_t largest = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k)
        for (std::size_t u = update_start[k]; u < update_start[k + 1]; ++u) {
            const int count = nodes[at(updates[u].source)].rows - updates[u].from;
            largest = std::max(largest,
                               at(in_tiles[k] ? std::min(count, tile) : count) * at(updates[u].to - updates[u].from));
        }
    return largest;
}

void SingleCholesky::Impl::find_updates() {
    std::vector<int> node_of(unknowns);
    for (std::size_t k = 0; k < nodes.size(); ++k)
        std::fill_n(node_of.begin() + nodes[k].first, nodes[k].width, static_cast<int>(k));
    std::vector<std::vector<Update>> of(nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const Supernode& s = nodes[k];
        const int* row = rows.data() + s.row_start;
        for (int from = s.width; from < s.rows;) {
            int to = from;
            const int target = node_of[at(row[from])];
            while (to < s.rows && node_of[at(row[to])] == target) ++to;
            of[at(target)].push_back({static_cast<int>(k), from, to});
            from = to;
        }
    }
    update_start = {0};
    for (const auto& list : of) {
        updates.insert(updates.end(), list.begin(), list.end());
        update_start.push_back(updates.size());
    }
}

void SingleCholesky::Impl::find_entries(const BlockPattern& pattern) {
    std::vector<int> node_of(unknowns);
    place.resize(unknowns);
    for (std::size_t k = 0; k < unknowns; ++k) place[at(order[k])] = static_cast<int>(k);
    for (std::size_t k = 0; k < nodes.size(); ++k)
        std::fill_n(node_of.begin() + nodes[k].first, nodes[k].width, static_cast<int>(k));
    // Counted, then filled, so that nothing is held twice.
    const auto for_each_entry = [&](const auto& visit) {
        for (int i = 0; i < pattern.rows; ++i)
            for (int e = pattern.row_start[at(i)]; e < pattern.row_start[at(i) + 1]; ++e) {
                int last = -1; // nearly always all columns of a block's entries are of one supernode
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c) {
                        const int j = pattern.column[at(e)];
                        const int k = node_of[at(std::min(place[at(3 * i + r)], place[at(3 * j + c)]))];
                        if (k != last) visit(at(k), Entry{e, i});
                        last = k;
                    }
            }
    };
    entry_start.assign(nodes.size() + 1, 0);
    for_each_entry([&](std::size_t node, const Entry&) { ++entry_start[node + 1]; });
    std::partial_sum(entry_start.begin(), entry_start.end(), entry_start.begin());
    entries.resize(entry_start.back());
    std::vector<std::size_t> next(entry_start.begin(), entry_start.end() - 1);
    for_each_entry([&](std::size_t node, const Entry& entry) { entries[next[node]++] = entry; });
}

/// Cuts the tree of supernodes: what is below piece_share of the operations is one piece, all above goes in order.
void SingleCholesky::Impl::find_pieces() {
    const int count = static_cast<int>(nodes.size());
    std::vector<int> parent(nodes.size(), -1), first(nodes.size());
    std::vector<double> cost(nodes.size());
    double total = 0;
    for (int k = 0; k < count; ++k) {
        const Supernode& s = nodes[at(k)];
        first[at(k)] = k;
        for (int c = 0; c < s.width; ++c) cost[at(k)] += double(s.rows - c) * double(s.rows - c);
        total += cost[at(k)];
    }
    std::vector<int> node_of(unknowns);
    for (int k = 0; k < count; ++k) std::fill_n(node_of.begin() + nodes[at(k)].first, nodes[at(k)].width, k);
    // Children come before their parents, and a subtree's supernodes one after another (postorder).
    for (int k = 0; k < count; ++k) {
        const Supernode& s = nodes[at(k)];
        if (s.rows == s.width) continue;
        const int p = parent[at(k)] = node_of[at(rows[s.row_start + at(s.width)])];
        cost[at(p)] += cost[at(k)];
        first[at(p)] = std::min(first[at(p)], first[at(k)]);
    }
    for (int k = 0; k < count; ++k) {
        const bool small = cost[at(k)] <= piece_share * total;
        if (!small)
            above.push_back(k);
        else if (parent[at(k)] < 0 || cost[at(parent[at(k)])] > piece_share * total)
            pieces.emplace_back(first[at(k)], k + 1);
    }
    // The costliest first, so that threads end together.
    std::stable_sort(pieces.begin(), pieces.end(),
                     [&](const auto& a, const auto& b) { return cost[at(a.second - 1)] > cost[at(b.second - 1)]; });
}

/// Takes what `u` gives to rows first_row…last_row-1 of s off them.
void SingleCholesky::Impl::subtract(const Supernode& s, const Update& u, int first_row, int last_row, Scratch& w) {
    const Supernode& d = nodes[at(u.source)];
    const int* row = rows.data() + d.row_start;
    int from = u.from, to = d.rows;
    if (first_row > 0) {
        const int limit = rows[s.row_start + at(first_row)];
        from = static_cast<int>(std::lower_bound(row + from, row + to, limit) - row);
    }
    if (last_row < s.rows) {
        const int limit = rows[s.row_start + at(last_row)];
        to = static_cast<int>(std::lower_bound(row + from, row + to, limit) - row);
    }
    if (from >= to) return;
    const int columns = u.to - u.from, count = to - from;
    const float one = 1, zero = 0;
    const float* block = values.data() + d.value_start;
    sgemm_("N", "T", &count, &columns, &d.width, &one, block + from, &d.rows, block + u.from, &d.rows, &zero,
           w.product.data(), &count);
    for (int c = 0; c < columns; ++c) {
        const int column = row[u.from + c];
        float* out = values.data() + s.value_start + at(column - s.first) * at(s.rows);
        const float* in = w.product.data() + at(c) * at(count);
        // Only the lower triangle is kept.
        for (int r = std::max(0, u.from + c - from); r < count; ++r) out[w.place[at(row[from + r])]] -= in[r];
    }
}

/// The dense factor of a supernode whose updates are taken off.
bool SingleCholesky::Impl::factor_dense(const Supernode& s, bool in_tiles) {
    float* block = values.data() + s.value_start;
    const float one = 1, minus = -1;
    int info = 0;
    if (!in_tiles) {
        spotrf_("L", &s.width, block, &s.rows, &info);
        const int below = s.rows - s.width;
        if (info == 0 && below > 0)
            strsm_("R", "L", "T", "N", &below, &s.width, &one, block, &s.rows, block + s.width, &s.rows);
        return info == 0;
    }
    for (int k = 0; k < s.width; k += panel) {
        const int width = std::min(panel, s.width - k);
        float* corner = block + at(k) * at(s.rows) + k;
        spotrf_("L", &width, corner, &s.rows, &info);
        if (info != 0) return false;
        const int first = k + width, below = s.rows - first, tiles = (below + tile - 1) / tile;
        const auto rows_of = [&](std::size_t t) { return std::min(tile, below - static_cast<int>(t) * tile); };
        parallel_for(at(tiles), 1, [&](std::size_t t) {
            const OneOpenMpThread guard;
            const int count = rows_of(t);
            strsm_("R", "L", "T", "N", &count, &width, &one, corner, &s.rows, corner + width + t * tile, &s.rows);
        });
        const int right = s.width - first;
        parallel_for(at(right > 0 ? tiles : 0), 1, [&](std::size_t t) {
            const OneOpenMpThread guard;
            const int count = rows_of(t), row = static_cast<int>(t) * tile,
                      columns = std::min(right, row + count); // the lower triangle, to whole tiles
            if (columns > 0)
                sgemm_("N", "T", &count, &columns, &width, &minus, corner + width + row, &s.rows, corner + width,
                       &s.rows, &one, block + at(first) * at(s.rows) + first + row, &s.rows);
        });
    }
    return true;
}

/// The matrix's entries, scaled, in the lower triangle of a supernode.
void SingleCholesky::Impl::take_entries(int node, const BlockView& a, const std::vector<int>& place_in_node) {
    const Supernode& s = nodes[at(node)];
    float* block = values.data() + s.value_start;
    std::fill_n(block, at(s.rows) * at(s.width), 0.0f);
    for (std::size_t e = entry_start[at(node)]; e < entry_start[at(node) + 1]; ++e) {
        const std::size_t i = at(entries[e].row), j = at(a.pattern->column[at(entries[e].block)]);
        const double* from = a.block(at(entries[e].block));
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = i == j ? r : 0; c < 3; ++c) { // of a diagonal block the upper triangle is read
                const auto [low, high] = std::minmax(place[3 * i + r], place[3 * j + c]);
                if (low < s.first || low >= s.first + s.width) continue;
                block[at(low - s.first) * at(s.rows) + at(place_in_node[at(high)])] =
                    static_cast<float>(from[3 * r + c]) * scale[3 * i + r] * scale[3 * j + c];
            }
    }
}

bool SingleCholesky::Impl::make(int node, const BlockView& a, bool in_tiles) {
    const Supernode& s = nodes[at(node)];
    const int* row = rows.data() + s.row_start;
    const std::size_t first = update_start[at(node)], last = update_start[at(node) + 1];
    Scratch& here = scratch.local();
    for (int r = 0; r < s.rows; ++r) here.place[at(row[r])] = r;
    take_entries(node, a, here.place);
    if (in_tiles && cut_into_tiles(s)) {
        parallel_for(at((s.rows + tile - 1) / tile), 1, [&](std::size_t t) {
            const OneOpenMpThread guard;
            Scratch& w = scratch.local();
            const int first_row = static_cast<int>(t) * tile, last_row = std::min(s.rows, first_row + tile);
            for (int r = first_row; r < last_row; ++r) w.place[at(row[r])] = r;
            for (std::size_t u = first; u < last; ++u) subtract(s, updates[u], first_row, last_row, w);
        });
        return factor_dense(s, true);
    }
    for (std::size_t u = first; u < last; ++u) subtract(s, updates[u], 0, s.rows, here);
    return factor_dense(s, false);
}

SingleCholesky::SingleCholesky(const BlockPattern& pattern)
    : impl_(std::make_unique<Impl>(pattern)) {}

SingleCholesky::~SingleCholesky() = default;

void SingleCholesky::release() { std::vector<float>().swap(impl_->values); }

std::size_t SingleCholesky::bytes() const { return impl_->values.capacity() * sizeof(float); }

double SingleCholesky::factor_operations() const { return impl_->operations; }

bool SingleCholesky::factorize(const BlockView& a) {
    Impl& f = *impl_;
    for (std::size_t i = 0; i < f.unknowns; ++i) {
        const double d = a.block(at(a.pattern->row_start[i / 3]))[4 * (i % 3)];
        if (!(d > 0) || !std::isfinite(d)) return false;
        f.scale[i] = static_cast<float>(1 / std::sqrt(d));
    }
    if (!a.finite()) return false;
    f.values.resize(f.value_count);
    std::atomic<bool> good = true;
    parallel_for(f.pieces.size(), 1, [&](std::size_t p) {
        const OneOpenMpThread guard;
        for (int k = f.pieces[p].first; k < f.pieces[p].second && good; ++k)
            if (!f.make(k, a, false)) good = false;
    });
    const OneOpenMpThread guard;
    for (const int k : f.above)
        if (good && !f.make(k, a, true)) good = false;
    return good;
}

void SingleCholesky::solve(const double* b, double* x) {
    Impl& f = *impl_;
    // To the size of 1, so that nothing leaves the range of single precision.
    double largest = 0;
    for (std::size_t i = 0; i < f.unknowns; ++i) largest = std::max(largest, std::abs(b[i]) * f.scale[i]);
    const double unit = largest > 0 && std::isfinite(largest) ? largest : 1;
    for (std::size_t k = 0; k < f.unknowns; ++k) {
        const std::size_t i = at(f.order[k]);
        f.work[k] = static_cast<float>(b[i] * f.scale[i] / unit);
    }
    float *y = f.work.data(), *below = f.below.data();
    const float one = 1, zero = 0, minus = -1;
    const int step = 1;
    for (const Supernode& s : f.nodes) {
        const float* block = f.values.data() + s.value_start;
        strsv_("L", "N", "N", &s.width, block, &s.rows, y + s.first, &step);
        const int count = s.rows - s.width;
        if (count == 0) continue;
        sgemv_("N", &count, &s.width, &one, block + s.width, &s.rows, y + s.first, &step, &zero, below, &step);
        const int* row = f.rows.data() + s.row_start + at(s.width);
        for (int r = 0; r < count; ++r) y[row[r]] -= below[r];
    }
    for (std::size_t k = f.nodes.size(); k-- > 0;) {
        const Supernode& s = f.nodes[k];
        const float* block = f.values.data() + s.value_start;
        const int count = s.rows - s.width;
        const int* row = f.rows.data() + s.row_start + at(s.width);
        for (int r = 0; r < count; ++r) below[r] = y[row[r]];
        if (count > 0)
            sgemv_("T", &count, &s.width, &minus, block + s.width, &s.rows, below, &step, &one, y + s.first, &step);
        strsv_("L", "T", "N", &s.width, block, &s.rows, y + s.first, &step);
    }
    for (std::size_t k = 0; k < f.unknowns; ++k) {
        const std::size_t i = at(f.order[k]);
        x[i] = static_cast<double>(y[k]) * f.scale[i] * unit;
    }
}

} // namespace sinew::solver
