// SPDX-License-Identifier: BSD-3-Clause
#include "protocol.hpp"

#include "conceg/portable.h"
#include "guard.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace conceg::simulate {

namespace {

constexpr double same_time_ms = 1e-9;
constexpr std::size_t shape_limit = 64;

std::vector<double> distinct(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  std::vector<double> out;
  for (const double t : times)
    if (t > same_time_ms && (out.empty() || t > out.back() + same_time_ms)) out.push_back(t);
  return out;
}

// Main axis of a symmetric tensor, by power iteration from its largest diagonal.
glm::dvec3 main_axis(const std::array<double, 6> &t) {
  const auto times = [&t](const glm::dvec3 &v) {
    return glm::dvec3(t[0] * v.x + t[3] * v.y + t[4] * v.z, t[3] * v.x + t[1] * v.y + t[5] * v.z,
                      t[4] * v.x + t[5] * v.y + t[2] * v.z);
  };
  glm::dvec3 v(0.0);
  v[t[0] >= t[1] && t[0] >= t[2] ? 0 : t[1] >= t[2] ? 1 : 2] = 1.0;
  for (int i = 0; i < 200; i++) {
    const glm::dvec3 w = times(v);
    const double length = glm::length(w);
    if (!(length > 0.0)) return {1.0, 0.0, 0.0};
    v = w / length;
  }
  return v;
}

// b = integral of q q^T, q the running integral of the gradient, linear in each sample.
std::array<double, 6> tensor_of(const std::vector<glm::dvec3> &gradient, double step) {
  std::array<double, 6> t{};
  glm::dvec3 q(0.0);
  constexpr int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (const glm::dvec3 &g : gradient) {
    const glm::dvec3 next = q + step * g;
    for (std::size_t k = 0; k < 6; k++) {
      const int a = pair[k][0], b = pair[k][1];
      t[k] += step * (q[a] * q[b] / 3.0 + (q[a] * next[b] + next[a] * q[b]) / 6.0 + next[a] * next[b] / 3.0);
    }
    q = next;
  }
  return t;
}

} // namespace

Protocol pulsed(const std::vector<Pulses> &rows) {
  Protocol p;
  std::vector<double> borders;
  std::map<std::pair<double, double>, std::size_t> shapes;
  for (const Pulses &row : rows) {
    borders.insert(borders.end(),
                   {row.duration_ms, row.separation_ms, row.separation_ms + row.duration_ms, row.echo_ms});
    shapes.insert({{row.duration_ms, row.separation_ms}, shapes.size()});
  }
  if (shapes.size() > shape_limit)
    fail(CONCEG_E_UNSUPPORTED,
         "protocol: expected at most %zu pairs of delta and Delta, got %zu; simulate them in parts",
         shape_limit, shapes.size());
  p.timeline.end = distinct(borders), p.timeline.shapes = shapes.size();
  const std::size_t intervals = p.timeline.intervals();
  p.timeline.record.assign(intervals, 0);
  p.timeline.shape.assign(shapes.size() * intervals, 0.0);
  for (const auto &[times, k] : shapes)
    for (std::size_t i = 0; i < intervals; i++) {
      const double middle = 0.5 * (p.timeline.end[i] + (i ? p.timeline.end[i - 1] : 0.0));
      p.timeline.shape[k * intervals + i] = middle < times.first ? 1.0
                                            : middle > times.second && middle < times.first + times.second
                                                ? -1.0
                                                : 0.0;
    }
  p.coefficient.assign(rows.size() * shapes.size(), glm::dvec3(0.0));
  for (std::size_t r = 0; r < rows.size(); r++) {
    const Pulses &row = rows[r];
    const double effective = row.separation_ms - row.duration_ms / 3.0;
    const std::size_t k = shapes.at({row.duration_ms, row.separation_ms});
    p.coefficient[r * shapes.size() + k] = (std::sqrt(row.b / effective) / row.duration_ms) * row.direction;
    p.b.push_back(row.b), p.direction.push_back(row.direction);
    p.pulse_duration.push_back(row.duration_ms), p.pulse_separation.push_back(row.separation_ms);
    p.echo_time.push_back(row.echo_ms);
    const glm::dvec3 &n = row.direction;
    p.b_tensor.push_back({row.b * n.x * n.x, row.b * n.y * n.y, row.b * n.z * n.z, row.b * n.x * n.y,
                          row.b * n.x * n.z, row.b * n.y * n.z});
  }
  return p;
}

