// SPDX-License-Identifier: BSD-3-Clause
// Wall time by phase, and the share of it in which a team of threads was idle or worked one after another.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace conceg {

class Phases {
public:
  Phases() : began_(Clock::now()), last_(began_) {}
  // What was done since the last call, or since the beginning, belongs to this phase.
  void end(const char *name) {
    const Clock::time_point now = Clock::now();
    of(name) += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  double wall_s() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }
  // 1 - busy / (threads x wall).
  double serial_and_idle(double busy_s, unsigned threads) const {
    return 1.0 - busy_s / (threads * wall_s());
  }
  // "input 0.12, propose 3.40" in s of wall time.
  std::string text() const {
    std::string text;
    for (const auto &[name, seconds] : phases_) {
      char part[96];
      std::snprintf(part, sizeof part, "%s%s %.2f", text.empty() ? "" : ", ", name, seconds);
      text += part;
    }
    return text;
  }

private:
  using Clock = std::chrono::steady_clock;
  double &of(const char *name) {
    for (auto &[known, seconds] : phases_)
      if (known == name) return seconds;
    return phases_.emplace_back(name, 0.0).second;
  }
  Clock::time_point began_, last_;
  std::vector<std::pair<const char *, double>> phases_; // names by address: literals of one place
};

} // namespace conceg
