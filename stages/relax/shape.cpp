// SPDX-License-Identifier: BSD-3-Clause
#include "shape.hpp"

#include "straightness.hpp"

#include <algorithm>
#include <cmath>

namespace conceg::relax {

namespace {

constexpr double resample_um = 1.0;

std::uint32_t children_of(const Bodies &bodies, std::size_t point) {
  return bodies.child_offset[point + 1] - bodies.child_offset[point];
}

// The segment that ends at `point` begins a section: its start is a root or a fork.
bool begins(const Bodies &bodies, std::size_t point) {
  const auto parent = static_cast<std::size_t>(bodies.parent[point]);
  return bodies.parent[parent] < 0 || children_of(bodies, parent) != 1;
}

double angle_at(const Bodies &bodies, std::size_t fork) {
  const glm::dvec3 at = bodies.position[fork];
  const std::uint32_t *child = bodies.child.data() + bodies.child_offset[fork];
  const glm::dvec3 one = bodies.position[child[0]] - at, other = bodies.position[child[1]] - at;
  return std::atan2(glm::length(glm::cross(one, other)), glm::dot(one, other));
}

double mean(const std::vector<double> &values) {
  double sum = 0;
  for (const double v : values)
    sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

} // namespace

Sections make_sections(const Bodies &bodies) {
  Sections out;
  out.of_point.assign(bodies.points, no_section);
  std::vector<std::uint32_t> points; // of each section, with the one that it leaves
  for (std::size_t i = 0; i < bodies.points; i++) {
    if (bodies.parent[i] < 0) continue;
    if (begins(bodies, i))
      out.of_point[i] = static_cast<std::uint32_t>(points.size()), points.push_back(1);
    else
      out.of_point[i] = out.of_point[static_cast<std::size_t>(bodies.parent[i])];
    points[out.of_point[i]]++;
  }
  out.offset.assign(points.size() + 1, 0);
  for (std::size_t s = 0; s < points.size(); s++)
    out.offset[s + 1] = out.offset[s] + points[s];
  out.point.resize(out.offset.back());
  std::vector<std::uint32_t> next(out.offset.begin(), out.offset.end() - 1);
  for (std::size_t i = 0; i < bodies.points; i++) {
    if (bodies.parent[i] < 0) continue;
    std::uint32_t &at = next[out.of_point[i]];
    if (begins(bodies, i)) out.point[at++] = static_cast<std::uint32_t>(bodies.parent[i]);
    out.point[at++] = static_cast<std::uint32_t>(i);
  }
  out.length.resize(points.size());
  for (std::size_t s = 0; s < points.size(); s++)
    out.length[s] = length_of(bodies, out, s);
  return out;
}

double length_of(const Bodies &bodies, const Sections &sections, std::size_t section) {
  double sum = 0;
  for (std::uint32_t n = sections.offset[section] + 1; n < sections.offset[section + 1]; n++)
    sum += glm::distance(bodies.position[sections.point[n]], bodies.position[sections.point[n - 1]]);
  return sum;
}

double straightness_of(const Bodies &bodies, const Sections &sections, std::size_t section) {
  if (sections.length[section] < shortest_judged_um) return -1;
  ResampledPath line(bodies.position[sections.point[sections.offset[section]]], resample_um);
  for (std::uint32_t n = sections.offset[section] + 1; n < sections.offset[section + 1]; n++)
    line.add(bodies.position[sections.point[n]]);
  return line.straightness();
}

Shape measure_shape(const Bodies &bodies, const Sections &sections, Workers &workers) {
  Shape shape;
  shape.length.resize(sections.count());
  shape.straightness.resize(sections.count());
  workers.loop(sections.count(), 64, [&](std::size_t s, unsigned) {
    shape.length[s] = length_of(bodies, sections, s);
    shape.straightness[s] = straightness_of(bodies, sections, s);
  });
  for (std::size_t i = 0; i < bodies.points; i++)
    if (bodies.parent[i] >= 0 && children_of(bodies, i) == 2) shape.angle.push_back(angle_at(bodies, i));
  return shape;
}

ShapeChange compare_shapes(const Shape &before, const Shape &after) {
  ShapeChange out;
  out.sections = before.length.size(), out.forks = before.angle.size();
  double ratios = 0;
  std::size_t within = 0, judged = 0;
  for (std::size_t s = 0; s < out.sections; s++) {
    const double ratio = before.length[s] > 0 ? after.length[s] / before.length[s] : 1;
    ratios += ratio, within += std::abs(ratio - 1) <= length_tolerance;
    if (before.straightness[s] < 0 || after.straightness[s] < 0) continue;
    out.worst_length_change = std::max(out.worst_length_change, std::abs(ratio - 1));
    judged++, out.straightness_before += before.straightness[s],
        out.straightness_after += after.straightness[s];
  }
  if (out.sections) {
    out.mean_length_ratio = ratios / static_cast<double>(out.sections);
    out.length_within = static_cast<double>(within) / static_cast<double>(out.sections);
  }
  if (judged)
    out.straightness_before /= static_cast<double>(judged),
        out.straightness_after /= static_cast<double>(judged);
  out.mean_angle_before = mean(before.angle), out.mean_angle_after = mean(after.angle);
  within = 0;
  for (std::size_t n = 0; n < out.forks; n++)
    within += std::abs(after.angle[n] - before.angle[n]) <= angle_tolerance;
  if (out.forks) out.angle_within = static_cast<double>(within) / static_cast<double>(out.forks);
  return out;
}

} // namespace conceg::relax
