// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/glb_file.h"

#include "nodes/json_file.h"
#include "solver/error.h"

#include <cstdint>
#include <cstring>
#include <string>

namespace sinew::nodes {

namespace {

using solver::Error;

constexpr std::uint32_t magic = 0x46546C67, json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

[[noreturn]] void fail(const std::string& why) { throw Error("IO403", why); }

std::uint32_t word(std::string_view bytes, std::size_t at) {
    std::uint32_t v = 0;
    std::memcpy(&v, bytes.data() + at, 4);
    return v;
}

} // namespace

GlbFile::GlbFile(std::string_view bytes) {
    if (bytes.size() < 12 || word(bytes, 0) != magic) fail("the file does not begin with glTF");
    if (word(bytes, 4) != 2) fail("it is of version " + std::to_string(word(bytes, 4)) + "; version 2 can be read");
    std::string_view text;
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
        const std::size_t length = word(bytes, at);
        const std::uint32_t kind = word(bytes, at + 4);
        if (length > bytes.size() - at - 8) fail("it ends in the middle");
        if (kind == json_chunk && text.empty()) text = bytes.substr(at + 8, length);
        if (kind == binary_chunk && binary_.empty()) binary_ = bytes.substr(at + 8, length);
        at += 8 + length;
    }
    if (is_too_deep(text)) fail("its description has brackets in too many brackets");
    document_ = nlohmann::json::parse(text);
    if (!document_.is_object()) fail("it has no description");
}

GlbNumbers GlbFile::numbers(std::size_t accessor, std::string_view type, std::size_t width) const {
    const nlohmann::json& a = document_.at("accessors").at(accessor);
    const std::string name = "accessor " + std::to_string(accessor);
    if (a.contains("sparse") || !a.contains("bufferView")) throw Error("IO404", name + " is sparse", "save it without");
    const nlohmann::json& view = document_.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
    const auto buffer = view.at("buffer").get<std::size_t>();
    if (buffer != 0 || document_.at("buffers").at(0).contains("uri"))
        throw Error("IO404", "its numbers lie in another file", "save it as one .glb");
    GlbNumbers n{};
    n.component = a.at("componentType").get<std::size_t>();
    n.size = n.component == 5121 ? 1 : n.component == 5123 ? 2 : 4;
    n.count = a.at("count").get<std::size_t>();
    n.stride = view.value("byteStride", n.size * width);
    const auto start = view.value("byteOffset", std::size_t{0}), length = view.at("byteLength").get<std::size_t>();
    const auto offset = a.value("byteOffset", std::size_t{0});
    if (a.at("type") != type) fail(name + " is not of type " + std::string(type));
    const bool fits =
        start <= binary_.size() && length <= binary_.size() - start && offset <= length && n.stride >= n.size * width &&
        (n.count == 0 ||
         (length - offset >= n.size * width && n.count - 1 <= (length - offset - n.size * width) / n.stride));
    if (!fits) fail(name + " reaches beyond the file's numbers");
    n.first = binary_.data() + start + offset;
    return n;
}

} // namespace sinew::nodes
