// Matrices as artists write them: translate, rotate and scale with Maya's rotate orders.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/attribute.h"
#include "engine/node_type.h"
#include "nodes/limits.h"
#include "nodes/values.h"

#include <string_view>

namespace sinew::nodes {

inline constexpr engine::Matrix4 identity_matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// a * b: first b, then a.
engine::Matrix4 multiply(const engine::Matrix4& a, const engine::Matrix4& b);
/// First scale, then rotate about the pivot, then translate. `order` "xyz" turns about x first. Degrees;
/// multiples of 90 are exact.
engine::Matrix4 compose(const engine::Vec3& translate, const engine::Vec3& rotate, const engine::Vec3& scale,
                        std::string_view order, const engine::Vec3& rotate_pivot);

/// Whether the last row is 0 0 0 1, but for rounding: nothing reads it. It is not where a matrix is written for row
/// vectors, with the translation there.
bool is_affine(const engine::Matrix4& matrix);
/// Fails at `attribute` with FE252 unless it is_affine.
void check_affine(const engine::Reads& in, std::string_view attribute, const engine::Matrix4& matrix);

/// How large a matrix makes the box of 1 x 1 x 1: below 0 where it mirrors, 0 where it makes everything flat.
double volume_factor(const engine::Matrix4& matrix);
/// Fails at `attribute` with FE332 if the matrix makes everything flat, so that no body is left of what it moves.
void refuse_flat(const engine::Reads& in, std::string_view attribute, const engine::Matrix4& matrix);

/// The mesh with every point moved; the very same mesh for the identity. Throws solver::Error FE202 or FE224 if they
/// land where no mesh may lie.
Mesh moved(const Mesh& mesh, const engine::Matrix4& matrix);
/// Likewise of points; the very same bits for the identity.
solver::Points moved(const solver::Points& points, const engine::Matrix4& matrix);

} // namespace sinew::nodes
