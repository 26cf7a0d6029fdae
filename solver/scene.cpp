// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/scene.h"

#include "solver/error.h"
#include "solver/system.h"
#include "solver/term/type.h"
#include "solver/terms/cloth/check_cloth.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace sinew::solver {

namespace {

/// Element entries are named by twice their place plus a bit, as an int.
constexpr std::size_t most_entries = (std::size_t{1} << 30) - 1;

[[noreturn]] void refuse(int body, const std::string& code, const std::string& message, const std::string& hint) {
    Error e(code, message, hint);
    e.body = body;
    throw e;
}

void check_tissue(const TissueRest& t, int body) {
    const std::size_t n = t.tets.tets.size();
    if (n == 0) refuse(body, "FE201", "the tissue has no tets", "its mesh or lattice must not be empty");
    for (std::size_t v = 0; v < t.tets.vertices.size(); ++v)
        if (!t.tets.vertices[v].allFinite())
            refuse(body, "FE202", "vertex " + std::to_string(v) + " of the tet mesh is not a finite number",
                   "repair the mesh");
    for (const Tet& tet : t.tets.tets)
        for (const int v : tet)
            if (v < 0 || static_cast<std::size_t>(v) >= t.tets.vertices.size())
                refuse(body, "FE203",
                       "a tet names vertex " + std::to_string(v) + " of " + std::to_string(t.tets.vertices.size()),
                       "vertex numbers count from 0");
    for (const auto& w : t.layer_weights)
        if (w.size() != n)
            refuse(body, "FE204",
                   "a material layer has " + std::to_string(w.size()) + " weights for " + std::to_string(n) + " tets",
                   "one weight per tet");
    if (needs_direction(t.law) && t.stiff_directions.size() != n)
        refuse(body, "FE225",
               "the law " + std::string(law_facts(t.law).name) + " has " + std::to_string(t.stiff_directions.size()) +
                   " directions for " + std::to_string(n) + " tets",
               "connect a fibre: it gives the stiff direction");
    if (t.layer_weights.empty()) refuse(body, "FE206", "the tissue has no material", "connect at least one zMaterial");
    for (const auto& f : t.fibers)
        if (f.directions.size() != n || f.weights.size() != n)
            refuse(body, "FE204",
                   "a fibre field has " + std::to_string(f.directions.size()) + " directions and " +
                       std::to_string(f.weights.size()) + " weights for " + std::to_string(n) + " tets",
                   "one of each per tet");
    // A weight that is not a number would pass every comparison below and come out as an energy that is none.
    const auto all_finite = [](const std::vector<double>& values) {
        return std::all_of(values.begin(), values.end(), [](double w) { return std::isfinite(w); });
    };
    for (const auto& w : t.layer_weights)
        if (!all_finite(w))
            refuse(body, "FE202", "a weight of a material layer is not a finite number", "check the painted map");
    for (const auto& f : t.fibers)
        if (!all_finite(f.weights) ||
            !std::all_of(f.directions.begin(), f.directions.end(), [](const Vec3& d) { return d.allFinite(); }))
            refuse(body, "FE202", "a weight or direction of a fibre field is not a finite number",
                   "check the painted map");
    if (!all_finite(t.tets.coverage))
        refuse(body, "FE202", "the coverage of a tet is not a finite number", "it lies between 0 and 1");
    const CutTets& cut = t.tets.cut;
    if (cut.tets.empty()) return;
    if (cut.moments.size() != moment_count(cut.degree) * cut.tets.size() || t.tets.coverage.size() != n)
        refuse(body, "FE204",
               std::to_string(cut.moments.size()) + " moments of " + std::to_string(cut.tets.size()) +
                   " cut tets, and " + std::to_string(t.tets.coverage.size()) + " coverages of " + std::to_string(n) +
                   " tets",
               std::to_string(moment_count(cut.degree)) + " moments a cut tet, one coverage a tet");
    for (std::size_t k = 0; k < cut.tets.size(); ++k)
        if (cut.tets[k] < 0 || static_cast<std::size_t>(cut.tets[k]) >= n || (k > 0 && cut.tets[k] <= cut.tets[k - 1]))
            refuse(body, "FE203", "cut tet " + std::to_string(cut.tets[k]) + " of " + std::to_string(n) + " tets",
                   "each is named once, in increasing order");
    if (!all_finite(cut.moments))
        refuse(body, "FE202", "a moment of a cut tet is not a finite number", "check what made the tets");
    if (t.element == ElementKind::quadratic && cut.degree != 4)
        refuse(body, "FE226", "the lattice was made for linear tets and knows too little about the tets it cuts",
               "make it for quadratic ones: zTet.element where the lattice is made, LatticeOptions::moments 4");
}

void check_subtissues(const TissueRest& t, int body) {
    const std::size_t n = t.tets.tets.size();
    for (const SubtissueRest& part : t.subtissues) {
        const auto fits = [&](const std::vector<double>& w) {
            return w.size() == n && std::all_of(w.begin(), w.end(), [](double x) { return std::isfinite(x); });
        };
        if (part.layer_weights.empty())
            refuse(body, "FE206", "a subtissue has no material", "connect at least one zMaterial");
        if (!fits(part.shares) || !std::all_of(part.layer_weights.begin(), part.layer_weights.end(), fits))
            refuse(body, "FE204", "a subtissue's shares or weights are not one finite number for each tet",
                   "one number per tet");
    }
}

/// A surface that rides on the tets of another body.
void check_carried(const SceneDescription& scene, const TissueRest& t, int body) {
    const auto carrier = static_cast<std::size_t>(t.carried_by);
    const auto* p = carrier < scene.bodies.size()
                        ? std::get_if<std::shared_ptr<const TissueRest>>(&scene.bodies[carrier])
                        : nullptr;
    if (!p || (*p)->carried_by >= 0 || (*p)->tets.tets.size() != t.tets.tets.size() || (*p)->element != t.element)
        refuse(body, "FE209", "what carries a subtissue is no tissue of the scene with the same tets",
               "connect the tissue that it is a part of to zSolver.bodies too");
}

double volume_of(const TetMesh& mesh) {
    double volume = 0;
    for (const Tet& tet : mesh.tets) {
        const auto corner = [&](std::size_t k) -> const Vec3& {
            return mesh.vertices[static_cast<std::size_t>(tet[k])];
        };
        volume += tet_volume(corner(0), corner(1), corner(2), corner(3));
    }
    return volume;
}

/// make_batches, whose Error does not know the body.
std::vector<TetBatch> checked_batches(const TissueRest& t, int first_vertex, int body) {
    try {
        return make_batches(t.tets, first_vertex);
    } catch (Error& e) {
        e.body = body;
        throw;
    }
}

std::vector<Anisotropy> make_anisotropy(const TissueRest& t, std::size_t batch_count) {
    std::vector<Anisotropy> out(batch_count);
    for (std::size_t slot = 0; slot < batch_count * lanes; ++slot) {
        const Vec3 d = t.stiff_directions[std::min(slot, t.tets.tets.size() - 1)];
        Anisotropy& a = out[slot / lanes];
        for (int c = 0; c < 3; ++c) a.direction[c][slot % lanes] = d[c];
        a.root[slot % lanes] = d.squaredNorm() > 0 ? 1 : 0; // 0 marks tets that stay isotropic
    }
    return out;
}

/// Numbers the middles of the edges after the corners and puts them into batches like those of the corners.
void add_edges(const TissueRest& t, int first_vertex, const std::vector<TetBatch>& corners, Points& nodes,
               Scene::System& system) {
    const std::vector<std::array<int, 2>> edges = edges_of(t.tets.tets);
    for (const auto& [a, b] : edges)
        nodes.push_back(0.5 *
                        (t.tets.vertices[static_cast<std::size_t>(a)] + t.tets.vertices[static_cast<std::size_t>(b)]));
    const std::size_t first_batch = system.edge_batches.size();
    system.edge_batches.resize(first_batch + corners.size());
    auto& of_tets = system.edge_vertices.back();
    of_tets = edge_vertices(t.tets.tets, edges, first_vertex + static_cast<int>(t.tets.vertices.size()));
    for (std::size_t slot = 0; slot < corners.size() * lanes; ++slot)
        for (std::size_t e = 0; e < 6; ++e)
            system.edge_batches[first_batch + slot / lanes].vertex[e][slot % lanes] =
                of_tets[std::min(slot, t.tets.tets.size() - 1)][e];
}

} // namespace

