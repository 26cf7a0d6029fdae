// meshFile reads binary glTF: triangles, strips and fans, nodes that move them, seams that are closed again; and
// refuses what it cannot.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.h"
#include "nodes/read_glb.h"
#include "solver/error.h"

#include <cstring>
#include <nlohmann/json.hpp>

using namespace bench;
using nlohmann::json;

namespace {

std::string bytes_of(std::uint32_t v) {
    std::string out(4, '\0');
    std::memcpy(out.data(), &v, 4);
    return out;
}

std::string glb(const json& document, const std::string& binary) {
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto size = [](const std::string& s) { return static_cast<std::uint32_t>(s.size()); };
    std::string chunks = bytes_of(size(text));
    chunks.append("JSON").append(text).append(bytes_of(size(binary))).append("BIN\0", 4).append(binary);
    std::string out = "glTF";
    return out.append(bytes_of(2)).append(bytes_of(size(chunks) + 12)).append(chunks);
}

template <class T>
void put(std::string& out, std::initializer_list<T> values) {
    for (const T v : values) {
        char raw[sizeof v];
        std::memcpy(raw, &v, sizeof v);
        out.append(raw, sizeof v);
    }
}

/// A square of two triangles whose diagonal is split, as at a seam; a strip and a fan over its first four vertices.
struct Square {
    std::string binary;
    json document = json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                    {"bufferView": 1, "byteOffset": 12, "componentType": 5123, "count": 4, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 72},
                      {"buffer": 0, "byteOffset": 72, "byteLength": 20}],
      "buffers": [{"byteLength": 92}]})");
    Square() {
        put<float>(binary, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0});
        put<std::uint16_t>(binary, {0, 1, 2, 4, 5, 3});
        put<std::uint16_t>(binary, {0, 1, 3, 2});
    }
    std::string bytes() const { return glb(document, binary); }
    solver::SurfaceMesh read() const { return nodes::read_glb(bytes(), "a.glb"); }
    std::string refusal() const {
        try {
            read();
        } catch (const solver::Error& e) {
            return e.code + " " + e.what();
        }
        return "none";
    }
};

double area_z(const solver::SurfaceMesh& m) {
    double sum = 0;
    for (const solver::Triangle& t : m.triangles) {
        const auto at = [&](std::size_t k) { return m.points[static_cast<std::size_t>(t[k])]; };
        sum += (at(1) - at(0)).cross(at(2) - at(0)).z() / 2;
    }
    return sum;
}

using Triangles = std::vector<solver::Triangle>;

} // namespace

TEST_CASE("GLB: triangles with their seam closed and strips and fans", "[nodes]") {
    Square s;
    const solver::SurfaceMesh mesh = s.read();
    CHECK(mesh.points == solver::Points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}});
    s.document["meshes"][0]["primitives"][0] =
        json::parse(R"({"attributes": {"POSITION": 0}, "indices": 2, "mode": 5})");
    CHECK(s.read().triangles == Triangles{{0, 1, 3}, {1, 2, 3}});
    CHECK(area_z(s.read()) == 1);
    s.document["meshes"][0]["primitives"][0] =
        json::parse(R"({"attributes": {"POSITION": 0}, "indices": 1, "mode": 6})");
    CHECK(s.read().triangles == Triangles{{0, 1, 2}, {0, 2, 3}}); // those that the seam made empty are gone
    s.document["meshes"][0]["primitives"][0] = json::parse(R"({"attributes": {"POSITION": 0}})");
    CHECK(s.read().triangles == Triangles{{0, 1, 2}, {3, 0, 2}}); // as they stand
    s.document["meshes"][0]["primitives"][0]["mode"] = 1;
    CHECK(s.refusal().starts_with("FE201"));
}

TEST_CASE("GLB: nodes move their meshes and mirrors do not turn them inside out", "[nodes]") {
    Square s;
    s.document["nodes"] = json::parse(R"([
      {"children": [1, 2], "translation": [10, 0, 0]},
      {"mesh": 0, "rotation": [0, 0, 0.70710678118654752, 0.70710678118654752], "scale": [2, 1, 1]},
      {"mesh": 0, "matrix": [-1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 5, 1]}])");
    const solver::SurfaceMesh mesh = s.read();
    REQUIRE(mesh.points.size() == 8);
    // The corner (1, 0, 0): twice as far along x, a quarter turn, ten along; and mirrored, five up, ten along.
    CHECK((mesh.points[1] - solver::Vec3(10, 2, 0)).norm() < 1e-14);
    CHECK((mesh.points[5] - solver::Vec3(9, 0, 5)).norm() < 1e-14);
    CHECK(area_z(mesh) == Approx(2 + 1));
    s.document["nodes"][0]["children"] = {1, 1};
    CHECK(s.refusal() == "IO403 a.glb: its nodes are no tree");
    s.document["nodes"][1]["children"] = {0};
    CHECK(s.refusal() == "IO403 a.glb: its nodes are no tree");
    s.document["nodes"] = json::array({json{{"children", {1}}}});
    for (int n = 1; n < 1500; ++n) s.document["nodes"].push_back({{"children", {n + 1}}});
    s.document["nodes"].push_back({{"mesh", 0}});
    CHECK(s.refusal() == "IO403 a.glb: its nodes lie more than 1000 deep in one another");
}

