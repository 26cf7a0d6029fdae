// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/glb.h"

#include "engine/atomic_file.h"
#include "engine/diagnostics.h"
#include "tools/cli/glb_writer.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace sinew::cli {

namespace {

constexpr double most_bytes = UINT32_MAX; // lengths in a GLB have 32 bits
/// Of JSON for a target: two accessors, two views, names and a weight. A little below what is written.
constexpr double text_of_target = 400;

std::string gigabytes(double bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f GB", bytes / 1e9);
    return text;
}

bool is_flesh(render::BodyKind kind) { return kind == render::BodyKind::tissue || kind == render::BodyKind::cloth; }

} // namespace

GlbCost glb_cost(render::BodyKind kind, const solver::Points& points, const std::vector<solver::Triangle>& triangles) {
    if (triangles.empty()) return {};
    return {render::split_creases(points, triangles).source.size(), triangles.size(), is_flesh(kind)};
}

double glb_size(const std::vector<GlbCost>& bodies, std::size_t frames) {
    const double count = static_cast<double>(frames), targets = std::max(0.0, count - 1);
    double bytes = 0;
    bool any_deforms = false;
    for (const GlbCost& b : bodies) {
        if (b.triangles == 0) continue;
        const double pose = 24 * static_cast<double>(b.shading_vertices); // positions and normals
        bytes += pose + 12 * static_cast<double>(b.triangles);
        if (b.deforms) bytes += targets * (pose + text_of_target);
        any_deforms = any_deforms || b.deforms;
    }
    return any_deforms ? bytes + 4 * count + 4 * count * targets : bytes;
}

void check_glb_size(const std::vector<GlbCost>& bodies, std::size_t frames) {
    const double bytes = glb_size(bodies, frames);
    if (bytes <= most_bytes) return;
    std::size_t fits = 0, too_many = frames;
    while (too_many - fits > 1) {
        const std::size_t middle = fits + (too_many - fits) / 2;
        (glb_size(bodies, middle) <= most_bytes ? fits : too_many) = middle;
    }
    engine::Diagnostic d;
    d.code = "IO405";
    d.message = "the animation of " + std::to_string(frames) + " frames needs " + gigabytes(bytes) +
                ", and a GLB file cannot hold more than " + gigabytes(most_bytes);
    d.hint = fits > 0
                 ? "at most " + std::to_string(fits) +
                       " frames fit: give --frames a part at a time and each an --out of its own, or write --format "
                       "obj or ply"
                 : "write --format obj or ply";
    throw engine::Failure(d);
}

GlbFile::GlbFile(std::filesystem::path file, const GlbScene& scene, engine::FileAccess files)
    : file_(std::move(file))
    , files_(std::move(files))
    , scene_(scene) {}

std::size_t GlbFile::add_body(std::string name, render::BodyKind kind, std::vector<solver::Triangle> triangles,
                              const GlbBody::Pose& first, const render::Appearance& appearance) {
    bodies_.emplace_back(std::move(name), kind, std::move(triangles), first, scene_.units_per_metre, appearance);
    return bodies_.size() - 1;
}

void GlbFile::add_pose(std::size_t body, int frame, const GlbBody::Pose& pose) {
    if (!spill_) {
        std::error_code error;
        const auto folder = file_.has_parent_path() ? file_.parent_path() : std::filesystem::path(".");
        files_.check(folder, "the folder of the GLB");
        std::filesystem::create_directories(folder, error);
        engine::remove_abandoned(file_);
        spill_ = std::make_unique<SpillFile>(folder);
    }
    bodies_.at(body).add(pose, *spill_); // may throw, and then the frame has not come
    if (frames_.empty() || frames_.back() != frame) frames_.push_back(frame);
}

std::vector<GlbCost> GlbFile::costs() const {
    std::vector<GlbCost> out;
    for (const GlbBody& b : bodies_)
        out.push_back({b.shading().source.size(), b.triangles().size(), is_flesh(b.kind()) || !b.is_rigid(b.poses())});
    return out;
}

bool GlbFile::finish() {
    // A run that broke off between two pulls of one frame: that frame is not whole and stays out.
    std::size_t whole = frames_.size();
    for (const GlbBody& body : bodies_) whole = std::min(whole, body.poses());
    if (whole == 0) return false;
    frames_.resize(whole);
    engine::AtomicFile out(file_, files_);
    write_glb(scene_, frames_, bodies_, *spill_, out);
    out.commit();
    spill_.reset();
    return true;
}

} // namespace sinew::cli
