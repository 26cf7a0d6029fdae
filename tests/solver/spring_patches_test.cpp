// Stiff springs by lattice vertices: which belong together, and what they weigh.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/terms/attachment/spring_patches.h"
#include "solver/terms/attachment/springs.h"
#include "tests/support/lattice_tissue.h"
#include "tests/support/solver_scenes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <map>
#include <random>
#include <set>

using namespace sinew::solver;
using namespace sinew::test;

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// In a lattice that does not fit it.
std::shared_ptr<TissueRest> block(const Vec3& corner, double tet_size, ElementKind kind) {
    SurfaceMesh cube = make_cube(0.3, 0.1, 0.1, 6, 2, 2);
    for (Vec3& x : cube.points) x += corner + Vec3(0.15, 0.05, 0.05);
    return lattice_tissue(cube, tet_size, ElasticLaw::stvk, kind);
}

std::vector<double> paint(const Points& points, const std::function<bool(const Vec3&)>& where) {
    std::vector<double> out(points.size(), 0.0);
    for (const int v : vertices_where(points, where)) out[at(v)] = 1;
    return out;
}

/// Two blocks, one above the other, the lower one with larger tets; a plate behind both.
struct Blocks {
    explicit Blocks(ElementKind kind)
        : scene(describe(kind))
        , in(values())
        , state(initial_state(scene, in)) {}

    static SceneDescription describe(ElementKind kind) {
        auto below = block({0, 0, 0}, 0.07, kind), above = block({0.013, 0.007, 0.1}, 0.045, kind);
        const auto at_root = [](const Vec3& x) { return x.x() < 1e-9; };
        AttachmentRest to_bone, up, down, soft;
        to_bone.source = 0, to_bone.target = 2, to_bone.source_weights = paint(below->surface, at_root);
        up.source = 0, up.target = 1;
        up.source_weights = paint(below->surface, [](const Vec3& x) { return x.z() > 0.09; });
        down.source = 1, down.target = 0;
        down.source_weights = paint(above->surface, [](const Vec3& x) { return x.z() < 0.11; });
        soft = to_bone;
        return {{below, above, bone({{0, -1, -1}, {0, 2, -1}, {0, 0, 2}}, {{0, 2, 1}})}, {to_bone, up, down, soft}};
    }
    static StepInputs values() {
        StepInputs in = still_inputs();
        in.bodies = {material(3e4, 0.3, 1000), material(6e4, 0.3, 1000),
                     BoneInputs{{{0, -1, -1}, {0, 2, -1}, {0, 0, 2}}}};
        in.attachments = {{1e9, 1, 2e6}, {1e8, 0.5, 0}, {1e8, 1, 0}, {1e4, 1, 0}};
        return in;
    }
    /// What single springs are limited to.
    double single(std::size_t attachment) const {
        const AttachmentView kept = attachments_kept(state.memories);
        return single_stiffness(scene,
                                held_tets(scene, scene.description().attachments[attachment], kept.anchors[attachment]),
                                tet_edges(scene), in);
    }
    Scene scene;
    StepInputs in;
    State state;
};

} // namespace

TEST_CASE("patches: of two tissues the one with larger tets gives the vertices, the softer one the stiffness") {
    const Blocks b(ElementKind::linear);
    const auto& attachments = b.scene.description().attachments;
    const std::vector<double> edges = tet_edges(b.scene);
    for (const AttachmentRest& a : attachments) CHECK(patch_side(b.scene, a, edges) == 0);
    CHECK(edges[0] == Approx(0.07).epsilon(0.25));
    CHECK(edges[1] == Approx(0.045).epsilon(0.25));
    CHECK(edges[2] == 0);
    CHECK(b.single(0) == Approx(125 * 3e4 / edges[0]));
    CHECK(b.single(1) == Approx(125 * 3e4 / edges[0]));
    AttachmentRest bones, equal = attachments[1];
    bones.source = bones.target = 2;
    CHECK(patch_side(b.scene, bones, edges) == -1);
    CHECK(std::isinf(single_stiffness(b.scene, held_tets(b.scene, bones, {}), edges, b.in)));
    // Tets of one size: the source's, whatever rounding makes of them.
    CHECK(patch_side(b.scene, equal, std::vector{0.05, 0.05 * (1 + 1e-12), 0.0}) == 0);
    std::swap(equal.source, equal.target);
    CHECK(patch_side(b.scene, equal, std::vector{0.05, 0.05 * (1 - 1e-12), 0.0}) == 1);
}

