// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/glb_writer.h"

#include "engine/diagnostics.h"
#include "solver/mesh/surface_mesh.h"
#include "tools/cli/json_text.h"

#include <bit>
#include <cstdint>
#include <numbers>

namespace sinew::cli {

using nlohmann::json;
using solver::Vec3;

namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

// Numbers of the glTF 2.0 specification.
constexpr int type_float = 5126, type_unsigned = 5125, target_vertices = 34962, target_indices = 34963;

/// What an accessor holds; each has a buffer view of its own.
enum class Part {
    positions,
    normals,
    indices,
    target_positions,
    target_normals,
    times,
    weights,
    translations,
    rotations
};

/// Accessors that follow each other: one, or those of the first pose of a body, or two a later pose.
enum class Group { base, targets, times, weights, translations, rotations };

struct Block {
    Part part;
    const GlbBody* body;
    std::size_t pose;
};

/// `values`: floats, the rows of a table, or triangles. Everything is four bytes wide and stays aligned to that.
template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

json material_of(const GlbBody& body, int index) {
    const render::Look look = render::look_of(body.kind(), body.appearance(), index);
    json material = {{"name", body.name()},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {look.colour[0], look.colour[1], look.colour[2], 1.0}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 0.85 - 0.6 * static_cast<double>(look.gloss)}}}};
    // A sheet has two sides that are seen; closed bodies have one.
    if (!solver::is_closed(body.triangles())) material["doubleSided"] = true;
    return material;
}

/// Writes "[a,b,c]" piece by piece.
template <class Sink>
class List {
  public:
    explicit List(Sink& sink)
        : sink_(sink) {
        sink_("[");
    }
    void add(std::string_view text) {
        if (!is_first_) sink_(",");
        is_first_ = false;
        sink_(text);
    }
    void end() { sink_("]"); }

  private:
    Sink& sink_;
    bool is_first_ = true;
};

class Writer {
  public:
    Writer(const GlbScene& scene, const std::vector<int>& frames, const std::deque<GlbBody>& bodies,
           const SpillFile& spill)
        : scene_(scene)
        , frames_(frames)
        , spill_(spill) {
        json children = json::array();
        for (std::size_t b = 0; b < bodies.size(); ++b)
            if (!bodies[b].triangles().empty()) children.push_back(add_body(bodies[b], static_cast<int>(b)));
        if (scene_.up == 'z' && !children.empty()) { // one node that turns the scene upright
            const double half = std::numbers::sqrt2 / 2;
            nodes_.push_back({{"name", "z up"}, {"rotation", {-half, 0, 0, half}}, {"children", children}});
            children = {nodes_.size() - 1};
        }
        children_ = std::move(children);
    }

    void write(engine::AtomicFile& out) const {
        std::uint64_t text_size = 0, binary_size = 0;
        write_text([&](std::string_view text) { text_size += text.size(); });
        for_blocks([&](const Block& block) { binary_size += size_of(block); });
        const std::size_t padding = (4 - text_size % 4) % 4; // text with spaces; the binary part needs none
        const std::uint64_t size = 20 + text_size + padding + (binary_size ? 8 + binary_size : 0);
        if (size > UINT32_MAX) refuse();
        const auto put = [&](std::uint64_t v) {
            const auto word = static_cast<std::uint32_t>(v);
            out.write({reinterpret_cast<const char*>(&word), 4});
        };
        put(0x46546C67); // "glTF"
        put(2);
        put(size);
        put(text_size + padding);
        put(0x4E4F534A); // "JSON"
        write_text([&](std::string_view text) { out.write(text); });
        out.write(std::string(padding, ' '));
        if (!binary_size) return;
        put(binary_size);
        put(0x004E4942); // "BIN"
        for_blocks([&](const Block& block) { write_block(block, out); });
    }

  private:
    struct Shown {
        const GlbBody* body;
        std::size_t first_accessor;
        bool is_rigid;
    };

    static void refuse() {
        engine::Diagnostic d;
        d.code = "IO405";
        d.message = "the animation needs more than 4 GB, which a GLB file cannot hold";
        d.hint = "write fewer frames, or --format obj or ply";
        throw engine::Failure(d);
    }

    std::size_t add_group(Group group, const GlbBody* body, std::size_t accessors) {
        groups_.emplace_back(group, body);
        accessors_ += accessors;
        return accessors_ - accessors;
    }

