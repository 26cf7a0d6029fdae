// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/block_column.h"

#include "solver/index.h"
#include "solver/linear/float8.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace sinew::solver {

namespace {

constexpr int width = 8;
/// Columns that are at work at once: with two packs of rows, twelve sums stay in registers.
constexpr int most_columns = 6;
/// Products longer than this are taken piece by piece, so that the packed columns stay in the cache.
constexpr int most_packed = 256;

/// Columns first…first+n-1 of the triangle, and what they take off the rows below.
template <int n>
void columns_down(const ShortColumn& l, int first, float* x) {
    const int stride = ShortColumn::stride(l.rows);
    const Short* column[n];
    float y[n];
    for (int c = 0; c < n; ++c) {
        column[c] = l.values + at(first + c) * at(stride);
        y[c] = x[first + c];
        for (int k = 0; k < c; ++k) y[c] -= to_float(column[k][first + c]) * y[k];
        y[c] *= l.inverse_diagonal[first + c];
        x[first + c] = y[c];
    }
    Float8 packed[n];
    for (int c = 0; c < n; ++c) packed[c] = all8(-y[c]);
    const auto taken = [&](int r) {
        Float8 sum = load8(column[0] + r) * packed[0];
        for (int c = 1; c < n; ++c) sum = multiply_add(load8(column[c] + r), packed[c], sum);
        return sum;
    };
    const int before = (first + n) % width; // of the first pack that many rows lie above
    int r = first + n - before;
    if (r < stride) store8(load8(x + r) + lanes_from(taken(r), before), x + r);
    for (r += width; r < stride; r += width) store8(load8(x + r) + taken(r), x + r);
}

template <int n>
void columns_up(const ShortColumn& l, int first, float* x) {
    const int stride = ShortColumn::stride(l.rows);
    const Short* column[n];
    Float8 sums[n];
    for (int c = 0; c < n; ++c) {
        column[c] = l.values + at(first + c) * at(stride);
        sums[c] = Float8{};
    }
    const auto add = [&](int r, Float8 below) {
        for (int c = 0; c < n; ++c) sums[c] = multiply_add(load8(column[c] + r), below, sums[c]);
    };
    const int before = (first + n) % width;
    int r = first + n - before;
    if (r < stride) add(r, lanes_from(load8(x + r), before));
    for (r += width; r < stride; r += width) add(r, load8(x + r));
    for (int c = n - 1; c >= 0; --c) {
        const Float8& s = sums[c];
        float y = x[first + c] - (((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7])));
        for (int k = c + 1; k < n; ++k) y -= to_float(column[c][first + k]) * x[first + k];
        x[first + c] = y * l.inverse_diagonal[first + c];
    }
}

/// n rows of k columns, a pack for each column, so that a product finds what it multiplies by in a row.
template <int n>
void pack(const float* b, int stride, int k, float* packed) {
    for (int i = 0; i < k; ++i) store8(load_first(b + at(i) * at(stride), n), packed + width * i);
}

/// sums[p][c] = rows 8p…8p+7 of A times row c of B, over k columns; of the last pack the first `last` rows alone.
template <int packs, int n, bool whole>
inline void product(const float* a, int stride, const float* packed, int k, int last, Float8 (&sums)[packs][n]) {
    Float8 sum[packs][n] = {}; // of its own, so that it stays in registers
    for (int i = 0; i < k; ++i, a += stride, packed += width) {
        Float8 rows[packs];
        for (int p = 0; p < packs - 1; ++p) rows[p] = load8(a + width * p);
        rows[packs - 1] = whole ? load8(a + width * (packs - 1)) : load_first(a + width * (packs - 1), last);
        for (int c = 0; c < n; ++c) {
            const Float8 b = all8(packed[c]);
            for (int p = 0; p < packs; ++p) sum[p][c] = multiply_add(rows[p], b, sum[p][c]);
        }
    }
    for (int p = 0; p < packs; ++p)
        for (int c = 0; c < n; ++c) sums[p][c] = sum[p][c];
}

/// Calls use(r, packs, last, sums) for all m rows, with twelve sums at a time, or as few as the last rows need.
template <int n, int packs = 12 / n, class Use>
void for_rows(const float* a, int stride, const float* packed, int k, int m, const Use& use, int r = 0) {
    for (; r + width * (packs - 1) < m; r += width * packs) {
        Float8 sums[packs][n];
        const int last = std::min(width, m - r - width * (packs - 1));
        if (last == width)
            product<packs, n, true>(a + r, stride, packed, k, last, sums);
        else
            product<packs, n, false>(a + r, stride, packed, k, last, sums);
        use(r, packs, last, &sums[0]);
    }
    if constexpr (packs > 1) for_rows<n, packs - 1>(a, stride, packed, k, m, use, r);
}

