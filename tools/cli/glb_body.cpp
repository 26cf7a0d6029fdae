// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/glb_body.h"

#include "solver/mesh/surface_mesh.h"

#include <algorithm>
#include <stdexcept>

namespace sinew::cli {

using solver::Points;
using solver::Vec3;

namespace {

std::vector<float> flat(const Points& points) {
    std::vector<float> out;
    out.reserve(3 * points.size());
    for (const Vec3& p : points)
        for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(p[k]));
    return out;
}

/// Differences of what is stored, not of what was computed: base + difference then gives the frame to the
/// last bit that floats can hold.
std::vector<float> difference(const std::vector<float>& now, const std::vector<float>& base) {
    std::vector<float> out(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) out[i] = now[i] - base[i];
    return out;
}

FloatBounds bounds_of(const std::vector<float>& values) {
    FloatBounds out;
    for (std::size_t i = 0; i < values.size(); ++i) out.add(values[i], i % 3);
    return out;
}

/// Unit normals; where a vertex has none, any unit vector will do and glTF demands one.
std::vector<float> unit_normals(const Points& points, const std::vector<solver::Triangle>& triangles) {
    Points normals = solver::vertex_normals(points, triangles);
    for (Vec3& n : normals)
        if (n.isZero()) n = {0, 1, 0};
    return flat(normals);
}

} // namespace

void FloatBounds::add(float value, std::size_t component) {
    low[component] = std::min(low[component], value);
    high[component] = std::max(high[component], value);
}

GlbBody::GlbBody(std::string name, render::BodyKind kind, std::vector<solver::Triangle> triangles, const Pose& first,
                 double units_per_metre, const render::Appearance& appearance)
    : name_(std::move(name))
    , kind_(kind)
    , appearance_(appearance)
    , units_per_metre_(units_per_metre)
    , triangles_(std::move(triangles))
    , first_(first) {
    if (triangles_.empty()) return; // not written
    shading_ = render::split_creases(*first, triangles_);
    const Points points = metres(shading_.gather(*first), Vec3::Zero());
    base_ = flat(points), base_normals_ = unit_normals(points, shading_.triangles);
    fit_ = std::make_unique<RigidFit>(*first);
}

Points GlbBody::metres(const Points& points, const Vec3& pivot) const {
    Points out;
    out.reserve(points.size());
    for (const Vec3& p : points) out.push_back((p - pivot) / units_per_metre_);
    return out;
}

void GlbBody::add(const Pose& pose, SpillFile& spill) {
    if (triangles_.empty()) { // not written
        ++poses_;
        return;
    }
    if (pose->size() != first_->size()) throw std::logic_error("a pose of " + name_ + " has other vertices");
    const std::size_t number = poses_;
    // The spill comes first: it is what fails on a full disk, and a pose that it does not hold has not been added.
    if (number > 0) {
        // What stands still takes no room.
        const bool repeats = !stored_.empty() && (pose == last_ || *pose == *last_);
        stored_.push_back(
            repeats ? stored_.back()
                    : Stored{spill.append(std::as_bytes(std::span(*pose))),
                             bounds_of(difference(flat(metres(shading_.gather(*pose), Vec3::Zero())), base_))});
    }
    if (first_moved_ > number && *pose != *first_) first_moved_ = number;
    if (fit_) {
        if (const auto fit = fit_->add(*pose))
            rigid_.push_back(*fit);
        else
            fit_.reset();
    }
    last_ = pose;
    poses_ = number + 1;
}

Vec3 GlbBody::pivot(std::size_t poses) const {
    return is_rigid(poses) ? RigidFit(*first_).pivot() : Vec3(Vec3::Zero());
}

std::vector<float> GlbBody::base_positions(std::size_t poses) const {
    return is_rigid(poses) ? flat(metres(shading_.gather(*first_), pivot(poses))) : base_;
}

std::vector<float> GlbBody::base_normals(std::size_t poses) const {
    return is_rigid(poses) ? unit_normals(metres(shading_.gather(*first_), pivot(poses)), shading_.triangles)
                           : base_normals_;
}

FloatBounds GlbBody::base_bounds(std::size_t poses) const { return bounds_of(base_positions(poses)); }

GlbBody::Target GlbBody::target(std::size_t pose, const SpillFile& spill) const {
    Points points(first_->size());
    spill.read(stored_.at(pose - 1).place, std::as_writable_bytes(std::span(points)));
    const Points now = metres(shading_.gather(points), Vec3::Zero());
    return {difference(flat(now), base_), difference(unit_normals(now, shading_.triangles), base_normals_)};
}

} // namespace sinew::cli
