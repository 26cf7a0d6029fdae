// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/memory_limit.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace sinew::engine {

namespace fs = std::filesystem;

namespace {

/// The number in a file of a control group; the largest of all if there is no limit ("max", or no file).
std::uint64_t limit_in(const fs::path& file) {
    std::ifstream in(file);
    std::uint64_t bytes = 0;
    return in >> bytes ? bytes : UINT64_MAX;
}

/// The least limit of a group and of those above it. In a container the path may name a group that is not visible in
/// it; the container's own limits then stand at the top.
std::uint64_t limit_of_group(const fs::path& mount, const fs::path& group, std::initializer_list<const char*> names) {
    std::uint64_t least = UINT64_MAX;
    for (fs::path at = group.relative_path();; at = at.parent_path()) {
        for (const char* name : names) least = std::min(least, limit_in(mount / at / name));
        if (at.empty()) return least;
    }
}

std::uint64_t limit_of_groups(const fs::path& root) {
    std::uint64_t least = UINT64_MAX;
    std::ifstream in(root / "proc/self/cgroup"); // "0::/user.slice" (v2), "7:memory:/docker/ab12" (v1)
    const fs::path mounts = root / "sys/fs/cgroup";
    for (std::string line; std::getline(in, line);) {
        std::istringstream parts(line);
        std::string number, controllers, group;
        std::getline(parts, number, ':'), std::getline(parts, controllers, ':'), std::getline(parts, group);
        if (controllers.empty()) // a mixed system has v2's tree in a folder of its own
            for (const fs::path& mount : {mounts, mounts / "unified"})
                least = std::min(least, limit_of_group(mount, group, {"memory.max", "memory.high"}));
        else if (("," + controllers + ",").find(",memory,") != std::string::npos)
            least = std::min(least, limit_of_group(mounts / "memory", group, {"memory.limit_in_bytes"}));
    }
    return least;
}

} // namespace

std::size_t memory_limit(const fs::path& root) {
    std::uint64_t bytes =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    bytes = std::min(bytes, limit_of_groups(root));
    rlimit space{};
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
        bytes = std::min(bytes, static_cast<std::uint64_t>(space.rlim_cur));
    return bytes;
}

} // namespace sinew::engine
