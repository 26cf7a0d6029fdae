// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/flesh.h"

#include "solver/mesh/closest_point.h"
#include "solver/parallel.h"

#include <algorithm>
#include <cmath>

namespace sinew::viewer {

using solver::Vec3;
using Weights = std::array<double, 4>;

namespace {

constexpr Weights middle_weights{0.25, 0.25, 0.25, 0.25};

Vec3 point(const Coordinates& c, int v) {
    const auto i = 3 * static_cast<std::size_t>(v);
    return {static_cast<double>(c[i]), static_cast<double>(c[i + 1]), static_cast<double>(c[i + 2])};
}

/// Points spread through a tet, none of them on its faces.
std::vector<Weights> make_samples() {
    constexpr int n = 4;
    std::vector<Weights> out;
    for (int a = 0; a <= n; ++a)
        for (int b = 0; a + b <= n; ++b)
            for (int c = 0; a + b + c <= n; ++c) {
                const int parts[4] = {a, b, c, n - a - b - c};
                Weights& w = out.emplace_back();
                for (std::size_t k = 0; k < 4; ++k) w[k] = (parts[k] + 0.25) / (n + 1);
            }
    return out;
}

class Flesh {
  public:
    Flesh(const ViewBody& body, std::vector<solver::Triangle> triangles)
        : body_(body)
        , triangles_(std::move(triangles))
        , surface_(points_of(body), triangles_) {}

    bool holds(const Vec3& p) const { return surface_.inside(p); }
    /// Points that lie together, faster than one by one.
    std::vector<bool> hold(const solver::Points& points) const {
        const std::vector<double> windings = surface_.winding_numbers(points);
        std::vector<bool> out;
        for (const double w : windings) out.push_back(w > 0.5);
        return out;
    }

    /// The vertices beside the flesh, on its skin.
    std::vector<ViewSkinPoint> skin() const {
        const Coordinates& rest = body_.lattice->rest;
        std::vector<solver::ClosestPoint> near(rest.size() / 3); // triangle -1: in the flesh
        solver::parallel_for(near.size(), 64, [&](std::size_t v) {
            const Vec3 p = point(rest, static_cast<int>(v));
            if (!holds(p)) near[v] = surface_.closest(p);
        });
        std::vector<ViewSkinPoint> out;
        for (std::size_t v = 0; v < near.size(); ++v) {
            if (near[v].triangle < 0) continue;
            ViewSkinPoint& s = out.emplace_back();
            s.vertex = static_cast<int>(v);
            s.host = triangles_[static_cast<std::size_t>(near[v].triangle)];
            for (std::size_t k = 0; k < 3; ++k)
                s.weights[k] = static_cast<float>(near[v].barycentric[static_cast<int>(k)]);
        }
        return out;
    }

    /// The middle of what a tet holds of the flesh, as weights of its vertices; false if it holds nothing.
    bool middle(const std::array<Vec3, 4>& tet, Weights& found) const {
        found = middle_weights;
        if (holds(at(tet, found))) return true;
        static const std::vector<Weights> samples = make_samples();
        solver::Points places;
        for (const Weights& w : samples) places.push_back(at(tet, w));
        const std::vector<bool> held = hold(places);
        std::vector<const Weights*> inside;
        Vec3 mean = Vec3::Zero();
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (held[i]) inside.push_back(&samples[i]), mean += places[i];
        if (inside.empty()) return on_skin(tet, found);
        mean /= static_cast<double>(inside.size());
        found = **std::min_element(inside.begin(), inside.end(), [&](const Weights* a, const Weights* b) {
            return (at(tet, *a) - mean).squaredNorm() < (at(tet, *b) - mean).squaredNorm();
        });
        return true;
    }

    /// How far one may go from `start` by -`step` and by `step` without leaving the flesh by more than `nearly`:
    /// shares.
    std::array<double, 2> ways(const Vec3& start, const Vec3& step, double nearly) const {
        if (surface_.closest(start, step.norm()).triangle < 0) return {1, 1}; // the skin is farther away than that
        constexpr std::size_t parts = 6;
        solver::Points places;
        for (const double sign : {-1.0, 1.0})
            for (std::size_t k = 1; k <= parts; ++k)
                places.push_back(start + step * (sign * static_cast<double>(k) / parts));
        const std::vector<bool> held = hold(places);
        std::array<double, 2> out{1, 1};
        for (std::size_t side = 0; side < 2; ++side)
            for (std::size_t k = 0; k < parts; ++k) {
                const std::size_t i = side * parts + k;
                if (held[i] || surface_.closest(places[i], nearly).triangle >= 0) continue;
                out[side] = static_cast<double>(k) / parts;
                break;
            }
        return out;
    }

    static Vec3 at(const std::array<Vec3, 4>& tet, const Weights& w) {
        return w[0] * tet[0] + w[1] * tet[1] + w[2] * tet[2] + w[3] * tet[3];
    }

  private:
    const ViewBody& body_;
    std::vector<solver::Triangle> triangles_;
    solver::SurfaceTree surface_;

    static solver::Points points_of(const ViewBody& body) {
        solver::Points out;
        for (int v = 0; v < static_cast<int>(body.vertex_count()); ++v) out.push_back(point(body.rest, v));
        return out;
    }

