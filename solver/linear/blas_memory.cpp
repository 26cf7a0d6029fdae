// SPDX-License-Identifier: GPL-3.0-or-later
#include "solver/linear/blas_memory.h"

#include <cstddef>
#include <cstdlib>
#include <vector>

// Not declared by its headers; builds that have no such functions keep no buffers either.
extern "C" {
void* blas_memory_alloc(int) __attribute__((weak));
void blas_memory_free(void*) __attribute__((weak));
}

namespace sinew::solver {

namespace {

/// Of the largest buffers of OpenBLAS for x86-64, with what it adds to align them.
constexpr std::size_t buffer_bytes = (std::size_t{128} << 20) + (std::size_t{1} << 20);

bool has_room() {
    void* block = std::malloc(buffer_bytes);
    std::free(block);
    return block != nullptr;
}

} // namespace

int take_blas_buffers(int threads) {
    if (!blas_memory_alloc || !blas_memory_free) return threads;
    std::vector<void*> taken; // all at once, or one would be given again and again
    while (static_cast<int>(taken.size()) < threads && has_room()) taken.push_back(blas_memory_alloc(1));
    for (void* buffer : taken) blas_memory_free(buffer);
    return static_cast<int>(taken.size());
}

} // namespace sinew::solver
