// Parallel loops for the thread sanitizer alone. TBB's library is not instrumented: what its threads hand to each other
// is not seen, and hundreds of warnings hide the one that matters. So under that sanitizer loops run on threads that it
// knows, started and joined each time: slow, and every race between two pieces of work is told, and nothing else.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <thread>
#include <utility>

namespace sinew::solver {

/// body(first, end) over pieces of [0, count) of `grain` each, on this thread and on another one if TBB would have one.
template <class Body>
void watched_loop(std::size_t count, std::size_t grain, const Body& body) {
    const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    std::atomic<std::size_t> next = 0; // relaxed: it must order nothing but itself
    const auto work = [&](std::exception_ptr& failure) {
        try {
            const std::size_t step = std::max<std::size_t>(1, grain);
            for (std::size_t i; (i = next.fetch_add(step, std::memory_order_relaxed)) < count;)
                body(i, std::min(count, i + step));
        } catch (...) {
            next.store(count, std::memory_order_relaxed);
            failure = std::current_exception();
        }
    };
    std::exception_ptr mine, other;
    if (allowed < 2 || tbb::this_task_arena::max_concurrency() < 2) {
        work(mine);
    } else {
        std::thread second([&] { work(other); });
        work(mine);
        second.join();
    }
    if (mine || other) std::rethrow_exception(mine ? mine : other);
}

} // namespace sinew::solver