    /// Flesh thinner than the samples lie apart: the place of the skin next to the tet's middle, if it lies in the tet.
    bool on_skin(const std::array<Vec3, 4>& tet, Weights& found) const {
        const solver::ClosestPoint near = surface_.closest(at(tet, middle_weights));
        solver::Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = tet[static_cast<std::size_t>(k) + 1] - tet[0];
        if (near.triangle < 0 || edges.determinant() == 0) return false;
        const Vec3 w = edges.inverse() * (near.point - tet[0]);
        found = {1 - w.sum(), w[0], w[1], w[2]};
        return std::all_of(found.begin(), found.end(), [](double x) { return x >= 0; });
    }
};

/// Half the length of a fibre's line at rest: less than half a tet, less where few fibres are painted.
double half_length(double volume, float weight) {
    return 0.42 * std::cbrt(volume) * (0.4 + 0.6 * static_cast<double>(weight));
}

/// Where a fibre's line lies in its tet, and how long it is.
struct Line {
    bool is_there = true;
    Weights centre = middle_weights;
    std::array<double, 2> reach{};
};

/// `flesh` is null for open surfaces.
Line line_of(const ViewLattice& lattice, const ViewFibres& fibres, std::size_t i, const Flesh* flesh) {
    Line out;
    std::array<Vec3, 4> tet;
    for (std::size_t k = 0; k < 4; ++k)
        tet[k] = point(lattice.rest, lattice.tets[static_cast<std::size_t>(fibres.tets[i])][k]);
    out.is_there = !flesh || flesh->middle(tet, out.centre);
    if (!out.is_there) return out;
    const double volume = std::abs((tet[1] - tet[0]).cross(tet[2] - tet[0]).dot(tet[3] - tet[0])) / 6;
    const double half = half_length(volume, fibres.weights[i]), nearly = 0.02 * std::cbrt(volume);
    const Vec3 step = half * point(fibres.directions, static_cast<int>(i));
    out.reach = flesh ? flesh->ways(Flesh::at(tet, out.centre), step, nearly) : std::array<double, 2>{1, 1};
    for (double& way : out.reach) way *= half;
    return out;
}

ViewFibres kept(const ViewLattice& lattice, const ViewFibres& all, const Flesh* flesh) {
    std::vector<Line> lines(all.tets.size());
    solver::parallel_for(lines.size(), 64, [&](std::size_t i) { lines[i] = line_of(lattice, all, i, flesh); });
    ViewFibres out;
    out.node = all.node;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!lines[i].is_there) continue;
        out.tets.push_back(all.tets[i]);
        out.weights.push_back(all.weights[i]);
        for (std::size_t c = 0; c < 3; ++c) out.directions.push_back(all.directions[3 * i + c]);
        for (const double w : lines[i].centre) out.centre.push_back(static_cast<float>(w));
        for (const double r : lines[i].reach) out.reach.push_back(static_cast<float>(r));
    }
    return out;
}

/// Of a body with a lattice.
FleshMemory::Found find_flesh(const ViewBody& body) {
    std::vector<solver::Triangle> triangles = body.triangles;
    for (solver::Triangle& t : triangles)
        for (int& v : t)
            if (!body.shading.empty()) v = body.shading[static_cast<std::size_t>(v)];
    std::optional<Flesh> flesh;
    if (!body.volume.empty()) flesh.emplace(body, std::move(triangles));
    FleshMemory::Found out;
    if (flesh) out.skin = flesh->skin();
    for (const ViewFibres& fibres : body.fibres)
        out.fibres.push_back(kept(*body.lattice, fibres, flesh ? &*flesh : nullptr));
    return out;
}

/// Of all that find_flesh reads.
engine::Digest digest_of_shapes(const ViewBody& body) {
    engine::Hasher h;
    const auto add = [&](const auto& list) { h.add_bytes(std::as_bytes(std::span(list))); };
    add(body.rest), add(body.triangles), add(body.shading);
    h.add(body.volume.empty());
    add(body.lattice->tets), add(body.lattice->rest);
    for (const ViewFibres& fibres : body.fibres) {
        h.add(fibres.node);
        add(fibres.tets), add(fibres.directions), add(fibres.weights);
    }
    return h.finish();
}

} // namespace

const FleshMemory::Found* FleshMemory::find(const engine::Digest& shapes) const {
    const auto it = found_.find(shapes);
    return it == found_.end() ? nullptr : &it->second;
}

const FleshMemory::Found& FleshMemory::keep(const engine::Digest& shapes, Found found) {
    constexpr std::size_t most = 1000; // bodies: several graphs as they are and as they were
    if (found_.size() >= most) found_.clear();
    return found_.insert_or_assign(shapes, std::move(found)).first->second;
}

void keep_to_flesh(ViewBody& body, FleshMemory* memory) {
    if (!body.lattice) return;
    FleshMemory own;
    FleshMemory& there = memory ? *memory : own;
    const engine::Digest shapes = digest_of_shapes(body);
    const FleshMemory::Found* found = there.find(shapes);
    if (!found) found = &there.keep(shapes, find_flesh(body));
    body.lattice->skin = found->skin;
    for (std::size_t i = 0; i < body.fibres.size(); ++i) {
        std::vector<float> excitation = std::move(body.fibres[i].excitation);
        body.fibres[i] = found->fibres[i];
        body.fibres[i].excitation = std::move(excitation);
    }
}

Coordinates drawn_lattice(const ViewBody& body, std::size_t frame) {
    Coordinates out = body.lattice->frames[frame];
    for (const ViewSkinPoint& s : body.lattice->skin) {
        std::array<float, 3> p{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto corner = vertex_position(body, frame, static_cast<std::size_t>(s.host[k]));
            for (std::size_t c = 0; c < 3; ++c) p[c] += s.weights[k] * corner[c];
        }
        std::copy(p.begin(), p.end(), out.begin() + 3 * s.vertex);
    }
    return out;
}

} // namespace sinew::viewer
