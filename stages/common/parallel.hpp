// SPDX-License-Identifier: BSD-3-Clause
// Parallel loops with a fixed number of workers. Bodies must write only what belongs to their index,
// so that the result does not depend on the number of threads or on the order.
#pragma once

#include "conceg/ctx.h"
#include "guard.hpp"
#include "phases.hpp"
#include "team.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace conceg {

// Workers of one stage run. Counts the items that each worker did; count() hands the numbers to the context.
// Loops do not nest.
class Workers {
public:
  explicit Workers(unsigned threads) : team_(std::max(1u, threads)), done_(team_.size()) {}
  unsigned threads() const { return team_.size(); }
  double busy_s() const { return team_.busy_s(); }

  // body(index, worker) for every index in [0, count); workers take blocks of `grain` indices as they come.
  template <class Body> void loop(std::size_t count, std::size_t grain, Body &&body) {
    grain = std::max<std::size_t>(1, grain);
    if (threads() == 1 || count <= grain) {
      for (std::size_t i = 0; i < count; i++)
        body(i, 0u);
      done_[0].items += count;
      return;
    }
    std::atomic<std::size_t> next{0};
    team_.all([&](unsigned worker) {
      try {
        for (std::size_t begin; (begin = next.fetch_add(grain)) < count;) {
          const std::size_t end = std::min(count, begin + grain);
          for (std::size_t i = begin; i < end; i++)
            body(i, worker);
          done_[worker].items += end - begin;
        }
      } catch (...) {
        next = count; // nobody takes another block
        throw;
      }
    });
  }

  // Adds the numbers of items done per worker to the context's counter and starts again at 0.
  void count(conceg_ctx *ctx, const char *counter) {
    for (unsigned worker = 0; worker < threads(); worker++) {
      conceg_ctx_count(ctx, counter, worker, done_[worker].items);
      done_[worker].items = 0;
    }
  }

private:
  struct alignas(64) Done {
    std::uint64_t items = 0;
  };
  Team team_;
  std::vector<Done> done_;
};

// Says where the wall time of a stage went; with several threads also how much of it they did not use.
inline void tell_phases(conceg_ctx *ctx, const char *stage, const Phases &phases, double busy_s,
                        unsigned threads) {
  if (threads == 1)
    conceg_ctx_log(ctx, CONCEG_LOG_INFO, "%s: seconds by phase: %s", stage, phases.text().c_str());
  else
    conceg_ctx_log(ctx, CONCEG_LOG_INFO,
                   "%s: seconds by phase: %s; serial and idle share of %u threads %.1f %%", stage,
                   phases.text().c_str(), threads, 100.0 * phases.serial_and_idle(busy_s, threads));
}

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
