// Handles of the C interface: numbers that a table leads to what they stand for. A number is never given out twice, so
// one that was released is known as such, and a call that runs keeps what it works on alive.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>

namespace sinew::c {

/// The next number of all tables of a program: a session's is never a frame's.
std::uintptr_t next_number();

template <class T>
class Handles {
  public:
    std::uintptr_t add(std::shared_ptr<T> object) {
        const std::uintptr_t number = next_number();
        const std::lock_guard lock(mutex_);
        objects_.emplace(number, std::move(object));
        return number;
    }
    /// Null for a number that is not alive.
    std::shared_ptr<T> find(std::uintptr_t number) const {
        const std::lock_guard lock(mutex_);
        const auto it = objects_.find(number);
        return it == objects_.end() ? nullptr : it->second;
    }
    /// What it stood for, which goes when nobody works on it any more; null for a number that is not alive.
    std::shared_ptr<T> remove(std::uintptr_t number) {
        const std::lock_guard lock(mutex_);
        const auto it = objects_.find(number);
        if (it == objects_.end()) return nullptr;
        std::shared_ptr<T> out = std::move(it->second);
        objects_.erase(it);
        return out;
    }

  private:
    mutable std::mutex mutex_;
    std::unordered_map<std::uintptr_t, std::shared_ptr<T>> objects_;
};

} // namespace sinew::c
