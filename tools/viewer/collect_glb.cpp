// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/viewer/collect_glb.h"

#include "nodes/glb_file.h"
#include "tools/viewer/recorder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <unordered_map>

namespace sinew::viewer {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

[[noreturn]] void fail(const std::string& why) { throw std::runtime_error(why); }

/// How one node moves: one entry a frame, or none.
struct Tracks {
    std::vector<float> translations, rotations;
};

} // namespace

struct GlbRun::Content {
    std::string bytes;
    nodes::GlbFile glb;
    const json& document;
    GlbFrames frames;
    std::vector<int> order;                        ///< frame numbers as the file has them
    std::unordered_map<int, std::size_t> place_of; ///< of each number in `order`, the first

    explicit Content(std::string all)
        : bytes(std::move(all))
        , glb(bytes)
        , document(glb.document()) {
        find_frames();
    }

    std::vector<float> floats(std::size_t accessor) const { return numbers<float>(accessor, 5126); }
    std::vector<std::uint32_t> indices(std::size_t accessor) const { return numbers<std::uint32_t>(accessor, 5125); }

    Tracks tracks_of(std::size_t node) const {
        Tracks out;
        for (const json& animation : document.value("animations", json::array()))
            for (const json& channel : animation.at("channels")) {
                const json& target = channel.at("target");
                if (target.value("node", std::size_t{0}) != node || !target.contains("node")) continue;
                const auto path = target.at("path").get<std::string>();
                if (path != "translation" && path != "rotation") continue;
                const json& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
                (path == "rotation" ? out.rotations : out.translations) =
                    floats(sampler.at("output").get<std::size_t>());
            }
        return out;
    }

  private:
    template <class T>
    std::vector<T> numbers(std::size_t index, std::size_t component) const {
        const json& accessor = document.at("accessors").at(index);
        static const std::map<std::string, std::size_t> widths{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
        const auto width = widths.find(accessor.at("type").get<std::string>());
        if (width == widths.end()) fail("it was not written by Sinew");
        const nodes::GlbNumbers n = glb.numbers(index, width->first, width->second);
        if (n.component != component || n.stride != sizeof(T) * width->second) fail("it was not written by Sinew");
        std::vector<T> out(n.count * width->second);
        if (!out.empty()) std::memcpy(out.data(), n.first, out.size() * sizeof(T));
        return out;
    }

    void find_frames() {
        const json& scene = document.at("scenes").at(0);
        if (!scene.contains("extras") || !scene["extras"].contains("sinew"))
            fail("it does not say which frames it has; Sinew writes that since version " SINEW_VERSION);
        const json& about = scene["extras"]["sinew"];
        order = about.at("frames").get<std::vector<int>>();
        for (std::size_t i = 0; i < order.size(); ++i) place_of.emplace(order[i], i);
        frames.numbers = {order.begin(), order.end()};
        frames.fps = about.at("fps").get<double>();
        frames.units_per_metre = about.at("units_per_metre").get<double>();
        frames.up = about.at("up") == "z" ? 'z' : 'y';
        if (order.empty() || !(frames.units_per_metre > 0)) fail("it has no frames");
    }
};

namespace {

/// Shading vertices -> body vertices: those that lie together in every pose are one.
std::vector<int> weld(const std::vector<std::vector<float>>& poses, std::size_t& count) {
    const std::size_t n = poses.front().size() / 3;
    const auto at = [&](std::size_t pose, std::size_t v) {
        return std::array<float, 3>{poses[pose][3 * v], poses[pose][3 * v + 1], poses[pose][3 * v + 2]};
    };
    std::map<std::array<float, 3>, std::vector<std::pair<std::size_t, int>>> seen;
    std::vector<int> out(n);
    count = 0;
    for (std::size_t v = 0; v < n; ++v) {
        auto& here = seen[at(0, v)];
        const auto same = std::find_if(here.begin(), here.end(), [&](const auto& other) {
            for (std::size_t p = 1; p < poses.size(); ++p)
                if (at(p, v) != at(p, other.first)) return false;
            return true;
        });
        if (same != here.end()) {
            out[v] = same->second;
            continue;
        }
        out[v] = static_cast<int>(count++);
        here.emplace_back(v, out[v]);
    }
    return out;
}

solver::Points welded(const std::vector<float>& pose, const std::vector<float>& base, const std::vector<int>& to,
                      std::size_t count, double scale) {
    solver::Points out(count, solver::Vec3::Zero());
    for (std::size_t v = 0; v < to.size(); ++v)
        for (std::size_t c = 0; c < 3; ++c) {
            const float p = &pose == &base ? base[3 * v + c] : base[3 * v + c] + pose[3 * v + c];
            out[static_cast<std::size_t>(to[v])][static_cast<int>(c)] = scale * static_cast<double>(p);
        }
    return out;
}

} // namespace

GlbRun::GlbRun(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!text.view().starts_with("glTF")) fail("it is no GLB file");
    try {
        content_ = std::make_unique<Content>(std::move(text).str());
    } catch (const json::exception&) {
        fail("its description is damaged");
    }
}

