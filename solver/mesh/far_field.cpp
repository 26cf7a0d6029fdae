// What triangles add to winding numbers.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/mesh/far_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace sinew::solver {

/// Adds factor * (a . r)(b . r)(c . r), and the sum of its three traces.
void FarField::add_cubic(const Vec3& a, const Vec3& b, const Vec3& c, double factor) {
    const auto pair = [&](int i, int j, int k) { return a[i] * b[j] * c[k]; };
    cubic.xxx += factor * pair(0, 0, 0), cubic.yyy += factor * pair(1, 1, 1), cubic.zzz += factor * pair(2, 2, 2);
    const auto twice = [&](int i, int k) { return factor * (pair(i, i, k) + pair(i, k, i) + pair(k, i, i)); };
    cubic.xxy += twice(0, 1), cubic.xxz += twice(0, 2), cubic.yyx += twice(1, 0);
    cubic.yyz += twice(1, 2), cubic.zzx += twice(2, 0), cubic.zzy += twice(2, 1);
    cubic.xyz +=
        factor * (pair(0, 1, 2) + pair(0, 2, 1) + pair(1, 0, 2) + pair(1, 2, 0) + pair(2, 0, 1) + pair(2, 1, 0));
    trace += factor * (a.dot(b) * c + a.dot(c) * b + b.dot(c) * a);
}

void FarField::add(const std::array<Vec3, 3>& corners) {
    const Vec3 vector_area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3 - centre;
    dipole += vector_area;
    quadrupole += vector_area * middle.transpose();
    // Second moments of a triangle: a twelfth of its area times those of its corners and of three times its
    // middle.
    for (const Vec3& corner : corners) {
        const Vec3 d = corner - centre;
        add_cubic(vector_area, d, d, 1.0 / 12);
    }
    add_cubic(vector_area, middle, middle, 9.0 / 12);
}

void FarField::add(const FarField& part) {
    const Vec3 shift = part.centre - centre;
    dipole += part.dipole;
    quadrupole += part.quadrupole + part.dipole * shift.transpose();
    const FarField::Cubic& c = part.cubic;
    cubic.xxx += c.xxx, cubic.yyy += c.yyy, cubic.zzz += c.zzz, cubic.xxy += c.xxy, cubic.xxz += c.xxz;
    cubic.yyx += c.yyx, cubic.yyz += c.yyz, cubic.zzx += c.zzx, cubic.zzy += c.zzy, cubic.xyz += c.xyz;
    trace += part.trace;
    // n (d + shift)^2: twice the quadrupole with the shift, and the dipole with its square.
    for (int k = 0; k < 3; ++k) add_cubic(part.quadrupole.col(k), Vec3::Unit(k), shift, 2);
    add_cubic(part.dipole, shift, shift, 1);
}

double FarField::winding(const Vec3& p) const {
    const Vec3 r = centre - p;
    const double r2 = r.squaredNorm(), x = r.x(), y = r.y(), z = r.z();
    const double bent = r.dot(quadrupole * r);
    const double form = x * x * (cubic.xxx * x + cubic.xxy * y + cubic.xxz * z) +
                        y * y * (cubic.yyy * y + cubic.yyx * x + cubic.yyz * z) +
                        z * z * (cubic.zzz * z + cubic.zzx * x + cubic.zzy * y) + cubic.xyz * x * y * z;
    const double sum = dipole.dot(r) + quadrupole.trace() + (-3 * bent - 1.5 * trace.dot(r) + 7.5 * form / r2) / r2;
    return sum / (4 * std::numbers::pi * r2 * std::sqrt(r2));
}

WindingSums::WindingSums(const Points& points)
    : count_(points.size())
    , sums_(count_, 0.0)
    , cosines_(count_, 1.0)
    , sines_(count_, 0.0)
    , tangents_(count_)
    , divisors_(count_) {
    for (std::size_t d = 0; d < 3; ++d)
        for (const Vec3& p : points) coordinates_[d].push_back(p[static_cast<int>(d)]);
}

