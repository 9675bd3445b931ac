// SPDX-License-Identifier: BSD-3-Clause
#include "signal_document.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace conceg::importing {
namespace {

using Pair = std::pair<double, double>; // duration, separation

std::vector<Pair> timings_of(const SignalSet &set) {
  std::vector<Pair> out;
  for (std::size_t i = 0; i < set.b.size(); i++) {
    const Pair pair(set.duration[i], set.separation[i]);
    if (std::find(out.begin(), out.end(), pair) == out.end()) out.push_back(pair);
  }
  return out;
}

// Ends of the intervals in which no pair of pulses changes.
std::vector<double> ends_of(const std::vector<Pair> &timings) {
  std::vector<double> out;
  for (const Pair &t : timings)
    out.insert(out.end(), {t.first, t.second, t.second + t.first});
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// The effective gradient: 1 during the first pulse, -1 during the second one.
double shape_at(const Pair &t, double time) {
  return time < t.first ? 1.0 : time >= t.second && time < t.second + t.first ? -1.0 : 0.0;
}

void put_extents(conceg_doc *doc, const char *path, const std::vector<double> &values, std::size_t a,
                 std::size_t b, std::size_t c) {
  conceg_array array = {};
  array.size = sizeof array;
  array.dtype = CONCEG_F64;
  array.rank = c ? 3 : 2;
  array.shape[0] = a, array.shape[1] = b, array.shape[2] = c;
  array.data = values.data();
  must(conceg_doc_write(doc, path, &array));
}

} // namespace

void write_signals(conceg_doc *doc, const SignalSet &set) {
  const std::size_t count = set.b.size();
  const std::vector<Pair> timings = timings_of(set);
  const std::vector<double> ends = ends_of(timings);
  std::vector<double> shape, coefficient(count * timings.size() * 3, 0.0);
  for (const Pair &t : timings)
    for (std::size_t j = 0; j < ends.size(); j++)
      shape.push_back(shape_at(t, 0.5 * ((j ? ends[j - 1] : 0.0) + ends[j])));
  for (std::size_t i = 0; i < count; i++) {
    const double d = set.duration[i], separation = set.separation[i];
    const auto own = std::find(timings.begin(), timings.end(), Pair(d, separation)) - timings.begin();
    const double gradient = std::sqrt(set.b[i] / (d * d * (separation - d / 3.0)));
    for (std::size_t k = 0; k < 3; k++)
      coefficient[(i * timings.size() + static_cast<std::size_t>(own)) * 3 + k] =
          gradient * set.direction[3 * i + k];
  }
  put(doc, "/protocol/b", set.b), put(doc, "/protocol/direction", set.direction, 3);
  put(doc, "/protocol/pulse_duration", set.duration), put(doc, "/protocol/pulse_separation", set.separation);
  put(doc, "/protocol/interval_end", ends);
  put_extents(doc, "/protocol/shape", shape, timings.size(), ends.size(), 0);
  put_extents(doc, "/protocol/coefficient", coefficient, count, timings.size(), 3);
  put_texts(doc, "/signals/compartment", set.compartment);
  put(doc, "/signals/walkers", std::vector<std::uint64_t>(set.compartment.size(), 0));
  put_extents(doc, "/signals/signal", set.signal, set.compartment.size(), count, 0);
  put_extents(doc, "/signals/standard_error", set.error, set.compartment.size(), count, 0);
}

} // namespace conceg::importing
