// What does not change while a simulation runs: rest shapes, lattices, embeddings, painted maps, attachments.
// Built once, immutable. What may change from step to step stands in step_inputs.h, the moving part in state.h.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/element/embedded_point.h"
#include "solver/material/law.h"
#include "solver/mesh/embedding.h"
#include "solver/mesh/surface_mesh.h"
#include "solver/numbering.h"
#include "solver/surface/paint.h"
#include "solver/term/part.h"

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace sinew::solver {

/// Shape functions of the tets. Linear: a vertex each corner, constant strain. Quadratic: also one at the middle of
/// each edge, linear strain; their numbers follow those of the mesh's vertices, in the order of edges_of(mesh.tets).
enum class ElementKind { linear, quadratic };

/// One fibre field of a tissue.
struct FiberRest {
    Points directions;           ///< unit vector per tet, zero where there is none
    std::vector<double> weights; ///< per tet, 0…1
};

/// A part of a tissue with materials of its own, which stand there in place of the tissue's.
struct SubtissueRest {
    std::vector<double> shares; ///< per tet: what of its solid is this part, and none of the parts within it; 0…1
    std::vector<std::vector<double>> layer_weights; ///< as TissueRest's
};

/// A tissue at rest. Everything in metres.
struct TissueRest {
    TetMesh tets;
    std::vector<Triangle> triangles; ///< of the embedded surface
    Points surface;                  ///< rest positions of the surface's vertices
    Embedding embedding;             ///< of the surface in the tets
    ElasticLaw law = ElasticLaw::stvk;
    ElementKind element = ElementKind::linear;
    Points stiff_directions; ///< law anisotropic: unit vector per tet along the fibre; zero = isotropic there
    std::vector<std::vector<double>> layer_weights; ///< [material layer][tet]; layer 0 is 1 everywhere
    std::vector<FiberRest> fibers;
    /// Parts with materials of their own. What their shares leave of a tet is of the tissue's own layers. Fibres of the
    /// parts are among `fibers`, their weights times their part's share.
    std::vector<SubtissueRest> subtissues = {};
    /// The body, a tissue before or after this one, whose tets these are: this is a surface that rides on it, has no
    /// unknowns, and layers and fibres of its own only in that body's `subtissues`. -1: none.
    int carried_by = -1;
    std::vector<int> fixed_vertices; ///< vertices (of quadratic tets also edge midpoints) held at their rest positions
                                     ///< (no unknowns); sorted, may be empty
};

/// A bone: vertices are prescribed at every step, so only connectivity is kept here.
struct BoneRest {
    std::vector<Triangle> triangles;
    Points surface; ///< as modelled; the start positions come with the first step inputs
};

/// The angle between two faces of a cloth at which its bending is at rest: that of the mesh, or none.
enum class BendRestAngle { mesh, flat };

/// A cloth at rest: a sheet whose vertices are those of its mesh. Everything in metres.
struct ClothRest {
    std::vector<Triangle> triangles;
    Points surface; ///< as modelled
    Points warp;    ///< per triangle: unit vector in its plane along the warp; the weft is square to it
    std::vector<std::vector<double>> layer_weights; ///< [material layer][vertex]; layer 0 is 1 everywhere
    BendRestAngle bend_rest = BendRestAngle::mesh;
    std::vector<int> fixed_vertices; ///< held at their rest positions (no unknowns); sorted, may be empty
};

using BodyRest =
    std::variant<std::shared_ptr<const TissueRest>, std::shared_ptr<const BoneRest>, std::shared_ptr<const ClothRest>>;

enum class Correspondence { closest_point, vertex_id };

struct AttachmentRest {
    int source = -1, target = -1; ///< body indices
    Correspondence correspondence = Correspondence::closest_point;
    /// Painted on the surface's vertices or triangles: a number for each, one for all, or none for 1 everywhere.
    std::vector<double> source_weights; ///< > 0 = attached
    std::vector<double> target_weights; ///< 0 = forbidden
    PaintedOn source_painted = PaintedOn::vertices, target_painted = PaintedOn::vertices;
    /// A sample whose closest point of the target is forbidden holds on to the closest allowed one up to this far [m];
    /// 0 = twice the mean edge of the target's allowed part or of the source's samples, whichever is smaller.
    double max_distance = 0;
    bool maintain_offset = true;
};

struct SceneDescription {
    std::vector<BodyRest> bodies;
    std::vector<AttachmentRest> attachments;
    std::vector<Part> parts = {}; ///< further forces
};

/// Derived once from the description: numbering of the unknowns, element batches, sparsity pattern.
class Scene {
  public:
    /// Throws Error FE2xx (body index set) where the description cannot be simulated.
    explicit Scene(SceneDescription description);
    ~Scene();
    const SceneDescription& description() const { return description_; }
    int body_count() const { return static_cast<int>(description_.bodies.size()); }
    const TissueRest* tissue(int body) const; ///< nullptr for others
    const BoneRest* bone(int body) const;
    const ClothRest* cloth(int body) const;
    bool deforms(int body) const { return !bone(body); } ///< tissues and cloth: they own vertices
    /// Surface of any body as modelled.
    const Points& surface(int body) const;
    const std::vector<Triangle>& triangles(int body) const;
    const Numbering& numbering() const;
    /// First vertex of what carries a body that deforms, in the state's arrays; the next one's for others.
    int first_vertex(int body) const { return first_vertex_[static_cast<std::size_t>(body)]; }
    int vertex_count() const { return vertex_count_; } ///< vertices of all bodies that deform
    /// Vertices of one body in the state's arrays; 0 for bones.
    std::size_t vertex_count(int body) const { return vertex_counts_[static_cast<std::size_t>(body)]; }
    /// The body whose vertices carry this one: itself, or of a subtissue the tissue that it is a part of.
    int carrier_of(int body) const {
        const TissueRest* t = tissue(body);
        return t && t->carried_by >= 0 ? t->carried_by : body;
    }
    /// Place among the deformables of what carries a body; -1 for bones.
    int deformable_of(int body) const { return numbering().deformable_of(carrier_of(body)); }
    /// What carries a point with these barycentric coordinates in a tet of a tissue.
    PointWeights embedded(int body, int tet, const std::array<double, 4>& barycentric) const;
    /// The same of a point with these barycentric coordinates among three vertices of a cloth.
    PointWeights on_cloth(int body, const std::array<int, 3>& vertices, const std::array<double, 4>& coordinates) const;
    /// What carries a vertex of the surface of a tissue or cloth.
    PointWeights carrier_of(int body, int vertex) const;
    struct System; ///< element batches and pattern; solver-internal
    const System& system() const { return *system_; }

  private:
    void add_cloth(const ClothRest& sheet, int body, System& system);
    SceneDescription description_;
    std::vector<int> first_vertex_;
    std::vector<std::size_t> vertex_counts_;
    int vertex_count_ = 0;
    std::unique_ptr<const System> system_;
};

} // namespace sinew::solver
