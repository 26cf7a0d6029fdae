// How much memory there is for this process.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>

namespace sinew::engine {

/// Bytes: the machine's memory, or less where a control group of the process or its address space (`ulimit -v`) is
/// limited. Of groups its own and those above it count: memory.max and memory.high of cgroup v2, and of v1
/// memory.limit_in_bytes.
/// \param root of the file system that holds proc and sys; another one for tests
std::size_t memory_limit(const std::filesystem::path& root = "/");

} // namespace sinew::engine
