// Keys without values: K of a node from the keys of its sources, and the hash chain of a simulation's frames
// from the content digests of its inputs. Whatever cannot be known yet is named, so that the caller can
// provide it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/eval/program.h"
#include "engine/eval/store.h"

#include <functional>
#include <map>
#include <span>
#include <unordered_map>

namespace sinew::engine {

/// What stands between the caller and a key.
struct Needs {
    std::map<int, int> chains; ///< simulation -> frame up to which its chain must be known
    std::vector<Site> values;  ///< nodes that must be evaluated, because only their values have a content digest
    bool empty() const { return chains.empty() && values.empty(); }
};

/// When one sub-step of a simulation reads its inputs.
struct SubstepTimes {
    std::vector<double> within; ///< at stages
    double end = 0;
};

/// Which of a value's digests: Value::digest, Value::aside_digest.
enum class DigestPart { content, aside };

/// The content digest behind a plug key, if it is known.
using ContentOf =
    std::function<std::optional<Digest>(const Digest& plug_key, const Digest& node_key, int output, DigestPart part)>;

/// What every key of a node of this type begins with.
Hasher identity(const NodeType& type);

/// The key of a node by what its inputs hold, whichever nodes gave it and at whichever frame: equal where `compute`
/// cannot tell two calls from each other. Known only when the inputs are.
Digest content_key(const Program& program, const Place& p, double time, std::span<const std::vector<Value>> values);

/// Keys of one program. Needs the core's mutex for every call.
class Keys {
  public:
    Keys(Program& program, ContentOf content)
        : program_(program)
        , content_(std::move(content)) {}

    /// The key of a node at a frame; empty if chains are missing, which are then added to `needs`.
    std::optional<Digest> of(const Site& site, Needs& needs);
    std::optional<Digest> of(const Source& source, double frame, Needs& needs);
    /// Extends the chain of a simulation up to `frame`; true if it is complete. At most a few hundred frames
    /// a call; false with empty needs means "call again".
    bool extend(int simulation, int frame, Needs& needs);
    /// The key of a simulation's frame; the chain must reach it.
    const Digest& frame_key(int simulation, int frame) const;
    /// When a step to `frame` reads its inputs; the start reads once.
    std::vector<SubstepTimes> read_times(int simulation, int frame) const;
    /// The content digest of all that one slot holds at a time; of lists with what stands aside where that is asked
    /// for.
    std::optional<Digest> content(const Slot& slot, double time, Needs& needs, bool with_aside = false);

  private:
    std::optional<Digest> known(const Site& site) const;
    Digest combine(const Site& site) const;
    std::optional<bool> is_on(const Place& p, std::string_view input, double time, Needs& needs);
    std::optional<Digest> inputs_digest(const Place& p, double time, bool initial, Needs& needs);
    std::optional<Digest> link(int simulation, int frame, Needs& needs);

    Program& program_;
    ContentOf content_;
    std::unordered_map<Site, Digest, SiteHash> memo_; ///< nodes that change over time
};

} // namespace sinew::engine
