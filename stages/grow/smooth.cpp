// SPDX-License-Identifier: BSD-3-Clause
#include "smooth.hpp"

#include "calibre.hpp"
#include "course.hpp"
#include "edit.hpp"
#include "occupancy.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::grow {

namespace {

constexpr double end_tolerance_um = 5e-4; // half of the 1 nm that a finished bar may miss

// Binomial weights of n passes of (1 2 1) / 4.
constexpr double weights[smoothing_lag + 1][smoothing_lag + 1] = {{1.0, 0.0, 0.0, 0.0},
                                                                  {0.5, 0.25, 0.0, 0.0},
                                                                  {0.375, 0.25, 0.0625, 0.0},
                                                                  {0.3125, 0.234375, 0.09375, 0.015625}};

glm::dvec3 smoothed_place(const std::vector<Vertex> &line, std::size_t index, double strength) {
  const std::size_t width =
      std::min({static_cast<std::size_t>(smoothing_lag), index, line.size() - 1 - index});
  const double *weight = weights[width];
  glm::dvec3 mean = weight[0] * line[index].position;
  for (std::size_t i = 1; i <= width; i++)
    mean += weight[i] * (line[index - i].position + line[index + i].position);
  return line[index].position + strength * (mean - line[index].position);
}

void recount(std::vector<Vertex> &line, std::size_t first) {
  for (std::size_t i = first; i < line.size(); i++)
    line[i].path = line[i - 1].path + glm::distance(line[i - 1].position, line[i].position);
}

// Radii of the two segments beside a moved vertex; false when the move would pinch or block them.
bool fits(const State &state, std::uint32_t bar, std::vector<Vertex> &line, std::size_t index,
          const glm::dvec3 &place) {
  const Vertex before = line[index];
  const float radius_after = line[index + 1].radius;
  const double least = 0.95 * std::min(before.radius, radius_after);
  const double need = std::max(state.parameters.r_min_um, least);
  line[index].position = place;
  // A varying calibre is taken where the vertex comes to stand; a taper hardly changes over the shift.
  const double path = calibre_varies(state, bar)
                          ? line[index - 1].path + glm::distance(line[index - 1].position, place)
                          : before.path;
  const double want_before = wanted_radius(state, bar, line[index - 1].path, path);
  const double want_after = wanted_radius(state, bar, path, line[index + 1].path);
  const double first = clearance(state, segment_at(state, bar, line, index), want_before, need);
  const double second =
      first >= need ? clearance(state, segment_at(state, bar, line, index + 1), want_after, need) : -1.0;
  if (second < need) {
    line[index] = before;
    return false;
  }
  line[index].radius = static_cast<float>(first), line[index + 1].radius = static_cast<float>(second);
  line[index].segment = line[index + 1].segment = none;
  return true;
}

} // namespace

std::vector<Vertex> open_line(const Projection &projection, std::uint32_t &offset) {
  const std::uint32_t before = smoothing_lag + 1;
  offset = projection.settled > before ? projection.settled - before : 0;
  return {projection.chain.begin() + offset, projection.chain.end()};
}

void settle(const State &state, std::uint32_t bar, std::vector<Vertex> &line, std::size_t index) {
  const double strength = smoothing_of(state, bar);
  if (!(strength > 0.0) || index == 0 || index + 1 >= line.size()) return;
  for (const double part : {strength, 0.5 * strength})
    if (fits(state, bar, line, index, smoothed_place(line, index, part))) return recount(line, index);
}

double settled_length(const State &state, std::uint32_t bar, const std::vector<Vertex> &line,
                      std::size_t open) {
  const double strength = smoothing_of(state, bar);
  glm::dvec3 last = line[open - 1].position;
  double path = line[open - 1].path;
  for (std::size_t i = open; i < line.size(); i++) {
    const glm::dvec3 place = smoothed_place(line, i, strength);
    path += glm::distance(last, place);
    last = place;
  }
  return path;
}

bool cut_at(std::vector<Vertex> &line, std::size_t index, double end) {
  if (line[index].path < end - end_tolerance_um) return false;
  line.resize(index + 1);
  const double over = line[index].path - end, length = line[index].path - line[index - 1].path;
  if (over > end_tolerance_um && over < length) {
    line[index].position += (over / length) * (line[index - 1].position - line[index].position);
    line[index].path = line[index - 1].path + glm::distance(line[index - 1].position, line[index].position);
    line[index].segment = none;
  }
  return true;
}

std::size_t settle_line(const State &state, std::uint32_t bar, std::vector<Vertex> &line, std::size_t open,
                        bool flush, double end, bool &finished) {
  const std::size_t lag = smoothing_of(state, bar) > 0.0 && !flush ? smoothing_lag : 0;
  finished = false;
  while (open + lag < line.size()) {
    settle(state, bar, line, open);
    finished = cut_at(line, open, end);
    open++;
    if (finished) break;
  }
  return open;
}

} // namespace conceg::grow
