// SPDX-License-Identifier: BSD-3-Clause
#include "tension.hpp"

#include <glm/geometric.hpp>

#include <algorithm>

namespace conceg::relax {

namespace {

constexpr double push_share = 0.4;                    // of the largest pull: what is pressed buckles
constexpr double least_scale = 0.7, most_scale = 1.2; // no force grows without bound

} // namespace

Tension::Tension(const Bodies &bodies, const Sections &sections, const Strength &strength, double most_pull)
    : sections_(sections), tension_(strength.tension), straightening_(strength.straightening),
      most_pull_(most_pull), scale_(sections.count(), 1), rest_(bodies.rest_length), chord_(sections.count()),
      straightness_(sections.count()), pull_(sections.count(), 0) {
  for (std::size_t s = 0; s < sections.count(); s++)
    chord_[s] = glm::length(end_to_end(bodies, s)), straightness_[s] = straightness_of(bodies, sections, s);
}

glm::dvec3 Tension::end_to_end(const Bodies &bodies, std::size_t section) const {
  return bodies.position[sections_.point[sections_.offset[section + 1] - 1]] -
         bodies.position[sections_.point[sections_.offset[section]]];
}

// By how much the ends are nearer to each other than the section's straightness asks, um.
double Tension::missing(const Bodies &bodies, std::size_t section) const {
  const double now = glm::length(end_to_end(bodies, section));
  const double straight = straightness_[section] > 0 ? straightness_of(bodies, sections_, section) : 0;
  return straight > 0 ? now * (straightness_[section] / straight - 1) : chord_[section] - now;
}

void Tension::update(const Bodies &bodies, Workers &workers) {
  workers.loop(sections_.count(), 64, [&](std::size_t s, unsigned) {
    if (!(sections_.length[s] > 0)) return;
    pull_[s] = std::min(most_pull_,
                        std::max(-push_share * most_pull_, pull_[s] + straightening_ * missing(bodies, s)));
    const double change = length_of(bodies, sections_, s) / sections_.length[s] - 1;
    scale_[s] = std::min(most_scale, std::max(least_scale, scale_[s] - tension_ * change));
    for (std::uint32_t n = sections_.offset[s] + 1; n < sections_.offset[s + 1]; n++)
      rest_[sections_.point[n]] = scale_[s] * bodies.rest_length[sections_.point[n]];
  });
}

void Tension::add_forces(const Bodies &bodies, std::vector<glm::dvec3> &force) const {
  for (std::size_t s = 0; s < sections_.count(); s++) {
    const glm::dvec3 along = end_to_end(bodies, s);
    const double distance = glm::length(along);
    if (!(distance > 0)) continue;
    const std::uint32_t first = sections_.offset[s], points = sections_.offset[s + 1] - first;
    const double middle = 0.5 * (points - 1);
    const glm::dvec3 unit = pull_[s] / (0.25 * points * distance) * along; // half of the points bear pull_
    for (std::uint32_t n = 0; n < points; n++) {
      const std::uint32_t point = sections_.point[first + n];
      if (!bodies.pinned[point]) force[point] += (n - middle) / middle * unit;
    }
  }
}

} // namespace conceg::relax
