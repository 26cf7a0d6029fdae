// The memory store: outputs and states under their keys, within byte budgets. Not thread-safe by itself (the
// core holds its mutex); knows no graphs.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "engine/diagnostics.h"
#include "engine/value.h"

#include <list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace sinew::engine {

/// All outputs of one node under one key, in the order of their declaration, and what compute warned about.
struct Entry {
    std::vector<Value> outputs;
    std::vector<Diagnostic> warnings;
    /// Of what came from disk without all of its outputs: the digests of all; else empty.
    std::vector<Digest> known = {};
    bool is_whole() const { return known.empty(); }
    bool has(int output) const { return static_cast<bool>(outputs[static_cast<std::size_t>(output)]); }
    Digest digest(std::size_t output) const { return known.empty() ? outputs[output].digest() : known[output]; }
    std::size_t bytes() const;
};
using EntryPtr = std::shared_ptr<const Entry>;

/// Key of a plug -> content digest of its value. Rows are small and outlive values by far: a chain of frames
/// can be rebuilt from them without evaluating anything. Two generations; the older one goes when the newer
/// is full.
class DigestTable {
  public:
    std::optional<Digest> find(const Digest& key);
    void put(const Digest& key, const Digest& content);

  private:
    static constexpr std::size_t generation = std::size_t{1} << 20;
    std::unordered_map<Digest, Digest, DigestHash> young_, old_;
};

/// Least recently used goes first. An entry larger than the whole budget is not kept.
class ValueStore {
  public:
    explicit ValueStore(std::size_t budget)
        : budget_(budget) {}
    EntryPtr find(const Digest& key);
    bool contains(const Digest& key) { return at_.contains(original(key)); }
    void put(const Digest& key, EntryPtr entry);
    /// From here on `key` finds what `other` does, and holds no memory of its own.
    void alias(const Digest& key, const Digest& other) { aliases_.put(key, original(other)); }
    void clear();
    std::size_t bytes() const { return bytes_; }

  private:
    struct Row {
        Digest key;
        EntryPtr entry;
    };
    void drop_last();
    Digest original(const Digest& key);
    std::size_t budget_, bytes_ = 0;
    DigestTable aliases_;
    std::list<Row> order_; ///< most recently used first
    std::unordered_map<Digest, std::list<Row>::iterator, DigestHash> at_;
};

struct StoredState {
    Value state;
    std::vector<Diagnostic> warnings; ///< of the step that made it
};

/// States of simulations. All are kept while they fit; then they are thinned, older ones to wider spacing, so
/// that a jump back costs at most about as many steps as it goes back. What is at work is not dropped: simulations of
/// one graph take turns, and each goes on from its own state.
class StateStore {
  public:
    StateStore(std::size_t budget, int every)
        : budget_(budget)
        , every_(every) {}
    const StoredState* find(const Digest& key);
    bool contains(const Digest& key) const { return states_.contains(key); }
    /// `root`: the start of the chain that the state belongs to; `offset`: frames from the start.
    /// `before`: the state that it came from. `at_work`: states that stay, besides this one.
    void put(const Digest& key, const Digest& root, int offset, StoredState state, const std::optional<Digest>& before,
             std::span<const Digest> at_work);
    std::size_t bytes() const { return bytes_; }

  private:
    struct Row {
        StoredState stored;
        Digest root;
        int offset = 0;
        std::uint64_t used = 0; ///< clock of the last use
    };
    void erase(const Digest& key);
    bool thin(const std::unordered_set<Digest, DigestHash>& kept);
    std::size_t budget_, bytes_ = 0;
    int every_;
    std::uint64_t clock_ = 0;
    std::unordered_map<Digest, Row, DigestHash> states_;
};

/// Scratch objects that nobody has on loan.
class ScratchPool {
  public:
    explicit ScratchPool(std::size_t limit)
        : limit_(limit) {}
    std::shared_ptr<void> take(const Digest& key);
    void give(const Digest& key, std::shared_ptr<void> scratch);
    void clear() { kept_.clear(); }

  private:
    std::size_t limit_;
    std::list<std::pair<Digest, std::shared_ptr<void>>> kept_; ///< most recently given first
};

/// Where the table keeps the digest of what a plug's value holds aside (Value::aside_digest).
Digest aside_key(const Digest& plug);
/// The key of one output of a node whose key is `node`.
Digest plug_key(const Digest& node, std::string_view output);

} // namespace sinew::engine