TEST_CASE("patches: flesh counts by what it is where it is held") {
    // A tendon at the root, as far as the tets' middles lie below x = 0.1.
    auto below = block({0, 0, 0}, 0.07, ElementKind::linear);
    below->layer_weights.emplace_back();
    double stiff = 0, all = 0;
    for (const Tet& t : below->tets.tets) {
        double x = 0;
        for (const int v : t) x += below->tets.vertices[at(v)].x() / 4;
        below->layer_weights[1].push_back(x < 0.1 ? 1 : 0);
    }
    AttachmentRest root, tip;
    root.source = tip.source = 0, root.target = tip.target = 1;
    root.source_weights = paint(below->surface, [](const Vec3& x) { return x.x() < 1e-9; });
    tip.source_weights = paint(below->surface, [](const Vec3& x) { return x.x() > 0.29; });
    AttachmentRest both = root;
    both.source_weights = {1};
    const Points plate{{0, -1, -1}, {0, 2, -1}, {0, 0, 2}};
    const Scene scene({{below, bone(plate, {{0, 2, 1}})}, {root, tip, both}});
    StepInputs in = still_inputs();
    TissueInputs flesh = material(3e4, 0.3, 1000);
    flesh.layers.push_back(flesh.layers[0]);
    flesh.layers[1].youngs_modulus = 7e5;
    in.bodies = {flesh, BoneInputs{plate}};
    in.attachments = {{1e9, 1, 0}, {1e9, 1, 0}, {1e9, 1, 0}};
    const State s = initial_state(scene, in);
    const AttachmentView kept = attachments_kept(s.memories);
    const std::vector<double> edges = tet_edges(scene);
    const auto single = [&](std::size_t a) {
        return single_stiffness(scene, held_tets(scene, scene.description().attachments[a], kept.anchors[a]), edges,
                                in);
    };
    CHECK(single(0) == Approx(125 * 7e5 / edges[0]));
    CHECK(single(1) == Approx(125 * 3e4 / edges[0]));
    // Held all over, by the areas.
    for (const Anchor& a : kept.anchors[2])
        all += a.area_weight, stiff += below->layer_weights[1][at(a.source.tet)] * a.area_weight;
    REQUIRE(stiff > 0.25 * all);
    REQUIRE(stiff < 0.5 * all);
    CHECK(single(2) == Approx(125 * (3e4 + stiff / all * 6.7e5) / edges[0]));
}

TEST_CASE("patches: between two vertices that are as near up to rounding the first one counts") {
    const Blocks b(ElementKind::linear);
    const AttachmentView kept = attachments_kept(b.state.memories);
    const auto patches_at = [&](double beside) {
        std::vector<Anchor> anchors(kept.anchors[0].begin(), kept.anchors[0].end());
        for (Anchor& a : anchors) a.source.coordinates = {0.4 + beside, 0.4 - beside, 0.1, 0.1};
        std::vector<std::span<const Anchor>> all(kept.anchors.begin(), kept.anchors.end());
        all[0] = anchors;
        const SpringBundles bundles(b.scene, all);
        const SpringPatches patches(b.scene, bundles, all, std::vector<int>{0, -1, -1, -1});
        std::vector<int> out;
        for (std::size_t s = 0; s < bundles.spring_count(); ++s) out.push_back(patches.of_spring(s));
        return out;
    };
    const std::vector<int> even = patches_at(0);
    CHECK(*std::max_element(even.begin(), even.end()) == 3);
    CHECK(patches_at(1e-12) == even);
    CHECK(patches_at(-1e-12) == even);
    CHECK(patches_at(1e-3) != patches_at(-1e-3)); // nearer than by rounding
}

