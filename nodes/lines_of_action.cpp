// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/lines_of_action.h"

#include "nodes/z_solver_attributes.h"
#include "solver/mesh/closest_point.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::nodes {

namespace {

using engine::Reads;

/// Pieces of a span of a cubic in pictures.
constexpr int drawn_per_span = 8;
/// Where a line is looked for in its muscle: this many places on each piece.
constexpr int looked_at = 4;
/// A line is near its muscle within this share of the muscle's size.
constexpr double near_share = 0.1;
/// By its muscle's size: what is shorter is a point and rounding.
constexpr double least_length = 1e-6;

double length_of(const Setup& setup, const SetupLine& l) {
    double length = 0;
    for (const CurvePoints& curve : l.line->line->curves) length += solver::curve_length(curve);
    return length / (setup.key.scale * setup.space.stretch);
}

std::string line_name(const Reads& in, const Setup& setup, const SetupLine& l) {
    return "the line of action of fiber " + std::to_string(l.line->fiber + 1) + " of " +
           in.source_name(z_solver::bodies.name, static_cast<std::size_t>(setup.simulated[l.body]));
}

bool runs_through(const LineOfAction& line, const Mesh& muscle) {
    const solver::SurfaceTree tree(*muscle.points, muscle.topology->triangles);
    const double reach = near_share * solver::bounding_box(*muscle.points).size().maxCoeff();
    for (const CurvePoints& curve : line.curves) {
        const solver::Points points = curve_samples(curve, drawn_per_span);
        for (std::size_t i = 1; i < points.size(); ++i)
            for (int k = 0; k <= looked_at; ++k) {
                const double share = static_cast<double>(k) / looked_at;
                const solver::Vec3 p = (1 - share) * points[i - 1] + share * points[i];
                if (tree.closest(p).distance <= reach || tree.inside_either_way(p)) return true;
            }
    }
    return false;
}

} // namespace

engine::Digest bound_digest(const LineOfAction& line) {
    engine::Hasher h;
    for (const CurvePoints& curve : line.curves) h.add(curve.bound);
    return h.finish();
}

void refuse_unbound_lines(const Reads& in, const Setup& setup, const SceneKey& known) {
    for (std::size_t i = 0; i < setup.lines.size() && i < known.lines.size(); ++i)
        if (setup.key.lines[i] != known.lines[i])
            in.fail(z_solver::bodies.name, "FE282",
                    line_name(in, setup, setup.lines[i]) +
                        " rides on a bone whose mesh is another one than at the start frame, so nothing says where the "
                        "line was drawn",
                    "Connect the bone's mesh before it moves to zRivetToBone.boneAsModelled, or move the bone by "
                    "zBone.matrix.");
}

std::vector<solver::LineMemory> start_lines(const Reads& in, const Setup& setup) {
    std::vector<solver::LineMemory> out;
    for (const SetupLine& l : setup.lines) {
        const double length = length_of(setup, l);
        const double muscle =
            solver::bounding_box(*setup.body(l.body).rest->mesh.points).size().norm() / setup.key.scale;
        if (!(length > least_length * muscle))
            in.fail(z_solver::bodies.name, "FE280", line_name(in, setup, l) + " has no length at the start frame",
                    "Give its curve points that lie apart.");
        out.push_back(solver::start_line(l.line->line->values, length));
    }
    return out;
}

std::vector<solver::LineMemory> follow_lines(const Setup& setup, std::span<const solver::LineMemory> before,
                                             double step) {
    std::vector<solver::LineMemory> out;
    for (std::size_t i = 0; i < setup.lines.size(); ++i) {
        const SetupLine& l = setup.lines[i];
        out.push_back(solver::follow_line(l.line->line->values, before[i], length_of(setup, l), step));
    }
    return out;
}

void use_lines(std::span<const solver::LineMemory> lines, Setup& setup) {
    for (std::size_t i = 0; i < setup.lines.size(); ++i) {
        const SetupLine& l = setup.lines[i];
        const auto& given = std::get<solver::TissueInputs>(setup.body(l.body).values);
        solver::FiberValues& fiber = setup.followed.try_emplace(l.body, given).first->second.fibers[l.line->fiber];
        fiber.excitation = solver::excitation_with(fiber.excitation, lines[i]);
        if (l.line->growth_follows) fiber.growth = std::pow(fiber.growth, lines[i].value);
    }
}

void warn_of_lines_elsewhere(const Reads& in, const Setup& setup) {
    for (const SetupLine& l : setup.lines) {
        if (runs_through(*l.line->line, setup.body(l.body).rest->mesh)) continue;
        in.warn(z_solver::bodies.name, "FE281", line_name(in, setup, l) + " runs nowhere in the muscle, nor near it",
                "Draw the curve from origin to insertion through the muscle as it is modelled, in the same units.");
    }
}

std::vector<LineReport> line_reports(const Setup& setup, std::span<const solver::LineMemory> lines, double run_up) {
    std::vector<LineReport> out;
    for (std::size_t i = 0; i < setup.lines.size(); ++i) {
        const SetupLine& l = setup.lines[i];
        const solver::FiberValues& fiber = setup.tissue_values(l.body).fibers[l.line->fiber];
        out.push_back({setup.simulated[l.body], static_cast<int>(l.line->fiber), lines[i], run_up * fiber.excitation,
                       fiber.growth});
    }
    return out;
}

void add_line_marks(const Setup& setup, std::span<const solver::LineMemory> lines, MarkList& marks) {
    if (setup.lines.empty()) return;
    solver::MarkGroup& group = marks.groups.emplace_back(solver::MarkGroup{"line of action", "loaValue", "1", {}});
    for (std::size_t i = 0; i < setup.lines.size(); ++i) {
        const SetupLine& l = setup.lines[i];
        for (const CurvePoints& curve : l.line->line->curves) {
            const solver::Points points = curve_samples(curve, drawn_per_span);
            for (std::size_t k = 1; k < points.size(); ++k)
                group.marks.push_back(
                    {static_cast<int>(i), points[k - 1], points[k], lines[i].value, {setup.simulated[l.body], -1}});
        }
    }
}

} // namespace sinew::nodes
