// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/text.h"
#include "solver/mesh/corner_welder.h"
#include "solver/mesh/edge_ways.h"
#include "solver/mesh/mesh_check.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/thickness.h"
#include "solver/meshing/lattice.h"
#include "tools/doubts/kinds.h"
#include "tools/embed/graph_walk.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace sinew::doubts {

namespace {

/// Parts are thin below this share of a tet's length; muscles taper, so it takes this share of the surface. So do parts
/// of up to a third of a tet's length where they are most of the surface.
struct Thin {
    double part, share;
    const char* words;
};
constexpr Thin thin_limits[] = {{0.25, 0.25, "a quarter"}, {0.34, 0.6, "a third"}};
/// And linear tets of flesh, which bends: a bar of them gives way under its weight .52 to .57 of what fine ones do
/// where they are as large as it is thick, .29 to .36 at 1.5 times that, .19 to .23 at twice; quadratic ones .97, .95
/// and .85.
constexpr Thin thin_for_bending = {0.67, 0.6, "two thirds"};
/// A tendon or a piece of rubber is pulled, and hardly bends [Pa].
constexpr double hardly_bends = 1e6;
/// Parts share vertices of a lattice where they lie less than about this many tets from each other: a spring of round
/// wire is 39 times too stiff at .9 of a tet from turn to turn, 8 times at 1.4, a third at 1.8, and right at 2.25.
constexpr double tied_within = 1.5;
/// And more than this many along the surface: in a crease they are near both ways. Rounded parts face each other on
/// little of their surface.
constexpr double far_along = 4, tied_share = 0.1;
/// A body that is shorter than one of its tets; as long as one is what a block as a mass on a spring is.
constexpr double least_tets_along = 0.95;
/// Of its length; a cloth that is thicker is none.
constexpr double thickest_sheet = 0.1;
constexpr std::size_t most_rays = 20000, most_rays_in_passing = 1000, most_gaps = 500;
/// Triangles of a mesh that is looked at for flaws in passing.
constexpr std::size_t most_triangles_in_passing = 20000;

double longest_edge(const solver::TissueRest& rest, int tet) {
    double longest = 0;
    const solver::Tet& t = rest.tets.tets[at(tet)];
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < i; ++j)
            longest = std::max(longest, (rest.tets.vertices[at(t[i])] - rest.tets.vertices[at(t[j])]).norm());
    return longest;
}

/// What of a surface is thinner than the tets there, or nearer to another part of it.
struct Narrow {
    std::vector<std::pair<double, double>> parts; ///< thickness or gap, area
    double area = 0, narrow_area = 0, largest = 0, largest_narrow = 0;

    void add(const solver::Thickness& t, double tet_length, bool is_narrow) {
        area += t.area;
        largest = std::max(largest, tet_length);
        if (!is_narrow) return;
        parts.emplace_back(t.distance, t.area);
        narrow_area += t.area;
        largest_narrow = std::max(largest_narrow, tet_length);
    }

    double share() const { return narrow_area / area; }

    /// Half of what is narrow is narrower.
    double usual() {
        std::sort(parts.begin(), parts.end());
        double passed = 0, width = 0;
        for (std::size_t i = 0; i < parts.size() && passed < narrow_area / 2; ++i)
            passed += parts[i].second, width = parts[i].first;
        return width;
    }
};

/// Length of the tets at a triangle.
double tet_length(const solver::TissueRest& rest, int triangle) {
    return longest_edge(rest, rest.embedding.tet[at(rest.triangles[at(triangle)][0])]);
}

Narrow thin_parts(const solver::TissueRest& rest, const std::vector<solver::Thickness>& all, double part) {
    Narrow out;
    for (const solver::Thickness& t : all) {
        const double length = tet_length(rest, t.triangle);
        out.add(t, length, t.distance < part * length);
    }
    return out;
}

/// A surface with one vertex at each place.
struct Joined {
    solver::Points points;
    std::vector<solver::Triangle> triangles;
    Joined(const solver::Points& own, const std::vector<solver::Triangle>& corners)
        : triangles(corners) {
        solver::CornerWelder welder;
        std::vector<int> vertex;
        for (const solver::Vec3& p : own) vertex.push_back(welder.add(p));
        for (solver::Triangle& t : triangles)
            for (int& v : t) v = vertex[at(v)];
        points = std::move(welder.points);
    }
};

/// Parts that tets reach across to from others.
Narrow tied_parts(const solver::TissueRest& rest) {
    Narrow out;
    std::optional<Joined> joined;
    std::optional<solver::EdgeWays> ways;
    for (const solver::Thickness& t : solver::gaps(rest.surface, rest.triangles, most_gaps)) {
        const double length = tet_length(rest, t.triangle);
        const bool is_near = t.distance < tied_within * length;
        if (is_near && !ways) {
            joined.emplace(rest.surface, rest.triangles);
            ways.emplace(joined->points, joined->triangles);
        }
        const auto corners = [&](int triangle) -> const solver::Triangle& { return joined->triangles[at(triangle)]; };
        out.add(t, length, is_near && ways->are_farther(corners(t.triangle), corners(t.opposite), far_along * length));
    }
    return out;
}

