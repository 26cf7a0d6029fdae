// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/run_output.h"

#include "tools/cli/atomic_file.h"
#include "tools/cli/names_apart.h"
#include "tools/viewer/recorder.h"

#include <algorithm>
#include <chrono>
#include <exception>

namespace sinew::cli {

namespace fs = std::filesystem;

RunOutput::RunOutput(fs::path folder, std::set<std::string> formats, std::string title, double fps, SceneAxes axes,
                     std::size_t frame_count, std::string run, engine::FileAccess files)
    : folder_(std::move(folder))
    , formats_(std::move(formats))
    , axes_(axes)
    , frame_count_(frame_count)
    , run_(std::move(run))
    , files_(std::move(files))
    , glb_path_(folder_ / (title + ".glb"))
    , glb_(glb_path_, {fps, axes.units_per_metre, axes.up}, files_)
    , started_(fs::file_time_type::clock::now() - std::chrono::seconds(1)) {} // file systems round times

void RunOutput::note(const fs::path& path) {
    if (std::find(written_.begin(), written_.end(), path) == written_.end()) written_.push_back(path);
}

/// Outputs of two nodes may hold bodies of one name, as where two solvers simulate the same.
std::vector<BodyLabel> RunOutput::labels(const engine::Graph& graph, const engine::Plug& plug, std::size_t count) {
    std::vector<BodyLabel> out = body_labels(graph, plug, count);
    std::vector<std::string> names;
    for (const BodyLabel& label : out) names.push_back(label.name);
    tell_apart(names, plug.node, [&](std::string& name, std::size_t i) {
        name = file_name(name);
        const std::pair owner(plug, i);
        return owner_of_.try_emplace(name, owner).first->second == owner;
    });
    for (std::size_t i = 0; i < out.size(); ++i) out[i].name = names[i];
    return out;
}

void RunOutput::add(const engine::Graph& graph, const engine::Plug& plug, int frame, const engine::Value& value) {
    wait();
    if (value.is<nodes::FileContent>()) {
        const auto& file = value.as<nodes::FileContent>();
        const std::string name = labels(graph, plug, 1).front().name;
        write_file(folder_ / frame_file_name(name, frame, file.ending), file.bytes, files_);
        note(folder_ / (name + ".*." + file.ending));
        return;
    }
    const std::vector<nodes::Mesh> meshes = meshes_in(value);
    if (meshes.empty()) return;
    const std::vector<BodyLabel> named = labels(graph, plug, meshes.size());
    std::vector<std::string> sequences;
    for (const std::string format : {"obj", "ply"})
        if (formats_.contains(format)) {
            sequences.push_back(format);
            note(folder_ / format);
        }
    if (!sequences.empty()) {
        pending_frame_ = frame;
        pending_ = std::async(std::launch::async, [this, sequences, named, meshes, frame] {
            for (const std::string& format : sequences)
                for (std::size_t i = 0; i < meshes.size(); ++i)
                    write_body(folder_, format, named[i], meshes[i], frame, axes_, run_, files_);
        });
    }
    if (formats_.contains("glb")) add_to_glb(named, meshes, frame);
}

void RunOutput::expect(const engine::Graph& graph, const engine::Plug& plug, const engine::Value& value) {
    if (!formats_.contains("glb")) return;
    const std::vector<nodes::Mesh> meshes = meshes_in(value);
    const std::vector<BodyLabel> named = labels(graph, plug, meshes.size());
    for (std::size_t i = 0; i < meshes.size(); ++i)
        expected_.push_back(glb_cost(named[i].kind, *meshes[i].points, meshes[i].topology->triangles));
    check_glb_size(expected_, frame_count_);
}

void RunOutput::check_kept(const ReadFiles& read, const engine::Graph& graph, const engine::Plug& plug,
                           const engine::Value& value, const std::vector<int>& frames) {
    const auto check = [&](const fs::path& folder, const std::string& name, const std::string& ending) {
        if (!fs::is_directory(folder)) return;
        for (const int frame : frames) read.check_kept(folder / frame_file_name(name, frame, ending), "--out");
    };
    if (value.is<nodes::FileContent>())
        check(folder_, labels(graph, plug, 1).front().name, value.as<nodes::FileContent>().ending);
    const std::size_t count = meshes_in(value).size();
    if (count == 0) return;
    if (formats_.contains("glb")) read.check_kept(glb_path_, "--out");
    for (const std::string format : {"obj", "ply"})
        if (formats_.contains(format))
            for (const BodyLabel& label : labels(graph, plug, count)) check(folder_ / format, label.name, format);
}

void RunOutput::check_apart(const fs::path& file, std::string_view flag, bool with_page) const {
    if (folder_.empty()) return;
    std::error_code error;
    const auto place = [&](fs::path p) {
        // A link whose file is yet to be made leads there as well.
        for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(p, error)); ++links) {
            const fs::path to = fs::read_symlink(p, error);
            p = to.is_absolute() ? to : p.parent_path() / to;
        }
        return fs::weakly_canonical(fs::absolute(p, error), error);
    };
    const fs::path wanted = place(file), folder = place(folder_);
    if (wanted.empty()) return;
    const auto is_of_frame = [&] { // NAME.0001.obj, unfinished.0001.json
        const std::string ending = wanted.extension().string();
        return !ending.empty() && parse_frame_file(wanted, ending.substr(1)).has_value();
    };
    std::string other;
    if (wanted == folder) other = "the folder of --out";
    if (formats_.contains("glb") && wanted == place(glb_path_)) other = "the animation of --out";
    if (with_page && wanted == folder / "view.html") other = "the page of --open";
    for (const fs::path& in : {folder, folder / "obj", folder / "ply"})
        if (wanted.parent_path() == in && is_of_frame()) other = "a file of --out";
    if (other.empty()) return;
    engine::Diagnostic d;
    d.code = "IO420";
    d.message = std::string(flag) + " and " + other + " would be one: '" + file.string() + "'";
    d.hint = "choose another place with " + std::string(flag);
    throw engine::Failure(d);
}

