// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/single_cholesky.h"

#include "solver/index.h"
#include "solver/linear/block_column.h"
#include "solver/linear/cholmod_threads.h"
#include "solver/linear/flush_denormals.h"
#include "solver/linear/large_array.h"
#include "solver/linear/row_blocks.h"
#include "solver/linear/supernodes.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <tbb/enumerable_thread_specific.h>

extern "C" {
void sgemm_(const char* transpose_a, const char* transpose_b, const int* m, const int* n, const int* k,
            const float* alpha, const float* a, const int* lda, const float* b, const int* ldb, const float* beta,
            float* c, const int* ldc);
void strsm_(const char* side, const char* triangle, const char* transpose, const char* diagonal, const int* m,
            const int* n, const float* alpha, const float* a, const int* lda, float* b, const int* ldb);
}

namespace sinew::solver {

namespace {

/// Where a factor takes fewer operations than this, it is one piece of work.
constexpr double least_operations = 2e7;
/// While it is made, subtrees of less than this share of all operations are a piece each: the large supernodes above
/// them are made by tiles of rows, side by side as well.
constexpr double made_share = 1.0 / 16;
/// In solves what is above the pieces is one thread's alone. So of these shares, of all numbers, that one is taken with
/// which two threads end first.
constexpr double solved_shares[] = {1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 8, 1.0 / 16};
/// Rows (of blocks) of a large supernode that are one piece of work.
constexpr int tile = 32;
/// Products of more columns, as long as wider than this, are BLAS's.
constexpr int most_own_width = 96, most_own_columns = 48;
/// Columns (of numbers) that are factorised between two updates of the rest of a large supernode.
constexpr int panel = 96;

/// A factor of more bytes than this gives its working memory back once it is made; smaller ones keep it for the next.
constexpr std::size_t large = std::size_t{64} << 20;
/// What rounding may do to a pivot of a matrix of unit diagonal: it is 1 less squares that sum to at most that, of
/// which there are up to some ten thousand.
constexpr float rounding = 1e-3f;

/// Whether a supernode above the pieces is made by tiles of rows side by side.
bool cut_into_tiles(const Supernode& s) { return s.rows > 2 * tile; }

/// What an earlier supernode takes off a later one: its rows from `from` on times those from `from` to `to`, which are
/// columns of the later one.
struct Update {
    int source, from, to;
};

/// Numbers that the rows of a supernode and a row of four after them take.
int room(int rows) { return ShortColumn::stride(3 * rows) + 4; }
/// Rows of the right side are three numbers and a zero, which go from and to memory as a whole. Here they stand one
/// after another, three numbers each; the fourth goes where the next row will come.
void put_row(Float4 row, float* p) { std::memcpy(p, &row, sizeof row); }
Float4 take_row(const float* p) {
    typedef std::int32_t Mask __attribute__((vector_size(16)));
    Float4 row;
    std::memcpy(&row, p, sizeof row);
    return (Float4)((Mask)row & Mask{-1, -1, -1, 0});
}

/// Rows of a product, and as many of a supernode from `place` on, that they are taken off.
struct Run {
    int row, place, count;
};

struct Scratch {
    std::vector<float> product;
    std::vector<Run> runs;
    std::vector<int> place; ///< of each row in the supernode at work
};

/// A subtree: supernodes first…last-1, of which the last is the root.
struct Subtree {
    int first, last;
    double cost;
};

/// The tree of supernodes in pieces, the costliest first, so that threads end together; what is above them goes in
/// order.
struct Cut {
    std::vector<Subtree> pieces;
    std::vector<int> above; ///< supernodes, ascending
    double above_cost = 0;
};

/// What a solve needs for a piece.
struct SolvedPiece {
    int end;                   ///< one past its last row of the factor
    std::vector<float> x;      ///< the right side at one supernode's rows
    std::vector<Float4> above; ///< what it takes off the right side above the pieces
};

} // namespace

struct SingleCholesky::Impl {
    Supernodes tree;
    std::vector<std::size_t> update_start;
    std::vector<Update> updates;
    std::vector<int> place; ///< of each row of the matrix in the factor
    /// A block of the matrix that lies in a supernode's columns, and its row.
    struct Entry {
        int block, row;
    };
    std::vector<std::size_t> entry_start; ///< per supernode and one past the end
    std::vector<Entry> entries;
    Cut made, solved;          ///< for the factor, and for solves with it
    std::vector<float> pivots; ///< per piece of `made`: the first that was not above zero, else one that was
    std::vector<SolvedPiece> solved_pieces;
    std::vector<int> above_place; ///< of each row of the factor among those of solved.above