Scene::Scene(SceneDescription description)
    : description_(std::move(description)) {
    auto system = std::make_unique<System>();
    for (int body = 0; body < body_count(); ++body) {
        first_vertex_.push_back(vertex_count_);
        vertex_counts_.push_back(0);
        if (const ClothRest* sheet = cloth(body)) {
            add_cloth(*sheet, body, *system);
            continue;
        }
        const TissueRest* t = tissue(body);
        if (!t) continue;
        if (t->carried_by >= 0) {
            check_carried(description_, *t, body);
            continue;
        }
        check_tissue(*t, body);
        check_subtissues(*t, body);
        TissueBatches batches;
        batches.body = body;
        batches.law = t->law;
        batches.kind = t->element;
        batches.first_batch = system->batches.size();
        batches.first_edge_batch = system->edge_batches.size();
        batches.deformable = system->numbering.deformables.size();
        batches.tet_count = t->tets.tets.size();
        std::vector<TetBatch> corners = checked_batches(*t, vertex_count_, body);
        batches.cut = make_cut_elements(t->tets, t->element);
        set_cut_volumes(t->tets, batches.cut, corners);
        batches.batch_count = corners.size();
        system->batches.insert(system->batches.end(), corners.begin(), corners.end());
        for (const FiberRest& f : t->fibers) batches.fibers.push_back(make_fiber_batches(f, corners.size()));
        if (needs_direction(t->law)) batches.anisotropy = make_anisotropy(*t, corners.size());
        batches.first_gradient = system->gradient_size;
        batches.first_hessian = system->hessian_size;
        batches.first_strain = system->strain_size;
        system->gradient_size = batches.gradient_at(batches.batch_count);
        system->hessian_size = batches.hessian_at(batches.batch_count);
        system->strain_size = batches.strain_at(batches.batch_count);
        if (system->hessian_size > most_entries)
            refuse(body, "FE210",
                   "the tets up to this body take " + std::to_string(system->hessian_size) + " stiffness entries; " +
                       std::to_string(most_entries) + " can be numbered",
                   "choose larger tets, or linear ones");
        Points nodes = t->tets.vertices;
        system->edge_vertices.resize(static_cast<std::size_t>(body) + 1); // bones before this one have none
        if (t->element == ElementKind::quadratic) {
            add_edges(*t, vertex_count_, corners, nodes, *system);
            if (!batches.cut.tets.empty())
                place_points(t->tets, batches.cut, std::span(system->edge_batches).subspan(batches.first_edge_batch));
        }
        std::vector<char> held(nodes.size(), 0);
        for (const int v : t->fixed_vertices) held.at(static_cast<std::size_t>(v)) = 1;
        for (const Part& part : description_.parts)
            if (part.type->hold && std::find(part.bodies.begin(), part.bodies.end(), body) != part.bodies.end())
                part.type->hold(part, description_.bodies[static_cast<std::size_t>(body)], held);
        system->numbering.add(body, nodes, held, std::cbrt(volume_of(t->tets) / static_cast<double>(nodes.size())));
        system->tissues.push_back(std::move(batches));
        vertex_count_ += static_cast<int>(nodes.size());
        vertex_counts_.back() = nodes.size();
    }
    for (int body = 0; body < body_count(); ++body)
        if (const int carrier = carrier_of(body); carrier != body) {
            first_vertex_[static_cast<std::size_t>(body)] = first_vertex(carrier);
            vertex_counts_[static_cast<std::size_t>(body)] = vertex_count(carrier);
        }
    for (const AttachmentRest& a : description_.attachments)
        if (a.source < 0 || a.target < 0 || a.source >= body_count() || a.target >= body_count())
            throw Error("FE209", "an attachment names a body that is not in the scene",
                        "both of its bodies must be among zSolver.bodies");

    for (const Part& part : description_.parts)
        for (const int body : part.bodies)
            if (body < 0 || body >= body_count())
                throw Error("FE209", "a " + std::string(part.type->name) + " names a body that is not in the scene",
                            "its bodies must be among zSolver.bodies");

    // Element nodes by unknown: count, then fill in batch order, which fixes the order of every sum.
    const auto for_each_node = [&](const auto& visit) {
        for (const TissueBatches& t : system->tissues)
            for (std::size_t i = 0; i < t.batch_count; ++i)
                for (int n = 0; n < t.nodes(); ++n)
                    for (std::size_t lane = 0; lane < lanes && i * lanes + lane < t.tet_count; ++lane) {
                        const int u = system->numbering.unknown[static_cast<std::size_t>(system->node(t, i, n)[lane])];
                        if (u >= 0)
                            visit(u,
                                  static_cast<int>(t.gradient_at(i) + static_cast<std::size_t>(3 * n) * lanes + lane));
                    }
    };
    system->node_start.assign(system->numbering.vertex_of_unknown.size() + 1, 0);
    for_each_node([&](int u, int) { ++system->node_start[static_cast<std::size_t>(u) + 1]; });
    std::vector<char> of_sheet(system->numbering.vertex_of_unknown.size(), 0); // no tets there
    for (const Deformable& d : system->numbering.deformables)
        if (d.is_sheet)
            std::fill_n(of_sheet.begin() + static_cast<std::ptrdiff_t>(d.first_unknown), d.unknown_count, char{1});
    for (std::size_t u = 0; u + 1 < system->node_start.size(); ++u) {
        if (system->node_start[u + 1] == 0 && !of_sheet[u]) {
            const int vertex = system->numbering.vertex_of_unknown[u];
            int body = 0;
            for (const Deformable& d : system->numbering.deformables)
                if (d.first_vertex <= static_cast<std::size_t>(vertex)) body = d.body;
            refuse(body, "FE208",
                   "vertex " + std::to_string(vertex - first_vertex(body)) + " of the tet mesh belongs to no tet",
                   "remove unused vertices from the tet mesh");
        }
        system->node_start[u + 1] += system->node_start[u];
    }
    system->nodes.resize(static_cast<std::size_t>(system->node_start.back()));
    std::vector<int> next(system->node_start.begin(), system->node_start.end() - 1);
    for_each_node(
        [&](int u, int at) { system->nodes[static_cast<std::size_t>(next[static_cast<std::size_t>(u)]++)] = at; });
    system_ = std::move(system);
}

