// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/options.h"
#include "solver/joined_sets.h"
#include "solver/mesh/closest_point.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/mesh/surface_pieces.h"
#include "solver/terms/hold/hold.h"
#include "tools/doubts/kinds.h"

#include <algorithm>
#include <map>
#include <optional>

namespace sinew::doubts {

namespace {

/// Vertices that are asked for what they hold on to.
constexpr std::size_t most_asked = 20000;

/// What moves by itself: a body, or what of one no tet joins to the rest of it.
struct Pieces {
    int first = 0, count = 1;   ///< numbers of the pieces, over all bodies
    std::vector<int> of_vertex; ///< of the body's surface; empty: all are of the one piece
    int of(std::size_t vertex) const { return vertex < of_vertex.size() ? of_vertex[vertex] : first; }
    bool is_split() const { return count > 1; }
};

/// By what vertices are joined through: `root` of each.
Pieces numbered(const std::vector<int>& root, int first) {
    Pieces out{first, 0, {}};
    std::map<int, int> known; // root, piece
    for (const int r : root) {
        const auto [piece, is_new] = known.emplace(r, first + out.count);
        if (is_new) ++out.count;
        out.of_vertex.push_back(piece->second);
    }
    if (out.count <= 1) return {first, 1, {}};
    return out;
}

Pieces pieces_of(const nodes::Body& body, int first) {
    if (body.is_bone() || body.subtissue) return {first, 1, {}};
    if (body.is_cloth()) {
        // Vertices that should be one are told otherwise.
        const auto pieces = solver::find_pieces_by_place(*body.rest->mesh.points, body.rest->mesh.topology->triangles);
        std::vector<int> roots;
        for (const int piece : pieces.of_point) roots.push_back(std::max(piece, 0)); // -1: of no triangle
        return numbered(roots, first);
    }
    const solver::TissueRest& rest = **std::get_if<0>(&body.rest->data);
    if (rest.tets.tets.empty()) return {first, 1, {}};
    solver::JoinedSets joined(rest.tets.vertices.size());
    for (const auto& tet : rest.tets.tets)
        for (const int v : tet) joined.join(tet[0], v);
    std::vector<int> roots;
    for (const int tet : rest.embedding.tet) roots.push_back(joined.root(rest.tets.tets[at(tet)][0]));
    return numbered(roots, first);
}

/// The body, or where several are alike (bones of one mesh in one place) all that may be meant.
std::vector<int> bodies_meant(const std::vector<nodes::BodyId>& ids, const nodes::BodyId& wanted) {
    if (const int one = find_body(ids, wanted); one >= 0) return {one};
    std::vector<int> out;
    for (std::size_t i = 0; i < ids.size(); ++i)
        if (ids[i].rest == wanted.rest) out.push_back(static_cast<int>(i));
    return out;
}

/// Attachments that are there but pull at nothing, at all frames.
bool is_idle(const Doubting& d, const std::string& attachment) {
    return d.number<double>(attachment, "envelope") == 0.0 || d.number<double>(attachment, "stiffness") == 0.0;
}

/// Of a surface's vertices: those with a weight above 0, or at a triangle with one.
std::vector<char> painted(const nodes::Mesh& mesh, const std::vector<double>& weights, solver::PaintedOn on) {
    if (weights.empty()) return std::vector<char>(mesh.points->size(), 1);
    if (weights.size() == 1) return std::vector<char>(mesh.points->size(), weights[0] > 0);
    const auto& triangles = mesh.topology->triangles;
    return on == solver::PaintedOn::faces ? solver::painted_triangles(triangles, mesh.points->size(), weights).vertices
                                          : solver::painted_vertices(triangles, weights).vertices;
}

/// Which pieces of a solver's bodies hold on to which.
class Ties {
  public:
    Ties(Doubting& d, const std::vector<Member>& members)
        : d_(d)
        , members_(members) {
        for (const Member& m : members) {
            ids_.push_back(id_of(m.body));
            pieces_.push_back(pieces_of(m.body, static_cast<int>(held_.size())));
            held_.resize(held_.size() + at(pieces_.back().count), m.body.is_bone());
        }
    }

