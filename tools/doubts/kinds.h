// The kinds of doubts: each function looks at one node, or at the bodies of one solver, and says what it doubts.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/doubts/doubting.h"

namespace sinew::cli {

/// One of a solver's bodies that take part, by the name of its node.
struct Member {
    std::string name;
    nodes::Body body;
};

// ---- values.cpp: numbers in another unit than the attribute's, or that nothing reads ----
void doubt_material(Doubting& d, const std::string& node);
void doubt_fiber(Doubting& d, const std::string& node);
void doubt_passive_muscles(Doubting& d, const std::vector<std::string>& fibers);
/// Of a zMaterial or zFiber: weights that are 0 everywhere.
void doubt_blank_paint(Doubting& d, const std::string& node);
void doubt_attachment(Doubting& d, const std::string& node);
void doubt_gravity(Doubting& d, const std::string& solver);

// ---- mirrors.cpp: scales and matrices that turn things inside out ----
void doubt_matrix(Doubting& d, const std::string& bone);
void doubt_transforms(Doubting& d, const std::vector<std::string>& transforms);

// ---- sizes.cpp: bodies in another unit than the solver's or than the others' ----
void doubt_sizes(Doubting& d, const std::string& solver, const std::vector<Member>& members, double units);

/// The same of the meshes that bodies are to be made of, where they cannot be.
void doubt_units_of_meshes(Doubting& d, const std::string& solver);

// ---- meshes.cpp: flaws of a mesh, and tets that do not suit it ----
void doubt_mesh(Doubting& d, const Member& member);
void doubt_tets(Doubting& d, const Member& tissue);
void doubt_sheet(Doubting& d, const Member& cloth, double units);

// ---- ties.cpp: what is held by nothing, or as a whole ----
void doubt_hold(Doubting& d, const std::string& node);
void doubt_floating(Doubting& d, const std::string& solver, const std::vector<Member>& members);
void doubt_paint(Doubting& d, const std::string& solver, const std::vector<Member>& members);

} // namespace sinew::cli