TEST_CASE("patches have every stiff spring once, with those nearest to the same vertex of the larger tets") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const Blocks b(kind);
        const AttachmentView kept = attachments_kept(b.state.memories);
        const SpringBundles bundles(b.scene, kept.anchors);
        const std::vector<int> sides{0, 0, 0, -1};
        const SpringPatches patches(b.scene, bundles, kept.anchors, sides);
        REQUIRE(patches.count() > 30);
        CHECK(patches.count() < bundles.spring_count() / 4);

        std::vector<double> area(patches.count(), 0.0);
        std::vector<std::map<int, double>> pulls(patches.count());
        const int below = static_cast<int>(b.scene.vertex_count(0));
        std::vector<std::set<int>> common(patches.count()), springs(patches.count());
        std::size_t alone = 0; // on a side of its tet
        for (std::size_t k = 0; k < bundles.count(); ++k)
            bundles.for_each_spring(k, [&](const SpringBundles::Spring& s) {
                const int p = patches.of_spring(s.number);
                REQUIRE((p < 0) == (bundles.attachment(k) == 3));
                if (p < 0) return;
                CHECK(patches.attachment(at(p)) == bundles.attachment(k));
                area[at(p)] += s.area_weight;
                springs[at(p)].insert(static_cast<int>(s.number));
                // The lower block's vertices come first; it is the target of the third attachment.
                const double sign = bundles.attachment(k) == 2 ? -1 : 1;
                double most = -1;
                for (std::size_t i = 0; i < s.coefficients.size(); ++i) {
                    const int vertex = bundles.vertices(k)[i];
                    pulls[at(p)][vertex] += s.area_weight * s.coefficients[i];
                    if (vertex < below) most = std::max(most, sign * s.coefficients[i]);
                }
                std::set<int> nearest; // several where the sample is as near to all
                for (std::size_t i = 0; i < s.coefficients.size(); ++i)
                    if (bundles.vertices(k)[i] < below && sign * s.coefficients[i] > most - 2e-5)
                        nearest.insert(bundles.vertices(k)[i]);
                if (springs[at(p)].size() == 1)
                    common[at(p)] = nearest;
                else
                    std::erase_if(common[at(p)], [&](int v) { return !nearest.contains(v); });
            });
        std::set<std::pair<int, int>> met;
        for (std::size_t p = 0; p < patches.count(); ++p) {
            CHECK(patches.area(p) == Approx(area[p]).epsilon(1e-13));
            CHECK(std::set<int>(patches.springs(p).begin(), patches.springs(p).end()) == springs[p]);
            REQUIRE_FALSE(common[p].empty());
            if (!met.insert({patches.attachment(p), *common[p].begin()}).second) ++alone;
            REQUIRE(patches.pulls(p).size() == pulls[p].size());
            for (const SpringPatches::Pull& pull : patches.pulls(p))
                CHECK(pull.area == Approx(pulls[p].at(pull.vertex)).margin(1e-15));
        }
        CHECK(alone < bundles.spring_count() / 20);
        for (const int a : {0, 1, 2}) CHECK(patches.has(a));
        CHECK_FALSE(patches.has(3));
        CHECK(SpringPatches(b.scene, bundles, kept.anchors, {}).count() == 0);
    }
}

TEST_CASE("where tets end at the surface no springs are put together") {
    auto t = tissue(box_mesh({0.3, 0.1, 0.1}, 6, 2, 2), ElasticLaw::stvk);
    AttachmentRest a;
    a.source = 0, a.target = 1;
    a.source_weights = paint(t->surface, [](const Vec3& x) { return x.x() < 1e-9; });
    const Points plate{{0, -1, -1}, {0, 2, -1}, {0, 0, 2}};
    const Scene scene({{t, bone(plate, {{0, 2, 1}})}, {a}});
    StepInputs in = still_inputs();
    in.bodies = {material(3e4, 0.3, 1000), BoneInputs{plate}};
    in.attachments = {{1e9, 1, 0}};
    const State s = initial_state(scene, in);
    const AttachmentView kept = attachments_kept(s.memories);
    const SpringBundles bundles(scene, kept.anchors);
    REQUIRE(bundles.spring_count() > 10);
    const SpringPatches patches(scene, bundles, kept.anchors, std::vector<int>{0});
    CHECK(patches.count() == 0);
    CHECK_FALSE(patches.has(0));
    // All of the stiffness, then, at each.
    Springs springs(scene, attachments_kept(s.memories), std::vector<int>{0});
    springs.limit_single({1e3});
    ImplicitForm form;
    quasi_static_form(s, form);
    springs.begin_stage(in, s, s.bones, form);
    std::vector<double> x(s.x);
    for (std::size_t v = 0; v < x.size(); v += 3) x[v] += 0.02 * s.x[v + 1];
    CHECK(springs.energy(x, nullptr) == Approx(0.5 * 1e9 * 0.02 * 0.02 * 0.1 * 0.001 / 3).epsilon(1e-6));
}