    void hold(const nodes::Force& force) {
        const auto* rest = dynamic_cast<const solver::HoldRest*>(force.rest.get());
        for (const nodes::BodyId& id : force.bodies)
            for (const int i : bodies_meant(ids_, id))
                if (rest && pieces_[at(i)].is_split())
                    for (std::size_t v = 0; v < rest->part.vertices.size(); ++v) {
                        if (rest->part.vertices[v]) held_[at(pieces_[at(i)].of(v))] = 1;
                    }
                else
                    for (int p = 0; p < pieces_[at(i)].count; ++p) held_[at(pieces_[at(i)].first + p)] = 1;
    }

    void attach(const nodes::Attachment& a) {
        for (const int source : bodies_meant(ids_, a.source_body))
            for (const int target : bodies_meant(ids_, a.target_body)) attach(at(source), at(target), a.rest);
    }

    /// All of one body to all of another, or of itself.
    void link(std::size_t a, std::size_t b) {
        for (const Pieces* one : {&pieces_[a], &pieces_[b]})
            for (int i = 1; i < one->count; ++i) links_.push_back({one->first, one->first + i});
        links_.push_back({pieces_[a].first, pieces_[b].first});
    }

    /// A part of a tissue goes with it, and what may be touched may catch what falls.
    void link_bodies(bool collides) {
        for (std::size_t i = 0; i < members_.size(); ++i)
            for (std::size_t k = 0; k < members_.size() && members_[i].body.subtissue; ++k)
                for (const nodes::BodyRest::Part& part : members_[k].body.rest->parts)
                    if (part.digest == members_[i].body.subtissue->digest) link(i, k);
        for (std::size_t i = 0; i < members_.size() && collides; ++i) {
            if (d_.number<bool>(members_[i].name, "selfCollisions").value_or(true)) link(i, i); // keyed: later
            for (std::size_t k = i + 1; k < members_.size(); ++k)
                if (may_touch(d_, members_[i], members_[k])) link(i, k);
        }
    }

    void spread() {
        solver::JoinedSets joined(held_.size());
        for (const auto& [a, b] : links_) joined.join(a, b);
        std::vector<char> holds(held_.size(), 0);
        for (std::size_t p = 0; p < held_.size(); ++p)
            if (held_[p]) holds[at(joined.root(static_cast<int>(p)))] = 1;
        for (std::size_t p = 0; p < held_.size(); ++p) held_[p] = holds[at(joined.root(static_cast<int>(p)))];
    }

    const Pieces& pieces(std::size_t member) const { return pieces_[member]; }
    /// Of a body: its pieces that nothing holds.
    std::vector<int> loose(std::size_t member) const {
        std::vector<int> out;
        for (int p = pieces_[member].first; p < pieces_[member].first + pieces_[member].count; ++p)
            if (!held_[at(p)]) out.push_back(p);
        return out;
    }

  private:
    /// Of the pieces that are painted each to that which is nearest to it.
    void attach(std::size_t source, std::size_t target, const solver::AttachmentRest& rest) {
        const Pieces &from = pieces_[source], &to = pieces_[target];
        if (!from.is_split() && !to.is_split()) return link(source, target);
        const nodes::Mesh &mesh = mesh_of(members_[source].body), &other = mesh_of(members_[target].body);
        const std::vector<char> is_painted = painted(mesh, rest.source_weights, rest.source_painted);
        const std::vector<char> may_hold = painted(other, rest.target_weights, rest.target_painted);
        std::optional<solver::SurfaceTree> tree;
        std::vector<char> allowed;
        if (to.is_split() && rest.correspondence == solver::Correspondence::closest_point) {
            tree.emplace(*other.points, other.topology->triangles);
            for (const auto& [a, b, c] : other.topology->triangles)
                allowed.push_back(may_hold[at(a)] || may_hold[at(b)] || may_hold[at(c)]);
        }
        const std::size_t stride = 1 + mesh.points->size() / most_asked;
        std::size_t asked = 0;
        for (std::size_t v = 0; v < mesh.points->size(); ++v) {
            if (v >= is_painted.size() || !is_painted[v]) continue;
            int piece = to.of(v);
            if (tree) {
                if (asked++ % stride != 0) continue;
                const solver::ClosestPoint c = tree->closest((*mesh.points)[v], allowed);
                if (c.triangle < 0) continue;
                piece = to.of(at(other.topology->triangles[at(c.triangle)][0]));
            }
            const std::array<int, 2> link{from.of(v), piece};
            if (links_.empty() || links_.back() != link) links_.push_back(link);
        }
    }

