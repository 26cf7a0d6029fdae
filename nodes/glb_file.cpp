// SPDX-License-Identifier: GPL-3.0-or-later
#include "nodes/glb_file.h"

#include "nodes/json_file.h"
#include "solver/error.h"

#include <cmath>
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

std::size_t whole(const nlohmann::json& number, std::string_view name) {
    // 3.0 is as good as 3.
    if (const double* v = number.get_ptr<const double*>(); v && *v >= 0 && *v < 9e15 && *v == std::floor(*v))
        return static_cast<std::size_t>(*v);
    if (!number.is_number_unsigned()) {
        const std::string found = number.is_primitive() ? number.dump(-1, ' ', true).substr(0, 40) : number.type_name();
        fail(std::string(name) + " is no whole number from 0 on: " + found);
    }
    return number.get<std::size_t>();
}

std::size_t whole(const nlohmann::json& object, const char* key, std::size_t otherwise) {
    const auto found = object.find(key);
    return found == object.end() ? otherwise : whole(*found, key);
}

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
    if (a.contains("sparse")) throw Error("IO404", name + " is sparse", "save it without");
    if (!a.contains("bufferView"))
        throw Error("IO404", name + " has no bufferView, so all its numbers are 0", "save it with its numbers");
    const nlohmann::json& view = document_.at("bufferViews").at(whole(a.at("bufferView"), "bufferView"));
    const auto buffer = whole(view.at("buffer"), "buffer");
    if (buffer != 0 || document_.at("buffers").at(0).contains("uri"))
        throw Error("IO404", "its numbers lie in another file", "save it as one .glb");
    GlbNumbers n{};
    n.component = whole(a.at("componentType"), "componentType");
    n.size = n.component == 5121 ? 1 : n.component == 5123 ? 2 : 4;
    n.count = whole(a.at("count"), "count");
    n.stride = whole(view, "byteStride", n.size * width);
    const auto start = whole(view, "byteOffset", 0), length = whole(view.at("byteLength"), "byteLength");
    const auto offset = whole(a, "byteOffset", 0);
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