TEST_CASE("GLB: what cannot be read is named", "[nodes]") {
    const auto with = [](const std::string& pointer, const json& value) {
        Square s;
        s.document[json::json_pointer(pointer)] = value;
        return s.refusal();
    };
    CHECK(with("/extensionsRequired", {"KHR_draco_mesh_compression"}) ==
          "IO404 a.glb: it is packed by KHR_draco_mesh_compression");
    CHECK(with("/accessors/0/sparse", json::object()) == "IO404 a.glb: accessor 0 is sparse");
    CHECK(with("/buffers/0/uri", "a.bin") == "IO404 a.glb: its numbers lie in another file");
    const std::string beyond = "IO403 a.glb: accessor 0 reaches beyond the file's numbers";
    CHECK(with("/accessors/0/count", 1000000000000000000) == beyond);
    CHECK(with("/accessors/0/count", 7) == beyond);
    CHECK(with("/accessors/0/byteOffset", 18446744073709551615u) == beyond);
    CHECK(with("/bufferViews/0/byteOffset", 1000) == beyond);
    CHECK(with("/bufferViews/0/byteStride", 4) == beyond);
    CHECK(with("/accessors/1/type", "VEC2") == "IO403 a.glb: accessor 1 is not of type SCALAR");
    CHECK(with("/accessors/0/count", 5) == "FE203 a.glb: a triangle uses vertex 5 of 5");
    CHECK(with("/accessors/0/count", "six") == "IO403 a.glb: count is no whole number from 0 on: \"six\"");
    CHECK(with("/accessors/0/count", 1.5) == "IO403 a.glb: count is no whole number from 0 on: 1.5");
    CHECK(with("/accessors/0/count", -1) == "IO403 a.glb: count is no whole number from 0 on: -1");
    CHECK(with("/accessors/0/count", 6.0) == "none"); // as spelt by some
    CHECK(with("/bufferViews/0/byteOffset", 1e300) == "IO403 a.glb: byteOffset is no whole number from 0 on: 1e+300");
    CHECK(with("/meshes/0/primitives/0/mode", json::array()) ==
          "IO403 a.glb: mode is no whole number from 0 on: array");
    CHECK(with("/nodes/0/mesh", 7).starts_with("IO403 a.glb: its description cannot be used"));
    const auto refusal = [](const std::string& bytes) {
        try {
            nodes::read_glb(bytes, "a.glb");
        } catch (const solver::Error& e) {
            return e.code + " " + e.what();
        }
        return std::string("none");
    };
    CHECK(refusal("v 0 0 0") == "IO403 a.glb: the file does not begin with glTF");
    CHECK(refusal("glTF" + bytes_of(1) + bytes_of(12)) == "IO403 a.glb: it is of version 1; version 2 can be read");
}

TEST_CASE("GLB: numbers that are used again and again are work, which has its limit", "[nodes]") {
    Square s;
    constexpr std::size_t count = 5'000'000;
    s.binary.append(count, '\0'); // one index a byte, all of the same vertex: no triangle comes of them
    s.document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 92}, {"byteLength", count}});
    s.document["accessors"].push_back(
        {{"bufferView", 2}, {"componentType", 5121}, {"count", count}, {"type", "SCALAR"}});
    const json primitive = {{"attributes", {{"POSITION", 0}}}, {"indices", 3}};
    for (int i = 0; i < 13; ++i) s.document["meshes"][0]["primitives"].push_back(primitive);
    CHECK(s.refusal() == "FE232 a.glb: it has more than 60000000 vertices and corners");
}

TEST_CASE("GLB: any file cut short or with a spoilt byte is read or refused", "[nodes]") {
    const std::string sound = Square().bytes();
    int refused = 0;
    const auto attempt = [&](const std::string& bytes) {
        try {
            nodes::read_glb(bytes, "a.glb");
        } catch (const solver::Error& e) {
            ++refused;
            CHECK(std::string(e.what()).size() > 3);
        }
    };
    for (std::size_t size = 0; size < sound.size(); ++size) attempt(sound.substr(0, size));
    CHECK(refused == static_cast<int>(sound.size()));
    for (std::size_t i = 0; i < sound.size(); ++i)
        for (const char c : {'\0', '\xFF', '9', '"'}) {
            std::string spoilt = sound;
            spoilt[i] = c;
            attempt(spoilt);
        }
}

TEST_CASE("meshFile takes GLB", "[nodes]") {
    const Folder folder;
    const std::string file = folder.write("a.GLB", Square().bytes());
    Session s(R"("m": {"type": "meshFile", "inputs": {"file": ")" + file + "\"}}");
    CHECK(s.get<nodes::Mesh>("m", "outMesh").points->size() == 4);
    const std::string other = folder.write("a.fbx", "Kaydara");
    std::string text;
    CHECK(codes(R"("m": {"type": "meshFile", "inputs": {"file": ")" + other + "\"}}", "m", "outMesh", &text) ==
          Codes{"IO404"});
    CHECK(text.find(".glb") != std::string::npos);
}
