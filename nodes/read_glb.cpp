// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/read_glb.h"

#include "nodes/glb_file.h"
#include "nodes/json_file.h"
#include "solver/error.h"
#include "solver/mesh/corner_welder.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

namespace sinew::nodes {

namespace {

using Json = nlohmann::json;
using solver::Error;
using Motion = Eigen::Matrix4d;

/// Numbers may be used again and again, by any number of primitives: so what is done is limited, not what there is.
constexpr std::size_t most_triangles = 20'000'000, most_corners = 3 * most_triangles, most_depth = 1000;

class GlbReader {
  public:
    explicit GlbReader(std::string_view bytes)
        : glb_(bytes)
        , document_(glb_.document()) {}

    solver::SurfaceMesh read() {
        for (const Json& name : document_.value("extensionsRequired", Json::array()))
            if (name.get<std::string>().find("compression") != std::string::npos || name == "KHR_mesh_quantization")
                throw Error("IO404", "it is packed by " + name.get<std::string>(), "save it unpacked");
        const Json& scenes = document_.value("scenes", Json::array());
        if (scenes.empty()) fail("it has no scene");
        seen_.assign(document_.value("nodes", Json::array()).size(), 0);
        const Json& scene = scenes.at(whole(document_, "scene", 0));
        for (const Json& node : scene.value("nodes", Json::array()))
            visit(whole(node, "a node of the scene"), Motion::Identity(), 0);
        return solver::SurfaceMesh::from_triangles(std::move(welder_.points), std::move(triangles_));
    }

  private:
    [[noreturn]] static void fail(const std::string& why) { throw Error("IO403", why); }

    template <std::size_t N>
    static std::array<double, N> numbers(const Json& node, const char* key, std::array<double, N> otherwise) {
        return node.contains(key) ? node.at(key).get<std::array<double, N>>() : otherwise;
    }

    static Motion motion_of(const Json& node) {
        if (node.contains("matrix"))
            return Motion(numbers<16>(node, "matrix", {}).data()); // columns, as Eigen has them
        const auto t = numbers<3>(node, "translation", {0, 0, 0}), s = numbers<3>(node, "scale", {1, 1, 1});
        const auto q = numbers<4>(node, "rotation", {0, 0, 0, 1});
        Eigen::Affine3d out = Eigen::Translation3d(t[0], t[1], t[2]) * Eigen::Quaterniond(q[3], q[0], q[1], q[2]) *
                              Eigen::Scaling(s[0], s[1], s[2]);
        return out.matrix();
    }

    void visit(std::size_t index, const Motion& above, std::size_t depth) {
        const Json& node = document_.at("nodes").at(index);
        if (seen_.at(index)++) fail("its nodes are no tree");
        if (depth > most_depth) fail("its nodes lie more than " + std::to_string(most_depth) + " deep in one another");
        const Motion here = above * motion_of(node);
        if (node.contains("mesh")) {
            const Json& mesh = document_.at("meshes").at(whole(node.at("mesh"), "mesh"));
            for (const Json& primitive : mesh.at("primitives"))
                take(primitive, node.contains("skin") ? Motion(Motion::Identity()) : here);
        }
        for (const Json& child : node.value("children", Json::array()))
            visit(whole(child, "a child of a node"), here, depth + 1);
    }

    void take_on(std::size_t count) {
        if (count > most_corners - corners_)
            throw Error("FE232", "it has more than " + std::to_string(most_corners) + " vertices and corners",
                        "save less of it");
        corners_ += count;
    }

    std::vector<int> vertices(std::size_t accessor, const Motion& motion) {
        const GlbNumbers p = glb_.numbers(accessor, "VEC3", 3);
        if (p.component != 5126) fail("positions are not of single precision");
        take_on(p.count);
        std::vector<int> out;
        for (std::size_t i = 0; i < p.count; ++i) {
            float v[3];
            std::memcpy(v, p.first + i * p.stride, sizeof v);
            const Eigen::Vector4d at = motion * Eigen::Vector4d(v[0], v[1], v[2], 1);
            if (!at.allFinite())
                throw Error("FE202", "vertex " + std::to_string(i) + " of accessor " + std::to_string(accessor) +
                                         " is not finite");
            out.push_back(welder_.add(at.head<3>()));
        }
        return out;
    }

    std::vector<std::size_t> corners(const Json& primitive, std::size_t vertex_count) {
        std::vector<std::size_t> out;
        if (!primitive.contains("indices")) {
            for (std::size_t i = 0; i < vertex_count; ++i) out.push_back(i);
            return out;
        }
        const GlbNumbers p = glb_.numbers(whole(primitive.at("indices"), "indices"), "SCALAR", 1);
        if (p.component != 5121 && p.component != 5123 && p.component != 5125) fail("indices are no whole numbers");
        take_on(p.count);
        for (std::size_t i = 0; i < p.count; ++i) {
            std::uint32_t v = 0;
            std::memcpy(&v, p.first + i * p.stride, p.size);
            if (v >= vertex_count)
                throw Error("FE203",
                            "a triangle uses vertex " + std::to_string(v) + " of " + std::to_string(vertex_count));
            out.push_back(v);
        }
        return out;
    }

    void take(const Json& primitive, const Motion& motion) {
        const std::size_t mode = whole(primitive, "mode", 4);
        if (mode < 4) return; // points and lines
        if (mode > 6) fail("a primitive has mode " + std::to_string(mode));
        const std::vector<int> v = vertices(whole(primitive.at("attributes").at("POSITION"), "POSITION"), motion);
        const std::vector<std::size_t> c = corners(primitive, v.size());
        const bool turned = motion.topLeftCorner<3, 3>().determinant() < 0; // mirrored: the other way round
        const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
            const solver::Triangle t{v[c[i]], v[c[turned ? k : j]], v[c[turned ? j : k]]};
            if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles_.push_back(t);
        };
        if (triangles_.size() + c.size() > most_triangles)
            throw Error("FE232", "it has more than " + std::to_string(most_triangles) + " triangles",
                        "save less of it");
        if (mode == 4)
            for (std::size_t i = 2; i < c.size(); i += 3) add(i - 2, i - 1, i);
        for (std::size_t i = 2; mode == 5 && i < c.size(); ++i) add(i - 2, i % 2 ? i : i - 1, i % 2 ? i - 1 : i);
        for (std::size_t i = 2; mode == 6 && i < c.size(); ++i) add(0, i - 1, i);
    }

    GlbFile glb_;
    const Json& document_;
    std::vector<char> seen_;
    solver::CornerWelder welder_;
    std::vector<solver::Triangle> triangles_;
    std::size_t corners_ = 0; ///< that were read, and vertices
};

} // namespace

solver::SurfaceMesh read_glb(std::string_view bytes, const std::string& file) {
    solver::SurfaceMesh mesh;
    try {
        mesh = GlbReader(bytes).read();
    } catch (const Error& e) {
        throw Error(e.code, file + ": " + e.what(), e.hint);
    } catch (const Json::exception& e) {
        throw Error("IO403", file + ": its description cannot be used: " + fault_of(e));
    }
    check_usable(mesh);
    return mesh;
}

} // namespace sinew::nodes
