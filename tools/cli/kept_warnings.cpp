// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/kept_warnings.h"

#include "engine/byte_stream.h"
#include "engine/format/graph_file.h"
#include "tools/live/watched_files.h"

#include <array>

namespace sinew::cli {

using engine::Diagnostic;

namespace {

constexpr std::string_view ending = ".warnings";

std::array<std::string Diagnostic::*, 5> texts() {
    return {&Diagnostic::code, &Diagnostic::node, &Diagnostic::attribute, &Diagnostic::message, &Diagnostic::hint};
}

} // namespace

KeptWarnings::KeptWarnings(const engine::StorePolicy& policy, const engine::Graph& graph,
                           const std::vector<std::string>& nodes)
    : graph_(graph) {
    if (!policy.keeps_frames || policy.disk_folder.empty()) return;
    disk_.emplace(policy.disk_folder, std::string(ending), policy.files);
    // The graph as it was read, with what the command line sets.
    engine::Hasher asked;
    asked.add("sinew warnings").add(policy.build).add(engine::write_graph(graph));
    for (const std::string& name : nodes) asked.add(name);
    asked_ = asked.finish();
    key_ = key_now();
}

/// Files by name, time of change and size: reading them all would take longer than the frames do.
engine::Digest KeptWarnings::key_now() const {
    engine::Hasher key;
    key.add(asked_);
    for (const std::string& file : live::files_of(graph_)) {
        key.add(file);
        if (const auto stamp = live::stamp_of(file))
            key.add(stamp->seconds).add(stamp->nanoseconds).add(stamp->size).add(stamp->inode);
    }
    return key.finish();
}

std::optional<std::vector<Diagnostic>> KeptWarnings::read() const {
    const auto found = disk_ ? disk_->read(key_) : engine::DiskStore::Found();
    if (!found.payload) return {};
    try {
        engine::ByteReader in(*found.payload);
        std::vector<Diagnostic> out;
        const auto count = in.get<std::uint64_t>();
        for (std::uint64_t i = 0; i < count; ++i) {
            Diagnostic& d = out.emplace_back();
            d.severity = engine::Severity::warning;
            for (const auto text : texts()) d.*text = in.get_text();
            if (in.get<bool>()) d.frame = in.get<double>();
            d.spot = graph_.spot(d.node, d.attribute);
            if (!d.spot) d.spot = graph_.spot(d.node);
        }
        disk_->touch(key_);
        return out;
    } catch (const engine::BadBytes&) {
        return {};
    }
}

void KeptWarnings::keep(const std::vector<Diagnostic>& all) const {
    if (!disk_ || key_now() != key_) return;
    std::vector<Diagnostic> warnings = all;
    std::erase_if(warnings, [](const Diagnostic& d) { return d.code == "IO406" || d.code == "IO407"; });
    engine::ByteWriter out;
    out.put<std::uint64_t>(warnings.size());
    for (const Diagnostic& d : warnings) {
        for (const auto text : texts()) out.put_text(d.*text);
        out.put(d.frame.has_value());
        if (d.frame) out.put<double>(*d.frame);
    }
    try {
        disk_->write(key_, out.bytes, false);
    } catch (const engine::Failure&) { // told where the first frame cannot be kept either
    }
}

} // namespace sinew::cli
