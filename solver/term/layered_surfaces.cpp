// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/layered_surfaces.h"

#include "solver/error.h"
#include "solver/index.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::solver {

namespace {

const SurfaceLayers& layers_of(const Part& part) { return dynamic_cast<const SurfaceLayers&>(*part.rest); }

void check(const Scene& scene, const Part& part) {
    if (part.bodies.size() != 1 || !scene.deforms(part.bodies.front()))
        throw std::logic_error("a force on a surface acts on one tissue or cloth");
    const std::size_t vertices = scene.surface(part.bodies.front()).size();
    const auto is_finite = [](double number) { return std::isfinite(number); };
    for (const SurfaceLayers::Layer& layer : layers_of(part).layers) {
        if (!is_finite(layer.value) || !std::all_of(layer.weights.begin(), layer.weights.end(), is_finite)) {
            Error e("FE202", "a value or weight of a " + std::string(part.type->name) + " is not a finite number",
                    "check the layer and its painted map");
            e.body = part.bodies.front();
            throw e;
        }
        if (layer.weights.size() <= 1 || layer.weights.size() == vertices) continue;
        Error e("FE204",
                "a " + std::string(part.type->name) + " has " + std::to_string(layer.weights.size()) +
                    " weights for a surface of " + std::to_string(vertices) + " vertices",
                "give one number for each, or one for all");
        e.body = part.bodies.front();
        throw e;
    }
}

/// What of a layer is seen at a vertex.
double share(const SurfaceLayers::Layer& layer, std::size_t vertex, double envelope) {
    if (layer.weights.empty()) return envelope;
    return envelope * layer.weights[layer.weights.size() == 1 ? 0 : vertex];
}

/// A cloth's triangles, each of which carries itself.
ClippedSurface whole_triangles(const std::vector<Triangle>& triangles) {
    ClippedSurface out;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        SurfacePiece piece{static_cast<int>(t), static_cast<int>(t), {}, {}};
        for (std::size_t c = 0; c < 3; ++c)
            piece.place[c] = Vec3::Unit(static_cast<Eigen::Index>(c)), piece.inside[c][c] = 1;
        out.pieces.push_back(piece);
    }
    out.is_outside.assign(triangles.size(), 0);
    return out;
}

ClippedSurface clipped(const Scene& scene, int body) {
    if (const TissueRest* tissue = scene.tissue(body))
        return clip_surface(tissue->surface, tissue->triangles, CarrierTets(tissue->tets));
    return whole_triangles(scene.triangles(body));
}

/// Appends the envelopes of the layers of a body.
void add_envelopes(const BodyInputs& inputs, std::vector<double>& out) {
    if (const auto* cloth = std::get_if<ClothInputs>(&inputs))
        for (const ClothMaterial& layer : cloth->layers) out.push_back(layer.envelope);
    else
        for (const MaterialValues& layer : std::get<TissueInputs>(inputs).layers) out.push_back(layer.envelope);
}

} // namespace

bool LayeredSurfaces::used(const Scene& scene, const TermType& type) {
    for (const Part& part : scene.description().parts)
        if (part.type == &type)
            for (const SurfaceLayers::Layer& layer : layers_of(part).layers)
                if (layer.value != 0) return true;
    return false;
}

