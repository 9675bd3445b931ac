// SPDX-License-Identifier: BSD-3-Clause
// What one thread gives to another through a library that ThreadSanitizer does not see into, because it is
// built without it (TBB, Embree): the order is told here. Nothing in other builds.
#pragma once

#if defined(__SANITIZE_THREAD__)
#define CONCEG_TELLS_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CONCEG_TELLS_THREAD_SANITIZER 1
#endif
#endif

#ifdef CONCEG_TELLS_THREAD_SANITIZER
extern "C" void __tsan_acquire(void *);
extern "C" void __tsan_release(void *);
#endif

namespace conceg {

// give() before the library is called and at the end of what it calls; take() where that begins and when the
// library has returned.
class Handover {
public:
#ifdef CONCEG_TELLS_THREAD_SANITIZER
  void give() {
    __tsan_release(this);
  }
  void take() {
    __tsan_acquire(this);
  }
#else
  void give() {}
  void take() {}
#endif
};

} // namespace conceg