    std::shared_ptr<LargeArray<float>> memory =
        std::make_shared<LargeArray<float>>(); ///< of the numbers, while it is made
    float* values = nullptr;                   ///< in it
    LargeArray<Short> kept;                    ///< for solves
    std::vector<std::size_t> kept_start;       ///< per supernode and one past the end
    std::vector<float> inverse_diagonal, scale, x;
    std::vector<Float4> work; ///< the right side, then the solution
    bool surely_indefinite = false;
    tbb::enumerable_thread_specific<Scratch> scratch;

    explicit Impl(const BlockPattern& pattern);
    std::vector<int> nodes_of_rows() const;
    void find_updates();
    void find_entries(const BlockPattern& pattern);
    Cut cut_tree(const std::vector<int>& parent, const std::vector<double>& cost, double share) const;
    void find_pieces();
    std::size_t largest_product() const;
    void take_entries(int node, const BlockView& a);
    float make(int node, bool in_tiles);
    void keep_for_solves(int node);
    float factor_dense(const Supernode& s, bool in_tiles);
    void subtract(const Supernode& s, const Update& u, int first_row, int last_row, Scratch& w);
    BlockColumn column(const Supernode& s);
    ShortColumn kept_column(int node) const;
    void down(int node, float* own, SolvedPiece* piece);
    void up(int node, float* own);
};

SingleCholesky::Impl::Impl(const BlockPattern& pattern)
    : tree(find_supernodes(pattern)) {
    const std::size_t unknowns = 3 * at(pattern.rows);
    for (auto* v : {&inverse_diagonal, &scale}) v->resize(unknowns);
    work.resize(at(pattern.rows));
    kept_start = {0};
    for (const Supernode& s : tree.nodes)
        kept_start.push_back(kept_start.back() + at(ShortColumn::stride(3 * s.rows)) * 3 * at(s.width));
    find_updates();
    find_entries(pattern);
    find_pieces();
    scratch = tbb::enumerable_thread_specific<Scratch>([rows = at(pattern.rows), largest = largest_product()] {
        Scratch w{std::vector<float>(largest), {}, std::vector<int>(rows)};
        w.runs.reserve(rows);
        return w;
    });
}

std::vector<int> SingleCholesky::Impl::nodes_of_rows() const {
    std::vector<int> out(tree.order.size());
    for (std::size_t k = 0; k < tree.nodes.size(); ++k)
        std::fill_n(out.begin() + tree.nodes[k].first, tree.nodes[k].width, static_cast<int>(k));
    return out;
}

/// Numbers of the largest product that `subtract` makes, so that no step has to allocate.
std::size_t SingleCholesky::Impl::largest_product() const {
    std::vector<char> in_tiles(tree.nodes.size(), 0);
    for (const int k : made.above) in_tiles[at(k)] = cut_into_tiles(tree.nodes[at(k)]);
    std::size_t largest = 0;
    for (std::size_t k = 0; k < tree.nodes.size(); ++k)
        for (std::size_t u = update_start[k]; u < update_start[k + 1]; ++u) {
            const int count = tree.nodes[at(updates[u].source)].rows - updates[u].from;
            largest = std::max(largest, 9 * at(in_tiles[k] ? std::min(count, tile) : count) *
                                            at(updates[u].to - updates[u].from));
        }
    return largest;
}

void SingleCholesky::Impl::find_updates() {
    const std::vector<int> node_of = nodes_of_rows();
    std::vector<std::vector<Update>> of(tree.nodes.size());
    for (std::size_t k = 0; k < tree.nodes.size(); ++k) {
        const Supernode& s = tree.nodes[k];
        const int* row = tree.rows.data() + s.row_start;
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
    const std::vector<int> node_of = nodes_of_rows();
    place.resize(at(pattern.rows));
    for (std::size_t k = 0; k < place.size(); ++k) place[at(tree.order[k])] = static_cast<int>(k);
    // Counted, then filled, so that nothing is held twice.
    const auto for_each_entry = [&](const auto& visit) {
        for (int i = 0; i < pattern.rows; ++i)
            for (int e = pattern.row_start[at(i)]; e < pattern.row_start[at(i) + 1]; ++e) {
                const int low = std::min(place[at(i)], place[at(pattern.column[at(e)])]);
                visit(at(node_of[at(low)]), Entry{e, i});
            }
    };
    entry_start.assign(tree.nodes.size() + 1, 0);
    for_each_entry([&](std::size_t node, const Entry&) { ++entry_start[node + 1]; });
    std::partial_sum(entry_start.begin(), entry_start.end(), entry_start.begin());
    entries.resize(entry_start.back());
    std::vector<std::size_t> next(entry_start.begin(), entry_start.end() - 1);
    for_each_entry([&](std::size_t node, const Entry& entry) { entries[next[node]++] = entry; });
}

/// Cuts the tree where a subtree costs more than a share of all; `parent` of a root is -1, `cost` each supernode's own.
Cut SingleCholesky::Impl::cut_tree(const std::vector<int>& parent, const std::vector<double>& cost,
                                   double share) const {
    const int count = static_cast<int>(tree.nodes.size());
    std::vector<int> first(tree.nodes.size());
    std::vector<double> whole = cost; // with all below it
    std::iota(first.begin(), first.end(), 0);
    // Children come before their parents, and a subtree's supernodes one after another (postorder).
    for (int k = 0; k < count; ++k) {
        const int p = parent[at(k)];
        if (p < 0) continue;
        whole[at(p)] += whole[at(k)];
        first[at(p)] = std::min(first[at(p)], first[at(k)]);
    }
    const double total = std::accumulate(cost.begin(), cost.end(), 0.0);
    const double most = tree.operations < least_operations ? total : share * total;
    Cut out;
    for (int k = 0; k < count; ++k) {
        if (!(whole[at(k)] <= most))
            out.above.push_back(k), out.above_cost += cost[at(k)];
        else if (parent[at(k)] < 0 || !(whole[at(parent[at(k)])] <= most))
            out.pieces.push_back({first[at(k)], k + 1, whole[at(k)]});
    }
    std::stable_sort(out.pieces.begin(), out.pieces.end(),
                     [](const Subtree& a, const Subtree& b) { return a.cost > b.cost; });
    return out;
}

/// What two threads take, each a piece after another.
double time_of_two(const Cut& cut) {
    double one = 0, other = 0;
    for (const Subtree& piece : cut.pieces) (one <= other ? one : other) += piece.cost;
    return std::max(one, other) + cut.above_cost;
}

void SingleCholesky::Impl::find_pieces() {
    const std::vector<int> node_of = nodes_of_rows();
    std::vector<int> parent(tree.nodes.size(), -1);
    std::vector<double> operations(tree.nodes.size()), numbers(tree.nodes.size());
    for (std::size_t k = 0; k < tree.nodes.size(); ++k) {
        const Supernode& s = tree.nodes[k];
        if (s.rows > s.width) parent[k] = node_of[at(tree.rows[s.row_start + at(s.width)])];
        for (int c = 0; c < s.width; ++c) operations[k] += double(s.rows - c) * double(s.rows - c);
        numbers[k] = double(s.rows) * double(s.width);
    }
    made = cut_tree(parent, operations, made_share);
    pivots.resize(made.pieces.size());
    double least = std::numeric_limits<double>::infinity();
    for (const double share : solved_shares) {
        Cut cut = cut_tree(parent, numbers, share);
        if (const double time = time_of_two(cut); time < least) least = time, solved = std::move(cut);
    }
    int rows_above = 0;
    above_place.assign(tree.order.size(), -1);
    for (const int k : solved.above)
        for (int c = 0; c < tree.nodes[at(k)].width; ++c) above_place[at(tree.nodes[at(k)].first + c)] = rows_above++;
    for (const Subtree& piece : solved.pieces) {
        int most_rows = 0;
        for (int k = piece.first; k < piece.last; ++k) most_rows = std::max(most_rows, tree.nodes[at(k)].rows);
        const Supernode& root = tree.nodes[at(piece.last - 1)];
        solved_pieces.push_back(
            {root.first + root.width, std::vector<float>(at(room(most_rows))), std::vector<Float4>(at(rows_above))});
    }
    x.resize(at(room(tree.most_rows)));
}

/// Takes what `u` gives to rows first_row…last_row-1 of s off them.
void SingleCholesky::Impl::subtract(const Supernode& s, const Update& u, int first_row, int last_row, Scratch& w) {
    const Supernode& d = tree.nodes[at(u.source)];
    const int* row = tree.rows.data() + d.row_start;
    int from = u.from, to = d.rows;
    if (first_row > 0) {
        const int limit = tree.rows[s.row_start + at(first_row)];
        from = static_cast<int>(std::lower_bound(row + from, row + to, limit) - row);
    }
    if (last_row < s.rows) {
        const int limit = tree.rows[s.row_start + at(last_row)];
        to = static_cast<int>(std::lower_bound(row + from, row + to, limit) - row);
    }
    if (from >= to) return;
    const int columns = 3 * (std::min(u.to, to) - u.from), count = 3 * (to - from), width = 3 * d.width,
              stride = 3 * d.rows;
    const float* block = values + d.value_start;
    if (width > most_own_width && columns > most_own_columns) {
        const float one = 1, zero = 0;
        sgemm_("N", "T", &count, &columns, &width, &one, block + 3 * from, &stride, block + 3 * u.from, &stride, &zero,
               w.product.data(), &count);
    } else {
        multiply_transposed(block + 3 * from, block + 3 * u.from, stride, count, columns, width, 3 * (from - u.from),
                            w.product.data());
    }
    // Rows that follow each other in both go together.
    w.runs.clear();
    for (int r = 0; r < to - from; ++r) {
        const int p = w.place[at(row[from + r])];
        if (!w.runs.empty() && p == w.runs.back().place + w.runs.back().count)
            ++w.runs.back().count;
        else
            w.runs.push_back({r, p, 1});
    }
    for (int c = 0; c < columns; ++c) {
        const int column = 3 * (row[u.from + c / 3] - s.first) + c % 3;
        float* out = values + s.value_start + at(column) * 3 * at(s.rows);
        const float* in = w.product.data() + at(c) * at(count);
        const int first = u.from + c / 3 - from; // the lower triangle alone
        for (const Run& run : w.runs) {
            const int skipped = std::max(0, first - run.row);
            float* o = out + 3 * run.place;
            const float* p = in + 3 * run.row;
            for (int n = 3 * skipped; n < 3 * run.count; ++n) o[n] -= p[n];
        }
    }
}

/// The dense factor of a supernode whose updates are taken off. Gives the least pivot, as make_factor does.
float SingleCholesky::Impl::factor_dense(const Supernode& s, bool in_tiles) {
    if (!in_tiles) return make_factor(column(s));
    float* block = values + s.value_start;
    float least = std::numeric_limits<float>::max();
    const float one = 1, minus = -1;
    const int columns = 3 * s.width, rows = 3 * s.rows;
    for (int k = 0; k < columns; k += panel) {
        const int width = std::min(panel, columns - k);
        float* corner = block + at(k) * at(rows) + k;
        const float pivot = make_factor({corner, inverse_diagonal.data() + 3 * s.first + k, width, width, rows});
        if (!(pivot > 0)) return pivot;
        least = std::min(least, pivot);
        const int first = k + width, below = rows - first, tiles = (below + 3 * tile - 1) / (3 * tile);
        const auto rows_of = [&](std::size_t t) { return std::min(3 * tile, below - static_cast<int>(t) * 3 * tile); };
        parallel_for(at(tiles), 1, [&](std::size_t t) {
            const OneOpenMpThread guard;
            const FlushDenormals flush;
            const int count = rows_of(t);
            strsm_("R", "L", "T", "N", &count, &width, &one, corner, &rows, corner + width + t * 3 * tile, &rows);
        });
        const int right = columns - first;
        parallel_for(at(right > 0 ? tiles : 0), 1, [&](std::size_t t) {
            const OneOpenMpThread guard;
            const FlushDenormals flush;
            const int count = rows_of(t), row = static_cast<int>(t) * 3 * tile,
                      wide = std::min(right, row + count); // the lower triangle, to whole tiles
            if (wide > 0)
                sgemm_("N", "T", &count, &wide, &width, &minus, corner + width + row, &rows, corner + width, &rows,
                       &one, block + at(first) * at(rows) + first + row, &rows);
        });
    }
    return least;
}

/// The matrix's entries, scaled, in the lower triangle of a supernode.
void SingleCholesky::Impl::take_entries(int node, const BlockView& a) {
    const Supernode& s = tree.nodes[at(node)];
    std::vector<int>& place_in_node = scratch.local().place;
    for (int r = 0; r < s.rows; ++r) place_in_node[at(tree.rows[s.row_start + at(r)])] = r;
    const std::size_t stride = 3 * at(s.rows);
    float* block = values + s.value_start;
    std::fill_n(block, stride * 3 * at(s.width), 0.0f);
    for (std::size_t e = entry_start[at(node)]; e < entry_start[at(node) + 1]; ++e) {
        const int i = entries[e].row, j = a.pattern->column[at(entries[e].block)];
        const std::size_t from = at(entries[e].block);
        const float *scale_i = scale.data() + 3 * i, *scale_j = scale.data() + 3 * j;
        const auto entry = [&](std::size_t r, std::size_t c) {
            return static_cast<float>(a.number(from, 3 * r + c)) * scale_i[r] * scale_j[c];
        };
        const auto [low, high] = std::minmax(place[at(i)], place[at(j)]);
        float* out = block + 3 * at(low - s.first) * stride + 3 * at(place_in_node[at(high)]);
        const bool transposed = low == place[at(i)]; // rows of the factor's block are columns of the matrix's
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t c = i == j ? r : 0; c < 3; ++c) // of a diagonal block the upper triangle is read
                out[transposed ? r * stride + c : c * stride + r] = entry(r, c);
    }
}

/// The columns of one supernode, which has its entries; the least pivot.
float SingleCholesky::Impl::make(int node, bool in_tiles) {
    const Supernode& s = tree.nodes[at(node)];
    const int* row = tree.rows.data() + s.row_start;
    const std::size_t first = update_start[at(node)], last = update_start[at(node) + 1];
    if (in_tiles && cut_into_tiles(s)) {
        parallel_for(at((s.rows + tile - 1) / tile), 1, [&](std::size_t t) {
            const OneOpenMpThread guard;
            const FlushDenormals flush;
            Scratch& w = scratch.local();
            const int first_row = static_cast<int>(t) * tile, last_row = std::min(s.rows, first_row + tile);
            for (int r = first_row; r < last_row; ++r) w.place[at(row[r])] = r;
            for (std::size_t u = first; u < last; ++u) subtract(s, updates[u], first_row, last_row, w);
        });
    } else {
        in_tiles = false;
        Scratch& here = scratch.local();
        for (int r = 0; r < s.rows; ++r) here.place[at(row[r])] = r;
        for (std::size_t u = first; u < last; ++u) subtract(s, updates[u], 0, s.rows, here);
    }
    return factor_dense(s, in_tiles);
}

void SingleCholesky::Impl::keep_for_solves(int node) {
    shorten(column(tree.nodes[at(node)]), kept.data() + kept_start[at(node)]);
}

BlockColumn SingleCholesky::Impl::column(const Supernode& s) {
    return {values + s.value_start, inverse_diagonal.data() + 3 * s.first, 3 * s.rows, 3 * s.width, 3 * s.rows};
}

ShortColumn SingleCholesky::Impl::kept_column(int node) const {
    const Supernode& s = tree.nodes[at(node)];
    return {kept.data() + kept_start[at(node)], inverse_diagonal.data() + 3 * s.first, 3 * s.rows, 3 * s.width};
}

/// Solves for a supernode's columns; what they take off rows above the piece (null: s is above itself) is kept there.
void SingleCholesky::Impl::down(int node, float* own, SolvedPiece* piece) {
    const Supernode& s = tree.nodes[at(node)];
    for (int c = 0; c < s.width; ++c) put_row(work[at(s.first + c)], own + 3 * c);
    std::fill(own + 3 * s.width, own + ShortColumn::stride(3 * s.rows), 0.0f);
    solve_down(kept_column(node), own);
    for (int c = 0; c < s.width; ++c) work[at(s.first + c)] = take_row(own + 3 * c);
    const int* row = tree.rows.data() + s.row_start;
    const int end = piece ? piece->end : static_cast<int>(tree.order.size());
    int r = s.width;
    for (; r < s.rows && row[r] < end; ++r) work[at(row[r])] += take_row(own + 3 * r);
    for (; r < s.rows; ++r) piece->above[at(above_place[at(row[r])])] += take_row(own + 3 * r);
}

void SingleCholesky::Impl::up(int node, float* own) {
    const Supernode& s = tree.nodes[at(node)];
    const int* row = tree.rows.data() + s.row_start;
    for (int r = 0; r < s.rows; ++r) put_row(work[at(row[r])], own + 3 * r);
    std::fill(own + 3 * s.rows, own + ShortColumn::stride(3 * s.rows), 0.0f);
    solve_up(kept_column(node), own);
    for (int c = 0; c < s.width; ++c) work[at(s.first + c)] = take_row(own + 3 * c);
}

SingleCholesky::SingleCholesky(const BlockPattern& pattern)
    : impl_(std::make_unique<Impl>(pattern)) {}

SingleCholesky::~SingleCholesky() = default;

void SingleCholesky::release() {
    impl_->memory->release();
    impl_->kept.release();
}

bool SingleCholesky::surely_indefinite() const { return impl_->surely_indefinite; }

std::size_t SingleCholesky::bytes() const {
    return impl_->memory->capacity() * sizeof(float) + impl_->kept.capacity() * sizeof(Short);
}

std::size_t SingleCholesky::working_bytes() const { return impl_->tree.value_count * sizeof(float); }

void SingleCholesky::share_memory(const SingleCholesky& other) { impl_->memory = other.impl_->memory; }

double SingleCholesky::factor_operations() const { return impl_->tree.operations; }

bool SingleCholesky::factorize(const BlockView& a) {
    Impl& f = *impl_;
    f.surely_indefinite = false;
    for (std::size_t i = 0; i < f.scale.size(); ++i) {
        const double d = a.number(at(a.pattern->row_start[i / 3]), 4 * (i % 3));
        if (!(d > 0) || !std::isfinite(d)) {
            f.surely_indefinite = d <= 0;
            return false;
        }
        f.scale[i] = static_cast<float>(1 / std::sqrt(d));
    }
    if (!a.finite()) return false;
    f.memory->resize(f.tree.value_count), f.kept.resize(f.kept_start.back());
    f.values = f.memory->data();
    const std::vector<int>& above = f.made.above;
    // What is above the pieces waits for them, but not to be filled in and put away.
    parallel_for(f.made.pieces.size() + above.size(), 1, [&](std::size_t p) {
        const OneOpenMpThread guard;
        const FlushDenormals flush;
        if (p >= f.made.pieces.size()) return f.take_entries(above[p - f.made.pieces.size()], a);
        const Subtree& piece = f.made.pieces[p];
        f.pivots[p] = 1;
        // What other pieces find does not count: what is found must not depend on which comes first.
        for (int k = piece.first; k < piece.last && f.pivots[p] > 0; ++k) {
            f.take_entries(k, a);
            f.pivots[p] = f.make(k, false);
            if (f.pivots[p] > 0) f.keep_for_solves(k);
        }
    });
    bool good = true;
    for (const float pivot : f.pivots) {
        good = good && pivot > 0;
        f.surely_indefinite = f.surely_indefinite || pivot < -rounding;
    }
    const OneOpenMpThread guard;
    const FlushDenormals flush;
    for (std::size_t k = 0; k < above.size() && good; ++k) {
        const float pivot = f.make(above[k], true);
        good = pivot > 0;
        f.surely_indefinite = pivot < -rounding;
    }
    parallel_for(good ? above.size() : 0, 1, [&](std::size_t k) {
        const FlushDenormals flush;
        f.keep_for_solves(above[k]);
    });
    if (working_bytes() > large) f.memory->release();
    return good;
}

void SingleCholesky::solve(const double* b, double* x) {
    Impl& f = *impl_;
    // To the size of 1, so that nothing leaves the range of single precision.
    double largest = 0;
    for (std::size_t i = 0; i < f.scale.size(); ++i) largest = std::max(largest, std::abs(b[i]) * f.scale[i]);
    const double unit = largest > 0 && std::isfinite(largest) ? largest : 1;
    for (std::size_t k = 0; k < f.work.size(); ++k) {
        const std::size_t i = 3 * at(f.tree.order[k]);
        Float4 row{};
        for (std::size_t c = 0; c < 3; ++c) row[c] = static_cast<float>(b[i + c] * f.scale[i + c] / unit);
        f.work[k] = row;
    }
    const FlushDenormals flush;
    const std::vector<Supernode>& nodes = f.tree.nodes;
    parallel_for(f.solved_pieces.size(), 1, [&](std::size_t p) {
        const FlushDenormals flush;
        SolvedPiece& piece = f.solved_pieces[p];
        std::ranges::fill(piece.above, Float4{});
        for (int k = f.solved.pieces[p].first; k < f.solved.pieces[p].last; ++k) f.down(k, piece.x.data(), &piece);
    });
    for (std::size_t p = 0; p < f.solved_pieces.size(); ++p) {
        const Supernode& root = nodes[at(f.solved.pieces[p].last - 1)]; // no other has rows that it has not
        for (int r = root.width; r < root.rows; ++r) {
            const int row = f.tree.rows[root.row_start + at(r)];
            f.work[at(row)] += f.solved_pieces[p].above[at(f.above_place[at(row)])];
        }
    }
    const std::vector<int>& above = f.solved.above;
    for (const int k : above) f.down(k, f.x.data(), nullptr);
    for (std::size_t k = above.size(); k-- > 0;) f.up(above[k], f.x.data());
    parallel_for(f.solved_pieces.size(), 1, [&](std::size_t p) {
        const FlushDenormals flush;
        float* own = f.solved_pieces[p].x.data();
        for (int k = f.solved.pieces[p].last; k-- > f.solved.pieces[p].first;) f.up(k, own);
    });
    for (std::size_t k = 0; k < f.work.size(); ++k)
        for (std::size_t c = 0, i = 3 * at(f.tree.order[k]); c < 3; ++c)
            x[i + c] = static_cast<double>(f.work[k][c]) * f.scale[i + c] * unit;
}

} // namespace sinew::solver