TEST_CASE("a patch's mean stretch meets 1,250 times what flesh is at most, what differs from it 125 times") {
    for (const ElementKind kind : {ElementKind::linear, ElementKind::quadratic}) {
        const Blocks b(kind);
        const auto& attachments = b.scene.description().attachments;
        const AttachmentView kept = attachments_kept(b.state.memories);
        const SpringBundles bundles(b.scene, kept.anchors);
        const std::vector<int> sides{0, 0, 0, -1};
        const SpringPatches patches(b.scene, bundles, kept.anchors, sides);
        std::vector<double> most_single;
        for (std::size_t a = 0; a < attachments.size(); ++a) most_single.push_back(b.single(a));
        Springs springs(b.scene, attachments_kept(b.state.memories), sides);
        springs.limit_single(most_single);
        // The step begins with all of them stretched.
        State begin = b.state;
        std::mt19937 random(3);
        std::normal_distribution<double> normal;
        for (double& x : begin.x) x += 1e-3 * normal(random);
        ImplicitForm form;
        backward_euler_form(begin, 0.02, form);
        springs.begin_stage(b.in, begin, begin.bones, form);

        // Of what `x` is away from `from`, with the stiffness of attachments or their damping over the step.
        const auto bed = [&](const std::vector<double>& x, const std::vector<double>& from, bool viscous) {
            std::vector<Vec3> mean(patches.count(), Vec3::Zero());
            double energy = 0;
            const auto each = [&](const auto& visit) {
                for (std::size_t k = 0; k < bundles.count(); ++k)
                    bundles.for_each_spring(k, [&](const SpringBundles::Spring& s) {
                        Vec3 d = Vec3::Zero();
                        for (std::size_t i = 0; i < s.coefficients.size(); ++i)
                            for (std::size_t c = 0; c < 3; ++c) {
                                const std::size_t n = 3 * at(bundles.vertices(k)[i]) + c;
                                d[static_cast<Eigen::Index>(c)] += s.coefficients[i] * (x[n] - from[n]);
                            }
                        visit(s, d, bundles.attachment(k), patches.of_spring(s.number));
                    });
            };
            each([&](const SpringBundles::Spring& s, const Vec3& d, int, int p) {
                if (p >= 0) mean[at(p)] += s.area_weight / patches.area(at(p)) * d;
            });
            each([&](const SpringBundles::Spring& s, const Vec3& d, int attachment, int p) {
                const AttachmentInputs& in = b.in.attachments[at(attachment)];
                const double limit = most_single[at(attachment)], told = in.stiffness * in.envelope,
                             k = p < 0 ? told : std::min(told, 10 * limit), single = std::min(k, limit);
                const double all = viscous ? in.damping * in.envelope / 0.02 / k : 1;
                const double of_mean = p < 0 ? 0 : (k - single) * mean[at(p)].squaredNorm();
                energy += 0.5 * all * s.area_weight * (single * d.squaredNorm() + of_mean);
            });
            return energy;
        };
        const auto expected = [&](const std::vector<double>& x) {
            return bed(x, b.state.x, false) + bed(x, begin.x, true);
        };
        std::vector<double> direction(b.state.x.size());
        for (double& d : direction) d = normal(random);
        for (const double far : {1e-2, 1e-6, 1.0}) {
            const auto moved = [&](double share) {
                std::vector<double> x(begin.x);
                for (std::size_t i = 0; i < x.size(); ++i) x[i] += share * far * direction[i];
                return x;
            };
            INFO("element " << static_cast<int>(kind) << ", " << far << " m");
            std::vector<double> gradient(direction.size(), 0.0);
            CHECK(springs.energy(moved(1), gradient.data()) == Approx(expected(moved(1))).epsilon(1e-9));
            CHECK(springs.stored_energy(moved(1)) == Approx(bed(moved(1), b.state.x, false)).epsilon(1e-9));
            double slope = 0;
            for (std::size_t i = 0; i < gradient.size(); ++i) slope += gradient[i] * direction[i];
            CHECK(slope * far == Approx(expected(moved(1.5)) - expected(moved(0.5))).epsilon(1e-8)); // it is quadratic
        }
        // As one piece it moves against all springs alike: stiff ones up to the limit of means, soft ones as told.
        std::vector<double> aside(b.state.x);
        for (std::size_t i = 0; i < aside.size(); i += 3) aside[i] += 0.01;
        CHECK(springs.stored_energy(aside) == Approx(0.5 * (10 * most_single[0] + 1e4) * 0.01 * 1e-4).epsilon(1e-9));
    }
}

