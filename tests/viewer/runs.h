// Small runs for the viewer's tests: a graph, scenes made by hand, and folders of OBJ files.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tests/tools/temporary_folder.h"
#include "tools/viewer/view_data.h"

#include <memory>
#include <string>

namespace sinew::test {

/// A soft block with fibres between two plates, one of which moves; frames 1 to 4.
std::string muscle_graph_text();
std::shared_ptr<const engine::Graph> muscle_graph();

/// A deforming ball of `vertices` points (no triangles to speak of), a rigid cube and `frames` frames.
viewer::ViewScene made_scene(std::size_t vertices, std::size_t frames);

/// A unit cube as OBJ text, moved by `x`; `extra` adds that many loose vertices.
std::string cube_obj(double x, int extra = 0);

} // namespace sinew::test
