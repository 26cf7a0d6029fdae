// Bytes that copies share until one of them is rewritten: what a term fixes at the start frame is kept once, however
// many frames hold it.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace sinew::solver {

class SharedBytes {
  public:
    SharedBytes() = default;
    SharedBytes(std::vector<std::byte> bytes)
        : bytes_(std::make_shared<std::vector<std::byte>>(std::move(bytes))) {}

    std::size_t size() const { return bytes_ ? bytes_->size() : 0; }
    bool empty() const { return size() == 0; }
    /// Aligned for every type.
    const std::byte* data() const { return bytes_ ? bytes_->data() : nullptr; }
    operator std::span<const std::byte>() const { return {data(), size()}; }
    /// Whether another copy holds the same bytes in memory.
    bool shared() const { return bytes_.use_count() > 1; }

    void clear() { bytes_.reset(); }
    /// So many bytes, to be written to; what they hold before is of no use. Other copies keep theirs.
    std::span<std::byte> rewrite(std::size_t size) {
        if (!bytes_ || shared()) bytes_ = std::make_shared<std::vector<std::byte>>();
        // A little room, so that a memory that grows and shrinks by some items stays where it is.
        if (bytes_->capacity() < size) bytes_->reserve(size + size / 4);
        bytes_->resize(size);
        return *bytes_;
    }

    friend bool operator==(const SharedBytes& a, const SharedBytes& b) {
        return a.bytes_ == b.bytes_ || (a.size() == b.size() && std::equal(a.data(), a.data() + a.size(), b.data()));
    }

  private:
    std::shared_ptr<std::vector<std::byte>> bytes_;
};

} // namespace sinew::solver
