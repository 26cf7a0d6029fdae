// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"
#include "nodes/frame_warnings.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/mesh_check.h"
#include "solver/terms/contact/contact_rest.h"
#include "tools/doubts/kinds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace sinew::doubts {

namespace {

/// Points of an open surface that lie farther apart than this share of what they are to stop are too few.
constexpr double widest_spacing = 0.55;
/// Of a body's points within another: real muscles are modelled into each other at their rims, not by a third.
constexpr double deep_share = 0.35;
/// Nor is a tenth of them ever a quarter of the body's breadth deep: such bodies go on through each other.
constexpr double some_share = 0.1, deep_way = 0.25;
/// Pairs that begin deep in each other: told one by one, and looked for.
constexpr std::size_t most_deep_told = 5, most_deep = 100;
/// Of its volume by area, which is half of a plate's thickness.
constexpr double just_below = 0.1;
/// Points of a body that are asked where they are.
constexpr std::size_t most_asked = 400, most_asked_in_passing = 60;

const solver::ContactRest& rest_of(const Member& m) {
    return static_cast<const solver::ContactRest&>(*m.body.contact->rest);
}

/// The middle one of the sides of the box around it.
double breadth(const solver::Points& points) {
    const solver::Box box = solver::bounding_box(points);
    solver::Vec3 sides = box.max - box.min;
    std::sort(sides.data(), sides.data() + 3);
    return sides[1];
}

double median_edge(const nodes::Mesh& mesh) {
    std::vector<double> edges;
    for (const solver::Triangle& t : mesh.topology->triangles)
        for (std::size_t i = 0; i < 3; ++i)
            edges.push_back(((*mesh.points)[at(t[i])] - (*mesh.points)[at(t[(i + 1) % 3])]).norm());
    if (edges.empty()) return 0;
    const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
    std::nth_element(edges.begin(), middle, edges.end());
    return *middle;
}

/// Whether a body comes to another by falling straight, as far as their boxes tell.
bool falls_on(const nodes::Mesh& body, const nodes::Mesh& other, const engine::Vec3& gravity) {
    const solver::Box one = solver::bounding_box(*body.points), two = solver::bounding_box(*other.points);
    const auto along =
        std::max_element(gravity.begin(), gravity.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
        gravity.begin();
    // It may begin inside what is open above, as a bowl.
    const auto axis_down = static_cast<Eigen::Index>(along);
    const double below = gravity[static_cast<std::size_t>(along)] > 0 ? two.max[axis_down] - one.centre()[axis_down]
                                                                      : one.centre()[axis_down] - two.min[axis_down];
    if (!(below > 0)) return false;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        if (axis != along && (one.max[axis] < two.min[axis] || two.max[axis] < one.min[axis])) return false;
    return true;
}

/// A surface that bounds no solid stops others by its points alone; what is smaller than the gaps between them falls
/// through. `spacing` of points that are tested, in scene units; 0: vertices alone.
void open_surface(Doubting& d, const std::string& solver, const Member& surface, const Member& other, double spacing,
                  double units) {
    if (has_faces(rest_of(surface)) || !has_faces(rest_of(other)) || !surface.body.is_bone()) return;
    const auto gravity = d.number<engine::Vec3>(solver, "gravity");
    if (!gravity || *gravity == engine::Vec3{} || !falls_on(mesh_of(other.body), mesh_of(surface.body), *gravity))
        return;
    const double edge = median_edge(mesh_of(surface.body)), gap = spacing > 0 ? std::min(spacing, edge) : edge,
                 size = breadth(*mesh_of(other.body).points);
    if (!(gap > widest_spacing * size) || !d.once("FE340", surface.name)) return;
    d.doubt("FE340", surface.name, "mesh",
            "bounds no solid, so it stops " + other.name + " by its points alone, and those lie " + rough(gap) +
                " apart where " + other.name + " is " + rough(size) + " wide",
            "close it, as by a polyCube in place of a plane, or test more of its points: " + solver +
                ".collisionSubdivision true, collisionPointSpacing " + rough(size / 10 / units) + " m");
}

struct Inside {
    std::size_t count = 0, asked = 0;
    double deepest = 0;
    double share() const { return asked ? static_cast<double>(count) / static_cast<double>(asked) : 0; }
};

/// A body's points and, of a solid, what is just below them: those of two bodies that were copied onto each other lie
/// in each other's faces.
struct Asked {
    solver::Points points, below;
};

Asked asked_points(const Member& body, std::size_t most) {
    const nodes::Mesh& mesh = mesh_of(body.body);
    const std::vector<solver::Triangle>& triangles = mesh.topology->triangles;
    const std::size_t step = mesh.points->size() / most + 1;
    double below = 0;
    solver::Points normals;
    if (body.body.contact && rest_of(body).is_volume) {
        const std::vector<double> areas = solver::vertex_areas(*mesh.points, triangles);
        const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
        if (area > 0) below = just_below * std::max(0.0, solver::enclosed_volume(*mesh.points, triangles)) / area;
        normals = solver::vertex_normals(*mesh.points, triangles);
    }
    Asked out;
    for (std::size_t i = 0; i < mesh.points->size(); i += step) {
        out.points.push_back((*mesh.points)[i]);
        out.below.push_back(normals.empty() ? out.points.back() : solver::Vec3(out.points.back() - below * normals[i]));
    }
    return out;
}

Inside points_inside(const Asked& asked, const solver::Box& box, const solver::SurfaceTree& tree) {
    Inside out;
    const auto is_inside = [&](const solver::Vec3& p) {
        return (p.array() > box.min.array()).all() && (p.array() < box.max.array()).all() && tree.inside(p);
    };
    out.asked = asked.points.size();
    for (std::size_t i = 0; i < asked.points.size(); ++i) {
        if (!is_inside(asked.below[i])) continue;
        ++out.count;
        if (is_inside(asked.points[i])) out.deepest = std::max(out.deepest, tree.closest(asked.points[i]).distance);
    }
    return out;
}

/// A cloth that touches anything, itself included, with a limit of Newton iterations that such steps run into.
void few_iterations_of_cloth(Doubting& d, const std::string& solver, const std::vector<Member>& members) {
    const auto most = d.number<std::int64_t>(solver, "maxNewtonIterations");
    if (!most || *most >= nodes::few_cloth_iterations) return;
    for (const Member& m : members) {
        if (!m.body.is_cloth()) continue;
        const bool meets_itself = may_touch(d, m, m) && d.number<bool>(m.name, "selfCollisions").value_or(true);
        const auto met = std::ranges::find_if(
            members, [&](const Member& other) { return other.name != m.name && may_touch(d, m, other); });
        if (!meets_itself && met == members.end()) continue;
        d.doubt("FE343", solver, "maxNewtonIterations",
                std::to_string(*most) + " are too few where " + m.name + " touches " +
                    (met == members.end() ? "itself" : met->name) + ": a step of cloth that touches or folds takes " +
                    std::to_string(nodes::few_cloth_iterations) + " to " + std::to_string(nodes::most_cloth_iterations),
                "write " + std::to_string(nodes::most_cloth_iterations) +
                    ": it is a limit, and costs nothing where fewer do");
        return;
    }
}

/// Positions of two bodies, the smaller first.
using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

/// What attachments hold to each other.
Pairs tied_pairs(Doubting& d, const std::string& solver, const std::vector<Member>& members) {
    std::vector<nodes::BodyId> ids;
    for (const Member& m : members) ids.push_back(id_of(m.body));
    Pairs out;
    for (const engine::Plug& plug : d.plugs(solver, "attachments"))
        if (const auto a = d.value<nodes::Attachment>(plug); a && a->values.mode() != solver::AttachmentMode::none) {
            const int source = find_body(ids, a->source_body), target = find_body(ids, a->target_body);
            if (source >= 0 && target >= 0) out.insert(std::minmax(at(source), at(target)));
        }
    return out;
}

/// Bodies whose points are another's: a copy that was to go elsewhere, or one file for two. Bones may begin alike.
Pairs doubles(Doubting& d, const std::vector<Member>& members, const Pairs& tied) {
    Pairs out;
    for (std::size_t k = 0; k < members.size(); ++k)
        for (std::size_t i = 0; i < k; ++i) {
            const Member &one = members[i], &other = members[k];
            if (one.body.subtissue || other.body.subtissue || (one.body.is_bone() && other.body.is_bone())) continue;
            if (one.body.is_cloth() != other.body.is_cloth()) continue; // a skin on what it covers
            if (tied.contains({i, k}) || *mesh_of(one.body).points != *mesh_of(other.body).points) continue;
            out.insert({i, k});
            d.doubt("FE341", other.name, "mesh", "begins exactly where " + one.name + " does: every point is the same",
                    "move one of the two, or give it the file that it was to have; or, if they belong together, attach "
                    "them to each other");
        }
    return out;
}

} // namespace

bool may_touch(const Doubting& d, const Member& a, const Member& b) {
    if (!a.body.contact || !b.body.contact) return false;
    const auto values = [&](const Member& m) {
        auto out = solver::get_fields<solver::ContactValues>(m.body.contact->values);
        if (!d.number<bool>(m.name, "collisions")) out.collides = 1;
        if (!d.number<double>(m.name, "contactStiffness")) out.stiffness = 1;
        return out;
    };
    return solver::may_meet(rest_of(a), values(a), rest_of(b), values(b)) &&
           (has_faces(rest_of(a)) || has_faces(rest_of(b)));
}

void doubt_contacts(Doubting& d, const std::string& solver, const std::vector<Member>& members, double units) {
    const Pairs tied = tied_pairs(d, solver, members); // what attachments hold together is left to them
    Pairs told = doubles(d, members, tied);
    if (d.number<bool>(solver, "collisionDetection") == false) return;
    few_iterations_of_cloth(d, solver, members);
    // Keyed: at some time points between vertices are tested.
    const bool subdivided = d.number<bool>(solver, "collisionSubdivision").value_or(true);
    const double spacing = subdivided ? units * d.number<double>(solver, "collisionPointSpacing").value_or(0) : 0;
    const std::size_t most = d.look() == Look::closely ? most_asked : most_asked_in_passing;
    std::vector<solver::Box> boxes;
    std::vector<std::optional<Asked>> asked(members.size());
    for (const Member& m : members) boxes.push_back(solver::bounding_box(*mesh_of(m.body).points));
    const auto apart = [](const solver::Box& a, const solver::Box& b) {
        return (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
    };
    std::size_t deep = 0; // pairs
    for (std::size_t k = 0; k < members.size() && deep < most_deep; ++k) {
        const Member& other = members[k];
        std::unique_ptr<solver::SurfaceTree> tree;
        bool solid = !other.body.subtissue && other.body.contact && rest_of(other).is_volume;
        for (std::size_t i = 0; i < members.size(); ++i) {
            const Member& body = members[i];
            if (i == k || (body.body.is_bone() && other.body.is_bone()) || !may_touch(d, body, other)) continue;
            if (tied.contains(std::minmax(i, k))) continue;
            open_surface(d, solver, body, other, spacing, units);
            if (!solid || body.body.subtissue || told.contains(std::minmax(i, k)) || apart(boxes[i], boxes[k]))
                continue;
            const nodes::Mesh& mesh = mesh_of(other.body);
            if (!tree) {
                solid = solver::is_closed(mesh.topology->triangles);
                if (!solid) continue;
                tree = std::make_unique<solver::SurfaceTree>(*mesh.points, mesh.topology->triangles);
            }
            if (!asked[i]) asked[i] = asked_points(body, most);
            const Inside found = points_inside(*asked[i], boxes[k], *tree);
            if (found.share() < deep_share &&
                !(found.share() > some_share && found.deepest > deep_way * breadth(*mesh_of(body.body).points)))
                continue;
            told.insert(std::minmax(i, k));
            if (++deep > most_deep_told) continue;
            d.doubt("FE341", body.name, "mesh",
                    "begins with " + rough(100 * found.share()) + " % of its points inside " + other.name +
                        (found.deepest > 0 ? ", up to " + rough(found.deepest) + " scene units deep" : "") +
                        ", and contact is to push it out",
                    "move it outside; or, if it belongs there, attach the two to each other, or let collisionSets or "
                    "collisions keep them from colliding");
        }
    }
    if (deep > most_deep_told)
        d.doubt("FE341", solver, "bodies",
                (deep < most_deep ? std::to_string(deep - most_deep_told)
                                  : "at least " + std::to_string(deep - most_deep_told)) +
                    " other pairs of bodies begin inside each other, too",
                "move them apart");
}

} // namespace sinew::doubts