    std::size_t add_body(const GlbBody& body, int index) {
        const bool rigid = body.is_rigid(frames_.size());
        shown_.push_back({&body, add_group(Group::base, &body, 3), rigid});
        materials_.push_back(material_of(body, index));
        if (!rigid) add_group(Group::targets, &body, 2 * (frames_.size() - 1));
        json extras = {{"kind", render::word_of(body.kind())}};
        if (body.appearance().matter) extras["appearance"] = nodes::word_of(*body.appearance().matter);
        if (body.appearance().colour) extras["colour"] = render::hex_of(*body.appearance().colour);
        json node = {{"name", body.name()}, {"mesh", shown_.size() - 1}, {"extras", std::move(extras)}};
        if (rigid) {
            const Vec3 at = body.pivot(frames_.size()) / scene_.units_per_metre;
            node["translation"] = {at[0], at[1], at[2]};
        }
        const std::size_t number = nodes_.size();
        nodes_.push_back(std::move(node));
        if (!rigid) {
            // At frame f the weight of target f is 1 and all others are 0. One table serves every deforming body.
            if (!weights_sampler_) weights_sampler_ = add_sampler(add_group(Group::weights, nullptr, 1));
            add_channel(*weights_sampler_, number, "weights");
        } else if (body.moves(frames_.size())) {
            add_channel(add_sampler(add_group(Group::translations, &body, 1)), number, "translation");
            add_channel(add_sampler(add_group(Group::rotations, &body, 1)), number, "rotation");
        }
        return number;
    }

    std::size_t add_sampler(std::size_t output) {
        if (!times_) times_ = add_group(Group::times, nullptr, 1);
        samplers_.push_back({{"input", *times_}, {"output", output}, {"interpolation", "LINEAR"}});
        return samplers_.size() - 1;
    }

    void add_channel(std::size_t sampler, std::size_t node, const char* path) {
        channels_.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
    }

    template <class Take>
    void for_blocks(Take take) const {
        for (const auto& [group, body] : groups_) {
            switch (group) {
            case Group::base:
                for (const Part part : {Part::positions, Part::normals, Part::indices}) take(Block{part, body, 0});
                break;
            case Group::targets:
                for (std::size_t pose = 1; pose < frames_.size(); ++pose)
                    for (const Part part : {Part::target_positions, Part::target_normals})
                        take(Block{part, body, pose});
                break;
            case Group::times:
                take(Block{Part::times, nullptr, 0});
                break;
            case Group::weights:
                take(Block{Part::weights, nullptr, 0});
                break;
            case Group::translations:
                take(Block{Part::translations, body, 0});
                break;
            case Group::rotations:
                take(Block{Part::rotations, body, 0});
                break;
            }
        }
    }

    /// Numbers an element.
    static std::size_t width_of(Part part) {
        switch (part) {
        case Part::indices:
        case Part::times:
        case Part::weights:
            return 1;
        case Part::rotations:
            return 4;
        default:
            return 3;
        }
    }

    std::uint64_t count_of(const Block& block) const {
        const std::uint64_t frames = frames_.size();
        switch (block.part) {
        case Part::indices:
            return 3 * block.body->shading().triangles.size();
        case Part::times:
        case Part::translations:
        case Part::rotations:
            return frames;
        case Part::weights:
            return frames * (frames - 1);
        default:
            return block.body->shading().source.size();
        }
    }

    std::uint64_t size_of(const Block& block) const { return 4 * width_of(block.part) * count_of(block); }

    json accessor_of(const Block& block, std::size_t number) const {
        constexpr const char* shapes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
        json out = {{"bufferView", number},
                    {"componentType", block.part == Part::indices ? type_unsigned : type_float},
                    {"count", count_of(block)},
                    {"type", shapes[width_of(block.part)]}};
        // The specification wants bounds for positions and times. As doubles: the shortest decimal of the float's
        // exact value, which a checker compares bit for bit.
        const auto put = [&](const FloatBounds& bounds, std::size_t width) {
            out["min"] = std::vector<double>(bounds.low.begin(), bounds.low.begin() + static_cast<long>(width));
            out["max"] = std::vector<double>(bounds.high.begin(), bounds.high.begin() + static_cast<long>(width));
        };
        if (block.part == Part::positions) put(block.body->base_bounds(frames_.size()), 3);
        if (block.part == Part::target_positions) put(block.body->target_bounds(block.pose), 3);
        if (block.part == Part::times) {
            FloatBounds bounds;
            for (const float t : times()) bounds.add(t, 0);
            put(bounds, 1);
        }
        return out;
    }

    static std::optional<int> target_of(Part part) {
        switch (part) {
        case Part::indices:
            return target_indices;
        case Part::positions:
        case Part::normals:
        case Part::target_positions:
        case Part::target_normals:
            return target_vertices;
        default:
            return {};
        }
    }

