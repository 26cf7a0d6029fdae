// meshSequence: a deforming mesh from numbered mesh files or from a point cache.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/file_sequence.h"
#include "engine/registry.h"
#include "nodes/adapters.h"
#include "nodes/json_file.h"
#include "nodes/mesh_formats.h"
#include "nodes/motion_track.h"
#include "solver/mesh/coordinates.h"
#include "solver/mesh/point_cache.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

namespace sinew::nodes {

using namespace engine;

namespace {

const Input<File> file{
    .name = "file",
    .doc = "Numbered mesh files of any format that meshFile reads, with # for the digits of the frame: "
           "\"skin.####.obj\" is skin.0001.obj and so on. Or one point cache, PC2 or MDD, which holds no faces: "
           "connect mesh then.",
    .required = true,
};
const Wire<Mesh> mesh{
    .name = "mesh",
    .doc = "Faces and vertex count: every frame must have them. Without it numbered files must have those of the "
           "first; point caches need it.",
    .required = false,
};
const Input<double> frame_offset{
    .name = "frameOffset",
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Shift along the files, in frames of theirs: graph frame 1 shows frame 1 + frameOffset. Numbered files have "
           "the frames that their names say, PC2 those of its header, MDD begins at frame 1 and goes by its times.",
};
const Input<double> frame_rate{
    .name = "frameRate",
    .def = 1,
    .limits = {.min = -1e9, .max = 1e9},
    .doc = "Frames of the files per graph frame. Between frames, and at sub-steps, vertices are taken on straight "
           "lines.",
    .keyable = false,
};
const Input<std::string> beyond{
    .name = "beyond",
    .def = "fail",
    .doc = "Before the first and after the last frame that there is: fail says so, hold stands still there.",
    .keyable = false,
    .options = {"fail", "hold"},
};
const Output<Mesh> out_mesh{.name = "outMesh", .doc = "The mesh at this frame, in scene units."};

/// The frames that the files have, whatever they are.
class Frames {
  public:
    virtual ~Frames() = default;
    /// Where they lie, rising.
    virtual const std::vector<double>& frames() const = 0;
    virtual solver::Points points(std::size_t index) const = 0;
    virtual const Mesh& reference() const = 0;
};

std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", v);
    return text;
}

bool same_faces(const Mesh& a, const solver::SurfaceMesh& b) {
    return a.points->size() == b.points.size() && a.topology->face_sizes == b.face_sizes &&
           a.topology->face_vertices == b.face_vertices;
}

/// Throws Error FE294 where a mesh is not the one that it should be at another time.
void check_faces(const std::string& whose, const Mesh& wanted, std::size_t points, const std::string& like, bool same) {
    if (points == wanted.points->size() && same) return;
    const bool other_count = points != wanted.points->size();
    throw solver::Error("FE294",
                        whose + (other_count ? " has " + std::to_string(points) + " vertices, " + like + " has " +
                                                   std::to_string(wanted.points->size())
                                             : " has other faces than " + like),
                        "Export all frames of one mesh, without changing it.");
}

class NumberedFiles : public Frames {
  public:
    NumberedFiles(const FileAccess& files, const std::string& pattern, const Mesh* given)
        : files_(files) {
        for (const auto& [n, path] : find_sequence(pattern)) {
            frames_.push_back(static_cast<double>(n));
            paths_.push_back(path);
        }
        if (paths_.empty()) throw solver::Error("IO401", "there is no file like " + pattern);
        if (given)
            reference_ = *given, like_ = "the mesh";
        else
            reference_ = Mesh::from(read_mesh(files_, paths_.front())), like_ = name_of(0);
    }
    const std::vector<double>& frames() const override { return frames_; }
    const Mesh& reference() const override { return reference_; }
    solver::Points points(std::size_t index) const override {
        solver::SurfaceMesh read = read_mesh(files_, paths_[index]);
        check_faces(name_of(index), reference_, read.points.size(), like_, same_faces(reference_, read));
        solver::check_coordinates(read.points);
        return std::move(read.points);
    }