TEST_CASE("a target whose tets end at its surface is held at each point, also from a distance, and what weighs nothing "
          "pulls nothing") {
    auto t = tissue(box_mesh({0.3, 0.1, 0.1}, 6, 2, 2), ElasticLaw::stvk);
    const Points plate{{-0.05, -0.05, 0.12}, {0.35, -0.05, 0.12}, {-0.05, 0.25, 0.12}};
    AttachmentRest a;
    a.source = 1, a.target = 0;
    a.source_weights = {1, 1, 1};
    a.max_distance = 1;
    auto in_cells = block({0, 0, 0}, 0.07, ElementKind::linear);
    AttachmentRest faint;
    faint.source = 2, faint.target = 1;
    for (const Vec3& x : in_cells->surface) faint.source_weights.push_back(x.x() < 1e-9 ? 1 : 1e-321);
    const auto scene =
        std::make_shared<const Scene>(SceneDescription{{t, bone(plate, {{0, 1, 2}}), in_cells}, {a, faint}});
    StepInputs in = still_inputs();
    in.bodies = {material(3e4, 0.3, 1000), BoneInputs{plate}, material(3e4, 0.3, 1000)};
    in.attachments = {{1e9, 1, 0}, {1e9, 1, 0}};
    const State s = initial_state(*scene, in);
    const AttachmentView kept = attachments_kept(s.memories);
    const SpringBundles bundles(*scene, kept.anchors);
    const SpringPatches patches(*scene, bundles, kept.anchors, std::vector<int>{0, 2});
    CHECK_FALSE(patches.has(0));
    CHECK(patches.has(1));
    for (std::size_t p = 0; p < patches.count(); ++p) CHECK(patches.area(p) > 1e-12);
    Workspace w(scene);
    CHECK(advance(w, s, std::span(&in, 1)).record.converged);
}

TEST_CASE("a patch that would couple very many vertices is left in single springs") {
    auto below = block({0, 0, 0}, 0.09, ElementKind::linear),
         above = block({0.013, 0.007, 0.1}, 0.012, ElementKind::linear);
    AttachmentRest a;
    a.source = 1, a.target = 0, a.source_weights = paint(above->surface, [](const Vec3& x) { return x.z() < 0.11; });
    const Scene scene({{below, above}, {a}});
    StepInputs in = still_inputs();
    in.bodies = {material(3e4, 0.3, 1000), material(3e4, 0.3, 1000)};
    in.attachments = {{1e9, 1, 0}};
    const State s = initial_state(scene, in);
    const AttachmentView kept = attachments_kept(s.memories);
    const SpringBundles bundles(scene, kept.anchors);
    const SpringPatches patches(scene, bundles, kept.anchors, std::vector<int>{0});
    REQUIRE(patches.has(0));
    CHECK(patches.count() > bundles.spring_count() / 2);
    for (std::size_t p = 0; p < patches.count(); ++p) CHECK(patches.pulls(p).size() <= SpringPatches::most_vertices);
}

TEST_CASE("stiffness and moduli that change take hold of patches as if they had been there from the start") {
    // TR-BDF2 looks at values between those of two steps; what is coupled is as at the step's start.
    const Integrator integrator = GENERATE(Integrator::backward_euler, Integrator::tr_bdf2);
    Blocks b(ElementKind::linear);
    b.in.integrator = integrator;
    b.in.step_size = 0.01;
    b.in.gravity = Vec3(0, 0, -9.8);
    const auto scene = std::make_shared<const Scene>(b.scene.description());
    Workspace lasting(scene);
    State state = initial_state(*scene, b.in);
    // Springs, then patches, then those of firmer single springs, then springs again, of either stiffness.
    for (const auto& [stiffness, modulus] : {std::pair{1e5, 3e4}, {1e9, 3e4}, {1e9, 3e5}, {1e9, 3e6}, {1e5, 3e6}}) {
        for (std::size_t a = 0; a < 3; ++a) b.in.attachments[a].stiffness = stiffness;
        std::get<TissueInputs>(b.in.bodies[0]).layers[0].youngs_modulus = modulus;
        INFO(stiffness << " N/m^3, " << modulus << " Pa");
        Workspace fresh(scene);
        const State anew = advance(fresh, state, std::span(&b.in, 1));
        state = advance(lasting, state, std::span(&b.in, 1));
        CHECK(state.record.converged);
        CHECK(state.x == anew.x);
    }
}
