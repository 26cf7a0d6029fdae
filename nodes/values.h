// The value types that travel on wires between nodes, each with its digest. Meshes are in scene units;
// zSolver.scale converts to metres in one place (nodes/z_solver.cpp).
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"
#include "solver/fiber/curve.h"
#include "solver/fiber/line_of_action.h"
#include "solver/scene.h"
#include "solver/state.h"
#include "solver/step.h"
#include "solver/step_inputs.h"
#include "solver/term/type.h"

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace sinew::solver {
struct Solid;
}

namespace sinew::nodes {

/// Connectivity of a mesh, shared by all of its deformed copies; its digest is made once.
struct MeshTopology {
    std::vector<int> face_sizes, face_vertices;
    std::vector<solver::Triangle> triangles;
    engine::Digest digest;
};

/// A polygon mesh in scene units.
struct Mesh {
    std::shared_ptr<const MeshTopology> topology;
    std::shared_ptr<const solver::Points> points;
    engine::Digest points_digest;
    static Mesh from(solver::SurfaceMesh mesh);
    Mesh with_points(solver::Points points) const;
    solver::SurfaceMesh surface() const;
};

/// Deformed bodies, in the order of zSolver.bodies.
struct MeshList {
    std::vector<Mesh> meshes;
};

/// A tet mesh in scene units (a lattice, or one that the user brings).
struct TetMeshValue {
    std::shared_ptr<const solver::TetMesh> mesh;
    solver::ElementKind element = solver::ElementKind::linear;
    engine::Digest digest; ///< of all of it
    static TetMeshValue from(solver::TetMesh tets);
    TetMeshValue with_element(solver::ElementKind kind) const;
};

/// A curve in scene units.
struct CurvePoints : solver::Curve {
    solver::Points modelled; ///< its points before anything moved them, at all frames alike
    engine::Digest bound;    ///< of what its points were bound to where they are modelled: at all frames alike, too
};

/// What a zLineOfAction gives to a fibre: how a path's shortening excites it.
struct LineOfAction {
    solver::LineOfActionValues values;
    std::vector<CurvePoints> curves; ///< whose lengths add
};

/// One material layer with its painted weights (per surface vertex; one entry = constant), and the closed mesh in which
/// it is, if there is one.
struct Material {
    solver::MaterialValues values;
    solver::ClothMaterial cloth; ///< what it is on a cloth; envelope and restScale as above
    engine::NumberList weights;
    std::shared_ptr<const solver::Solid> place = nullptr; ///< in scene units; null: not bounded
    engine::Digest place_digest = {};                     ///< of the mesh that `place` was made from
    /// On the surface: [Pa], [N/m].
    double pressure = 0, surface_tension = 0;
};

/// One fibre field as painted.
struct Fiber {
    solver::FiberValues values;
    engine::NumberList weights, end_points;
    engine::NumberList directions; ///< 3 numbers a tet, or 3 for all, of any length; empty: from the end points
    std::shared_ptr<const LineOfAction> line = nullptr; ///< null: there is none
    bool growth_follows_line = false;                   ///< values.growth is to the power of the line's loaValue
};

/// A line of action of a body.
struct FiberLine {
    std::size_t fiber = 0; ///< whose it is: place in TissueInputs::fibers
    std::shared_ptr<const LineOfAction> line;
    bool growth_follows = false;
};

/// A part of a tissue with a mesh, materials and fibres of its own, as zSubtissue describes it: static but for the
/// values among its layers and fibres. In scene units.
struct Subtissue {
    Mesh mesh; ///< closed
    std::shared_ptr<const solver::Solid> place;
    std::vector<Material> materials; ///< from bottom to top, painted on its own mesh
    std::vector<Fiber> fibers;       ///< likewise
    double rest_scale_envelope = 1;
    std::vector<std::shared_ptr<const Subtissue>> parts; ///< within it
    engine::Digest digest;                               ///< of all that is static, its parts' too
};

/// Rest data of a body in scene units (static) … The digest says what the data was made from; a bone's covers
/// the connectivity alone, because its points move.
struct BodyRest {
    solver::BodyRest data;
    Mesh mesh; ///< for output: polygons; points as modelled
    engine::Digest digest;
    /// Of a tissue: its parts, those within parts too, a part before those within it. Each with the tissue's tets and
    /// its own surface in them.
    struct Part {
        engine::Digest digest; ///< Subtissue::digest
        std::shared_ptr<const BodyRest> rest;
    };
    std::vector<Part> parts = {};
};

/// Points that ride on tets: the vertices that carry each.
using CarriedPoints = std::vector<solver::PointWeights>;

/// A mesh of the user's that shall stand in for a tissue's own surface in contacts, placed in the tissue's tets at
/// rest.
struct CollisionSurface {
    Mesh mesh; ///< at rest, scene units
    CarriedPoints carriers;
};

/// How a body is recognised at the other end of a wire. Names never travel, so that renaming changes nothing:
/// a body is its rest data and, where several share those (one mesh used for two bones), its values at that
/// time, but for those of contact, which nobody may read where zSolver.collisionDetection is off.
struct BodyId {
    engine::Digest rest, value;
    friend auto operator<=>(const BodyId&, const BodyId&) = default;
};

/// A further force of the scene, of any kind that solver/terms knows: a field, a hold … Lengths among the values are in
/// scene units, all else is SI.
struct Force {
    const solver::TermType* type = nullptr;
    std::vector<BodyId> bodies;                   ///< that it acts on
    bool on_all = false;                          ///< on all tissues and cloths of the solver instead
    std::shared_ptr<const solver::PartRest> rest; ///< may be null
    engine::Digest digest;                        ///< of all that `rest` was made from
    solver::PartValues values;
};

/// A body: its rest data and its values at one time.
struct Body {
    std::shared_ptr<const BodyRest> rest;
    bool enable = true;                                                   ///< at this time
    std::variant<solver::TissueInputs, Mesh, solver::ClothInputs> values; ///< bone: its mesh now, scene units
    solver::InitialMotion start = {};                                     ///< of a tissue or cloth, at the start frame
    /// Tissues with a collisionShape, else null: for zEmbedder. Contact reads it through `contact`.
    std::shared_ptr<const CollisionSurface> collision = nullptr;
    std::vector<Force> forces = {};    ///< that its own attributes ask for; they act on this body
    std::optional<Force> contact = {}; ///< what it brings to contact; acts where zSolver.collisionDetection is on
    /// Of a subtissue, else null. Its rest data has a surface but no tets: those are the tissue's that it is a part of.
    std::shared_ptr<const Subtissue> subtissue = nullptr;
    /// Enabled at some time, so that it has a place in the scene at all of them.
    bool takes_part = true;
    /// Of a tissue, in the order of its fibres. What they come to is known to zSolver alone, which keeps their lengths.
    std::vector<FiberLine> lines = {};
    bool is_bone() const { return values.index() == 1; }
    bool is_cloth() const { return values.index() == 2; }
};

/// A body's mesh in scene units: a bone's where it is now, which may be scaled, others' as modelled.
const Mesh& mesh_of(const Body& body);

BodyId id_of(const Body& body);

/// Position of `wanted` in `bodies`. `hint`: the answer of an earlier frame, taken where two bodies are alike
/// in all.
constexpr int body_missing = -1, body_ambiguous = -2;
int find_body(std::span<const BodyId> bodies, const BodyId& wanted, int hint = body_missing);

struct Attachment {
    BodyId source_body, target_body;
    solver::AttachmentRest rest; ///< body indices are set by zSolver
    solver::AttachmentInputs values;
};

/// Digest of an attachment's rest data without the body indices.
engine::Digest static_digest(const solver::AttachmentRest& rest);

/// Digest of a force's type and rest data, without its bodies.
engine::Digest static_digest(const Force& force);

/// A bone as its mesh is at the start frame, which may be another one later: the scene is built from this.
struct ModelledBone {
    std::shared_ptr<const solver::Points> points; ///< [scene units]; null: the body is no bone
    engine::Digest digest{};                      ///< of them
    friend bool operator==(const ModelledBone& a, const ModelledBone& b) { return a.digest == b.digest; }
};

/// What all frames of one simulation must share: the static data that its scene is built from.
struct SceneKey {
    double scale = 100;                              ///< scene units per metre at the start frame
    engine::Matrix4 frame{};                         ///< where the solver's transform was then
    std::vector<engine::Digest> bodies, attachments; ///< of those that take part
    std::vector<ModelledBone> modelled;              ///< of those bodies
    std::vector<std::array<int, 2>> links;           ///< source and target of each attachment, positions in `bodies`
    std::vector<engine::Digest> forces;              ///< of the further forces that take part
    std::vector<std::vector<int>> reach;             ///< of each, the bodies it acts on, positions in `bodies`
    /// How many of `forces`, the last ones, are contacts: the one thing that may come and go over a run.
    std::uint64_t contacts = 0;
    /// Of the lines of action, by bodies and their fibres: what their curves are bound to. No part of the scene, but
    /// their lengths can be compared only while it stays.
    std::vector<engine::Digest> lines = {};
    engine::Digest digest() const; ///< of what the scene is built from
    friend bool operator==(const SceneKey&, const SceneKey&) = default;
};

/// zSolver's state: the solver's, and the key of the scene that it belongs to.
struct SimulationState {
    SceneKey scene;
    solver::State state;
    int residual_body = -1; ///< whose the record's residual is, a place in zSolver.bodies; -1: nobody's
    std::vector<solver::LineMemory> lines = {}; ///< of the lines of action, by bodies that take part and their fibres
};

/// A line of action at one frame, as zSolver took it.
struct LineReport {
    int body = -1; ///< place in zSolver.bodies
    int fiber = 0; ///< place in that tissue's fibers
    solver::LineMemory line;
    double excitation = 0; ///< in use, the fibre's own included
    double growth = 1;     ///< muscleGrowthScale in use
};

/// Where a frame is at its worst. Places in scene units; -1: there is none.
struct WorstPlaces {
    int body = -1, tet = -1; ///< of the least det F: place in zSolver.bodies, tet of that tissue
    double j = 1;            ///< det F there, from the rest shape as it is at that frame
    std::array<double, 3> tet_place{};
    /// Of the largest stretch: place in zSolver.attachments, in zSolver.bodies of its source, and the vertex of the
    /// source's mesh that is nearest.
    int attachment = -1, source_body = -1, vertex = -1;
    double stretch = 0; ///< [m]
    std::array<double, 3> stretch_place{};
    int residual_body = -1; ///< whose the record's residual is: place in zSolver.bodies
    /// Of the deepest contact, places in zSolver.bodies: whose point, and whose surface.
    int contact_body = -1, contact_target = -1;
    double depth = 0; ///< [m]
    std::array<double, 3> contact_place{};
    /// Of bodies that contact does not keep apart, those that are deepest by their own thickness: whose point, whose
    /// surface, how deep [m] and by what share. See nodes/deep_contact.h.
    int deep_body = -1, deep_target = -1;
    double deep = 0, deep_share = 0;
    std::array<double, 3> deep_place{};
};

/// What one frame's solve reported; the command line writes it into --report.
struct SolveReport {
    solver::StepRecord record; ///< seconds are not digested
    std::int64_t bodies = 0, tets = 0, triangles = 0, dofs = 0, attachments = 0;
    std::vector<std::string> terms; ///< the energy terms that the scene uses
    WorstPlaces worst = {};
    std::vector<LineReport> lines = {};
};

/// The solved tets of every body at one frame, for zEmbedder. Positions in scene units.
struct Solved {
    std::vector<BodyId> bodies;
    std::vector<std::shared_ptr<const BodyRest>> rests; ///< same order
    std::vector<solver::Points> positions;              ///< tissues: tet vertices; others: surface vertices
    /// Of tissues of quadratic tets: vertices at the middles of the edges, in the order of solver::edges_of. Else
    /// empty.
    std::vector<solver::Points> midpoints;
    /// Whose tets carry each: its own place, or of a subtissue that of the tissue that it is a part of.
    std::vector<int> carriers;
};

/// A file that a writer node made: pure content; the command line puts it on disk, whole or not at all.
struct FileContent {
    std::string ending; ///< "obj", "ply", "vtk" …
    std::string bytes;
};

} // namespace sinew::nodes