  private:
    std::string name_of(std::size_t index) const { return std::filesystem::path(paths_[index]).filename().string(); }
    FileAccess files_;
    std::vector<double> frames_;
    std::vector<std::string> paths_;
    Mesh reference_;
    std::string like_;
};

class Cache : public Frames {
  public:
    Cache(const FileAccess& files, const std::string& path, const Mesh& given, double fps)
        : cache_(solver::PointCache::parse(read_text(files, path), path))
        , reference_(given) {
        check_faces(path, given, cache_.points, "the mesh", true);
        for (std::size_t k = 0; k < cache_.samples; ++k) frames_.push_back(cache_.frame_of(k, fps));
    }
    const std::vector<double>& frames() const override { return frames_; }
    const Mesh& reference() const override { return reference_; }
    solver::Points points(std::size_t index) const override { return cache_.at(index); }

  private:
    solver::PointCache cache_;
    Mesh reference_;
    std::vector<double> frames_;
};

/// Place among the frames where `at` lies, and how far on the way to the next.
std::pair<std::size_t, double> find(const Reads& in, const std::vector<double>& frames, double at) {
    constexpr double rounding = 1e-6;
    const bool before = at<frames.front() - rounding, after = at> frames.back() + rounding;
    if ((before || after) && in[beyond] == "fail")
        in.fail(file.name, "FE293",
                "frame " + number(at) + " is asked for; there are frames " + number(frames.front()) + " to " +
                    number(frames.back()),
                "Export it, shift the files by frameOffset, or let them stand still by beyond: hold.");
    if (at <= frames.front() + rounding) return {0, 0};
    if (at >= frames.back() - rounding) return {frames.size() - 1, 0};
    const auto next = std::upper_bound(frames.begin(), frames.end(), at + rounding);
    const auto k = static_cast<std::size_t>(next - frames.begin()) - 1;
    const double share = (at - frames[k]) / (frames[k + 1] - frames[k]);
    return {k, std::abs(at - frames[k]) <= rounding ? 0 : share};
}

/// Files of numbers that are left out would be bridged by a straight line without a word.
void refuse_gap(const Reads& in, const std::vector<double>& frames, std::size_t k) {
    if (!names_sequence(in[file].path) || frames[k + 1] - frames[k] <= 1) return;
    in.fail(file.name, "FE293",
            "frame " + number(frames[k] + 1) + " is missing: after " + number(frames[k]) + " comes " +
                number(frames[k + 1]),
            "Export it again.");
}

void compute(const Reads& in, Writes& out) {
    const std::string& path = in[file].path;
    const Mesh* given = in.find(mesh);
    const bool numbered = names_sequence(path);
    if (!numbered && !solver::is_point_cache(path))
        in.fail(file.name, "IO404", path + " is one file, and no point cache",
                "Write # for the digits of the frame (\"skin.####.obj\"), or name a .pc2 or .mdd file.");
    if (!numbered && !given)
        in.fail(mesh.name, "DG110", "a point cache has no faces", "Connect the mesh whose vertices it moves.");
    struct Kept {
        std::unique_ptr<Frames> frames;
    };
    Hasher h;
    h.add("meshSequence").add(path).add(in[file].content).add(in.fps());
    if (given) h.add(given->topology->digest).add(given->points_digest);
    auto kept = in.lease<Kept>(h.finish(), [&] {
        return guarded(in, file.name, [&] {
            auto made = std::make_shared<Kept>();
            if (numbered)
                made->frames = std::make_unique<NumberedFiles>(in.files(), path, given);
            else
                made->frames = std::make_unique<Cache>(in.files(), path, *given, in.fps());
            return made;
        });
    });
    const Frames& frames = *kept->frames;
    const auto [k, share] = find(in, frames.frames(), track_frame(in.frame(), in[frame_offset], in[frame_rate]));
    if (share > 0) refuse_gap(in, frames.frames(), k);
    const Mesh result = guarded(in, file.name, [&] {
        solver::Points points = frames.points(k);
        if (share > 0) {
            const solver::Points next = frames.points(k + 1);
            for (std::size_t v = 0; v < points.size(); ++v) points[v] += share * (next[v] - points[v]);
        }
        return frames.reference().with_points(std::move(points));
    });
    out.set(out_mesh, result);
}

} // namespace

void add_mesh_sequence(Registry& registry) {
    NodeType type;
    type.name = "meshSequence";
    type.doc = "Reads a deforming mesh: numbered mesh files, or a PC2 or MDD point cache. Simulations that read it go "
               "by what each frame holds: files that stay the same make nothing run again.";
    type.inputs = {describe(file), describe(mesh), describe(frame_offset), describe(frame_rate), describe(beyond)};
    type.outputs = {describe(out_mesh)};
    type.uses_time = true;
    type.compute = compute;
    registry.add(std::move(type));
}

} // namespace sinew::nodes
