// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/idle_cost.h"

#include "solver/terms/elastic/rest_shape.h"
#include "solver/terms/field/field.h"
#include "solver/terms/pressure/pressure.h"
#include "solver/terms/surface_tension/surface_tension.h"
#include "tools/bench/beams.h"
#include "tools/bench/cantilever.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sinew::bench {

using namespace solver;

namespace {

/// A scene that a feature may be added to.
struct Subject {
    std::shared_ptr<TissueRest> rest;
    std::shared_ptr<BoneRest> bone; ///< none without the feature that brings one
    std::vector<AttachmentRest> attachments;
    std::vector<Part> parts;
    TissueInputs tissue;
    StepInputs inputs;
};

struct Feature {
    const char* name;
    void (*add)(Subject&);
};

void add_bone(Subject& s) {
    s.bone = std::make_shared<BoneRest>();
    s.bone->surface = {{0, -1, -1}, {0, 1, -1}, {0, 0, 1}};
    s.bone->triangles = {{0, 1, 2}};
}

/// On all of the surface; its envelope is 0.
void add_on_surface(const TermType& type, Subject& s) {
    auto layers = std::make_shared<SurfaceLayers>();
    layers->layers = {{1000, {}}};
    s.parts = {{&type, {0}, layers}};
    s.inputs.parts = {{0}};
}

/// Each with the values that make it do nothing.
constexpr Feature features[] = {
    {"fibre field, no excitation",
     [](Subject& s) {
         const std::size_t tets = s.rest->tets.tets.size();
         s.rest->fibers = {{Points(tets, Vec3(1, 0, 0)), std::vector<double>(tets, 1.0)}};
         s.tissue.fibers = {FiberValues{}};
     }},
    {"second material layer, envelope 0",
     [](Subject& s) {
         s.rest->layer_weights.push_back(std::vector<double>(s.rest->tets.tets.size(), 1.0));
         s.tissue.layers.push_back(s.tissue.layers.front());
         s.tissue.layers.back().youngs_modulus *= 10;
         s.tissue.layers.back().envelope = 0;
     }},
    {"restScale 1 in all layers, restScaleEnvelope 2", [](Subject& s) { s.tissue.rest_scale_envelope = 2; }},
    {"restScale 0.8, restScaleEnvelope 0",
     [](Subject& s) { s.tissue.layers.front().rest_scale = 0.8, s.tissue.rest_scale_envelope = 0; }},
    {"target of a rest shape, targetWeight 0",
     [](Subject& s) {
         Points smaller;
         for (const Vec3& v : s.rest->tets.vertices) smaller.push_back(0.8 * v);
         const std::vector<double> everywhere(s.rest->tets.tets.size(), 1.0);
         s.parts = {
             {&rest_shape_type, {0}, std::make_shared<RestShape>(make_rest_shape(s.rest->tets, smaller, everywhere))}};
         s.inputs.parts = {{0}};
     }},
    {"muscle growth, envelope 0",
     [](Subject& s) {
         const std::size_t tets = s.rest->tets.tets.size();
         s.rest->fibers = {{Points(tets, Vec3(1, 0, 0)), std::vector<double>(tets, 1.0)}};
         s.tissue.fibers = {FiberValues{.strength = 0, .envelope = 0, .growth = 2}};
     }},
    {"dead loads, all zero", [](Subject& s) { s.tissue.forces.assign(s.rest->tets.vertices.size(), Vec3::Zero()); }},
    {"a bone that nothing holds on to", add_bone},
    {"attachment of one held vertex, envelope 0",
     [](Subject& s) {
         add_bone(s);
         AttachmentRest a;
         a.source = 0, a.target = 1;
         a.source_weights.assign(s.rest->surface.size(), 0.0);
         a.source_weights[static_cast<std::size_t>(s.rest->fixed_vertices.front())] = 1;
         s.attachments = {a};
         AttachmentInputs idle;
         idle.envelope = 0;
         s.inputs.attachments = {idle};
     }},
    {"field of magnitude 0",
     [](Subject& s) {
         s.parts = {{&field_type, {0}, std::make_shared<FieldRest>()}};
         s.inputs.parts.emplace_back(FieldValues::fields().size());
         put_fields(FieldValues{}, s.inputs.parts.back());
     }},
    {"pressure of 0", [](Subject& s) { add_on_surface(pressure_type, s); }},
    {"surface tension of 0", [](Subject& s) { add_on_surface(surface_tension_type, s); }},
    {"halving of failed steps allowed", [](Subject& s) { s.inputs.max_halvings = 8; }},
    {"transverse anisotropy set, isotropic law", [](Subject& s) { s.tissue.transverse_anisotropy = 0.5; }},
};

struct Run {
    double seconds = 0;
    Work work;
    std::vector<double> x;
};

Run simulate(int n, int steps, const Feature* feature, const std::stop_token& stop) {
    Subject s;
    s.rest = std::make_shared<TissueRest>(cantilever_rest(n, ElasticLaw::neo_hookean));
    s.tissue = material(1e5, 0.45);
    s.inputs.step_size = 1.0 / 48;
    s.inputs.max_newton_iterations = 50;
    if (feature) feature->add(s);
    s.inputs.bodies = {s.tissue};
    SceneDescription scene{{s.rest}, s.attachments, s.parts};
    if (s.bone) {
        scene.bodies.push_back(s.bone);
        s.inputs.bodies.push_back(BoneInputs{s.bone->surface});
    }
    Simulation sim(std::move(scene), s.inputs, stop);
    sim.step(); // the first one makes patterns and buffers
    const double made = sim.work.seconds;
    for (int i = 1; i < steps; ++i) sim.step();
    return {sim.work.seconds - made, sim.work, sim.state.x};
}

/// The middle half of the values, sorted.
std::vector<double> middle_half(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto quarter = static_cast<std::ptrdiff_t>(values.size() / 4);
    return {values.begin() + quarter, values.end() - quarter};
}

} // namespace

