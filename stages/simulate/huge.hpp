// SPDX-License-Identifier: BSD-3-Clause
// Memory for large tables that are read here and there: in huge pages where the system offers them, as else
// most of the time goes into looking up pages.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace conceg::simulate {

template <class T> struct HugeAllocator {
  using value_type = T;
  static constexpr std::size_t page = std::size_t{1} << 21;
  HugeAllocator() = default;
  template <class U> HugeAllocator(const HugeAllocator<U> &) {}
  T *allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < page) return static_cast<T *>(::operator new (bytes, std::align_val_t{64}));
    const std::size_t whole = (bytes + page - 1) / page * page;
    void *memory = ::operator new (whole, std::align_val_t{page});
#if defined(__linux__)
    (void)madvise(memory, whole, MADV_HUGEPAGE); // without it merely slower
#endif
    return static_cast<T *>(memory);
  }
  void deallocate(T *memory, std::size_t count) {
    ::operator delete (memory, std::align_val_t{count * sizeof(T) < page ? 64 : page});
  }
  // What has no values of its own stays as it is, so that the threads that fill it touch its pages first.
  template <class U> void construct(U *at) {
    ::new (static_cast<void *>(at)) U;
  }
  template <class U, class... Values> void construct(U *at, Values &&...values) {
    ::new (static_cast<void *>(at)) U(std::forward<Values>(values)...);
  }
  template <class U> bool operator==(const HugeAllocator<U> &) const {
    return true;
  }
  template <class U> bool operator!=(const HugeAllocator<U> &) const {
    return false;
  }
};

template <class T> using HugeVector = std::vector<T, HugeAllocator<T>>;

} // namespace conceg::simulate
