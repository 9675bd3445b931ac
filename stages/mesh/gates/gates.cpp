// SPDX-License-Identifier: BSD-3-Clause
#include "gates.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::gates {

const char *verdict_name(Verdict verdict) {
  return verdict == Verdict::passed ? "passed" : verdict == Verdict::failed ? "failed" : "void";
}

void Gates::add(const char *group, const char *name, bool good, double value, const char *unit,
                std::string rule, const std::string &note) {
  const double shown = std::isfinite(value) ? value : 1e300;
  gates_.push_back(
      {group, name, good ? Verdict::passed : Verdict::failed, shown, unit, std::move(rule), note});
}

void Gates::at_most(const char *group, const char *name, double value, double limit, const char *unit,
                    const std::string &note) {
  add(group, name, value <= limit, value, unit, formatted("at most %g", limit), note);
}

void Gates::at_least(const char *group, const char *name, double value, double limit, const char *unit,
                     const std::string &note) {
  add(group, name, value >= limit, value, unit, formatted("at least %g", limit), note);
}

void Gates::none(const char *group, const char *name, std::uint64_t found, const std::string &looked_at,
                 const std::string &first) {
  add(group, name, found == 0, static_cast<double>(found), "", "none",
      found ? looked_at + "; first: " + first : looked_at);
}

void Gates::not_judged(const char *group, const char *name, const std::string &why) {
  gates_.push_back({group, name, Verdict::void_, 0, "", "", why});
}

std::size_t Gates::count(Verdict verdict) const {
  return static_cast<std::size_t>(
      std::count_if(gates_.begin(), gates_.end(), [&](const Gate &gate) { return gate.verdict == verdict; }));
}

} // namespace conceg::gates
