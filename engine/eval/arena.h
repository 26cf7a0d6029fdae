// Running a function on a task arena. oneTBB is not built for the thread sanitizer, which therefore misses
// the synchronisation inside execute(); the two annotations state it. They are nothing in other builds.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <tbb/task_arena.h>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
extern "C" {
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
}
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

/// A value out of a task's closure, in the thread that runs the task: oneTBB has handed the closure over, after all
/// that its maker could publish, so that the sanitizer takes a first look at it for a race.
template <class T>
T handed_over(const T& captured) {
#if defined(__SANITIZE_THREAD__)
    AnnotateIgnoreReadsBegin(__FILE__, __LINE__);
    T copy = captured;
    AnnotateIgnoreReadsEnd(__FILE__, __LINE__);
    return copy;
#else
    return captured;
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