namespace sinew::engine {
#define SINEW_NODE_VALUE(T, NAME)                                                                                      \
    template <>                                                                                                        \
    struct ValueTraits<T> {                                                                                            \
        static constexpr std::string_view name = NAME;                                                                 \
        static void hash(Hasher& h, const T& v);                                                                       \
        static std::size_t bytes(const T& v);                                                                          \
    };
SINEW_NODE_VALUE(nodes::Mesh, "mesh")
SINEW_NODE_VALUE(nodes::MeshList, "meshes")
SINEW_NODE_VALUE(nodes::TetMeshValue, "tet mesh")
SINEW_NODE_VALUE(nodes::CurvePoints, "curve")
SINEW_NODE_VALUE(nodes::LineOfAction, "line of action")
SINEW_NODE_VALUE(nodes::Material, "material")
SINEW_NODE_VALUE(nodes::Fiber, "fiber")
SINEW_NODE_VALUE(nodes::Attachment, "attachment")
SINEW_NODE_VALUE(nodes::Force, "force")
SINEW_NODE_VALUE(nodes::SolveReport, "solve report")
SINEW_NODE_VALUE(nodes::Solved, "solved bodies")
SINEW_NODE_VALUE(nodes::FileContent, "file content")
SINEW_NODE_VALUE(nodes::SimulationState, "simulation state")
#undef SINEW_NODE_VALUE
template <>
struct ValueTraits<nodes::Body> {
    static constexpr std::string_view name = "body";
    static void hash(Hasher& h, const nodes::Body& v);
    static void hash_rest(Hasher& h, const nodes::Body& v);  ///< collision surface; a bone's points as modelled
    static void hash_aside(Hasher& h, const nodes::Body& v); ///< what it brings to contact
    static std::size_t bytes(const nodes::Body& v);
};
} // namespace sinew::engine
