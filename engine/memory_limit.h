// How much memory there is for this process.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>

namespace sinew::engine {

/// Bytes: the machine's memory, or less where a control group of the process (cgroup v2: memory.max and memory.high,
/// v1: memory.limit_in_bytes; its own and those above it) or its address space (`ulimit -v`) is limited. \param root of
/// the file system that holds proc and sys; another one for tests
std::size_t memory_limit(const std::filesystem::path& root = "/");

} // namespace sinew::engine
