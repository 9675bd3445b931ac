// SPDX-License-Identifier: BSD-3-Clause
#include "shells.hpp"

#include "guard.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace conceg::fit {
namespace {

// No scanner reaches this; 1 s/mm^2 is 1e-3 ms/um^2, 1 s/m^2 1e-9.
constexpr double largest_b = 100.0;

void check(const Measurements &rows, const std::string &what) {
  for (std::size_t i = 0; i < rows.b.size(); i++) {
    if (!std::isfinite(rows.b[i]) || !std::isfinite(rows.signal[i]))
      fail(CONCEG_E_FORMAT,
           "signal %s: measurement %zu: expected finite numbers, got b %g, signal %g; leave the "
           "measurement out",
           what.c_str(), i, rows.b[i], rows.signal[i]);
    if (rows.b[i] < 0.0)
      fail(CONCEG_E_FORMAT, "signal %s: measurement %zu: expected b of 0 or more, got %g", what.c_str(), i,
           rows.b[i]);
    if (rows.b[i] > largest_b)
      fail(CONCEG_E_FORMAT, "signal %s: measurement %zu: expected b in ms/um^2 up to %g, got %g; %s",
           what.c_str(), i, largest_b, rows.b[i],
           rows.b[i] < 1e6 ? "is it in s/mm^2? divide by 1000" : "is it in s/m^2? divide by 1e9");
  }
}

// Rows from `begin` to `end` of the sorted order: mean b, mean signal, error of that mean.
struct Mean {
  double b = 0.0, signal = 0.0, error = 0.0;
};
Mean mean_of(const Measurements &rows, const std::size_t *begin, const std::size_t *end) {
  Mean out;
  const double n = static_cast<double>(end - begin);
  double squares = 0.0;
  bool one_group = !rows.group.empty();
  for (const std::size_t *i = begin; i != end; i++) {
    one_group = one_group && rows.group[*i] == rows.group[*begin];
    out.b += rows.b[*i] / n, out.signal += rows.signal[*i] / n;
    if (!rows.error.empty()) squares += rows.error[*i] * rows.error[*i];
  }
  out.error = one_group ? rows.group_error[*begin] : std::sqrt(squares) / n;
  return out;
}

void warn(Averages &out, const std::string &what) {
  const std::vector<double> &s = out.shells.signal;
  if (!s.empty() && *std::max_element(s.begin(), s.end()) > 1.0)
    out.warnings.push_back("signal " + what +
                           ": some averages lie above the signal at b = 0; is b = 0 measured like the rest?");
}

} // namespace

Averages average_shells(const Measurements &rows, double width, const std::string &what) {
  check(rows, what);
  std::vector<std::size_t> order(rows.b.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rows.b[a] < rows.b[b]; });
  const std::size_t *place = order.data(), *const last = place + order.size();
  const auto end_of = [&](auto within) {
    const std::size_t *end = place;
    while (end != last && within(end))
      end++;
    return end;
  };
  const std::size_t *zeros = end_of([&](const std::size_t *i) { return rows.b[*i] <= width; });
  if (zeros == place)
    fail(CONCEG_E_FORMAT,
         "signal %s: no measurement with b = 0 (up to %g ms/um^2), so the signal cannot be normalised; add "
         "one, of "
         "signal 1 when it is normalised already",
         what.c_str(), width);
  const Mean origin = mean_of(rows, place, zeros);
  if (!(origin.signal > 0.0))
    fail(CONCEG_E_FORMAT, "signal %s: expected a signal above 0 at b = 0, got %g", what.c_str(),
         origin.signal);
  Averages out;
  out.unweighted = origin.signal;
  for (place = zeros; place != last;) {
    const std::size_t *end =
        end_of([&](const std::size_t *i) { return i == place || rows.b[*i] - rows.b[*(i - 1)] <= width; });
    const Mean shell = mean_of(rows, place, end);
    out.shells.b.push_back(shell.b), out.shells.signal.push_back(shell.signal / origin.signal);
    if (!rows.error.empty()) out.shells.error.push_back(shell.error / origin.signal);
    out.members.push_back(static_cast<std::uint64_t>(end - place));
    place = end;
  }
  const std::vector<double> &errors = out.shells.error;
  if (std::all_of(errors.begin(), errors.end(), [](double e) { return e == 0.0; })) out.shells.error.clear();
  warn(out, what);
  return out;
}

void check_shells(const Shells &shells, const std::vector<std::string> &fitted, const std::string &what) {
  if (shells.b.size() >= fitted.size()) return;
  std::string names;
  for (const std::string &name : fitted)
    names += (names.empty() ? "" : ", ") + name;
  fail(CONCEG_E_RANGE,
       "signal %s: expected %zu values of b above 0 or more to fit %s, got %zu; measure more, or hold "
       "diffusivities "
       "(parameter free)",
       what.c_str(), fitted.size(), names.c_str(), shells.b.size());
}

void check_errors(const Shells &shells, const std::string &what) {
  for (std::size_t i = 0; i < shells.b.size(); i++)
    if (shells.error.empty() || !(shells.error[i] > 0.0))
      fail(CONCEG_E_MISSING,
           "weights: expected standard errors above 0 of the signal %s, got none at b %g; use weights=none",
           what.c_str(), shells.b[i]);
}

} // namespace conceg::fit
