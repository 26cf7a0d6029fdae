// Digests and sizes of the values on wires. A value's digest covers all that a consumer can see, save the
// wall clock and what Body holds for zEmbedder and for contact (why: values.h).
// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/values.h"

#include "nodes/simulation_state.h"
#include "solver/mesh/coordinates.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace sinew::nodes {

using engine::Digest;
using engine::Hasher;

namespace {

std::span<const double> numbers(const solver::Points& points) {
    static_assert(sizeof(solver::Vec3) == 3 * sizeof(double));
    return {points.empty() ? nullptr : points.front().data(), 3 * points.size()};
}

template <std::size_t N>
std::span<const int> numbers(const std::vector<std::array<int, N>>& cells) {
    static_assert(sizeof(std::array<int, N>) == N * sizeof(int));
    return {cells.empty() ? nullptr : cells.front().data(), N * cells.size()};
}

template <class T>
std::size_t size_of(const std::vector<T>& v) {
    return v.size() * sizeof(T);
}

Digest digest_of(const solver::Points& points) { return Hasher().add_doubles(numbers(points)).finish(); }

void add(Hasher& h, const BodyId& id) { h.add(id.rest).add(id.value); }

void add(Hasher& h, const solver::MaterialValues& m) {
    for (const auto& f : solver::MaterialValues::fields()) h.add(m.*f.at);
}

void add(Hasher& h, const solver::FiberValues& f) {
    for (const auto& field : solver::FiberValues::fields()) h.add(f.*field.at);
}

void add(Hasher& h, const solver::TissueInputs& t) {
    for (const auto& f : solver::TissueInputs::fields()) h.add(t.*f.at);
    h.add(static_cast<std::uint64_t>(t.layers.size()));
    for (const auto& layer : t.layers) add(h, layer);
    h.add(static_cast<std::uint64_t>(t.fibers.size()));
    for (const auto& fiber : t.fibers) add(h, fiber);
    h.add(static_cast<std::uint64_t>(t.subtissues.size()));
    for (const solver::SubtissueInputs& part : t.subtissues) {
        for (const auto& f : solver::SubtissueInputs::fields()) h.add(part.*f.at);
        h.add(static_cast<std::uint64_t>(part.layers.size()));
        for (const auto& layer : part.layers) add(h, layer);
    }
}

std::size_t bytes_of(const solver::TissueInputs& t) {
    std::size_t n = size_of(t.layers) + size_of(t.fibers) + size_of(t.forces) + size_of(t.subtissues);
    for (const solver::SubtissueInputs& part : t.subtissues) n += size_of(part.layers);
    return n;
}

void add(Hasher& h, const CurvePoints& c) {
    h.add(static_cast<int>(c.form)).add_doubles(numbers(c.points)).add_doubles(numbers(c.modelled)).add(c.bound);
}

void add(Hasher& h, const LineOfAction& line) {
    for (const auto& f : solver::LineOfActionValues::fields()) h.add(line.values.*f.at);
    h.add(static_cast<std::uint64_t>(line.curves.size()));
    for (const CurvePoints& curve : line.curves) add(h, curve);
}

void add(Hasher& h, const solver::LineMemory& m) {
    h.add(m.rest_length).add(m.length).add(m.rate).add(m.step).add(m.value);
}

void add(Hasher& h, const solver::ClothMaterial& m) {
    for (const auto& f : solver::ClothMaterial::fields()) h.add(m.*f.at);
}

void add(Hasher& h, const solver::ClothInputs& c) {
    for (const auto& f : solver::ClothInputs::fields()) h.add(c.*f.at);
    h.add(static_cast<std::uint64_t>(c.layers.size()));
    for (const auto& layer : c.layers) add(h, layer);
}

void add(Hasher& h, const Mesh& m) { h.add(m.topology->digest).add(m.points_digest); }

void add(Hasher& h, const solver::StepRecord& r) {
    h.add(r.residual).add(r.converged).add(r.newton_iterations).add(r.substeps).add(r.halvings);
    h.add(r.energy).add(r.min_j).add(r.inverted);
    for (const solver::Measured& m : r.measured) h.add(m.what->term).add(m.what->name).add(m.value).add(m.part);
}

void add(Hasher& h, const SceneKey& k) {
    h.add(k.scale).add_doubles(k.frame).add(static_cast<std::uint64_t>(k.bodies.size()));
    for (const Digest& d : k.bodies) h.add(d);
    for (const ModelledBone& bone : k.modelled) h.add(bone.digest);
    h.add(static_cast<std::uint64_t>(k.attachments.size()));
    for (const Digest& d : k.attachments) h.add(d);
    h.add_ints(numbers(k.links));
    h.add(static_cast<std::uint64_t>(k.forces.size()));
    for (std::size_t i = 0; i < k.forces.size(); ++i) h.add(k.forces[i]).add_ints(k.reach[i]);
    h.add(k.contacts);
}

} // namespace

