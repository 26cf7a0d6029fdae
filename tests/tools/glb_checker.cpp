// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/glb_checker.h"

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

namespace sinew::test {

using nlohmann::json;

namespace {

std::uint32_t word_at(const std::string& file, std::size_t at) {
    if (at + 4 > file.size()) throw std::runtime_error("file ends in the middle of a header");
    std::uint32_t v;
    std::memcpy(&v, file.data() + at, 4);
    return v;
}

const std::map<std::string, int> widths{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};

} // namespace

Glb::Glb(const std::string& file) {
    if (word_at(file, 0) != 0x46546C67) throw std::runtime_error("no glTF magic");
    if (word_at(file, 4) != 2) throw std::runtime_error("version is not 2");
    if (word_at(file, 8) != file.size()) throw std::runtime_error("length in the header is not the file's");
    const std::size_t text = word_at(file, 12);
    if (word_at(file, 16) != 0x4E4F534A) throw std::runtime_error("first chunk is not JSON");
    if (text % 4) throw std::runtime_error("JSON chunk is not aligned");
    document = json::parse(file.substr(20, text));
    const std::size_t next = 20 + text;
    if (next == file.size()) return;
    const std::size_t size = word_at(file, next);
    if (word_at(file, next + 4) != 0x004E4942) throw std::runtime_error("second chunk is not BIN");
    if (next + 8 + size != file.size() || size % 4) throw std::runtime_error("BIN chunk has the wrong length");
    binary = file.substr(next + 8);
}

template <class T>
std::vector<T> Glb::numbers(int accessor) const {
    const json& a = document.at("accessors").at(static_cast<std::size_t>(accessor));
    const json& view = document.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
    std::vector<T> out(a.at("count").get<std::size_t>() * static_cast<std::size_t>(widths.at(a.at("type"))));
    if (out.size() * sizeof(T) > view.at("byteLength").get<std::size_t>())
        throw std::runtime_error("accessor leaves its view");
    std::memcpy(out.data(), binary.data() + view.at("byteOffset").get<std::size_t>(), out.size() * sizeof(T));
    return out;
}

std::vector<float> Glb::floats(int accessor) const { return numbers<float>(accessor); }
std::vector<std::uint32_t> Glb::indices(int accessor) const { return numbers<std::uint32_t>(accessor); }

std::vector<std::string> Glb::problems() const {
    std::vector<std::string> out;
    const auto expect = [&out](bool right, const std::string& what) {
        if (!right) out.push_back(what);
    };
    if (document.at("asset").at("version") != "2.0") out.push_back("asset version");
    if (!binary.empty()) expect(document.at("buffers").at(0).at("byteLength") == binary.size(), "buffer length");
    for (const json& view : document.value("bufferViews", json::array())) {
        const std::size_t offset = view.at("byteOffset"), length = view.at("byteLength");
        expect(offset % 4 == 0 && length > 0 && offset + length <= binary.size(), "view outside the buffer");
    }
    const json accessors = document.value("accessors", json::array());
    const auto count = [&](const json& index) {
        return accessors.at(index.get<std::size_t>()).at("count").get<std::size_t>();
    };
    for (int i = 0; i < static_cast<int>(accessors.size()); ++i) {
        const json& a = accessors[static_cast<std::size_t>(i)];
        expect(a.at("count") > 0, "empty accessor");
        if (a.at("componentType") != 5126) continue;
        const std::size_t width = static_cast<std::size_t>(widths.at(a.at("type")));
        const std::vector<float> values = floats(i);
        for (std::size_t k = 0; k < values.size(); ++k) {
            expect(std::isfinite(values[k]), "number that is not finite");
            if (!a.contains("min")) continue;
            expect(a.at("min").at(k % width).get<float>() <= values[k] &&
                       values[k] <= a.at("max").at(k % width).get<float>(),
                   "value outside min and max");
        }
        for (std::size_t k = 0; a.contains("min") && k < width; ++k) {
            float low = INFINITY, high = -INFINITY;
            for (std::size_t e = k; e < values.size(); e += width)
                low = std::min(low, values[e]), high = std::max(high, values[e]);
            expect(a.at("min").at(k).get<double>() == static_cast<double>(low) &&
                       a.at("max").at(k).get<double>() == static_cast<double>(high),
                   "min or max is not exact");
        }
    }
    for (const json& mesh : document.value("meshes", json::array()))
        for (const json& primitive : mesh.at("primitives")) {
            const json& attributes = primitive.at("attributes");
            const std::size_t vertices = count(attributes.at("POSITION"));
            expect(count(attributes.at("NORMAL")) == vertices, "normals do not match positions");
            expect(accessors.at(attributes.at("POSITION").get<std::size_t>()).contains("min"),
                   "positions without bounds");
            for (const std::uint32_t index : indices(primitive.at("indices")))
                expect(index < vertices, "index out of range");
            expect(count(primitive.at("indices")) % 3 == 0, "indices are no triangles");
            expect(primitive.at("material").get<std::size_t>() < document.at("materials").size(), "no such material");
            const std::vector<float> normals = floats(attributes.at("NORMAL"));
            for (std::size_t v = 0; v < vertices; ++v)
                expect(std::abs(std::hypot(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]) - 1) < 1e-5,
                       "normal is not a unit vector");
            const json targets = primitive.value("targets", json::array());
            expect(targets.size() == mesh.value("weights", json::array()).size(), "weights do not match targets");
            for (const json& target : targets) {
                expect(count(target.at("POSITION")) == vertices && count(target.at("NORMAL")) == vertices,
                       "target size");
                expect(accessors.at(target.at("POSITION").get<std::size_t>()).contains("min"), "target without bounds");
            }
        }
    for (const json& animation : document.value("animations", json::array()))
        for (const json& channel : animation.at("channels")) {
            const json& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
            const json& node = document.at("nodes").at(channel.at("target").at("node").get<std::size_t>());
            std::size_t per_key = 1;
            if (channel.at("target").at("path") == "weights")
                per_key = document.at("meshes").at(node.at("mesh").get<std::size_t>()).at("weights").size();
            expect(count(sampler.at("output")) == per_key * count(sampler.at("input")), "sampler lengths");
            const std::vector<float> times = floats(sampler.at("input"));
            for (std::size_t k = 1; k < times.size(); ++k) expect(times[k - 1] < times[k], "times do not rise");
            expect(accessors.at(sampler.at("input").get<std::size_t>()).contains("max"), "times without bounds");
            if (channel.at("target").at("path") == "rotation") {
                const std::vector<float> q = floats(sampler.at("output"));
                for (std::size_t k = 0; k + 3 < q.size(); k += 4)
                    expect(std::abs(q[k] * q[k] + q[k + 1] * q[k + 1] + q[k + 2] * q[k + 2] + q[k + 3] * q[k + 3] - 1) <
                               1e-5,
                           "rotation is not a unit quaternion");
            }
        }
    return out;
}

} // namespace sinew::test