LayeredSurfaces::LayeredSurfaces(const Scene& scene, const TermType& type)
    : scene_(scene) {
    std::vector<PointWeights> points;
    std::vector<int> carrier;
    int first_carrier = 0;
    const std::vector<Part>& parts = scene.description().parts;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (parts[p].type != &type) continue;
        check(scene, parts[p]);
        const int body = parts[p].bodies.front();
        const Points& surface = scene.surface(body);
        const std::vector<Triangle>& triangles = scene.triangles(body);
        const TissueRest* tissue = scene.tissue(body);
        const auto deformable = at(scene.deformable_of(body));
        const int first = static_cast<int>(points.size());
        surfaces_.push_back({body, deformable, p, points.size(), surface.size(), triangles_.size(), triangles.size(),
                             clipped(scene, body)});
        for (const Triangle& t : triangles) triangles_.push_back({t[0] + first, t[1] + first, t[2] + first});
        for (std::size_t v = 0; v < surface.size(); ++v) {
            points.push_back(scene.carrier_of(body, static_cast<int>(v)));
            carrier.push_back(first_carrier + (tissue ? tissue->embedding.tet[v] : static_cast<int>(v)));
        }
        first_carrier += static_cast<int>(tissue ? tissue->tets.tets.size() : surface.size());
    }
    values_.assign(points.size(), 0.0);
    vertices_ = std::make_unique<CarriedPoints>(scene.numbering(), points, carrier, std::vector<std::pair<int, int>>{});
}

LayeredSurfaces::Taken LayeredSurfaces::take(const StepInputs& inputs) {
    Taken out;
    wanted_.clear();
    for (Surface& s : surfaces_) {
        const double envelope = inputs.parts[s.part].front();
        out.envelopes = out.envelopes || envelope != s.envelope;
        s.envelope = envelope;
        const std::size_t before = wanted_.size();
        add_envelopes(inputs.bodies[at(s.body)], wanted_);
        if (layers_of(scene_.description().parts[s.part]).layers.size() != wanted_.size() - before)
            throw std::logic_error("a force on a surface needs a value for each of the body's layers");
    }
    out.values = wanted_ != taken_;
    if (out.values) {
        taken_ = wanted_;
        const double* of_layers = taken_.data();
        for (const Surface& s : surfaces_) {
            const auto& layers = layers_of(scene_.description().parts[s.part]).layers;
            for (std::size_t v = 0; v < s.vertex_count; ++v) {
                double value = layers.front().value;
                for (std::size_t k = 1; k < layers.size(); ++k) {
                    const double a = share(layers[k], v, of_layers[k]);
                    value = a * layers[k].value + (1 - a) * value;
                }
                values_[s.first_vertex + v] = value;
            }
            of_layers += layers.size();
        }
    }
    if (!out.values && !out.envelopes) return out;
    all_zero_ = true;
    for (const Surface& s : surfaces_)
        for (std::size_t v = 0; s.envelope != 0 && v < s.vertex_count; ++v)
            all_zero_ = all_zero_ && values_[s.first_vertex + v] == 0;
    return out;
}

double LayeredSurfaces::value_at(const Surface& surface, int triangle, const Vec3& place) const {
    double corner[3], sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        corner[c] = values_[at(triangles_[surface.first_triangle + at(triangle)][c])];
        sum += place[static_cast<Eigen::Index>(c)] * corner[c];
    }
    // What is constant stays so to the last bit.
    return corner[0] == corner[1] && corner[1] == corner[2] ? corner[0] : sum;
}

std::array<int, quadratic_nodes> LayeredSurfaces::nodes(const Surface& surface, int tet) const {
    std::array<int, quadratic_nodes> out{};
    const int count = node_count(surface);
    if (count == 3) {
        const Triangle& t = scene_.triangles(surface.body)[at(tet)];
        for (std::size_t c = 0; c < 3; ++c) out[c] = t[c] + scene_.first_vertex(surface.body);
        return out;
    }
    for (int n = 0; n < count; ++n) {
        std::array<double, 4> place{};
        if (n < 4)
            place[at(n)] = 1;
        else
            for (const int corner : tet_edge_corners[n - 4]) place[at(corner)] = 0.5;
        out[at(n)] = scene_.embedded(surface.body, tet, place).vertex[0];
    }
    return out;
}

const LayeredSurfaces::Surface& LayeredSurfaces::surface_of(std::size_t triangle) const {
    std::size_t s = 0;
    while (triangle >= surfaces_[s].first_triangle + surfaces_[s].triangle_count) ++s;
    return surfaces_[s];
}

} // namespace sinew::solver