void Scene::add_cloth(const ClothRest& sheet, int body, System& system) {
    check_cloth(sheet, body);
    std::vector<char> held(sheet.surface.size(), 0);
    for (const int v : sheet.fixed_vertices) held.at(static_cast<std::size_t>(v)) = 1;
    for (const Part& part : description_.parts)
        if (part.type->hold && std::find(part.bodies.begin(), part.bodies.end(), body) != part.bodies.end())
            part.type->hold(part, description_.bodies[static_cast<std::size_t>(body)], held);
    double area = 0;
    for (const double a : vertex_areas(sheet.surface, sheet.triangles)) area += a;
    const double spacing = std::sqrt(area / static_cast<double>(sheet.surface.size()));
    system.numbering.add(body, sheet.surface, held, spacing, true);
    vertex_counts_.back() = sheet.surface.size();
    vertex_count_ += static_cast<int>(sheet.surface.size());
}

Scene::~Scene() = default;

const Numbering& Scene::numbering() const { return system_->numbering; }

const TissueRest* Scene::tissue(int body) const {
    const auto* p =
        std::get_if<std::shared_ptr<const TissueRest>>(&description_.bodies[static_cast<std::size_t>(body)]);
    return p ? p->get() : nullptr;
}

PointWeights Scene::embedded(int body, int tet, const std::array<double, 4>& barycentric) const {
    Tet corners = tissue(body)->tets.tets[static_cast<std::size_t>(tet)];
    for (int& v : corners) v += first_vertex(body);
    const bool quadratic = tissue(body)->element == ElementKind::quadratic;
    const auto carrier = static_cast<std::size_t>(carrier_of(body));
    return embedded_point(
        corners, quadratic ? &system_->edge_vertices[carrier][static_cast<std::size_t>(tet)] : nullptr, barycentric);
}

