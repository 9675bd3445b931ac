// SPDX-License-Identifier: BSD-3-Clause
#include "read.hpp"

#include "view.hpp"
#include "words.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace conceg::fit {
namespace {

struct Protocol {
  View<double> b, duration, separation;
  std::vector<Timing> timings; // of the pairs of pulses with b above 0
};

bool same(const Timing &a, double duration, double separation) {
  return a.delta_ms == duration && a.separation_ms == separation;
}

Protocol read_protocol(conceg_ctx *ctx, conceg_doc *doc) {
  Protocol p;
  p.b = view<double>(doc, "/protocol/b");
  p.duration = view<double>(doc, "/protocol/pulse_duration");
  p.separation = view<double>(doc, "/protocol/pulse_separation");
  if (p.duration.rows() != p.b.rows() || p.separation.rows() != p.b.rows())
    fail(CONCEG_E_FORMAT, "/protocol: expected %zu durations and separations of pulses, got %zu and %zu",
         p.b.rows(), p.duration.rows(), p.separation.rows());
  std::size_t other = 0;
  for (std::size_t i = 0; i < p.b.rows(); i++) {
    if (!(p.b[i] > 0.0)) continue;
    const double duration = p.duration[i], separation = p.separation[i];
    if (!(duration > 0.0) || !(separation >= duration)) {
      other++;
      continue;
    }
    if (std::none_of(p.timings.begin(), p.timings.end(),
                     [&](const Timing &t) { return same(t, duration, separation); }))
      p.timings.push_back({duration, separation});
  }
  if (other)
    conceg_ctx_log(
        ctx, CONCEG_LOG_WARNING,
        "fit: %zu of %zu measurements are no pair of pulses (/protocol/pulse_duration, pulse_separation) and "
        "are left out: SANDI is made for pulsed gradients",
        other, p.b.rows());
  if (p.timings.empty())
    fail(CONCEG_E_FORMAT, "/protocol: no pair of pulses with b above 0; simulate or import pulsed gradients");
  return p;
}

std::string timed(const std::string &compartment, const Timing &timing) {
  char text[80];
  std::snprintf(text, sizeof text, ", delta %g, Delta %g ms", timing.delta_ms, timing.separation_ms);
  return compartment + text;
}

// Rows of /signals to fit.
std::vector<std::size_t> chosen_rows(const std::vector<std::string> &names, const std::string &wanted) {
  std::vector<std::size_t> out;
  const std::vector<std::string> asked =
      wanted.empty() ? std::vector<std::string>{"intra", "all"} : split(wanted);
  std::string there;
  for (const std::string &name : names)
    there += (there.empty() ? "" : ", ") + name;
  for (const std::string &name : asked) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end())
      out.push_back(static_cast<std::size_t>(found - names.begin()));
    else if (!wanted.empty())
      fail(CONCEG_E_MISSING, "compartment %s: expected one of those in /signals/compartment (%s)",
           name.c_str(), there.c_str());
  }
  if (out.empty())
    fail(CONCEG_E_MISSING,
         "/signals/compartment: expected intra or all, got %s; name those to fit with the parameter "
         "compartment",
         there.c_str());
  return out;
}

} // namespace

std::vector<Signal> read_signals(conceg_ctx *ctx, conceg_doc *doc, const std::string &wanted) {
  const Protocol protocol = read_protocol(ctx, doc);
  const std::vector<std::string> names = texts(doc, "/signals/compartment");
  const std::size_t count = protocol.b.rows();
  const View<double> signal = view<double>(doc, "/signals/signal", count),
                     error = view<double>(doc, "/signals/standard_error", count);
  if (signal.rows() != names.size() || error.rows() != names.size())
    fail(CONCEG_E_FORMAT, "/signals: expected %zu rows of signal and standard_error, got %zu and %zu",
         names.size(), signal.rows(), error.rows());
  View<std::uint32_t> group;
  View<double> group_error;
  if (has(doc, "/protocol/shell") && has(doc, "/signals/powder_error")) {
    group = view<std::uint32_t>(doc, "/protocol/shell");
    group_error = view<double>(doc, "/signals/powder_error", view<double>(doc, "/signals/powder_b").rows());
    if (group.rows() != count || group_error.rows() != names.size())
      fail(CONCEG_E_FORMAT,
           "/protocol/shell, /signals/powder_error: expected %zu and %zu rows, got %zu and %zu", count,
           names.size(), group.rows(), group_error.rows());
  }
  std::vector<Signal> out;
  for (const std::size_t row : chosen_rows(names, wanted))
    for (const Timing &timing : protocol.timings) {
      Signal s{protocol.timings.size() > 1 ? timed(names[row], timing) : names[row], names[row], timing, {}};
      for (std::size_t i = 0; i < count; i++) {
        if (protocol.b[i] > 0.0 && !same(timing, protocol.duration[i], protocol.separation[i])) continue;
        s.rows.b.push_back(protocol.b[i]), s.rows.signal.push_back(signal.row(row)[i]);
        s.rows.error.push_back(error.row(row)[i]);
        if (!group.rows()) continue;
        if (group[i] >= group_error.columns())
          fail(CONCEG_E_FORMAT, "/protocol/shell: expected less than %zu, got %u", group_error.columns(),
               group[i]);
        s.rows.group.push_back(group[i]), s.rows.group_error.push_back(group_error.row(row)[group[i]]);
      }
      out.push_back(std::move(s));
    }
  return out;
}

} // namespace conceg::fit