Protocol sampled(const Waveforms &waveforms) {
  Protocol p;
  std::size_t samples = 0;
  for (const auto &row : waveforms.row)
    samples = std::max(samples, row.size());
  std::vector<std::vector<double>> basis; // orthonormal over samples
  struct Part {
    std::size_t row;
    int axis;
    std::vector<double> share;
  };
  std::vector<Part> parts;
  for (std::size_t r = 0; r < waveforms.row.size(); r++)
    for (int axis = 0; axis < 3; axis++) {
      std::vector<double> rest(samples, 0.0);
      double size = 0.0;
      for (std::size_t i = 0; i < waveforms.row[r].size(); i++)
        rest[i] = waveforms.row[r][i][axis], size += rest[i] * rest[i];
      Part part{r, axis, {}};
      double left = size;
      for (int pass = 0; pass < 2; pass++) // twice is enough for orthogonality to rounding
        for (std::size_t k = 0; k < basis.size(); k++) {
          double share = 0.0;
          for (std::size_t i = 0; i < samples; i++)
            share += basis[k][i] * rest[i];
          for (std::size_t i = 0; i < samples; i++)
            rest[i] -= share * basis[k][i];
          part.share.resize(std::max(part.share.size(), k + 1), 0.0);
          part.share[k] += share;
        }
      left = 0.0;
      for (const double x : rest)
        left += x * x;
      if (left > 1e-16 * size && size > 0.0) {
        if (basis.size() == shape_limit)
          fail(CONCEG_E_UNSUPPORTED,
               "protocol: expected waveforms that %zu shapes span, got more; simulate them in parts",
               shape_limit);
        const double length = std::sqrt(left);
        for (double &x : rest)
          x /= length;
        part.share.resize(basis.size() + 1, 0.0), part.share[basis.size()] = length;
        basis.push_back(rest);
      }
      parts.push_back(part);
    }
  // Samples in which no shape changes are one interval.
  std::vector<std::size_t> last;
  for (std::size_t i = 0; i < samples; i++) {
    bool border = i + 1 == samples;
    for (const auto &shape : basis)
      border = border || std::fabs(shape[i + 1 < samples ? i + 1 : i] - shape[i]) > 1e-15;
    if (border) last.push_back(i);
  }
  for (const std::size_t i : last)
    p.timeline.end.push_back(static_cast<double>(i + 1) * waveforms.step_ms);
  p.timeline.shapes = basis.size();
  p.timeline.record.assign(last.size(), 0);
  for (const auto &shape : basis)
    for (const std::size_t i : last)
      p.timeline.shape.push_back(shape[i]);
  p.coefficient.assign(waveforms.row.size() * basis.size(), glm::dvec3(0.0));
  for (const Part &part : parts)
    for (std::size_t k = 0; k < part.share.size(); k++)
      p.coefficient[part.row * basis.size() + k][part.axis] = part.share[k];
  for (const auto &row : waveforms.row) {
    const std::array<double, 6> t = tensor_of(row, waveforms.step_ms);
    p.b_tensor.push_back(t), p.b.push_back(std::max(0.0, t[0] + t[1] + t[2])),
        p.direction.push_back(main_axis(t));
    p.pulse_duration.push_back(0.0), p.pulse_separation.push_back(0.0);
    p.echo_time.push_back(static_cast<double>(samples) * waveforms.step_ms);
  }
  return p;
}

void record_at(Timeline &timeline, const std::vector<double> &times) {
  const Timeline old = timeline;
  std::vector<double> borders = old.end;
  borders.insert(borders.end(), times.begin(), times.end());
  timeline.end = distinct(borders);
  const std::size_t intervals = timeline.intervals();
  timeline.record.assign(intervals, 0);
  timeline.shape.assign(timeline.shapes * intervals, 0.0);
  for (std::size_t i = 0; i < intervals; i++) {
    const double middle = 0.5 * (timeline.end[i] + (i ? timeline.end[i - 1] : 0.0));
    const std::size_t was =
        static_cast<std::size_t>(std::upper_bound(old.end.begin(), old.end.end(), middle) - old.end.begin());
    for (std::size_t k = 0; k < timeline.shapes && was < old.intervals(); k++)
      timeline.shape[k * intervals + i] = old.shape[k * old.intervals() + was];
    for (const double t : times)
      if (std::fabs(t - timeline.end[i]) <= same_time_ms) timeline.record[i] = 1;
  }
}

std::vector<std::uint32_t> shells(const Protocol &p) {
  std::vector<std::uint32_t> out;
  std::vector<std::array<double, 6>> known;
  for (std::size_t r = 0; r < p.measurements(); r++) {
    // Trace, squared norm and determinant tell a tensor up to rotation.
    const std::array<double, 6> &t = p.b_tensor[r];
    const double norm =
        t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2.0 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]);
    const double determinant = t[0] * (t[1] * t[2] - t[5] * t[5]) - t[3] * (t[3] * t[2] - t[5] * t[4]) +
                               t[4] * (t[3] * t[5] - t[1] * t[4]);
    const std::array<double, 6> key = {p.b[r],         p.pulse_duration[r], p.pulse_separation[r],
                                       p.echo_time[r], std::sqrt(norm),     std::cbrt(determinant)};
    std::size_t s = 0;
    for (; s < known.size(); s++) {
      bool same = true;
      for (std::size_t i = 0; i < 6; i++)
        same = same &&
               std::fabs(known[s][i] - key[i]) <= 1e-4 * std::max(1e-3, i > 3 ? p.b[r] : std::fabs(key[i]));
      if (same) break;
    }
    if (s == known.size()) known.push_back(key);
    out.push_back(static_cast<std::uint32_t>(s));
  }
  return out;
}

std::vector<glm::dvec3> spread_directions(std::size_t count) {
  std::vector<glm::dvec3> n(count);
  for (std::size_t i = 0; i < count; i++) {
    // Along a spiral down the half sphere.
    const double z = 1.0 - (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double angle = 2.39996322972865332 * static_cast<double>(i), radius = std::sqrt(1.0 - z * z);
    n[i] = {radius * conceg_cos(angle), radius * conceg_sin(angle), z};
  }
  double step = 0.1 / static_cast<double>(count);
  for (int round = 0; round < 400; round++, step *= 0.99) {
    std::vector<glm::dvec3> force(count, glm::dvec3(0.0));
    for (std::size_t i = 0; i < count; i++)
      for (std::size_t j = 0; j < count; j++) {
        if (i == j) continue;
        for (const double sign : {1.0, -1.0}) {
          const glm::dvec3 d = n[i] - sign * n[j];
          const double squared = std::max(1e-12, glm::dot(d, d));
          force[i] += d / (squared * std::sqrt(squared));
        }
      }
    for (std::size_t i = 0; i < count; i++)
      n[i] = glm::normalize(n[i] + step * force[i]);
  }
  return n;
}

} // namespace conceg::simulate
