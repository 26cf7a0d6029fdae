// Between two matrices of a moving body.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/value.h"

namespace sinew::engine {

/// At share u in [0, 1] of the way. The rotation turns by slerp about the axis of the screw that joins the two (so a
/// hinge stays a hinge, wherever the origin lies), and stretch changes linearly (polar decomposition); matrices without
/// an inverse are interpolated by their numbers. Where only the translations differ, these are interpolated like keyed
/// numbers, to the bit.
Matrix4 matrix_between(const Matrix4& from, const Matrix4& to, double u);

} // namespace sinew::engine
