// What a viewer shows: a whole run as plain data. Knows no HTML and no graph evaluation, so the page,
// pictures and tests share it. Positions are in scene units.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "solver/state.h"
#include "tools/render/look.h"
#include "tools/viewer/graph_layout.h"

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace sinew::viewer {

/// x, y, z of one point after the other. Single precision: what is looked at needs no more, and it halves a
/// long run.
using Coordinates = std::vector<float>;

/// p = translation + rotation * (p_rest - pivot); rotation as a unit quaternion (x, y, z, w).
struct RigidPose {
    std::array<float, 4> rotation{0, 0, 0, 1};
    std::array<float, 3> translation{};
};

/// A body that never changes its shape. One pose a frame.
struct RigidMotion {
    std::array<float, 3> pivot{};
    std::vector<RigidPose> poses;
};

/// A body that deforms. One entry a frame; empty where the body is missing.
struct DeformingMotion {
    std::vector<Coordinates> points;
};

/// Where surface vertices sit in a lattice.
struct ViewEmbedding {
    std::vector<int> tet;
    std::vector<float> weights; ///< 4 a vertex, sum 1
};

/// A tet vertex beside the flesh, and the point of the surface next to it at rest: where it is drawn.
struct ViewSkinPoint {
    int vertex = -1;
    std::array<int, 3> host{-1, -1, -1}; ///< body vertices
    std::array<float, 3> weights{};
};

/// The tets that carry a tissue.
struct ViewLattice {
    std::vector<solver::Tet> tets;
    Coordinates rest;
    std::vector<Coordinates> frames; ///< tet vertices; empty where missing
    ViewEmbedding surface;           ///< empty: the surface has its own motion
    std::vector<ViewSkinPoint> skin; ///< from keep_to_flesh (flesh.h)
};

/// Fibre segments of one fibre field.
struct ViewFibres {
    std::string node; ///< in the graph
    std::vector<int> tets;
    Coordinates directions;        ///< unit, at rest
    std::vector<float> weights;    ///< 0…1
    std::vector<float> centre;     ///< 4 a fibre: weights of its tet's vertices where its line has its middle
    std::vector<float> reach;      ///< 2 a fibre: how far its line goes back and forth at rest, scene units
    std::vector<float> excitation; ///< per frame, 0…1, envelope included
};

/// A painted map: one value a vertex.
struct ViewMap {
    std::string node, name; ///< "bicepsTendonPaint", "material weights"
    std::vector<float> values;
};

struct ViewBody {
    std::string name, node; ///< `node` is empty where no graph is known
    render::BodyKind kind = render::BodyKind::plain;
    nodes::Matter matter = nodes::Matter::plain; ///< what it looks to be made of
    render::Look look;
    Coordinates rest;                        ///< as modelled
    std::vector<solver::Triangle> triangles; ///< of shading vertices
    std::vector<int> shading;                ///< the body vertex of each shading vertex; empty = the same
    std::vector<std::array<int, 2>> edges;   ///< of the polygons, once each; body vertices
    std::variant<RigidMotion, DeformingMotion> motion;
    std::vector<char> present; ///< per frame; empty = always there
    bool is_framed = true;     ///< pictures: the camera makes room for it
    std::optional<ViewLattice> lattice;
    std::vector<ViewFibres> fibres;
    std::vector<ViewMap> maps;
    std::vector<float> volume; ///< enclosed volume / that at rest, per frame; empty where the surface is open

    std::size_t vertex_count() const { return rest.size() / 3; }
    bool is_there(std::size_t frame) const { return present.empty() || present[frame]; }
};

/// A point that a body carries: a weighted sum of tet vertices of a tissue, or of surface vertices of a bone (then 3).
struct ViewCarried {
    std::array<int, 4> host{-1, -1, -1, -1};
    std::array<float, 4> weights{};
};

/// An attached point and where it holds on: a point of the target plus an offset that turns with it.
struct ViewAnchor {
    ViewCarried source, target;
    std::array<float, 3> offset{}; ///< bones: in the frame of the triangle
};

struct ViewAttachment {
    std::string node, mode = "fixed"; ///< "fixed" or "sliding"
    int source = -1, target = -1;     ///< bodies
    std::vector<ViewAnchor> anchors;
};

/// A line, or a point where both ends are the same.
struct ViewMark {
    std::array<float, 3> from{}, to{};
    float value = 0;
    std::array<int, 2> bodies{-1, -1}; ///< of the scene, whom it is about; -1: nobody
};

/// What a force shows of itself: a field's arrows, what is held.
struct ViewMarks {
    std::string term, what, unit; ///< "field", "wind", "N/m^3": SI
    std::vector<ViewMark> marks;
};

/// What is known of one frame's solve.
struct ViewFrame {
    int frame = 0;
    bool reused = false;
    double wall_s = 0;
    std::optional<solver::StepRecord> step = {}; ///< times, convergence, energy
    std::vector<ViewMarks> marks = {};
    std::vector<std::string> faults = {}; ///< what must not be believed, for people: "biceps flies apart"
};

/// Something that a user must know about what is shown or missing.
struct ViewNote {
    bool is_warning = true;
    std::string text;
};

struct ViewScene {
    std::string title, source; ///< `source`: the graph file or folder, for people
    double fps = 24, units_per_metre = 100;
    char up = 'y';
    std::vector<ViewFrame> frames; ///< rising
    std::vector<ViewBody> bodies;
    std::vector<ViewAttachment> attachments;
    GraphDrawing graph; ///< empty where no graph is known
    std::vector<ViewNote> notes;
    bool is_evaluated = false; ///< from a graph, with all that it knows; else from files
};

/// Position of a vertex of a body at `frame` (an index). The body must be there.
std::array<float, 3> vertex_position(const ViewBody& body, std::size_t frame, std::size_t vertex);
/// Smallest box around all that is shown, over all frames without faults (over all, if each has some): min
/// and max.
std::array<std::array<float, 3>, 2> bounds(const ViewScene& scene);

} // namespace sinew::viewer