GlbRun::~GlbRun() = default;

const GlbFrames& GlbRun::frames() const { return content_->frames; }

std::vector<ViewBody> GlbRun::bodies(const std::vector<int>& chosen, std::vector<ViewNote>& notes) const {
    std::vector<ViewBody> out;
    const Content& in = *content_;
    const double scale = in.frames.units_per_metre;
    try {
        const json& nodes = in.document.value("nodes", json::array());
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            if (!nodes[n].contains("mesh")) continue;
            const json& mesh = in.document.at("meshes").at(nodes[n]["mesh"].get<std::size_t>());
            const json& primitive = mesh.at("primitives").at(0);
            std::vector<std::vector<float>> poses{in.floats(primitive.at("attributes").at("POSITION"))};
            for (const json& target : primitive.value("targets", json::array()))
                poses.push_back(in.floats(target.at("POSITION")));
            for (const auto& pose : poses)
                if (pose.size() != poses.front().size() || pose.size() % 3 != 0) fail("it is damaged");
            std::size_t count = 0;
            const std::vector<int> to = weld(poses, count);
            solver::SurfaceMesh surface;
            const std::vector<std::uint32_t> corners = in.indices(primitive.at("indices"));
            for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
                solver::Triangle t{};
                for (std::size_t k = 0; k < 3; ++k) t[k] = to.at(corners[i + k]);
                surface.triangles.push_back(t);
                surface.face_sizes.push_back(3);
                surface.face_vertices.insert(surface.face_vertices.end(), t.begin(), t.end());
            }
            const Tracks tracks = in.tracks_of(n);
            const auto still = nodes[n].value("translation", std::vector<float>{0, 0, 0});
            const json extras = nodes[n].value("extras", json::object());
            const render::Appearance appearance{render::matter_of(extras.value("appearance", "")),
                                                render::colour_of(extras.value("colour", ""))};
            BodyRecorder recorder(nodes[n].value("name", "body"), extras.value("node", ""),
                                  render::kind_of(extras.value("kind", "")), static_cast<int>(out.size()), appearance);
            const auto pose_at = [&](int frame) {
                const auto found = in.place_of.find(frame);
                const std::size_t f = found == in.place_of.end() ? in.order.size() : found->second;
                const auto& pose = f > 0 && f < poses.size() ? poses[f] : poses.front();
                solver::Points points = welded(pose, poses.front(), to, count, scale);
                Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
                solver::Vec3 t(static_cast<double>(still.at(0)), static_cast<double>(still.at(1)),
                               static_cast<double>(still.at(2)));
                for (int c = 0; c < 4 && !tracks.rotations.empty(); ++c)
                    q.coeffs()[c] = static_cast<double>(tracks.rotations.at(4 * f + static_cast<std::size_t>(c)));
                for (int c = 0; c < 3 && !tracks.translations.empty(); ++c)
                    t[c] = static_cast<double>(tracks.translations.at(3 * f + static_cast<std::size_t>(c)));
                q.normalize();
                for (solver::Vec3& p : points) p = q * p + scale * t;
                return points;
            };
            surface.points = pose_at(in.order.front());
            recorder.set_rest(surface);
            for (const int frame : chosen) recorder.add_points(frame, pose_at(frame));
            out.push_back(recorder.finish(notes));
        }
    } catch (const json::exception&) {
        fail("its description is damaged");
    } catch (const std::out_of_range&) {
        fail("its description is damaged");
    }
    return out;
}

fs::path find_glb(const fs::path& folder) {
    fs::path newest;
    fs::file_time_type when;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (entry.path().extension() != ".glb" || !entry.is_regular_file(error)) continue;
        const auto time = entry.last_write_time(error);
        if (newest.empty() || time > when) newest = entry.path(), when = time;
    }
    return newest;
}

} // namespace sinew::viewer