const ClothRest* Scene::cloth(int body) const {
    const auto* p = std::get_if<std::shared_ptr<const ClothRest>>(&description_.bodies[static_cast<std::size_t>(body)]);
    return p ? p->get() : nullptr;
}

const Points& Scene::surface(int body) const {
    return std::visit([](const auto& rest) -> const Points& { return rest->surface; },
                      description_.bodies[static_cast<std::size_t>(body)]);
}

const std::vector<Triangle>& Scene::triangles(int body) const {
    return std::visit([](const auto& rest) -> const std::vector<Triangle>& { return rest->triangles; },
                      description_.bodies[static_cast<std::size_t>(body)]);
}

PointWeights Scene::on_cloth(int body, const std::array<int, 3>& vertices,
                             const std::array<double, 4>& coordinates) const {
    PointWeights out;
    for (std::size_t c = 0; c < 3; ++c) {
        out.vertex[out.count] = vertices[c] + first_vertex(body);
        out.weight[out.count++] = coordinates[c];
    }
    return out;
}

PointWeights Scene::carrier_of(int body, int vertex) const {
    if (const TissueRest* t = tissue(body)) {
        const auto v = static_cast<std::size_t>(vertex);
        return embedded(body, t->embedding.tet[v], t->embedding.barycentric[v]);
    }
    PointWeights out;
    out.count = 1, out.vertex[0] = first_vertex(body) + vertex, out.weight[0] = 1;
    return out;
}

const BoneRest* Scene::bone(int body) const {
    const auto* p = std::get_if<std::shared_ptr<const BoneRest>>(&description_.bodies[static_cast<std::size_t>(body)]);
    return p ? p->get() : nullptr;
}

} // namespace sinew::solver