/// Takes what columns 0…first-1 stand for off columns first…first+n-1, and makes those of the factor. Gives the least
/// pivot.
template <int n>
float make_columns(const BlockColumn& l, int first) {
    float* column[n];
    for (int c = 0; c < n; ++c) column[c] = l.values + at(first + c) * at(l.stride);
    alignas(32) float packed[width * most_packed];
    for (int from = 0; from < first; from += most_packed) {
        const int k = std::min(most_packed, first - from);
        const float* earlier = l.values + at(from) * at(l.stride) + first;
        pack<n>(earlier, l.stride, k, packed);
        for_rows<n>(earlier, l.stride, packed, k, l.rows - first,
                    [&](int r, int packs, int last, const Float8(*sums)[n]) {
                        for (int p = 0; p < packs; ++p)
                            for (int c = 0; c < n; ++c) {
                                float* out = column[c] + first + r + width * p;
                                if (p + 1 < packs || last == width)
                                    store8(load8(out) - sums[p][c], out);
                                else
                                    store_first(load_first(out, last) - sums[p][c], out, last);
                            }
                    });
    }
    float least = std::numeric_limits<float>::max();
    float corner[n][n], *inverse = l.inverse_diagonal + first;
    for (int c = 0; c < n; ++c)
        for (int r = c; r < n; ++r) {
            float v = column[c][first + r];
            for (int k = 0; k < c; ++k) v -= corner[k][r] * corner[k][c];
            if (r == c) {
                if (!(v > 0)) return v;
                least = std::min(least, v);
                v = std::sqrt(v);
                inverse[c] = 1 / v;
            } else {
                v *= inverse[c];
            }
            corner[c][r] = column[c][first + r] = v;
        }
    int r = first + n;
    const auto finish = [&](const auto& load, const auto& store) {
        Float8 v[n];
        for (int c = 0; c < n; ++c) {
            v[c] = load(column[c] + r);
            for (int k = 0; k < c; ++k) v[c] = multiply_add(v[k], all8(-corner[k][c]), v[c]);
            v[c] *= inverse[c];
            store(v[c], column[c] + r);
        }
    };
    for (; r + width <= l.rows; r += width)
        finish([](const float* p) { return load8(p); }, [](Float8 v, float* p) { store8(v, p); });
    if (const int last = l.rows - r; last > 0)
        finish([&](const float* p) { return load_first(p, last); },
               [&](Float8 v, float* p) { store_first(v, p, last); });
    return least;
}

template <int n>
void multiply_columns(const float* a, const float* b, int stride, int m, int out_stride, int k, float* out) {
    alignas(32) float packed[width * most_packed];
    for (int from = 0; from < k; from += most_packed) {
        const int count = std::min(most_packed, k - from);
        const std::size_t skipped = at(from) * at(stride);
        pack<n>(b + skipped, stride, count, packed);
        for_rows<n>(a + skipped, stride, packed, count, m, [&](int r, int packs, int last, const Float8(*sums)[n]) {
            for (int p = 0; p < packs; ++p)
                for (int c = 0; c < n; ++c) {
                    float* to = out + at(c) * at(out_stride) + at(r + width * p);
                    const bool whole = p + 1 < packs || last == width;
                    const Float8 sum = from == 0 ? sums[p][c] : sums[p][c] + (whole ? load8(to) : load_first(to, last));
                    if (whole)
                        store8(sum, to);
                    else
                        store_first(sum, to, last);
                }
        });
    }
}

} // namespace

float make_factor(const BlockColumn& l) {
    float least = std::numeric_limits<float>::max();
    for (int first = 0; first < l.columns;) {
        const bool many = first + most_columns <= l.columns;
        const float pivot = many ? make_columns<most_columns>(l, first) : make_columns<3>(l, first);
        if (!(pivot > 0)) return pivot;
        least = std::min(least, pivot);
        first += many ? most_columns : 3;
    }
    return least;
}

void multiply_transposed(const float* a, const float* b, int stride, int m, int n, int k, int above, float* out) {
    int first = 0;
    const auto columns = [&]<int count>(std::integral_constant<int, count>) {
        const int skipped = std::max(0, first - above);
        if (skipped < m)
            multiply_columns<count>(a + skipped, b + first, stride, m - skipped, m, k,
                                    out + at(first) * at(m) + at(skipped));
        first += count;
    };
    while (first + most_columns <= n) columns(std::integral_constant<int, most_columns>());
    while (first < n) columns(std::integral_constant<int, 3>());
}

void shorten(const BlockColumn& l, Short* out) {
    const int stride = ShortColumn::stride(l.rows);
    for (int c = 0; c < l.columns; ++c, out += stride) {
        const float* column = l.values + at(c) * at(l.stride);
        int r = 0;
        for (; r + width <= l.rows; r += width) store8(load8(column + r), out + r);
        if (r < l.rows) store8(load_first(column + r, l.rows - r), out + r);
    }
}

void solve_down(const ShortColumn& l, float* x) {
    int first = 0;
    for (; first + most_columns <= l.columns; first += most_columns) columns_down<most_columns>(l, first, x);
    for (; first < l.columns; first += 3) columns_down<3>(l, first, x);
}

void solve_up(const ShortColumn& l, float* x) {
    int first = l.columns;
    for (; first >= most_columns; first -= most_columns) columns_up<most_columns>(l, first - most_columns, x);
    for (; first > 0; first -= 3) columns_up<3>(l, first - 3, x);
}

} // namespace sinew::solver