IdleCost run_idle_cost(const RunOptions& options) {
    const int n = options.quick ? 8 : 20, turns = options.quick ? 5 : 9;
    IdleCost out;
    out.steps = options.quick ? 3 : 6;
    std::vector<const Feature*> wanted;
    for (const Feature& f : features)
        if (options.wants(f.name)) wanted.push_back(&f);
    if (wanted.empty()) return out;
    std::vector<double> base_seconds, base_ratio;
    std::vector<std::vector<double>> ratios(wanted.size());
    std::vector<Run> last(wanted.size());
    Run base;
    for (int turn = 0; turn < turns; ++turn) {
        options.tell("idle cost, turn " + std::to_string(turn + 1) + " of " + std::to_string(turns));
        // Each feature stands between two runs without it, so that a machine that slows down does not count against it.
        base = simulate(n, out.steps, nullptr, options.stop);
        double before = base.seconds;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            last[i] = simulate(n, out.steps, wanted[i], options.stop);
            const double after = simulate(n, out.steps, nullptr, options.stop).seconds;
            ratios[i].push_back(last[i].seconds / (0.5 * (before + after)));
            base_ratio.push_back(std::abs(after / before - 1));
            base_seconds.push_back(after);
            before = after;
        }
    }
    out.tets = 3 * n * n * n / 8;
    out.seconds = median(base_seconds);
    out.noise_level = std::max(0.01, middle_half(base_ratio).back());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        IdleRow row;
        row.feature = wanted[i]->name;
        const std::vector<double> middle = middle_half(ratios[i]);
        row.ratio = median(ratios[i]), row.spread = 0.5 * (middle.back() - middle.front());
        row.turns = turns, row.newton = last[i].work.newton;
        row.same_work =
            last[i].work.newton == base.work.newton && last[i].work.linear_iterations == base.work.linear_iterations;
        for (std::size_t k = 0; k < base.x.size(); ++k)
            row.difference = std::max(row.difference, std::abs(last[i].x[k] - base.x[k]));
        row.noise = std::abs(row.ratio - 1) <= out.noise_level;
        out.rows.push_back(row);
    }
    return out;
}

Table idle_cost_table(const IdleCost& result) {
    Table t{{"unused feature", "time with / without", "spread", "same iterations", "farthest vertex [m]", "verdict"},
            {}};
    for (const IdleRow& r : result.rows)
        t.rows.push_back({r.feature, number(r.ratio, 4), number(r.spread, 2), r.same_work ? "yes" : "no",
                          number(r.difference, 2),
                          r.noise       ? "noise"
                          : r.ratio < 1 ? "faster"
                                        : "COSTS"});
    return t;
}

nlohmann::ordered_json idle_cost_json(const IdleCost& result) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const IdleRow& r : result.rows)
        rows.push_back({{"feature", r.feature},
                        {"ratio", r.ratio},
                        {"spread", r.spread},
                        {"turns", r.turns},
                        {"newton", r.newton},
                        {"same_work", r.same_work},
                        {"difference_m", r.difference},
                        {"noise", r.noise}});
    return {{"tets", result.tets},
            {"steps", result.steps},
            {"seconds", result.seconds},
            {"noise_level", result.noise_level},
            {"features", rows}};
}

} // namespace sinew::bench