Mesh Mesh::from(solver::SurfaceMesh mesh) {
    auto topology = std::make_shared<MeshTopology>();
    solver::check_coordinates(mesh.points);
    topology->digest =
        Hasher().add_ints(mesh.face_sizes).add_ints(mesh.face_vertices).add_ints(numbers(mesh.triangles)).finish();
    topology->face_sizes = std::move(mesh.face_sizes);
    topology->face_vertices = std::move(mesh.face_vertices);
    topology->triangles = std::move(mesh.triangles);
    Mesh out;
    out.topology = std::move(topology);
    out.points_digest = digest_of(mesh.points);
    out.points = std::make_shared<const solver::Points>(std::move(mesh.points));
    return out;
}

Mesh Mesh::with_points(solver::Points moved) const {
    if (moved.size() != points->size())
        throw std::invalid_argument(std::to_string(moved.size()) + " points for a mesh of " +
                                    std::to_string(points->size()));
    Mesh out;
    out.topology = topology;
    out.points_digest = digest_of(moved);
    out.points = std::make_shared<const solver::Points>(std::move(moved));
    return out;
}

solver::SurfaceMesh Mesh::surface() const {
    return {*points, topology->face_sizes, topology->face_vertices, topology->triangles};
}

TetMeshValue TetMeshValue::from(solver::TetMesh tets) {
    TetMeshValue out;
    out.digest = Hasher()
                     .add_doubles(numbers(tets.vertices))
                     .add_ints(numbers(tets.tets))
                     .add_doubles(tets.coverage)
                     .add(tets.cut.degree)
                     .add_ints(tets.cut.tets)
                     .add_doubles(tets.cut.moments)
                     .finish();
    out.mesh = std::make_shared<const solver::TetMesh>(std::move(tets));
    return out;
}

TetMeshValue TetMeshValue::with_element(solver::ElementKind kind) const {
    TetMeshValue out = *this;
    if (kind == element) return out;
    out.element = kind;
    out.digest = Hasher().add(digest).add(static_cast<int>(kind)).finish();
    return out;
}

const Mesh& mesh_of(const Body& body) {
    const auto* now = std::get_if<Mesh>(&body.values);
    return now ? *now : body.rest->mesh;
}

BodyId id_of(const Body& body) {
    Hasher h;
    h.add(body.enable).add(body.is_bone());
    if (body.takes_part && !body.enable) h.add("at another time");
    if (body.is_cloth()) h.add("cloth");
    std::visit([&](const auto& v) { add(h, v); }, body.values);
    for (const solver::Vec3& v : {body.start.velocity, body.start.angular_velocity}) h.add(v.x()).add(v.y()).add(v.z());
    for (const Force& f : body.forces) h.add(static_digest(f)).add_doubles(f.values);
    for (const FiberLine& l : body.lines) {
        h.add(static_cast<std::uint64_t>(l.fiber)).add(l.growth_follows);
        add(h, *l.line);
    }
    return {body.rest->digest, h.finish()};
}

