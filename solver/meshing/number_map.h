// A small hash map from lattice numbers to indices: open addressing, no deletion.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace sinew::solver {

/// Keys are not negative. What it holds depends on the insertions alone; it offers no order to walk in.
class NumberMap {
  public:
    /// Index of a key, or -1.
    int find(std::int64_t key) const {
        if (slots_.empty()) return -1;
        const Slot& slot = slots_[place(key)];
        return slot.key == key ? slot.index : -1;
    }
    /// Whether the key is new; if it is not, its index stays.
    bool insert(std::int64_t key, int index) {
        if (2 * (count_ + 1) > slots_.size()) grow();
        Slot& slot = slots_[place(key)];
        if (slot.key == key) return false;
        slot = {key, index};
        ++count_;
        return true;
    }
    std::size_t size() const { return count_; }

  private:
    struct Slot {
        std::int64_t key = -1;
        int index = -1;
    };

    /// The key's slot, or the free one where it belongs. Fewer than half of the slots are ever taken.
    std::size_t place(std::int64_t key) const {
        std::uint64_t h = static_cast<std::uint64_t>(key) * 0x9e3779b97f4a7c15ULL;
        h ^= h >> 29;
        std::size_t i = static_cast<std::size_t>(h) & (slots_.size() - 1);
        while (slots_[i].key != key && slots_[i].key != -1) i = (i + 1) & (slots_.size() - 1);
        return i;
    }
    void grow() {
        const std::vector<Slot> old = std::move(slots_);
        slots_ = std::vector<Slot>(old.empty() ? 64 : 2 * old.size());
        for (const Slot& s : old)
            if (s.key >= 0) slots_[place(s.key)] = s;
    }

    std::vector<Slot> slots_;
    std::size_t count_ = 0;
};

} // namespace sinew::solver
