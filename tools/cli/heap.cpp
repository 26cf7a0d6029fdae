// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/heap.h"

#include "engine/memory_limit.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace sinew::cli {

bool has_limited_space() {
    rlimit space{};
    return getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY;
}

#if defined(__GLIBC__)
namespace {

/// Once the room below is used up, arrays of that size go back to the system as soon as they are let go: by default
/// glibc keeps larger and larger ones, which go to pieces in its heap. Smaller ones stay: each frame takes them anew.
constexpr int returned_at_once = 16 << 20;
/// What stays free at the heap's end beyond the room below.
constexpr int kept_at_end = 64 << 20;
/// Of the heap that may have large pages: addresses, not memory. glibc's own numbers end at 2 GB.
constexpr std::size_t most_room = std::size_t{1500} << 20;

/// Takes addresses for a heap of `bytes`, and asks for large pages there: each page that is new to the process costs
/// time, on virtual machines 10 microseconds, and a frame of a rig goes through thousands.
void make_room(std::size_t bytes) {
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    const auto begin = (reinterpret_cast<std::uintptr_t>(sbrk(0)) + page - 1) / page * page;
    mallopt(M_TOP_PAD, static_cast<int>(bytes));
    void* volatile moves_the_end = std::malloc(returned_at_once / 4);
    std::free(moves_the_end);
    mallopt(M_TOP_PAD, 1 << 20);
    const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0)) / page * page;
    // Where the system has no large pages, it says so and all stays as it was.
    if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

/// Whether addresses that are taken count, used or not: `ulimit -v`, `ulimit -d`, or a system that promises no more
/// than it has (vm.overcommit_memory).
bool addresses_count() {
    rlimit data{};
    if (has_limited_space() || (getrlimit(RLIMIT_DATA, &data) == 0 && data.rlim_cur != RLIM_INFINITY)) return true;
    int promises = 0;
    std::ifstream("/proc/sys/vm/overcommit_memory") >> promises;
    return promises == 2;
}

} // namespace
#endif

void set_up_heap() {
#if defined(__GLIBC__)
    // What counts is not to be used up by what may never be needed.
    const std::size_t room = addresses_count() ? 0 : std::min(most_room, engine::memory_limit() / 8);
    mallopt(M_MMAP_THRESHOLD, returned_at_once);
    mallopt(M_TRIM_THRESHOLD, static_cast<int>(room) + kept_at_end); // which else is small as soon as another is set
    if (room > 0) make_room(room);
#endif
}

void renew_heap() {
#if defined(__GLIBC__)
    malloc_trim(0);
    set_up_heap();
#endif
}

} // namespace sinew::cli
