// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/term/layered_surfaces.h"

#include "solver/error.h"
#include "solver/surface/sampled_surface.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace sinew::solver {

namespace {

const SurfaceLayers& layers_of(const Part& part) { return dynamic_cast<const SurfaceLayers&>(*part.rest); }

void check(const Scene& scene, const Part& part) {
    if (part.bodies.size() != 1 || !scene.tissue(part.bodies.front()))
        throw std::logic_error("a force on a surface acts on one tissue");
    const std::size_t vertices = scene.tissue(part.bodies.front())->surface.size();
    for (const SurfaceLayers::Layer& layer : layers_of(part).layers) {
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

} // namespace

struct LayeredSurfaces::Building {
    std::vector<PointWeights> points;
    std::vector<int> carrier;
    std::vector<Triangle> triangles;
    int first_carrier = 0;
};

bool LayeredSurfaces::used(const Scene& scene, const TermType& type) {
    for (const Part& part : scene.description().parts)
        if (part.type == &type)
            for (const SurfaceLayers::Layer& layer : layers_of(part).layers)
                if (layer.value != 0) return true;
    return false;
}

LayeredSurfaces::LayeredSurfaces(const Scene& scene, const TermType& type)
    : scene_(scene) {
    Building building;
    const std::vector<Part>& parts = scene.description().parts;
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (parts[p].type == &type) add_surface(p, building);
    values_.assign(building.points.size(), 0.0);
    triangles_ = std::make_unique<Stencils<3>>(scene.numbering(), building.points, building.carrier,
                                               std::move(building.triangles));
}

void LayeredSurfaces::add_surface(std::size_t p, Building& building) {
    const Part& part = scene_.description().parts[p];
    check(scene_, part);
    const int body = part.bodies.front();
    const TissueRest& tissue = *scene_.tissue(body);
    const SampledSurface cut = sample_surface(tissue, CarrierTets(tissue.tets));
    const std::size_t first = building.points.size();
    surfaces_.push_back({body, p, first, cut.points.size()});
    const auto deformable = at(scene_.numbering().deformable_of(body));
    for (std::size_t i = 0; i < cut.points.size(); ++i) {
        const bool lies_somewhere = cut.point_triangle[i] >= 0;
        building.points.push_back(
            lies_somewhere ? scene_.embedded(body, cut.carriers.tet[i], cut.carriers.barycentric[i]) : PointWeights{});
        building.carrier.push_back(building.first_carrier + cut.carriers.tet[i]);
        places_.push_back({tissue.triangles[at(std::max(cut.point_triangle[i], 0))], cut.point_place[i]});
        deformable_.push_back(deformable);
        part_.push_back(static_cast<int>(p));
        rest_.insert(rest_.end(), cut.points[i].data(), cut.points[i].data() + 3);
    }
    building.first_carrier += static_cast<int>(tissue.tets.tets.size());
    const int shift = static_cast<int>(first);
    for (const Triangle& t : cut.triangles)
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
            building.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
}

bool LayeredSurfaces::take(const StepInputs& inputs) {
    wanted_.clear();
    for (const Surface& s : surfaces_) {
        wanted_.push_back(inputs.parts[s.part].front());
        const auto& values = std::get<TissueInputs>(inputs.bodies[at(s.body)]);
        if (layers_of(scene_.description().parts[s.part]).layers.size() != values.layers.size())
            throw std::logic_error("a force on a surface needs a value for each of the body's layers");
        for (const MaterialValues& layer : values.layers) wanted_.push_back(layer.envelope);
    }
    if (wanted_ == taken_) return false;
    taken_ = wanted_;
    all_zero_ = true;
    const double* envelope = taken_.data(); // of the part, then of its layers
    for (const Surface& s : surfaces_) {
        const auto& layers = layers_of(scene_.description().parts[s.part]).layers;
        of_vertices_.resize(scene_.tissue(s.body)->surface.size());
        for (std::size_t v = 0; v < of_vertices_.size(); ++v) {
            double value = layers.front().value;
            for (std::size_t k = 1; k < layers.size(); ++k) {
                const double a = share(layers[k], v, envelope[1 + k]);
                value = a * layers[k].value + (1 - a) * value;
            }
            of_vertices_[v] = envelope[0] * value;
            all_zero_ = all_zero_ && of_vertices_[v] == 0;
        }
        for (std::size_t i = s.first_point; i < s.first_point + s.point_count; ++i) {
            const Place& place = places_[i];
            double corner[3], sum = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                corner[c] = of_vertices_[at(place.vertices[c])];
                sum += place.coordinates[static_cast<Eigen::Index>(c)] * corner[c];
            }
            // What is constant stays so to the last bit.
            values_[i] = corner[0] == corner[1] && corner[1] == corner[2] ? corner[0] : sum;
        }
        envelope += 1 + layers.size();
    }
    return true;
}

} // namespace sinew::solver