void RunOutput::add_to_glb(const std::vector<BodyLabel>& labels, const std::vector<nodes::Mesh>& meshes, int frame) {
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const auto [it, is_new] = animated_.emplace(labels[i].name, topologies_.size());
        if (is_new) {
            glb_.add_body(labels[i].name, labels[i].kind, meshes[i].topology->triangles, meshes[i].points,
                          labels[i].appearance);
            topologies_.push_back(meshes[i].topology);
        } else if (topologies_[it->second]->digest != meshes[i].topology->digest) {
            engine::Diagnostic d;
            d.code = "FE211";
            d.frame = frame;
            d.message = labels[i].name + " changes its topology, which a GLB animation cannot hold";
            d.hint = "write --format obj or ply";
            throw engine::Failure(d);
        }
        glb_.add_pose(it->second, frame, meshes[i].points);
    }
    // What was taken for rigid may turn out not to be, and that is told when it shows rather than at the end.
    const std::vector<GlbCost> costs = glb_.costs();
    const auto deforming =
        static_cast<std::size_t>(std::count_if(costs.begin(), costs.end(), [](const GlbCost& c) { return c.deforms; }));
    if (deforming > deforming_) check_glb_size(costs, frame_count_);
    deforming_ = deforming;
}

std::vector<engine::Diagnostic> RunOutput::older_files() const {
    std::vector<engine::Diagnostic> out;
    for (const std::string& format : formats_) {
        std::size_t count = 0;
        std::set<std::string> names;
        std::set<int> frames;
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(folder_ / format, error)) {
            const auto name = parse_frame_file(entry.path(), format);
            if (!name || !entry.is_regular_file(error)) continue;
            // A mark says whose it is; without one the time does.
            const bool readable = format == "obj" && !files_.refusal(entry.path());
            const std::string mark = readable ? read_run_mark(entry.path()) : "";
            if (mark.empty() ? entry.last_write_time(error) >= started_ : mark == run_) continue;
            ++count, names.insert(name->first), frames.insert(name->second);
        }
        if (count == 0) continue;
        engine::Diagnostic d;
        d.severity = engine::Severity::warning;
        std::string who;
        for (const std::string& name : names) who += (who.empty() ? "" : ", ") + name;
        d.code = "IO421";
        const bool one = frames.size() == 1;
        d.message = "'" + (folder_ / format).string() + "' also holds " + std::to_string(count) +
                    (count == 1 ? " file" : " files") + " of an earlier run, " + (one ? "frame " : "frames ") +
                    viewer::frame_list({frames.begin(), frames.end()}) + " of " + who;
        d.hint = "remove them, or give each run a folder of its own: what shows the folder shows them too";
        out.push_back(std::move(d));
    }
    return out;
}

void RunOutput::wait() {
    if (!pending_.valid()) return;
    try {
        pending_.get();
    } catch (...) {
        if (!failed_frame_) failed_frame_ = pending_frame_;
        throw;
    }
}

void RunOutput::finish() {
    std::exception_ptr first;
    try {
        wait();
    } catch (...) {
        first = std::current_exception();
    }
    try {
        if (glb_.finish()) note(glb_path_);
    } catch (...) {
        if (!first) throw;
    }
    if (first) std::rethrow_exception(first);
}

} // namespace sinew::cli
