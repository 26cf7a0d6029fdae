// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/run_output.h"

#include <chrono>

#include "tools/cli/atomic_file.h"

#include <algorithm>

namespace sinew::cli {

namespace fs = std::filesystem;

RunOutput::RunOutput(fs::path folder, std::set<std::string> formats, std::string title, double fps, SceneAxes axes)
    : folder_(std::move(folder))
    , formats_(std::move(formats))
    , title_(std::move(title))
    , axes_(axes)
    , started_(fs::file_time_type::clock::now() - std::chrono::seconds(1)) { // file systems round times
    animation_.fps = fps;
    animation_.units_per_metre = axes.units_per_metre;
    animation_.up = axes.up;
}

void RunOutput::note(const fs::path& path) {
    if (std::find(written_.begin(), written_.end(), path) == written_.end()) written_.push_back(path);
}

void RunOutput::add(const engine::Graph& graph, const engine::Plug& plug, int frame, const engine::Value& value) {
    if (pending_.valid()) pending_.get();
    if (value.is<nodes::FileContent>()) {
        const auto& file = value.as<nodes::FileContent>();
        const std::string name = body_labels(graph, plug, 1).front().name;
        write_file(folder_ / frame_file_name(name, frame, file.ending), file.bytes);
        note(folder_ / (name + ".*." + file.ending));
        return;
    }
    const std::vector<nodes::Mesh> meshes = meshes_in(value);
    if (meshes.empty()) return;
    const std::vector<BodyLabel> labels = body_labels(graph, plug, meshes.size());
    std::vector<std::string> sequences;
    for (const std::string format : {"obj", "ply"})
        if (formats_.contains(format)) {
            sequences.push_back(format);
            note(folder_ / format);
        }
    if (!sequences.empty())
        pending_ = std::async(std::launch::async, [this, sequences, labels, meshes, frame] {
            for (const std::string& format : sequences)
                for (std::size_t i = 0; i < meshes.size(); ++i)
                    write_body(folder_, format, labels[i], meshes[i], frame, axes_);
        });
    if (formats_.contains("glb")) keep_for_glb(labels, meshes, frame);
}

void RunOutput::keep_for_glb(const std::vector<BodyLabel>& labels, const std::vector<nodes::Mesh>& meshes, int frame) {
    if (animation_.frames.empty() || animation_.frames.back() != frame) animation_.frames.push_back(frame);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const auto [it, is_new] = animated_.emplace(labels[i].name, animation_.bodies.size());
        if (is_new) {
            animation_.bodies.push_back(
                {labels[i].name, labels[i].kind, meshes[i].topology->triangles, {}, labels[i].appearance});
            topologies_.push_back(meshes[i].topology);
        } else if (topologies_[it->second]->digest != meshes[i].topology->digest) {
            engine::Diagnostic d;
            d.code = "FE211";
            d.frame = frame;
            d.message = labels[i].name + " changes its topology, which a GLB animation cannot hold";
            d.hint = "write --format obj or ply";
            throw engine::Failure(d);
        }
        animation_.bodies[it->second].poses.push_back(meshes[i].points);
    }
}

std::size_t RunOutput::older_files() const {
    std::size_t count = 0;
    std::error_code error;
    for (const std::string& format : formats_)
        for (const auto& entry : fs::directory_iterator(folder_ / format, error))
            if (entry.is_regular_file(error) && entry.last_write_time(error) < started_) ++count;
    return count;
}

void RunOutput::finish() {
    if (pending_.valid()) pending_.get();
    if (animation_.frames.empty()) return;
    // A run that broke off between two pulls of one frame: that frame is not whole and stays out.
    std::size_t whole = animation_.frames.size();
    for (const AnimatedBody& body : animation_.bodies) whole = std::min(whole, body.poses.size());
    animation_.frames.resize(whole);
    for (AnimatedBody& body : animation_.bodies) body.poses.resize(whole);
    if (whole == 0) return;
    const fs::path file = folder_ / (title_ + ".glb");
    write_file(file, encode_glb(animation_));
    note(file);
}

} // namespace sinew::cli
