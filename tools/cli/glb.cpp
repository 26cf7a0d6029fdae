// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/glb.h"

#include "engine/diagnostics.h"
#include "solver/mesh/surface_mesh.h"
#include "tools/cli/json_text.h"
#include "tools/cli/rigid_motion.h"
#include "tools/render/shading_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

namespace sinew::cli {

using nlohmann::json;
using solver::Points;
using solver::Vec3;

namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

// Numbers of the glTF 2.0 specification.
constexpr int type_float = 5126, type_unsigned = 5125, target_vertices = 34962, target_indices = 34963;

/// The binary chunk and the accessors that describe it, one buffer view each.
class Buffer {
  public:
    /// `width` numbers an element; `bounds`: write min and max, which the specification wants for positions
    /// and times.
    int add_floats(const std::vector<float>& values, int width, bool bounds,
                   std::optional<int> target = target_vertices) {
        constexpr const char* shapes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
        json accessor = make_accessor(values, width, type_float, shapes[width], target);
        if (bounds) {
            // As doubles: the shortest decimal of the float's exact value, which a checker compares bit for
            // bit.
            std::vector<double> low(static_cast<std::size_t>(width), INFINITY),
                high(static_cast<std::size_t>(width), -INFINITY);
            for (std::size_t i = 0; i < values.size(); ++i) {
                const std::size_t k = i % static_cast<std::size_t>(width);
                low[k] = std::min(low[k], static_cast<double>(values[i]));
                high[k] = std::max(high[k], static_cast<double>(values[i]));
            }
            accessor["min"] = low, accessor["max"] = high;
        }
        return keep(std::move(accessor));
    }
    int add_indices(const std::vector<std::uint32_t>& values) {
        return keep(make_accessor(values, 1, type_unsigned, "SCALAR", target_indices));
    }

    std::string bytes;
    json views = json::array(), accessors = json::array();

  private:
    template <class T>
    json make_accessor(const std::vector<T>& values, int width, int component, const char* shape,
                       std::optional<int> target) {
        static_assert(sizeof(T) == 4, "everything stays aligned to four bytes");
        const std::size_t size = 4 * values.size(), offset = bytes.size();
        bytes.resize(offset + size);
        if (size) std::memcpy(bytes.data() + offset, values.data(), size);
        json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
        if (target) view["target"] = *target;
        views.push_back(std::move(view));
        return {{"bufferView", views.size() - 1},
                {"componentType", component},
                {"count", values.size() / static_cast<std::size_t>(width)},
                {"type", shape}};
    }
    int keep(json accessor) {
        accessors.push_back(std::move(accessor));
        return static_cast<int>(accessors.size()) - 1;
    }
};

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

/// Unit normals; where a vertex has none, any unit vector will do and glTF demands one.
Points unit_normals(const Points& points, const std::vector<solver::Triangle>& triangles) {
    Points normals = solver::vertex_normals(points, triangles);
    for (Vec3& n : normals)
        if (n.isZero()) n = {0, 1, 0};
    return normals;
}

class Writer {
  public:
    explicit Writer(const Animation& animation)
        : in_(animation) {
        document_["asset"] = {{"version", "2.0"}, {"generator", "Sinew " SINEW_VERSION}};
        for (const int frame : in_.frames) times_.push_back(static_cast<float>((frame - in_.frames.front()) / in_.fps));
    }

