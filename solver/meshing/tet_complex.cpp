// Tets that come and go.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/meshing/tet_complex.h"

#include "solver/index.h"

#include <algorithm>

namespace sinew::solver {
namespace {

/// The two other corners (c, d) of a tet, such that (a, b, c, d) is positively oriented.
std::array<int, 2> across(const Tet& t, int a, int b) {
    std::array<std::size_t, 4> p{};
    std::size_t k = 2;
    for (std::size_t i = 0; i < 4; ++i)
        if (t[i] == a)
            p[0] = i;
        else if (t[i] == b)
            p[1] = i;
        else
            p[k++] = i;
    int swaps = 0; // parity of the permutation p
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) swaps += p[i] > p[j];
    if (swaps % 2) std::swap(p[2], p[3]);
    return {t[p[2]], t[p[3]]};
}

} // namespace

TetComplex::TetComplex(Points points, std::vector<Tet> tets)
    : vertices(std::move(points))
    , tets_of(vertices.size())
    , tets_(std::move(tets))
    , alive_(tets_.size(), 1) {
    for (std::size_t t = 0; t < tets_.size(); ++t)
        for (const int v : tets_[t]) tets_of[at(v)].push_back(static_cast<int>(t));
}

std::vector<Tet> TetComplex::living() const {
    std::vector<Tet> out;
    for (std::size_t t = 0; t < tets_.size(); ++t)
        if (alive_[t]) out.push_back(tets_[t]);
    return out;
}

int TetComplex::add_vertex(const Vec3& p) {
    vertices.push_back(p);
    tets_of.emplace_back();
    return static_cast<int>(vertices.size()) - 1;
}

void TetComplex::drop_last_vertex() {
    vertices.pop_back();
    tets_of.pop_back();
}

std::vector<int> TetComplex::replace(const std::vector<int>& old, const std::vector<Tet>& fresh) {
    for (const int t : old) {
        alive_[at(t)] = 0;
        for (const int v : tet(t)) std::erase(tets_of[at(v)], t);
    }
    std::vector<int> numbers;
    for (const Tet& t : fresh) {
        numbers.push_back(static_cast<int>(tets_.size()));
        tets_.push_back(t);
        alive_.push_back(1);
        for (const int v : t) tets_of[at(v)].push_back(numbers.back());
    }
    return numbers;
}

std::optional<TetComplex::Ring> TetComplex::ring_of(int a, int b) const {
    Ring ring{a, b, {}, {}};
    std::vector<std::array<int, 2>> steps;
    const bool from_a = tets_of[at(a)].size() <= tets_of[at(b)].size();
    for (const int t : tets_of[at(from_a ? a : b)]) {
        if (!has_corner(tet(t), from_a ? b : a)) continue;
        ring.tets.push_back(t);
        steps.push_back(across(tet(t), a, b));
    }
    if (steps.size() < 3 || steps.size() > longest_ring) return std::nullopt;
    int v = steps.front()[0];
    do {
        ring.vertices.push_back(v);
        const auto next = std::find_if(steps.begin(), steps.end(), [&](const auto& s) { return s[0] == v; });
        if (next == steps.end()) return std::nullopt; // the ring is open: a boundary edge
        v = (*next)[1];
    } while (v != steps.front()[0] && ring.vertices.size() <= steps.size());
    if (ring.vertices.size() != steps.size()) return std::nullopt;
    return ring;
}

int TetComplex::beside(int t, int a, int b, int c) const {
    for (const int s : tets_of[at(a)])
        if (s != t && has_corner(tet(s), b) && has_corner(tet(s), c)) return s;
    return -1;
}

bool TetComplex::has_edge(int a, int b) const {
    return std::any_of(tets_of[at(a)].begin(), tets_of[at(a)].end(), [&](int t) { return has_corner(tet(t), b); });
}

bool TetComplex::has_face(int a, int b, int c) const { return beside(-1, a, b, c) >= 0; }

} // namespace sinew::solver