int find_body(std::span<const BodyId> bodies, const BodyId& wanted, int hint) {
    int same_rest = 0, same_all = 0, last_rest = body_missing, last_all = body_missing;
    for (int i = 0; i < static_cast<int>(bodies.size()); ++i) {
        const BodyId& b = bodies[static_cast<std::size_t>(i)];
        if (b.rest != wanted.rest) continue;
        ++same_rest, last_rest = i;
        if (b.value == wanted.value) ++same_all, last_all = i;
    }
    if (same_rest <= 1) return last_rest;
    if (same_all == 1) return last_all;
    const bool hint_fits =
        hint >= 0 && hint < static_cast<int>(bodies.size()) && bodies[static_cast<std::size_t>(hint)] == wanted;
    return hint_fits ? hint : body_ambiguous;
}

Digest static_digest(const solver::AttachmentRest& rest) {
    return Hasher()
        .add(static_cast<int>(rest.correspondence))
        .add(rest.maintain_offset)
        .add_doubles(rest.source_weights)
        .add_doubles(rest.target_weights)
        .add(static_cast<int>(rest.source_painted))
        .add(static_cast<int>(rest.target_painted))
        .add(rest.max_distance)
        .finish();
}

Digest static_digest(const Force& force) {
    return Hasher().add(force.type->name).add(force.type->numerics).add(force.on_all).add(force.digest).finish();
}

Digest SceneKey::digest() const {
    Hasher h;
    add(h, *this);
    return h.finish();
}

} // namespace sinew::nodes

