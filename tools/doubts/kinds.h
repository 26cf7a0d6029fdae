// The kinds of doubts: each function looks at one node, or at the bodies of one solver, and says what it doubts.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/doubts/doubting.h"

namespace sinew::doubts {

/// One of a solver's bodies that take part, by the name of its node.
struct Member {
    std::string name;
    nodes::Body body;
};

// ---- values.cpp: numbers in another unit than the attribute's, or that nothing reads ----
void doubt_material(Doubting& d, const std::string& node);
void doubt_fiber(Doubting& d, const std::string& node);
void doubt_weight_of_cloth(Doubting& d, const std::string& cloth);
void doubt_gravity(Doubting& d, const std::string& solver);
/// Fields that push cloth, to which the same number is a force per area, by many times its weight.
void doubt_fields_on_cloth(Doubting& d, const std::string& solver, const std::vector<Member>& members);
/// Values of materials that are given for what their only readers do not read.
void doubt_unread_values(Doubting& d);
/// Where none of the muscles among `nodes` has anything to pull by.
void doubt_passive_muscles(Doubting& d, const std::vector<std::string>& nodes);

// ---- idle.cpp ----
/// Of a node: values that are given and do nothing, since another of its attributes says so.
void doubt_idle_values(Doubting& d, const std::string& name);
/// Damping of bodies and attachments that no solver has velocities for.
void doubt_idle_damping(Doubting& d);
/// What bodies say of contact, in solvers without any.
void doubt_idle_contact(Doubting& d);
/// Forces on the mesh of parts of tissues that no solver has the mesh of.
void doubt_idle_parts(Doubting& d);

// ---- paint.cpp: maps that paint nothing ----
/// Of a weights node: a mesh or a sphere that what is painted does not come near; with `ramps` also one that begins and
/// ends beside it, which may well be meant where nothing fails for it.
void doubt_reach_of_paint(Doubting& d, const std::string& node, bool ramps);
/// Of a tissue or cloth: its layers but the first, and its fibres, whose weights are 0 everywhere.
void doubt_blank_paint(Doubting& d, const std::string& body);

// ---- mirrors.cpp: scales and matrices that turn things inside out ----
void doubt_matrix(Doubting& d, const std::string& bone);
void doubt_transforms(Doubting& d, const std::vector<std::string>& transforms);

// ---- sizes.cpp: bodies in another unit than the solver's or than the others' ----
void doubt_sizes(Doubting& d, const std::string& solver, const std::vector<Member>& members, double units);
/// The same as far as it can be told where some of the bodies cannot be made: of those by their meshes.
void doubt_units_of_meshes(Doubting& d, const std::string& solver);

// ---- meshes.cpp: flaws of a mesh, tets that do not suit it, sheets that are none ----
/// Of a tissue or cloth, which is modelled once: a mesh that is another one at a later frame.
void doubt_moving_mesh(Doubting& d, const std::string& body);
void doubt_mesh(Doubting& d, const Member& member);
/// After mirrors are told. `all`: the solver's bodies.
void doubt_bone(Doubting& d, const Member& member, const std::vector<Member>& all);
void doubt_tets(Doubting& d, const Member& tissue);
void doubt_thickness(Doubting& d, const Member& cloth, double units);

// ---- floating.cpp ----
/// Bodies that nothing holds, or pieces of them that no tets join to one that is held.
void doubt_floating(Doubting& d, const std::string& solver, const std::vector<Member>& members);

// ---- ties.cpp: what is held by next to nothing, or as a whole ----
void doubt_attachment(Doubting& d, const std::string& node);
void doubt_hold(Doubting& d, const std::string& node);
void doubt_whole_attachments(Doubting& d, const std::string& solver, const std::vector<Member>& members);

// ---- touching.cpp: bodies that contact cannot keep apart ----
/// Whether two bodies can push each other away at some frame; what is keyed does so then.
bool may_touch(const Doubting& d, const Member& a, const Member& b);
/// Open surfaces with hardly a point to stop others by; bodies that begin deep within each other, or in one place,
/// which is told without contact, too; cloth whose steps end before they have converged.
void doubt_contacts(Doubting& d, const std::string& solver, const std::vector<Member>& members, double units);

} // namespace sinew::doubts