    std::string encode() {
        json children = json::array();
        for (std::size_t b = 0; b < in_.bodies.size(); ++b)
            if (!in_.bodies[b].triangles.empty() && !in_.bodies[b].poses.empty())
                children.push_back(add_body(in_.bodies[b], static_cast<int>(b)));
        // For reading the run back (tools/viewer/collect_glb.cpp).
        json scene = {{"name", "sinew"},
                      {"extras",
                       {{"sinew",
                         {{"frames", in_.frames},
                          {"fps", in_.fps},
                          {"units_per_metre", in_.units_per_metre},
                          {"up", std::string(1, in_.up)}}}}}};
        if (!children.empty()) {
            if (in_.up == 'z') { // one node that turns the scene upright
                const double half = std::numbers::sqrt2 / 2;
                children = {add_node({{"name", "z up"}, {"rotation", {-half, 0, 0, half}}, {"children", children}})};
            }
            scene["nodes"] = children;
        }
        document_["scene"] = 0;
        document_["scenes"] = {scene};
        if (!channels_.empty())
            document_["animations"] = {{{"name", "run"}, {"channels", channels_}, {"samplers", samplers_}}};
        if (!buffer_.bytes.empty()) {
            document_["bufferViews"] = buffer_.views;
            document_["accessors"] = buffer_.accessors;
            document_["buffers"] = {{{"byteLength", buffer_.bytes.size()}}};
        }
        return container();
    }

  private:
    int add_node(json node) {
        document_["nodes"].push_back(std::move(node));
        return static_cast<int>(document_["nodes"].size()) - 1;
    }

    int add_material(const AnimatedBody& body, int index) {
        const render::Look look = render::look_of(body.kind, body.appearance, index);
        json material = {{"name", body.name},
                         {"pbrMetallicRoughness",
                          {{"baseColorFactor", {look.colour[0], look.colour[1], look.colour[2], 1.0}},
                           {"metallicFactor", 0.0},
                           {"roughnessFactor", 0.85 - 0.6 * static_cast<double>(look.gloss)}}}};
        // A sheet has two sides that are seen; closed bodies have one.
        if (!solver::is_closed(body.triangles)) material["doubleSided"] = true;
        document_["materials"].push_back(std::move(material));
        return static_cast<int>(document_["materials"].size()) - 1;
    }

    /// Metres, relative to `pivot` (scene units).
    Points metres(const Points& points, const Vec3& pivot = Vec3::Zero()) const {
        Points out;
        out.reserve(points.size());
        for (const Vec3& p : points) out.push_back((p - pivot) / in_.units_per_metre);
        return out;
    }

    int add_body(const AnimatedBody& body, int index) {
        const auto rigid = find_rigid_motion(body.poses);
        const render::ShadingMesh shading = render::split_creases(*body.poses.front(), body.triangles);
        const Vec3 pivot = rigid ? rigid->pivot : Vec3::Zero();
        const Points points = metres(shading.gather(*body.poses.front()), pivot);
        const std::vector<float> base = flat(points), base_normals = flat(unit_normals(points, shading.triangles));

        std::vector<std::uint32_t> indices;
        for (const solver::Triangle& t : shading.triangles)
            for (const int v : t) indices.push_back(static_cast<std::uint32_t>(v));
        json primitive = {
            {"attributes",
             {{"POSITION", buffer_.add_floats(base, 3, true)}, {"NORMAL", buffer_.add_floats(base_normals, 3, false)}}},
            {"indices", buffer_.add_indices(indices)},
            {"material", add_material(body, index)}};
        json mesh = {{"name", body.name}};
        if (!rigid) {
            json names = json::array();
            for (std::size_t f = 1; f < body.poses.size(); ++f) {
                const Points pose = metres(shading.gather(*body.poses[f]));
                primitive["targets"].push_back(
                    {{"POSITION", buffer_.add_floats(difference(flat(pose), base), 3, true)},
                     {"NORMAL", buffer_.add_floats(
                                    difference(flat(unit_normals(pose, shading.triangles)), base_normals), 3, false)}});
                names.push_back("frame " + std::to_string(in_.frames[f]));
            }
            mesh["weights"] = std::vector<double>(body.poses.size() - 1, 0.0);
            mesh["extras"] = {{"targetNames", names}}; // where viewers and Blender look for them
        }
        mesh["primitives"] = {primitive};
        document_["meshes"].push_back(mesh);

        json extras = {{"kind", render::word_of(body.kind)}};
        if (body.appearance.matter) extras["appearance"] = nodes::word_of(*body.appearance.matter);
        if (body.appearance.colour) extras["colour"] = render::hex_of(*body.appearance.colour);
        json node = {{"name", body.name}, {"mesh", document_["meshes"].size() - 1}, {"extras", std::move(extras)}};
        if (rigid) {
            const Vec3 at = rigid->pivot / in_.units_per_metre;
            node["translation"] = {at[0], at[1], at[2]};
        }
        const int number = add_node(std::move(node));
        if (rigid && rigid->moves) animate(number, *rigid);
        if (!rigid) animate_weights(number);
        return number;
    }