namespace sinew::engine {

using nodes::add;
using nodes::numbers;
using nodes::size_of;

void ValueTraits<nodes::Mesh>::hash(Hasher& h, const nodes::Mesh& v) {
    if (!v.topology || !v.points)
        throw std::logic_error("a mesh without points or faces; nodes::Mesh::from makes one of a surface");
    add(h, v);
}
std::size_t ValueTraits<nodes::Mesh>::bytes(const nodes::Mesh& v) {
    // Deformed copies share their topology: who made it pays for it.
    const nodes::MeshTopology& t = *v.topology;
    const std::size_t shared = size_of(t.face_sizes) + size_of(t.face_vertices) + size_of(t.triangles);
    return size_of(*v.points) + (v.topology.use_count() == 1 ? shared : 0);
}

void ValueTraits<nodes::MeshList>::hash(Hasher& h, const nodes::MeshList& v) {
    h.add(static_cast<std::uint64_t>(v.meshes.size()));
    for (const nodes::Mesh& m : v.meshes) add(h, m);
}
std::size_t ValueTraits<nodes::MeshList>::bytes(const nodes::MeshList& v) {
    std::size_t n = size_of(v.meshes);
    for (const nodes::Mesh& m : v.meshes) n += ValueTraits<nodes::Mesh>::bytes(m);
    return n;
}

void ValueTraits<nodes::TetMeshValue>::hash(Hasher& h, const nodes::TetMeshValue& v) { h.add(v.digest); }
std::size_t ValueTraits<nodes::TetMeshValue>::bytes(const nodes::TetMeshValue& v) {
    return size_of(v.mesh->vertices) + size_of(v.mesh->tets) + size_of(v.mesh->coverage) + size_of(v.mesh->cut.tets) +
           size_of(v.mesh->cut.moments);
}

void ValueTraits<nodes::CurvePoints>::hash(Hasher& h, const nodes::CurvePoints& v) { add(h, v); }
std::size_t ValueTraits<nodes::CurvePoints>::bytes(const nodes::CurvePoints& v) {
    return size_of(v.points) + size_of(v.modelled);
}

void ValueTraits<nodes::LineOfAction>::hash(Hasher& h, const nodes::LineOfAction& v) { add(h, v); }
std::size_t ValueTraits<nodes::LineOfAction>::bytes(const nodes::LineOfAction& v) {
    std::size_t n = 0;
    for (const nodes::CurvePoints& curve : v.curves) n += ValueTraits<nodes::CurvePoints>::bytes(curve);
    return n;
}

void ValueTraits<nodes::Material>::hash(Hasher& h, const nodes::Material& v) {
    add(h, v.values);
    add(h, v.cloth);
    h.add_doubles(v.weights).add(v.place_digest).add(v.pressure).add(v.surface_tension);
}
std::size_t ValueTraits<nodes::Material>::bytes(const nodes::Material& v) { return size_of(v.weights); }

void ValueTraits<nodes::Fiber>::hash(Hasher& h, const nodes::Fiber& v) {
    add(h, v.values);
    h.add_doubles(v.weights).add_doubles(v.end_points).add_doubles(v.directions);
    h.add(v.line != nullptr).add(v.growth_follows_line);
    if (v.line) add(h, *v.line);
}
std::size_t ValueTraits<nodes::Fiber>::bytes(const nodes::Fiber& v) {
    return size_of(v.weights) + size_of(v.end_points) + size_of(v.directions);
}

void ValueTraits<nodes::Body>::hash(Hasher& h, const nodes::Body& v) { add(h, nodes::id_of(v)); }
void ValueTraits<nodes::Body>::hash_rest(Hasher& h, const nodes::Body& v) {
    add(h, v.rest->mesh);
    h.add(v.collision != nullptr);
    if (!v.collision) return;
    add(h, v.collision->mesh);
    h.add(static_cast<std::uint64_t>(v.collision->carriers.size()));
    for (const solver::PointWeights& w : v.collision->carriers) {
        const auto n = static_cast<std::size_t>(w.count);
        h.add_ints({w.vertex, n}).add_doubles({w.weight, n});
    }
}
void ValueTraits<nodes::Body>::hash_aside(Hasher& h, const nodes::Body& v) {
    h.add(v.contact.has_value());
    if (v.contact) h.add(static_digest(*v.contact)).add_doubles(v.contact->values);
}
std::size_t ValueTraits<nodes::Body>::bytes(const nodes::Body& v) {
    // The rest data is one object for all frames, so a frame pays for its values only.
    if (v.is_bone()) return ValueTraits<nodes::Mesh>::bytes(std::get<nodes::Mesh>(v.values));
    if (v.is_cloth()) return size_of(std::get<solver::ClothInputs>(v.values).layers);
    return nodes::bytes_of(std::get<solver::TissueInputs>(v.values));
}

void ValueTraits<nodes::Attachment>::hash(Hasher& h, const nodes::Attachment& v) {
    add(h, v.source_body);
    add(h, v.target_body);
    h.add(nodes::static_digest(v.rest));
    for (const auto& field : solver::AttachmentInputs::fields()) h.add(v.values.*field.at);
}
std::size_t ValueTraits<nodes::Attachment>::bytes(const nodes::Attachment& v) {
    return size_of(v.rest.source_weights) + size_of(v.rest.target_weights);
}

void ValueTraits<nodes::Force>::hash(Hasher& h, const nodes::Force& v) {
    h.add(nodes::static_digest(v)).add_doubles(v.values).add(static_cast<std::uint64_t>(v.bodies.size()));
    for (const nodes::BodyId& id : v.bodies) add(h, id);
}
std::size_t ValueTraits<nodes::Force>::bytes(const nodes::Force& v) { return size_of(v.bodies) + size_of(v.values); }

void ValueTraits<nodes::SolveReport>::hash(Hasher& h, const nodes::SolveReport& v) {
    add(h, v.record);
    h.add(v.bodies).add(v.tets).add(v.triangles).add(v.dofs).add(v.attachments);
    h.add(static_cast<std::uint64_t>(v.terms.size()));
    for (const std::string& term : v.terms) h.add(term);
    const nodes::WorstPlaces& w = v.worst;
    h.add(w.body).add(w.tet).add(w.j).add_doubles(w.tet_place);
    h.add(w.attachment).add(w.source_body).add(w.vertex).add(w.stretch).add_doubles(w.stretch_place);
    h.add(w.residual_body);
    h.add(w.contact_body).add(w.contact_target).add(w.depth).add_doubles(w.contact_place);
    h.add(w.deep_body).add(w.deep_target).add(w.deep).add(w.deep_share).add_doubles(w.deep_place);
    h.add(static_cast<std::uint64_t>(v.lines.size()));
    for (const nodes::LineReport& l : v.lines) {
        h.add(l.body).add(l.fiber).add(l.excitation).add(l.growth);
        add(h, l.line);
    }
}
std::size_t ValueTraits<nodes::SolveReport>::bytes(const nodes::SolveReport& v) {
    return size_of(v.terms) + size_of(v.lines);
}

void ValueTraits<nodes::Solved>::hash(Hasher& h, const nodes::Solved& v) {
    h.add(static_cast<std::uint64_t>(v.bodies.size()));
    for (const nodes::BodyId& id : v.bodies) add(h, id);
    for (const solver::Points& p : v.positions) h.add_doubles(numbers(p));
    for (const solver::Points& p : v.midpoints) h.add_doubles(numbers(p));
    h.add_ints(v.carriers);
}
std::size_t ValueTraits<nodes::Solved>::bytes(const nodes::Solved& v) {
    std::size_t n = size_of(v.bodies) + size_of(v.rests);
    for (const solver::Points& p : v.positions) n += size_of(p);
    for (const solver::Points& p : v.midpoints) n += size_of(p);
    return n;
}

void ValueTraits<nodes::FileContent>::hash(Hasher& h, const nodes::FileContent& v) { h.add(v.ending).add(v.bytes); }
std::size_t ValueTraits<nodes::FileContent>::bytes(const nodes::FileContent& v) { return v.bytes.size(); }

void ValueTraits<nodes::SimulationState>::hash(Hasher& h, const nodes::SimulationState& v) {
    // All that the next frame reads, so that nothing can be forgotten here.
    nodes::write(v, [&](std::span<const std::byte> bytes) { h.add_bytes(bytes); });
}
std::size_t ValueTraits<nodes::SimulationState>::bytes(const nodes::SimulationState& v) {
    const solver::State& s = v.state;
    std::size_t n = size_of(s.x) + size_of(s.v) + size_of(v.scene.bodies) + size_of(v.scene.attachments) +
                    size_of(s.history.x) + size_of(s.history.v) + size_of(s.history.acceleration);
    for (const solver::TermMemory& m : s.memories)
        if (!m.bytes.shared()) n += m.bytes.size(); // what other frames hold as well would not come free
    if (const auto& factor = s.linear.factor)       // shared with the frames around this one, and with who solves
        n += (size_of(factor->values) + size_of(factor->without)) /
             static_cast<std::size_t>(std::max(1L, factor.use_count() - 1));
    for (const solver::PartValues& part : s.parts) n += size_of(part);
    for (const solver::Points& bone : s.bones) n += size_of(bone);
    for (const nodes::ModelledBone& bone : v.scene.modelled)
        if (bone.points.use_count() == 1) n += size_of(*bone.points); // else the bone or another state pays
    for (const solver::Points& bone : s.history.bones) n += size_of(bone);
    if (s.history.values)
        for (const solver::BodyInputs& body : s.history.values->bodies) {
            if (const auto* t = std::get_if<solver::TissueInputs>(&body)) n += nodes::bytes_of(*t);
            if (const auto* c = std::get_if<solver::ClothInputs>(&body)) n += size_of(c->layers) + size_of(c->forces);
        }
    return n;
}

} // namespace sinew::engine
