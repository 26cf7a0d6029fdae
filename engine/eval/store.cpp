// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/eval/store.h"

#include <algorithm>
#include <limits>

namespace sinew::engine {

std::size_t Entry::bytes() const {
    std::size_t out = sizeof(Entry) + 128; // the rows of the tables that point here
    for (const Value& v : outputs)
        if (v) out += v.bytes();
    for (const Diagnostic& d : warnings) out += sizeof(Diagnostic) + d.message.size() + d.hint.size();
    return out;
}

Digest ValueStore::original(const Digest& key) { return at_.contains(key) ? key : aliases_.find(key).value_or(key); }

EntryPtr ValueStore::find(const Digest& key) {
    const auto it = at_.find(original(key));
    if (it == at_.end()) return {};
    order_.splice(order_.begin(), order_, it->second);
    return it->second->entry;
}

void ValueStore::put(const Digest& key, EntryPtr entry) {
    const std::size_t size = entry->bytes();
    if (const auto it = at_.find(key); it != at_.end()) {
        if (it->second->entry->is_whole() || !entry->is_whole()) return;
        bytes_ -= it->second->entry->bytes();
        order_.erase(it->second);
        at_.erase(it);
    }
    if (size > budget_) return;
    while (bytes_ + size > budget_) drop_last();
    order_.push_front({key, std::move(entry)});
    at_[key] = order_.begin();
    bytes_ += size;
}

void ValueStore::drop_last() {
    bytes_ -= order_.back().entry->bytes();
    at_.erase(order_.back().key);
    order_.pop_back();
}

void ValueStore::clear() {
    order_.clear();
    at_.clear();
    bytes_ = 0;
}

const StoredState* StateStore::find(const Digest& key) {
    const auto it = states_.find(key);
    if (it == states_.end()) return nullptr;
    it->second.used = ++clock_;
    return &it->second.stored;
}

void StateStore::put(const Digest& key, const Digest& root, int offset, StoredState state,
                     const std::optional<Digest>& before, std::span<const Digest> at_work) {
    if (states_.contains(key)) return;
    bytes_ += state.state.bytes() + sizeof(Row);
    states_[key] = Row{std::move(state), root, offset, ++clock_};
    std::unordered_set<Digest, DigestHash> kept(at_work.begin(), at_work.end());
    kept.insert(key);
    // With `every` above 1 only each k-th frame stays; the newest goes when the next one has come.
    if (before && !kept.contains(*before))
        if (const auto it = states_.find(*before); it != states_.end() && it->second.offset % every_ != 0)
            erase(*before);
    while (bytes_ > budget_ && thin(kept)) {
    }
}

void StateStore::erase(const Digest& key) {
    const auto it = states_.find(key);
    bytes_ -= it->second.stored.state.bytes() + sizeof(Row);
    states_.erase(it);
}

// Drops the state whose loss costs least: the steps that a visit would then need (the gap between its
// neighbours), divided by how long ago it was used. Keeping that quotient even spaces old states ever wider.
bool StateStore::thin(const std::unordered_set<Digest, DigestHash>& kept) {
    struct Candidate {
        Digest root;
        int offset;
        std::uint64_t used;
        Digest key;
    };
    std::vector<Candidate> all;
    for (const auto& [key, row] : states_) all.push_back({row.root, row.offset, row.used, key});
    std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
        return std::tie(a.root, a.offset, a.used, a.key) < std::tie(b.root, b.offset, b.used, b.key);
    });
    double best = std::numeric_limits<double>::infinity();
    std::optional<Digest> victim;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (kept.contains(all[i].key)) continue;
        const bool first = i == 0 || all[i - 1].root != all[i].root;
        const bool last = i + 1 == all.size() || all[i + 1].root != all[i].root;
        const int before = first ? -1 : all[i - 1].offset, after = last ? all[i].offset + 1 : all[i + 1].offset;
        const double cost = static_cast<double>(after - before) / static_cast<double>(clock_ - all[i].used + 1);
        if (cost < best) best = cost, victim = all[i].key;
    }
    if (victim) erase(*victim);
    return victim.has_value();
}

std::optional<Digest> DigestTable::find(const Digest& key) {
    const auto young = young_.find(key);
    if (young != young_.end()) return young->second;
    const auto old = old_.find(key);
    if (old == old_.end()) return {};
    const Digest content = old->second;
    put(key, content); // in use: moves to the younger generation
    return content;
}

void DigestTable::put(const Digest& key, const Digest& content) {
    if (young_.size() >= generation) {
        old_ = std::move(young_);
        young_.clear();
    }
    young_[key] = content;
}

std::shared_ptr<void> ScratchPool::take(const Digest& key) {
    for (auto it = kept_.begin(); it != kept_.end(); ++it)
        if (it->first == key) {
            auto out = std::move(it->second);
            kept_.erase(it);
            return out;
        }
    return {};
}

void ScratchPool::give(const Digest& key, std::shared_ptr<void> scratch) {
    kept_.emplace_front(key, std::move(scratch));
    if (kept_.size() > limit_) kept_.pop_back();
}

Digest aside_key(const Digest& plug) { return Hasher().add(plug).add("aside").finish(); }

Digest plug_key(const Digest& node, std::string_view output) { return Hasher().add(node).add(output).finish(); }

} // namespace sinew::engine
