// SPDX-License-Identifier: BSD-3-Clause
// Parallel loops over TBB with a fixed number of workers. Bodies must write only what belongs to their index, so that the
// result does not depend on the number of threads or on the order.
#pragma once

#include "conceg/ctx.h"
#include "guard.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace conceg {

// Workers of one stage run. Counts the items that each worker did; count() hands the numbers to the context.
class Workers {
public:
  explicit Workers(unsigned threads)
      : threads_(std::max(1u, threads)), limit_(tbb::global_control::max_allowed_parallelism, threads_),
        arena_(static_cast<int>(threads_)), done_(threads_) {}
  unsigned threads() const { return threads_; }

  // body(index, worker) for every index in [0, count), in blocks of `grain` indices.
  template <class Body> void loop(std::size_t count, std::size_t grain, Body &&body) {
    if (threads_ == 1 || count <= grain) {
      for (std::size_t i = 0; i < count; i++) body(i, 0u);
      done_[0].items += count;
      return;
    }
    arena_.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, count, std::max<std::size_t>(1, grain)),
          [&](const tbb::blocked_range<std::size_t> &range) {
            const auto worker = static_cast<unsigned>(tbb::this_task_arena::current_thread_index());
            for (std::size_t i = range.begin(); i != range.end(); i++) body(i, worker);
            done_[worker].items += range.size();
          },
          tbb::simple_partitioner());
    });
  }

  // Adds the numbers of items done per worker to the context's counter and starts again at 0.
  void count(conceg_ctx *ctx, const char *counter) {
    for (unsigned worker = 0; worker < threads_; worker++) {
      conceg_ctx_count(ctx, counter, worker, done_[worker].items);
      done_[worker].items = 0;
    }
  }

private:
  struct alignas(64) Done { std::uint64_t items = 0; };
  unsigned threads_;
  tbb::global_control limit_; // lets TBB start more workers than the machine has processors
  tbb::task_arena arena_;
  std::vector<Done> done_;
};

// How an algorithm file reports progress and learns that it must stop, without knowing the library.
// Returns false when the run was cancelled.
using Progress = std::function<bool(const char *what, std::uint64_t done, std::uint64_t total)>;

inline Progress progress_of(conceg_ctx *ctx) {
  return [ctx](const char *what, std::uint64_t done, std::uint64_t total) {
    return conceg_ctx_progress(ctx, what, done, total) == CONCEG_OK;
  };
}
// For algorithm files: throws the cancelled status when progress says stop.
inline void report(const Progress &progress, const char *what, std::uint64_t done, std::uint64_t total) {
  if (progress && !progress(what, done, total)) throw Error(CONCEG_E_CANCELLED, "");
}

} // namespace conceg
