// Puts a run on disk while it goes: mesh sequences frame by frame, the GLB at the end with the frames there
// are, which wait on disk too.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/cli/body_files.h"
#include "tools/cli/glb.h"
#include "tools/cli/read_files.h"

#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sinew::cli {

class RunOutput {
  public:
    /// \param formats of "obj", "ply", "glb"
    /// \param title names the GLB file
    /// \param frame_count of the whole run
    /// \param run its run_mark
    /// \param files where files may lie
    RunOutput(std::filesystem::path folder, std::set<std::string> formats, std::string title, double fps,
              SceneAxes axes, std::size_t frame_count, std::string run, engine::FileAccess files = {});

    /// Before anything is written: what `plug` will give is like this `value`. Throws Failure IO405 if the GLB could
    /// not hold all frames of it and of the plugs before.
    void expect(const engine::Graph& graph, const engine::Plug& plug, const engine::Value& value);
    /// Throws Failure IO420 if what will be written of `plug`, which gives what is like this `value`, would go over a
    /// file that is read.
    void check_kept(const ReadFiles& read, const engine::Graph& graph, const engine::Plug& plug,
                    const engine::Value& value, const std::vector<int>& frames);
    /// Throws Failure IO420 if `file` is the folder, the GLB that will be written, the page beside it, or has the name
    /// of a frame's file.
    void check_apart(const std::filesystem::path& file, std::string_view flag, bool with_page) const;
    /// What `plug` gave at `frame`: meshes, or a file. Anything else is left alone. Sequences are written
    /// beside the next frame's work; what goes wrong there is thrown by the next call. Throws Failure (IO405,
    /// FE211).
    void add(const engine::Graph& graph, const engine::Plug& plug, int frame, const engine::Value& value);
    /// Waits for the sequences. Throws Failure (IO405).
    void wait();
    /// Waits for the sequences and writes the GLB, also where the sequences fail. Called after a failure too: the
    /// finished frames stay.
    void finish();
    /// The frame whose sequences could not be written, which was told by a later call; nothing if all could.
    std::optional<int> failed_frame() const { return failed_frame_; }
    /// Files and folders that were written, for the closing line.
    const std::vector<std::filesystem::path>& written() const { return written_; }
    /// Warnings IO421, one a format: files in the sequences' folders that an earlier run has left, unless their marks
    /// say that it ran the same graph (ranges of a farm share a folder). They stay, but must not be taken for this
    /// run's.
    std::vector<engine::Diagnostic> older_files() const;

  private:
    std::vector<BodyLabel> labels(const engine::Graph& graph, const engine::Plug& plug, std::size_t count);
    void add_to_glb(const std::vector<BodyLabel>& labels, const std::vector<nodes::Mesh>& meshes, int frame);
    void note(const std::filesystem::path& path);

    std::filesystem::path folder_;
    std::set<std::string> formats_;
    SceneAxes axes_;
    std::size_t frame_count_;
    std::string run_;
    engine::FileAccess files_;
    std::filesystem::path glb_path_;
    GlbFile glb_;
    std::vector<GlbCost> expected_;
    std::map<std::string, std::pair<engine::Plug, std::size_t>>
        owner_of_;                                ///< of a name: whose output, and which mesh of it
    std::size_t deforming_ = 0;                   ///< bodies in the GLB
    std::map<std::string, std::size_t> animated_; ///< body name -> index in glb_
    std::vector<std::shared_ptr<const nodes::MeshTopology>> topologies_; ///< of the bodies in glb_
    std::future<void> pending_;
    int pending_frame_ = 0;
    std::optional<int> failed_frame_;
    std::vector<std::filesystem::path> written_;
    std::filesystem::file_time_type started_;
};

} // namespace sinew::cli