void WindingSums::add(const FarField& f) {
    const double cx = f.centre.x(), cy = f.centre.y(), cz = f.centre.z();
    const double dx = f.dipole.x(), dy = f.dipole.y(), dz = f.dipole.z();
    const double tx = 1.5 * f.trace.x(), ty = 1.5 * f.trace.y(), tz = 1.5 * f.trace.z();
    const Mat3& q = f.quadrupole;
    const double qt = q.trace(), xx = q(0, 0), yy = q(1, 1), zz = q(2, 2), xy = q(0, 1) + q(1, 0),
                 xz = q(0, 2) + q(2, 0), yz = q(1, 2) + q(2, 1);
    const FarField::Cubic k = f.cubic;
    const double *px = coordinates_[0].data(), *py = coordinates_[1].data(), *pz = coordinates_[2].data();
    double* sums = sums_.data();
    for (std::size_t i = 0; i < count_; ++i) {
        const double x = cx - px[i], y = cy - py[i], z = cz - pz[i];
        const double r2 = x * x + y * y + z * z, inverse = 1 / r2;
        const double bent = xx * x * x + yy * y * y + zz * z * z + xy * x * y + xz * x * z + yz * y * z;
        const double form = x * x * (k.xxx * x + k.xxy * y + k.xxz * z) + y * y * (k.yyy * y + k.yyx * x + k.yyz * z) +
                            z * z * (k.zzz * z + k.zzx * x + k.zzy * y) + k.xyz * x * y * z;
        const double sum =
            dx * x + dy * y + dz * z + qt + (7.5 * form * inverse - 3 * bent - (tx * x + ty * y + tz * z)) * inverse;
        sums[i] += sum * inverse / std::sqrt(r2);
    }
}

void WindingSums::add(const std::array<Vec3, 3>& c) {
    const double ax = c[0].x(), ay = c[0].y(), az = c[0].z(), bx = c[1].x(), by = c[1].y(), bz = c[1].z(),
                 cx = c[2].x(), cy = c[2].y(), cz = c[2].z();
    const double *px = coordinates_[0].data(), *py = coordinates_[1].data(), *pz = coordinates_[2].data();
    double *tangents = tangents_.data(), *divisors = divisors_.data();
    for (std::size_t i = 0; i < count_; ++i) {
        const double ux = ax - px[i], uy = ay - py[i], uz = az - pz[i];
        const double vx = bx - px[i], vy = by - py[i], vz = bz - pz[i];
        const double wx = cx - px[i], wy = cy - py[i], wz = cz - pz[i];
        const double u = std::sqrt(ux * ux + uy * uy + uz * uz), v = std::sqrt(vx * vx + vy * vy + vz * vz),
                     w = std::sqrt(wx * wx + wy * wy + wz * wz);
        tangents[i] = ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx);
        divisors[i] = u * v * w + (ux * vx + uy * vy + uz * vz) * w + (vx * wx + vy * wy + vz * wz) * u +
                      (wx * ux + wy * uy + wz * uz) * v;
    }
    double largest = 0, least_divisor = 1;
    for (std::size_t i = 0; i < count_; ++i) {
        least_divisor = std::min(least_divisor, divisors[i]);
        largest = std::max(largest, std::abs(tangents[i] / divisors[i]));
    }
    if (!(least_divisor > 0) || !(largest < 2)) return add_one_by_one();
    if (tangent_sum_ + largest > 3) take_products();
    tangent_sum_ += largest;
    double *cosines = cosines_.data(), *sines = sines_.data();
    for (std::size_t i = 0; i < count_; ++i) {
        const double tangent = tangents[i] / divisors[i];
        const double cosine = cosines[i] - sines[i] * tangent;
        sines[i] += cosines[i] * tangent;
        cosines[i] = cosine;
    }
}

std::vector<double> WindingSums::finish() {
    take_products();
    for (double& s : sums_) s /= 4 * std::numbers::pi;
    return std::move(sums_);
}

/// For triangles that are large or in whose plane a point lies.
void WindingSums::add_one_by_one() {
    for (std::size_t i = 0; i < count_; ++i)
        if (tangents_[i] != 0) sums_[i] += 2 * std::atan2(tangents_[i], divisors_[i]);
}

void WindingSums::take_products() {
    if (tangent_sum_ == 0) return;
    for (std::size_t i = 0; i < count_; ++i) sums_[i] += 2 * std::atan2(sines_[i], cosines_[i]);
    std::fill(cosines_.begin(), cosines_.end(), 1.0);
    std::fill(sines_.begin(), sines_.end(), 0.0);
    tangent_sum_ = 0;
}

} // namespace sinew::solver