/// Where no transform is told to mirror it.
void doubt_inside_out(Doubting& d, const Member& m) {
    if (d.has_said("FE265", m.name)) return;
    d.doubt("FE321", m.name, "mesh", "all faces of its mesh look inwards",
            "turn them where it is modelled; pressure, contact and drawing go by the side that a face shows");
}

} // namespace

void doubt_moving_mesh(Doubting& d, const std::string& body) {
    const engine::Timing& timing = d.graph().timing();
    for (const engine::Plug& plug : d.plugs(body, "mesh")) {
        // Nothing is simulated for a doubt.
        if (!embed::simulations(d.graph(), embed::upstream_of(d.graph(), {plug.node})).empty()) continue;
        const auto first = d.value<nodes::Mesh>(plug);
        if (!first) continue;
        // Halfway as well: what comes back at the end has moved, too.
        for (const double frame : {timing.start + 1.0, 0.5 * (timing.start + timing.end), 1.0 * timing.end}) {
            if (!(frame > timing.start) || frame > timing.end) continue;
            const auto later = d.value<nodes::Mesh>(plug, frame);
            if (!later ||
                (later->points_digest == first->points_digest && later->topology->digest == first->topology->digest))
                continue;
            d.doubt("FE211", body, "mesh",
                    "its mesh is another one at frame " + engine::number_text(frame) +
                        ", and the run ends where the rest shape changes",
                    "meshes, tets and painted maps must not change over time; move what it is attached to, or key "
                    "zSolver.translate and rotate for a frame that moves");
            break;
        }
    }
}

void doubt_mesh(Doubting& d, const Member& m) {
    if (m.body.is_bone()) return;
    const auto& triangles = m.body.rest->mesh.topology->triangles;
    if (d.look() == Look::in_passing && triangles.size() > most_triangles_in_passing) return;
    const solver::MeshCheck check = solver::check_mesh(*m.body.rest->mesh.points, triangles);
    if (check.duplicate_triangles)
        d.doubt("FE321", m.name, "mesh",
                "its mesh has " +
                    solver::describe(check.duplicate_triangles, "repeated triangle", "repeated triangles"),
                "remove faces that are there twice, or remesh it by zIsoMesh; volume, pressure and contact count them "
                "twice");
    else if (m.body.is_cloth() && check.components > 1 && check.coinciding_vertices)
        d.doubt("FE321", m.name, "mesh",
                "its mesh falls into " + std::to_string(check.components) + " parts that nothing joins, with " +
                    solver::describe(check.coinciding_vertices, "vertex at the place of another",
                                     "vertices at the places of others"),
                "merge vertices that lie at one place where it is modelled");
    else if (check.badly_oriented_edges)
        d.doubt("FE321", m.name, "mesh",
                "some faces of its mesh look the other way than their neighbours: " +
                    solver::describe(check.badly_oriented_edges, "edge between opposite sides",
                                     "edges between opposite sides"),
                "turn the faces alike where it is modelled, or remesh it by zIsoMesh; pressure, contact and drawing go "
                "by the side that a face shows");
    else if (check.is_closed() && check.volume < 0)
        doubt_inside_out(d, m);
}

void doubt_bone(Doubting& d, const Member& m, const std::vector<Member>& all) {
    const nodes::Mesh& mesh = mesh_of(m.body);
    const auto& triangles = mesh.topology->triangles;
    if (!m.body.is_bone() || mesh.points->empty()) return;
    if (d.look() == Look::in_passing && triangles.size() > most_triangles_in_passing) return;
    if (!solver::is_closed(triangles) || solver::enclosed_volume(*mesh.points, triangles) >= 0) return;
    // A room is meant to look inwards.
    const solver::Box box = solver::bounding_box(*mesh.points);
    for (const Member& other : all) {
        if (&other == &m) continue;
        const solver::Vec3 centre = solver::bounding_box(*mesh_of(other.body).points).centre();
        if ((centre.array() > box.min.array()).all() && (centre.array() < box.max.array()).all()) return;
    }
    doubt_inside_out(d, m);
}

void doubt_thickness(Doubting& d, const Member& m, double units) {
    if (!m.body.is_cloth() || !d.graph().find(m.name)->inputs.contains("thickness")) return; // only contact reads it
    const double length = extent(*m.body.rest->mesh.points);
    if (const auto thickness = d.number<double>(m.name, "thickness");
        thickness && *thickness * units > thickest_sheet * length)
        d.doubt("FE337", m.name, "thickness",
                rough(1000 * *thickness) + " mm is " + rough(100 * *thickness * units / length) +
                    " % of its length of " + rough(1000 * length / units) + " mm",
                "thickness is in metres, whatever the scene's scale: 0.001 is a millimetre");
}

