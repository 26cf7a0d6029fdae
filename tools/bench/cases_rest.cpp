// Accuracy of rest shapes that change: free bodies scaled, grown and shaped as targets, of which everything is known,
// and a strip of two halves that bends.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/fiber/line_of_action.h"
#include "solver/terms/elastic/rest_shape.h"
#include "tools/bench/accuracy.h"
#include "tools/bench/free_body.h"
#include "tools/bench/models.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sinew::bench {

using namespace solver;

namespace {

constexpr double length = 0.2, thick = 0.1;

std::string words(const LawName& law, const ElementName& element) {
    return std::string(law.word) + ", " + std::string(element.word);
}

std::shared_ptr<TissueRest> block(const LawName& law, const ElementName& element, const Vec3& fibre) {
    auto rest = make_tissue(box_mesh({0, 0, 0}, {length, thick, thick}, 2, 1, 1), law.law, element.kind);
    const std::size_t n = rest->tets.tets.size();
    rest->stiff_directions.assign(n, fibre);
    return rest;
}

void add_fibre(TissueRest& rest, const Vec3& along) {
    const std::size_t n = rest.tets.tets.size();
    rest.fibers.push_back({Points(n, along), std::vector<double>(n, 1.0)});
}

/// Lets a body come to rest and judges distances, volume and energy by the affine map that it must have taken, but for
/// a rigid motion.
using Target = std::pair<std::shared_ptr<const RestShape>, double>;
void judge_free(Book& book, const std::string& setting, std::shared_ptr<TissueRest> rest, const TissueInputs& values,
                const Mat3& to, const RunOptions& options, const std::vector<Target>& targets = {}) {
    FreeBody body(rest, values);
    for (const auto& [shape, weight] : targets) body.reshape(shape, weight);
    body.settle(options.stop);
    const Points nodes = nodes_of(*rest);
    double worst = 0;
    for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
            worst =
                std::max(worst, std::abs((body.place(static_cast<int>(a)) - body.place(static_cast<int>(b))).norm() -
                                         (to * (nodes[a] - nodes[b])).norm()));
    const double model = length * thick * thick;
    book.judge(CaseKind::exact, setting, "farthest distance of two nodes from that of G X [m]", worst, 0,
               worst / length, 1e-8, body.work);
    book.compare(CaseKind::exact, setting, "volume / that of the model", body.volume() / model, to.determinant(), 1e-8);
    const double left = targets.empty() ? body.elastic_energy() : body.stored_energy();
    const double energy = std::abs(left) / (values.layers[0].youngs_modulus * model);
    book.judge(CaseKind::exact, setting, "energy / (E V)", energy, 0, energy, 1e-12);
}

void rest_scale(Book& book, const RunOptions& options) {
    book.open("9", "rest scale of a free body");
    for (const LawName& law : all_laws)
        for (const ElementName& element : elements)
            for (const double e : {-1.0, 0.0, 1.0, 2.0}) {
                if (options.quick && e == 0) continue;
                TissueInputs values = material(2e4, 0.45);
                values.compression_resistance = TissueInputs().compression_resistance;
                values.transverse_anisotropy = 0.5;
                values.layers[0].rest_scale = 0.8;
                values.rest_scale_envelope = e;
                judge_free(book, words(law, element) + ", 0.8 to the power " + number(e, 2),
                           block(law, element, Vec3::UnitX()), values, std::pow(0.8, e) * Mat3::Identity(), options);
            }
    for (const ElementName& element : elements) {
        TissueInputs values = material(2e4, 0.3);
        values.layers[0].volume_conservation = 2e8;
        values.layers[0].rest_scale = 1.2;
        judge_free(book, words(all_laws[0], element) + ", volumeConservation 1e4 E",
                   block(all_laws[0], element, Vec3::UnitX()), values, 1.2 * Mat3::Identity(), options);
        values.layers[0].volume_conservation = 0;
        auto hung = block(all_laws[0], element, Vec3::UnitX());
        hung->fixed_vertices = {0};
        judge_free(book, words(all_laws[0], element) + ", held at one vertex", hung, values, 1.2 * Mat3::Identity(),
                   options);
    }
}

void growth(Book& book, const RunOptions& options) {
    book.open("9", "growth of a free body");
    const auto g = [](const Vec3& a, double scale) {
        return Mat3(a * a.transpose() + scale * (Mat3::Identity() - a * a.transpose()));
    };
    const Vec3 along = Vec3(1, 0.5, -0.3).normalized();
    for (const LawName& law : all_laws)
        for (const ElementName& element : elements)
            for (const double scale : {0.5, 1.6}) {
                TissueInputs values = material(2e4, 0.45);
                values.transverse_anisotropy = 0.5;
                values.fibers = {{1e4, 1, 1, 1, scale}}; // pulls on what is longer than at rest
                auto rest = block(law, element, along);
                add_fibre(*rest, along);
                judge_free(book, words(law, element) + ", growth " + number(scale, 2), rest, values, g(along, scale),
                           options);
            }
    for (const ElementName& element : elements) {
        TissueInputs values = material(2e4, 0.3);
        values.fibers = {{0, 1, 0, 1, 1.2}, {0, 1, 0, 1, 1.2}};
        auto rest = block(all_laws[0], element, along);
        add_fibre(*rest, along), add_fibre(*rest, along);
        judge_free(book, words(all_laws[0], element) + ", two fibres of growth 1.2 each", rest, values, g(along, 1.44),
                   options);
    }
}

/// Growth that follows a line of action which has shortened by a quarter: by the scale to the power of 1/4.
void growth_by_line(Book& book, const RunOptions& options) {
    book.open("9", "growth by a line of action");
    const Vec3 along = Vec3(1, 0.5, -0.3).normalized();
    const LineOfActionValues line;
    const double loa = follow_line(line, start_line(line, 0.4), 0.3, 1.0 / 24).value;
    for (const ElementName& element : elements)
        for (const double scale : {0.5, 1.6}) {
            TissueInputs values = material(2e4, 0.45);
            values.fibers = {{0, 1, 0, 1, std::pow(scale, loa)}};
            auto rest = block(all_laws[0], element, along);
            add_fibre(*rest, along);
            const double across = std::sqrt(std::sqrt(scale));
            judge_free(book, words(all_laws[0], element) + ", growth " + number(scale, 2), rest, values,
                       along * along.transpose() + across * (Mat3::Identity() - along * along.transpose()), options);
        }
}

/// Targets that are affine maps: a free body takes their shape, or that of their blend where both stretch along the
/// same axes.
void rest_shapes(Book& book, const RunOptions& options) {
    book.open("9", "rest shape of a free body");
    Mat3 shear = Mat3::Identity();
    shear(0, 1) = 0.4, shear(1, 2) = -0.2;
    const Mat3 wide = Vec3(1.4, 0.7, 1).asDiagonal(), tall = Vec3(1, 1, 1.5).asDiagonal();
    struct Blend {
        const char* name;
        std::vector<std::pair<Mat3, double>> targets;
        Mat3 to;
    };
    const Blend blends[] = {
        {"scaled by 0.8", {{0.8 * Mat3::Identity(), 1}}, 0.8 * Mat3::Identity()},
        {"sheared", {{shear, 1}}, shear},
        {"half of wide", {{wide, 0.5}}, Vec3(std::sqrt(1.4), std::sqrt(0.7), 1).asDiagonal()},
        {"wide, and tall by -2", {{wide, 1}, {tall, -2}}, Vec3(1.4, 0.7, 1 / 2.25).asDiagonal()},
    };
    for (const LawName& law : all_laws)
        for (const ElementName& element : elements)
            for (const Blend& blend : blends) {
                if (options.quick && &law != &all_laws[0]) continue;
                TissueInputs values = material(2e4, 0.45);
                values.transverse_anisotropy = 0.5;
                const auto rest = block(law, element, Vec3(1, 0.5, -0.3).normalized());
                std::vector<Target> targets;
                for (const auto& [map, weight] : blend.targets) {
                    Points moved;
                    for (const Vec3& p : rest->tets.vertices) moved.push_back(map * p);
                    const std::vector<double> everywhere(rest->tets.tets.size(), 1.0);
                    targets.emplace_back(
                        std::make_shared<const RestShape>(make_rest_shape(rest->tets, moved, everywhere)), weight);
                }
                judge_free(book, words(law, element) + ", " + blend.name, rest, values, blend.to, options, targets);
            }
}

/// Stiffness about its rest of a body of restScale s over that of the model: one direction's, at one vertex.
void scaled_stiffness(Book& book, const RunOptions&) {
    book.open("9", "stiffness of a scaled body");
    const double s = 1.7, step = 1e-6;
    for (const LawName& law : all_laws)
        for (const ElementName& element : elements) {
            const auto stiffness = [&](double scale) {
                auto rest = block(law, element, Vec3::UnitX());
                TissueInputs values = material(2e4, 0.3);
                values.transverse_anisotropy = 0.5;
                values.layers[0].rest_scale = scale;
                HoldingForces held(*rest, values);
                const Points nodes = nodes_of(*rest);
                const int tip = vertex_at(nodes, {length, thick, thick});
                Points force[2];
                for (const int side : {0, 1}) {
                    std::vector<double> x(3 * nodes.size());
                    for (std::size_t v = 0; v < nodes.size(); ++v)
                        set_position(x, static_cast<int>(v), scale * nodes[v]);
                    x[3 * static_cast<std::size_t>(tip)] += (side ? 1 : -1) * step * scale;
                    force[side] = held.at(x);
                }
                const auto at = static_cast<std::size_t>(tip);
                return (force[1][at] - force[0][at]).x() / (2 * step * scale);
            };
            book.compare(CaseKind::exact, words(law, element), "stiffness / that of the model",
                         stiffness(s) / stiffness(1), s, 1e-7);
        }
}

/// Two halves whose rest lengths differ by a strain bend to a curvature of 3 strain / (2 thickness), whatever
/// Poisson's ratio, where they are slender and the strain is small (Timoshenko 1925).
void bilayer(Book& book, const RunOptions& options) {
    book.open("9", "bilayer strip");
    const double strain = 1e-4, h = 0.02, l = 0.24;
    const int along = options.quick ? 24 : 48;
    auto rest = make_tissue(box_mesh({0, 0, 0}, {l, h, h}, along, 2, 2), ElasticLaw::stvk, ElementKind::quadratic);
    std::vector<double> upper;
    for (const Tet& tet : rest->tets.tets) {
        double z = 0;
        for (const int v : tet) z += 0.25 * rest->tets.vertices[static_cast<std::size_t>(v)].z();
        upper.push_back(z > 0.5 * h ? 1 : 0);
    }
    for (const double nu : {0.0, 0.3}) {
        TissueInputs values = material(1e5, nu);
        FreeBody body(std::make_shared<TissueRest>(*rest), values);
        MaterialValues longer = values.layers[0];
        longer.rest_scale = 1 + strain;
        body.add_layer(upper, longer);
        body.settle(options.stop);
        // Away from the ends, by three points of the middle line.
        const auto at = [&](double x) { return body.place(vertex_at(rest->tets.vertices, {x, 0.5 * h, 0.5 * h})); };
        const Vec3 a = at(0.25 * l), b = at(0.5 * l), c = at(0.75 * l);
        const double curvature = (a - 2 * b + c).norm() / (b - a).squaredNorm();
        book.compare(CaseKind::continuum, "quadratic, nu " + number(nu, 2), "curvature [1/m]", curvature,
                     1.5 * strain / h, 1e-3, body.work);
    }
}

} // namespace

std::vector<AccuracyCase> rest_cases() {
    return {{"rest scale of a free body", rest_scale},        {"growth of a free body", growth},
            {"growth by a line of action", growth_by_line},   {"rest shape of a free body", rest_shapes},
            {"stiffness of a scaled body", scaled_stiffness}, {"bilayer strip", bilayer}};
}

} // namespace sinew::bench
