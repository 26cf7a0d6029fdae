// Frames of simulations on disk, each under the key of its place in the chain, with what it was made from; and what
// plugs hold, so that a later process finds the keys without evaluating what leads to them.
//
// A frame repeats much of the one at the start: connectivity, anchors, rest poses. So it is written as the blocks in
// which it differs from that one, part by part. Its state, which only who simulates on needs, is the file's second part
// and read for them alone. Files are whole or not there; a damaged one is not used. Several processes may share the
// folder.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/disk_store.h"
#include "engine/eval/kept_entry.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::engine {

/// The content digest of what a plug gives, by the plug's key.
struct PlugContent {
    Digest plug, content;
};

struct LaidFrame; ///< a frame's bytes, and where the parts of them begin
struct KeptFrame {
    KeptInputs made_from; ///< of what is read, frames_of tells it
    int frame = 0;
    EntryPtr entry;               ///< outputs whose type has no codec are missing
    std::vector<std::byte> state; ///< as the node type saves it
    std::vector<Diagnostic> warnings_of_state;
};

/// Thread-safe.
class FrameStore {
  public:
    /// \param budget most bytes of all that is kept in the folder, frames and outputs
    /// \param build  what other builds have kept is not seen
    FrameStore(std::filesystem::path folder, std::uintmax_t budget, std::string_view build, FileAccess files = {});

    bool contains(const Digest& key) const { return files_.contains(name_of(key)); }
    struct Found {
        std::optional<KeptFrame> frame;
        std::string fault; ///< a file is there and cannot be used: why. Without frame and fault there is none.
    };
    /// \param with_state else the state is left out
    Found read(const Registry& registry, const NodeType& type, const Digest& key, bool with_state) const;
    /// \param start the key of the simulation's start frame, whose file is there if it can be
    /// Throws Failure IO405.
    void write(const Registry& registry, const NodeType& type, const Digest& key, const Digest& start,
               const KeptFrame& frame);
    std::filesystem::path file_of(const Digest& key) const { return files_.file_of(name_of(key)); }

    void read_rows(const std::function<void(const PlugContent&)>& take) const;
    /// Throws Failure IO405.
    void add_rows(std::span<const PlugContent> rows);

    /// Frames of a node, newest first, with what they were made from.
    struct Listed {
        KeptInputs made_from;
        int frame = 0;
        Digest made_by; ///< the node type's identity: its version, and the kernels of the processor where bits depend
                        ///< on them
    };
    std::vector<Listed> frames_of(const std::string& node) const;

  private:
    using Bytes = std::shared_ptr<const LaidFrame>;
    Digest name_of(const Digest& key) const { return Hasher().add(key).add(build_).finish(); }
    /// Here and in start_of: of files, not of frames.
    struct Whole {
        std::shared_ptr<LaidFrame> bytes; ///< null: there is none
        Digest start;
        std::string fault;
    };
    /// \param is_start it must stand for itself, and not differ from another one in turn
    Whole whole(const Digest& name, bool is_start, bool with_state) const;
    Bytes start_of(const Digest& start, bool with_state) const;
    std::shared_ptr<LaidFrame> take_room() const;
    void give_back(std::shared_ptr<LaidFrame> room) const;
    std::vector<Value> last_outputs(const Digest& start) const;
    /// Before so many are written, which may say what differs from the file of `needed`: that stays. False: both
    /// together are more than there may be, and nothing was done.
    bool make_room(std::uintmax_t bytes, const std::optional<Digest>& needed);
    std::vector<std::filesystem::directory_entry> rows_of_build() const;
    /// Frames of a simulation that are used one after another. They count as used when the first of them was, each a
    /// moment before the one ahead of it, so that room is made from their end: whoever runs them again begins at the
    /// first, and would find each gone just before it is wanted if room was made from the start.
    struct Sweep {
        int first = 0, frame = 0;
        std::filesystem::file_time_type begun;
    };
    /// When a frame that is used now shall count as used.
    std::filesystem::file_time_type note_use(const Digest& start, int frame) const;

    std::filesystem::path folder_;
    std::uintmax_t budget_;
    Digest build_;
    DiskStore files_;
    mutable std::mutex mutex_;
    mutable std::map<Digest, Bytes> starts_;               ///< start frames that are in use
    mutable std::map<Digest, std::vector<Value>> outputs_; ///< of the last frame that was read, by its start frame
    mutable std::map<Digest, Sweep> sweeps_;               ///< by their start frame
    mutable std::shared_ptr<LaidFrame> room_;              ///< that the last frame was laid out in, for the next one
    std::filesystem::path rows_;                           ///< this process's file of rows; empty: none yet
    std::uintmax_t written_ = 0;                           ///< since room was made
};

} // namespace sinew::engine
