// Running a function on a task arena. oneTBB is not built for the thread sanitizer, which therefore misses
// the synchronisation inside execute(); the two annotations state it. They are nothing in other builds.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <tbb/task_arena.h>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace sinew::engine {

/// What the calling thread did before `publish` is seen by a thread after its `receive` of the same tag.
inline void publish_to_threads([[maybe_unused]] void* tag) {
#if defined(__SANITIZE_THREAD__)
    __tsan_release(tag);
#endif
}
inline void receive_from_threads([[maybe_unused]] void* tag) {
#if defined(__SANITIZE_THREAD__)
    __tsan_acquire(tag);
#endif
}

/// Runs `f` on the arena and returns when it is done; `f` must not throw.
template <class F>
void run_on(tbb::task_arena& arena, F&& f) {
    char tag = 0;
    publish_to_threads(&tag);
    arena.execute([&] {
        receive_from_threads(&tag);
        f();
        publish_to_threads(&tag);
    });
    receive_from_threads(&tag);
}

} // namespace sinew::engine
