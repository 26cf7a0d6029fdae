// Bytes that wait on disk instead of in memory. The file has no name from the start, so whatever ends the program,
// nothing of it is left.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace sinew::cli {

class SpillFile {
  public:
    /// Takes the space of `folder`, which exists. Throws engine::Failure IO405.
    explicit SpillFile(const std::filesystem::path& folder);
    ~SpillFile();
    SpillFile(const SpillFile&) = delete;
    /// Gives the place of the bytes. Throws engine::Failure IO405, and then holds nothing of them.
    std::uint64_t append(std::span<const std::byte> bytes);
    /// Throws engine::Failure IO402.
    void read(std::uint64_t place, std::span<std::byte> bytes) const;

  private:
    std::filesystem::path folder_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

} // namespace sinew::cli
