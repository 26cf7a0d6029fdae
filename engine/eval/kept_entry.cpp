// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/kept_entry.h"

namespace sinew::engine {

namespace {

void put_inputs(const KeptInputs& inputs, ByteWriter& out) {
    out.bytes.reserve(4096);
    out.put_text(inputs.node);
    out.put<std::uint64_t>(inputs.contents.size());
    for (const auto& [plug, content] : inputs.contents) {
        out.put_text(plug);
        out.put(content);
    }
}

} // namespace

std::vector<std::byte> encode_entry(const Registry& registry, const NodeType& type, const Entry& entry,
                                    const KeptInputs& inputs) {
    ByteWriter out;
    put_inputs(inputs, out);
    for (std::size_t i = 0; i < type.outputs.size(); ++i) {
        const Codec& codec = *registry.find_codec(type.outputs[i].type);
        out.put_text(codec.type_name);
        out.put<std::int64_t>(codec.version);
        out.put(entry.outputs[i].digest());
        codec.write(entry.outputs[i], out);
    }
    out.put<std::uint64_t>(entry.warnings.size());
    for (const Diagnostic& d : entry.warnings) // places are those of the graph that reads it: see Session::note_reuse
        for (const std::string* text : {&d.code, &d.attribute, &d.message, &d.hint}) out.put_text(*text);
    return std::move(out.bytes);
}

namespace {

KeptInputs get_inputs(ByteReader& in) {
    KeptInputs out;
    out.node = in.get_text();
    const auto count = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
        std::string plug = in.get_text();
        out.contents.emplace_back(std::move(plug), in.get<Digest>());
    }
    return out;
}

} // namespace

KeptInputs decode_inputs(std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    return get_inputs(in);
}

Entry decode_entry(const Registry& registry, const NodeType& type, std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    get_inputs(in);
    Entry out;
    for (const AttributeInfo& info : type.outputs) {
        const Codec& codec = *registry.find_codec(info.type);
        if (in.get_text() != codec.type_name || in.get<std::int64_t>() != codec.version)
            throw BadBytes("its values are written in another way");
        const auto digest = in.get<Digest>();
        out.outputs.push_back(codec.read(in, nullptr));
        if (out.outputs.back().digest() != digest) throw BadBytes("what it gives is not what was kept");
    }
    const auto warnings = in.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < warnings; ++i) {
        Diagnostic d;
        d.severity = Severity::warning;
        for (std::string* text : {&d.code, &d.attribute, &d.message, &d.hint}) *text = in.get_text();
        out.warnings.push_back(std::move(d));
    }
    if (!in.rest.empty()) throw BadBytes("it holds more than the outputs");
    return out;
}

} // namespace sinew::engine
