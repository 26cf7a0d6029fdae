// Memory for millions of numbers: not written before it is used, so that it comes into being in the threads that do,
// and on huge pages where the system lends them. A factor of 30 MB on small pages is 7,000 of them, which take as long
// to come into being as the factor to be made, and whose addresses no processor remembers.
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace sinew::solver {

/// Numbers of a plain type; resize leaves them undefined.
template <class T>
class LargeArray {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_default_constructible_v<T>);

  public:
    /// Throws std::bad_alloc.
    void resize(std::size_t count) {
        if (count <= capacity_) return;
        release();
        constexpr std::size_t page = std::size_t{2} << 20;
        const std::size_t bytes = (count * sizeof(T) + page - 1) / page * page;
        memory_.reset(static_cast<T*>(bytes > page ? std::aligned_alloc(page, bytes) : std::malloc(count * sizeof(T))));
        if (!memory_) throw std::bad_alloc();
#if defined(__linux__)
        if (bytes > page) madvise(memory_.get(), bytes, MADV_HUGEPAGE); // advice: without it all works as well
#endif
        capacity_ = count;
    }
    /// Gives the memory back.
    void release() { memory_.reset(), capacity_ = 0; }
    std::size_t capacity() const { return capacity_; }
    T* data() { return memory_.get(); }
    const T* data() const { return memory_.get(); }

  private:
    struct Free {
        void operator()(T* p) const { std::free(p); }
    };
    std::unique_ptr<T[], Free> memory_;
    std::size_t capacity_ = 0;
};

} // namespace sinew::solver
