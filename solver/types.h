// The few types that all of the solver shares. SI units everywhere: m, s, kg, N, Pa, J.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace sinew::solver {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Points = std::vector<Vec3>;
using Triangle = std::array<int, 3>;
using Tet = std::array<int, 4>;

} // namespace sinew::solver