    /// The document, its keys in the order of the alphabet.
    template <class Sink>
    void write_text(Sink sink) const {
        sink("{");
        if (accessors_ > 0) {
            sink("\"accessors\":");
            List list(sink);
            std::size_t number = 0;
            for_blocks([&](const Block& block) { list.add(json_text(accessor_of(block, number++))); });
            list.end();
            sink(",");
        }
        if (!channels_.empty())
            sink("\"animations\":[" +
                 json_text(json({{"name", "run"}, {"channels", channels_}, {"samplers", samplers_}})) + "],");
        sink("\"asset\":" + json_text(json({{"version", "2.0"}, {"generator", "Sinew " SINEW_VERSION}})));
        if (accessors_ > 0) {
            sink(",\"bufferViews\":");
            List list(sink);
            std::uint64_t offset = 0;
            for_blocks([&](const Block& block) {
                json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size_of(block)}};
                if (const auto target = target_of(block.part)) view["target"] = *target;
                list.add(json_text(view));
                offset += size_of(block);
            });
            list.end();
            sink(",\"buffers\":[" + json_text(json({{"byteLength", offset}})) + "]");
        }
        if (!materials_.empty()) sink(",\"materials\":" + json_text(materials_));
        if (!shown_.empty()) {
            sink(",\"meshes\":");
            List list(sink);
            for (std::size_t i = 0; i < shown_.size(); ++i) {
                list.add("");
                write_mesh(shown_[i], i, sink);
            }
            list.end();
        }
        if (!nodes_.empty()) sink(",\"nodes\":" + json_text(nodes_));
        sink(",\"scene\":0,\"scenes\":[" + json_text(scene_text()) + "]}");
    }

    template <class Sink>
    void write_mesh(const Shown& s, std::size_t material, Sink& sink) const {
        const std::size_t poses = s.is_rigid ? 1 : frames_.size(), at = s.first_accessor;
        sink("{");
        if (!s.is_rigid) { // where viewers and Blender look for names
            sink("\"extras\":{\"targetNames\":");
            List names(sink);
            for (std::size_t f = 1; f < poses; ++f) names.add("\"frame " + std::to_string(frames_[f]) + "\"");
            names.end();
            sink("},");
        }
        sink("\"name\":" + json_text(json(s.body->name())) +
             ",\"primitives\":[{\"attributes\":" + json_text(json({{"POSITION", at}, {"NORMAL", at + 1}})) +
             ",\"indices\":" + std::to_string(at + 2) + ",\"material\":" + std::to_string(material));
        if (!s.is_rigid) {
            sink(",\"targets\":");
            List targets(sink);
            for (std::size_t f = 1; f < poses; ++f)
                targets.add("{\"NORMAL\":" + std::to_string(at + 2 * f + 2) +
                            ",\"POSITION\":" + std::to_string(at + 2 * f + 1) + "}");
            targets.end();
        }
        sink("}]");
        if (!s.is_rigid) {
            sink(",\"weights\":");
            List weights(sink);
            for (std::size_t f = 1; f < poses; ++f) weights.add("0.0");
            weights.end();
        }
        sink("}");
    }

    /// For reading the run back (tools/viewer/collect_glb.cpp).
    json scene_text() const {
        json out = {{"name", "sinew"},
                    {"extras",
                     {{"sinew",
                       {{"frames", frames_},
                        {"fps", scene_.fps},
                        {"units_per_metre", scene_.units_per_metre},
                        {"up", std::string(1, scene_.up)}}}}}};
        if (!children_.empty()) out["nodes"] = children_;
        return out;
    }

    std::vector<float> times() const {
        std::vector<float> out;
        for (const int frame : frames_) out.push_back(static_cast<float>((frame - frames_.front()) / scene_.fps));
        return out;
    }

    void write_block(const Block& block, engine::AtomicFile& out) const {
        const GlbBody* body = block.body;
        const std::size_t frames = frames_.size();
        switch (block.part) {
        case Part::positions:
            return out.write(bytes_of(body->base_positions(frames)));
        case Part::normals:
            return out.write(bytes_of(body->base_normals(frames)));
        case Part::indices:
            return out.write(bytes_of(body->shading().triangles));
        case Part::target_positions: {
            const GlbBody::Target target = body->target(block.pose, spill_);
            out.write(bytes_of(target.positions));
            return out.write(bytes_of(target.normals));
        }
        case Part::target_normals:
            return; // with the positions
        case Part::times:
            return out.write(bytes_of(times()));
        case Part::weights:
            for (std::size_t f = 0; f < frames; ++f) {
                std::vector<float> row(frames - 1, 0.0f);
                if (f > 0) row[f - 1] = 1;
                out.write(bytes_of(row));
            }
            return;
        case Part::translations:
        case Part::rotations: {
            std::vector<float> values;
            for (std::size_t f = 0; f < frames; ++f) {
                const RigidPose& pose = body->rigid_poses()[f];
                if (block.part == Part::translations)
                    for (int k = 0; k < 3; ++k)
                        values.push_back(static_cast<float>(pose.translation[k] / scene_.units_per_metre));
                else
                    for (int k = 0; k < 4; ++k) values.push_back(static_cast<float>(pose.rotation.coeffs()[k]));
            }
            return out.write(bytes_of(values));
        }
        }
    }

    const GlbScene& scene_;
    const std::vector<int>& frames_;
    const SpillFile& spill_;
    std::vector<Shown> shown_;
    std::vector<std::pair<Group, const GlbBody*>> groups_;
    std::size_t accessors_ = 0;
    std::optional<std::size_t> times_, weights_sampler_;
    json materials_ = json::array(), nodes_ = json::array(), children_, channels_ = json::array(),
         samplers_ = json::array();
};

} // namespace

void write_glb(const GlbScene& scene, const std::vector<int>& frames, const std::deque<GlbBody>& bodies,
               const SpillFile& spill, engine::AtomicFile& out) {
    Writer(scene, frames, bodies, spill).write(out);
}

} // namespace sinew::cli
