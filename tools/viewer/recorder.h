// Takes one body frame after frame. Finds out by itself whether it is rigid, and copes with frames that are
// missing or have another number of vertices.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "nodes/values.h"
#include "tools/viewer/view_data.h"

#include <optional>
#include <span>
#include <utility>

namespace sinew::viewer {

class BodyRecorder {
  public:
    /// `index`: position among all bodies, for the colour.
    BodyRecorder(std::string name, std::string node, render::BodyKind kind, int index,
                 const render::Appearance& appearance = {});

    /// The shape as modelled. Without it the first frame is taken.
    void set_rest(const solver::SurfaceMesh& rest);
    /// The tets, and where the surface sits in them. Then every frame also needs add_tets.
    void set_lattice(const solver::TetMesh& tets, const solver::Embedding& surface);

    void add(int frame, const solver::SurfaceMesh& mesh);
    /// Only points are new; the connectivity is that of the rest shape. Throws std::logic_error without one.
    void add_points(int frame, const solver::Points& points);
    void add_tets(const solver::Points& tet_vertices);
    void add_missing(int frame);

    ViewBody& body() { return body_; }
    /// The finished body; what was strange about it goes into `notes`.
    ViewBody finish(std::vector<ViewNote>& notes);
    /// Frames without the body, for a note about several bodies; finish() then says nothing of them.
    std::vector<int> take_missing() { return std::exchange(missing_, {}); }
    /// Frames whose number of vertices is not that of the rest shape.
    const std::vector<int>& other_count() const { return other_count_; }

  private:
    bool try_rigid(const solver::Points& points);
    void store(const solver::Points& points);
    void repeat_last();
    void measure_volume(const solver::Points& points);

    ViewBody body_;
    solver::Points rest_;
    std::vector<solver::Triangle> triangles_; ///< of body vertices
    std::optional<double> rest_volume_;
    bool has_rest_ = false, is_rigid_ = true, lattice_fits_ = false;
    std::vector<int> missing_, other_count_;
};

Coordinates coordinates(const solver::Points& points);
/// "3, 5-9 and 12".
std::string frame_list(const std::vector<int>& frames);

} // namespace sinew::viewer