namespace {

/// How much more the tets count as solid than the surface encloses, in words; empty where that is hardly any.
std::string gain_of(const solver::TissueRest& rest) {
    constexpr double told_from = 0.02;
    const double enclosed = solver::enclosed_volume(rest.surface, rest.triangles);
    double solid = 0;
    for (std::size_t t = 0; t < rest.tets.tets.size(); ++t) {
        const auto corner = [&](std::size_t c) -> const solver::Vec3& {
            return rest.tets.vertices[static_cast<std::size_t>(rest.tets.tets[t][c])];
        };
        solid += rest.tets.coverage[t] * std::abs(solver::tet_volume(corner(0), corner(1), corner(2), corner(3)));
    }
    if (!(enclosed > 0) || solid < (1 + told_from) * enclosed) return {};
    return "; they count as " + rough(100 * (solid / enclosed - 1)) + " % more flesh than the mesh encloses";
}

} // namespace

namespace {

/// "a tetSize of about 0.2", and the maxResolution that so many cubes along `length` need, if it is higher than that of
/// `tets` (a zTet, or a tissue that has none yet).
std::string size_advised(Doubting& d, const std::string& tets, double size, double length, const char* words) {
    const std::string out = "a tetSize of " + std::string(words) + " " + rough(size);
    const auto limit = d.number<std::int64_t>(tets, "maxResolution").value_or(solver::LatticeOptions{}.max_resolution);
    const bool refined = d.graph().find(tets)->inputs.contains("weights");
    const double levels = refined ? std::ceil(d.number<double>(tets, "envelope").value_or(1) *
                                              d.number<double>(tets, "surfaceRefinement").value_or(1))
                                  : 0;
    // Room for what rounding the size takes; to the next ten.
    const double along = 10 * std::ceil(0.105 * length / size * std::exp2(levels) - 1e-6);
    if (along <= static_cast<double>(limit)) return out;
    return out + " and a maxResolution of " + engine::number_text(along);
}

/// Whether the tets' bending counts: flesh, by its softest layer, in linear tets.
bool shall_bend(Doubting& d, const Member& m) {
    for (const engine::Plug& plug : d.plugs(m.name, "tets"))
        if (const auto tets = d.value<nodes::TetMeshValue>(plug))
            if (tets->element == solver::ElementKind::quadratic) return false;
    for (const engine::Plug& layer : d.plugs(m.name, "materials"))
        if (const auto material = d.value<nodes::Material>(layer))
            if (material->values.youngs_modulus < hardly_bends) return true;
    return false;
}

} // namespace

void doubt_tets(Doubting& d, const Member& m) {
    const auto* of_tissue = std::get_if<0>(&m.body.rest->data);
    if (!of_tissue) return;
    const solver::TissueRest& rest = **of_tissue;
    if (rest.tets.coverage.empty()) return; // tets that fit the surface
    const std::size_t most = d.look() == Look::closely ? most_rays : most_rays_in_passing;
    const std::vector<solver::Thickness> all = solver::thickness(rest.surface, rest.triangles, most);
    const Narrow whole = thin_parts(rest, all, 1);
    const std::vector<engine::Plug> tets = d.plugs(m.name, "tets");
    const bool sized = !tets.empty() && d.graph().find(tets.front().node)->type_name == "zTet";
    const std::string node = sized ? tets.front().node : m.name, attribute = sized ? "tetSize" : "tets";
    const std::string take = sized ? "choose" : "connect a zTet with";
    const double length = extent(rest.surface);
    if (length < least_tets_along * whole.largest) {
        d.doubt("FE262", node, attribute,
                m.name + " is " + rough(length) + " long and its tets are " + rough(whole.largest) +
                    ", so it cannot bend",
                take + " " + size_advised(d, node, length / 8, length, "about"));
        return;
    }
    std::vector<Thin> limits(std::begin(thin_limits), std::end(thin_limits));
    if (shall_bend(d, m)) limits.push_back(thin_for_bending);
    for (const Thin& limit : limits) {
        Narrow thin = thin_parts(rest, all, limit.part);
        if (!(thin.share() > limit.share)) continue;
        d.doubt("FE262", node, attribute,
                rough(100 * thin.share()) + " % of the surface of " + m.name + " belongs to parts about " +
                    rough(thin.usual()) + " thick, less than " + limit.words + " of the tets there (" +
                    rough(thin.largest_narrow) + ")" + gain_of(rest),
                take + " " + size_advised(d, node, thin.usual(), length, "about") +
                    (limit.part < thin_for_bending.part
                         ? ", or refine there by weights and surfaceRefinement"
                         : ", or set element to quadratic: linear tets of that size bend too little by far"));
        break;
    }
    if (Narrow tied = tied_parts(rest); tied.share() > tied_share)
        d.doubt("FE262", node, attribute,
                rough(100 * tied.share()) + " % of the surface of " + m.name + " lies about " + rough(tied.usual()) +
                    " from another part of it, less than one and a half of the tets there (" +
                    rough(tied.largest_narrow) + "), which tie the two together",
                take + " " + size_advised(d, node, tied.usual() / 2, length, "at most") +
                    ", or refine there by weights and surfaceRefinement");
}

} // namespace sinew::doubts