    int times() {
        if (times_accessor_ < 0) times_accessor_ = buffer_.add_floats(times_, 1, true, {});
        return times_accessor_;
    }

    int add_sampler(int output) {
        samplers_.push_back({{"input", times()}, {"output", output}, {"interpolation", "LINEAR"}});
        return static_cast<int>(samplers_.size()) - 1;
    }

    void add_channel(int sampler, int node, const char* path) {
        channels_.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
    }

    void animate(int node, const RigidMotion& motion) {
        std::vector<float> translations, rotations;
        for (const RigidPose& pose : motion.poses) {
            for (int k = 0; k < 3; ++k)
                translations.push_back(static_cast<float>(pose.translation[k] / in_.units_per_metre));
            for (int k = 0; k < 4; ++k) rotations.push_back(static_cast<float>(pose.rotation.coeffs()[k]));
        }
        add_channel(add_sampler(buffer_.add_floats(translations, 3, false, {})), node, "translation");
        add_channel(add_sampler(buffer_.add_floats(rotations, 4, false, {})), node, "rotation");
    }

    /// At frame f the weight of target f is 1 and all others are 0. One table serves every deforming body.
    void animate_weights(int node) {
        if (weights_sampler_ < 0) {
            const std::size_t frames = times_.size(), targets = frames - 1;
            std::vector<float> weights(frames * targets, 0.0f);
            for (std::size_t f = 1; f < frames; ++f) weights[f * targets + f - 1] = 1;
            weights_sampler_ = add_sampler(buffer_.add_floats(weights, 1, false, {}));
        }
        add_channel(weights_sampler_, node, "weights");
    }

    /// Header, JSON chunk padded with spaces, binary chunk padded with zeros.
    std::string container() const {
        std::string text = json_text(document_);
        text.append((4 - text.size() % 4) % 4, ' ');
        std::string out;
        const auto put = [&out](std::uint32_t v) { out.append(reinterpret_cast<const char*>(&v), 4); };
        const std::size_t binary = buffer_.bytes.empty() ? 0 : 8 + buffer_.bytes.size();
        if (20 + text.size() + binary > UINT32_MAX) {
            engine::Diagnostic d;
            d.code = "IO405";
            d.message = "the animation needs more than 4 GB, which a GLB file cannot hold";
            d.hint = "write fewer frames, or --format obj or ply";
            throw engine::Failure(d);
        }
        put(0x46546C67); // "glTF"
        put(2);
        put(static_cast<std::uint32_t>(12 + 8 + text.size() + binary));
        put(static_cast<std::uint32_t>(text.size()));
        put(0x4E4F534A); // "JSON"
        out += text;
        if (binary) {
            put(static_cast<std::uint32_t>(buffer_.bytes.size()));
            put(0x004E4942); // "BIN"
            out += buffer_.bytes;
        }
        return out;
    }

    const Animation& in_;
    json document_ = json::object(), channels_ = json::array(), samplers_ = json::array();
    Buffer buffer_;
    std::vector<float> times_;
    int times_accessor_ = -1, weights_sampler_ = -1;
};

} // namespace

std::string encode_glb(const Animation& animation) { return Writer(animation).encode(); }

} // namespace sinew::cli
