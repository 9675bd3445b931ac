// SPDX-License-Identifier: BSD-3-Clause
// A team of threads for many short rounds. A waiting worker spins briefly, then yields, then sleeps, so that
// it is there when the next round begins, also on a busy machine.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace conceg {

class Team {
public:
  explicit Team(unsigned size) : size_(size > 0 ? size : 1), errors_(size_), busy_s_(size_, 0.0) {
    for (unsigned worker = 1; worker < size_; worker++)
      threads_.emplace_back([this, worker] { serve(worker); });
  }
  ~Team() {
    start([](unsigned) {}, true);
    for (std::thread &thread : threads_)
      thread.join();
  }
  Team(const Team &) = delete;
  Team &operator=(const Team &) = delete;
  unsigned size() const { return size_; }
  // Wall time that the workers have spent in shares, summed; to be asked between shares.
  double busy_s() const {
    double sum = 0.0;
    for (const double seconds : busy_s_)
      sum += seconds;
    return sum;
  }

  // body(index, worker) for every index below count. Three quarters are dealt out in turn, so that every
  // worker does its share whatever the machine is doing; the rest goes to who is ready for it.
  template <class Body> void loop(std::size_t count, const Body &body) {
    if (count < 2) {
      for (std::size_t i = 0; i < count; i++)
        body(i, 0u);
      return;
    }
    // A whole number of turns: in a short loop one index more or less is a large share.
    const std::size_t turns = (3 * count / 4 + size_ - 1) / size_, shared = std::min(count, turns * size_);
    std::atomic<std::size_t> next{shared};
    all([&](unsigned worker) {
      for (std::size_t i = worker; i < shared; i += size_)
        body(i, worker);
      for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;)
        body(i, worker);
    });
  }

  // share(worker) once by every worker; returns when all are done. The first worker's exception is thrown.
  template <class Share> void all(const Share &share) {
    if (size_ == 1) {
      job_ = std::ref(share);
      run(0);
      if (const std::exception_ptr error = std::exchange(errors_[0], nullptr)) std::rethrow_exception(error);
      return;
    }
    start([&share](unsigned worker) { share(worker); }, false);
    run(0);
    await([this] { return busy_.load(std::memory_order_acquire) == 0; }, finished_);
    std::exception_ptr first;
    for (std::exception_ptr &error : errors_)
      if (const std::exception_ptr taken = std::exchange(error, nullptr); taken && !first) first = taken;
    if (first) std::rethrow_exception(first);
  }

private:
  void start(std::function<void(unsigned)> job, bool stop) {
    std::lock_guard<std::mutex> lock(mutex_);
    job_ = std::move(job);
    stop_ = stop;
    busy_.store(size_ - 1, std::memory_order_relaxed);
    round_.fetch_add(1, std::memory_order_release);
    started_.notify_all();
  }
  void run(unsigned worker) {
    const auto began = std::chrono::steady_clock::now();
    try {
      job_(worker);
    } catch (...) {
      errors_[worker] = std::current_exception();
    }
    busy_s_[worker] += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  }
  void serve(unsigned worker) {
    std::uint64_t seen = 0;
    for (;;) {
      await([&] { return round_.load(std::memory_order_acquire) != seen; }, started_);
      seen++;
      if (stop_) return;
      run(worker);
      if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
        std::lock_guard<std::mutex> lock(mutex_);
        finished_.notify_one();
      }
    }
  }
  template <class Ready> void await(const Ready &ready, std::condition_variable &signal) {
    for (int spin = 0; spin < 2000; spin++) {
      if (ready()) return;
#if defined(__x86_64__) || defined(__i386__)
      __builtin_ia32_pause();
#endif
    }
    for (int turn = 0; turn < 500; turn++) {
      if (ready()) return;
      std::this_thread::yield();
    }
    std::unique_lock<std::mutex> lock(mutex_);
    signal.wait(lock, ready);
  }

  unsigned size_;
  std::vector<std::thread> threads_;
  std::vector<std::exception_ptr> errors_;
  std::vector<double> busy_s_;
  std::function<void(unsigned)> job_;
  std::mutex mutex_;
  std::condition_variable started_, finished_;
  std::atomic<std::uint64_t> round_{0};
  std::atomic<unsigned> busy_{0};
  bool stop_ = false;
};

} // namespace conceg