    Doubting& d_;
    const std::vector<Member>& members_;
    std::vector<nodes::BodyId> ids_;
    std::vector<Pieces> pieces_;
    std::vector<char> held_;
    std::vector<std::array<int, 2>> links_;
};

/// "12.5 long, around (10, 20, 0)": of the largest of these pieces.
std::string place_of(const Member& m, const Pieces& pieces, const std::vector<int>& which) {
    const solver::Points& points = *m.body.rest->mesh.points;
    std::vector<solver::Points> own(at(pieces.count));
    for (std::size_t v = 0; v < points.size(); ++v) own[at(pieces.of(v) - pieces.first)].push_back(points[v]);
    solver::Box largest{solver::Vec3::Zero(), solver::Vec3::Zero()};
    for (const int piece : which) {
        const solver::Box box = solver::bounding_box(own[at(piece - pieces.first)]);
        if (box.size().maxCoeff() > largest.size().maxCoeff()) largest = box;
    }
    const solver::Vec3 middle = largest.centre();
    const auto number = [](double v) { return rough(v, 3); };
    return number(largest.size().maxCoeff()) + " long, around (" + number(middle.x()) + ", " + number(middle.y()) +
           ", " + number(middle.z()) + ")";
}

} // namespace

void doubt_floating(Doubting& d, const std::string& solver, const std::vector<Member>& members) {
    const auto gravity = d.number<engine::Vec3>(solver, "gravity");
    const auto integrator = d.number<std::string>(solver, "integrator");
    if (gravity == engine::Vec3{}) return;
    if (integrator == std::string(nodes::word_of(solver::Integrator::quasi_static))) return; // FE303
    Ties ties(d, members);
    for (const engine::Plug& plug : d.plugs(solver, "forces"))
        if (const auto force = d.value<nodes::Force>(plug); force && force->type->ties) ties.hold(*force);
    std::string idle;
    for (const engine::Plug& plug : d.plugs(solver, "attachments"))
        if (const auto a = d.value<nodes::Attachment>(plug); a && a->values.mode() != solver::AttachmentMode::none) {
            if (is_idle(d, plug.node))
                idle += (idle.empty() ? "" : ", ") + plug.node;
            else
                ties.attach(*a);
        }
    const bool collides = d.number<bool>(solver, "collisionDetection").value_or(true); // keyed: later
    ties.link_bodies(collides);
    ties.spread();

    const auto why = [&](bool many) {
        return std::string(": no chain of attachments ties ") + (many ? "them" : "it") +
               " to a bone, and nothing holds " + (many ? "them" : "it") +
               (collides ? many ? " or could catch them" : " or could catch it" : "") +
               (idle.empty() ? "" : "; attachments without stiffness or envelope tie nothing: " + idle);
    };
    std::vector<std::string> falling;
    for (std::size_t i = 0; i < members.size(); ++i) {
        if (members[i].body.subtissue) continue;
        const std::vector<int> loose = ties.loose(i);
        const int count = static_cast<int>(loose.size());
        if (count == ties.pieces(i).count)
            falling.push_back(members[i].name);
        else if (count > 0)
            d.doubt("FE260", solver, "bodies",
                    (count == 1 ? "a piece of " + members[i].name + " falls, "
                                : std::to_string(count) + " of the " + std::to_string(ties.pieces(i).count) +
                                      " pieces of " + members[i].name + " fall, the largest ") +
                        place_of(members[i], ties.pieces(i), loose) + why(count > 1),
                    "attach it as well, or hold it by zHold; or take it out of the mesh");
    }
    // What a whole scene does is told once.
    const bool many = falling.size() > 3;
    const std::string cure = many
                                 ? "attach each to a bone, hold a part of it by zHold, or switch gravity off: [0, 0, 0]"
                                 : "attach it to a bone, hold a part of it by zHold, or switch gravity off: [0, 0, 0]";
    if (many)
        falling = {falling[0] + ", " + falling[1] + ", " + falling[2] + " and " + std::to_string(falling.size() - 3) +
                   (falling.size() > 4 ? " others fall" : " other fall")};
    for (const std::string& name : falling)
        d.doubt("FE260", solver, "bodies", name + (many ? "" : " falls") + why(many), cure);
}

} // namespace sinew::doubts
