// SPDX-License-Identifier: BSD-3-Clause
#include "axons.hpp"

#include "conceg/swc.h"
#include "neighbours.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace conceg::place {
namespace {

constexpr int kTrials = 1000000;  // of a line, before the box counts as closed to it
constexpr double kShortest = 1.0; // um: a shorter piece is none
constexpr double kLeastLength = 5.0;
constexpr double kMostLength = 1e5; // um, as for every bar
constexpr double kMostAxons = 1e8;
constexpr double kWidest = 0.25; // radius over the shortest side: a wider one would touch its own image

double shortest_side(const conceg_box &box) {
  const glm::dvec3 size = side(box);
  return std::min({size.x, size.y, size.z});
}

// Whether a point keeps its distance from all somas and their images.
class Outside {
public:
  Outside(const conceg_box &box, const Somas &somas, double widest)
      : box_(box), somas_(somas), grid_(box, largest(somas) + widest) {
    for (std::size_t i = 0; i < somas.center.size(); i++)
      grid_.add(somas.center[i], static_cast<std::uint32_t>(i));
  }

  bool holds(const glm::dvec3 &point, double radius) const {
    bool outside = true;
    grid_.around(point, [&](std::uint32_t i) {
      const glm::dvec3 d = nearest(box_, point - somas_.center[i]);
      const double apart = radius + somas_.radius[i];
      return outside = glm::dot(d, d) >= apart * apart;
    });
    return outside;
  }

private:
  static double largest(const Somas &somas) {
    double most = 0.0;
    for (const double radius : somas.radius)
      most = std::max(most, radius);
    return most;
  }
  const conceg_box &box_;
  const Somas &somas_;
  NeighbourGrid grid_;
};

// Cuts the line from `start` at the open sides: moves its start and gives what is left of its length.
double cut_at_open_sides(const conceg_box &box, const glm::dvec3 &direction, double length,
                         glm::dvec3 &start) {
  double from = 0.0, to = length;
  for (int axis = 0; axis < 3; axis++) {
    if (box.periodic[axis]) continue;
    const double ahead = direction[axis];
    double enters = (box.lo[axis] - start[axis]) / ahead, leaves = (box.hi[axis] - start[axis]) / ahead;
    if (ahead == 0.0) { // along the side: inside for all its length, or not at all
      const bool inside = start[axis] >= box.lo[axis] && start[axis] <= box.hi[axis];
      enters = inside ? 0.0 : length, leaves = inside ? length : 0.0;
    }
    from = std::max(from, std::min(enters, leaves)), to = std::min(to, std::max(enters, leaves));
  }
  if (!(to > from)) return 0.0;
  start += from * direction;
  return to - from;
}

// A line that starts anywhere in the box, or up to its length before an open side: so each place of the box
// is crossed as often as any other.
double draw_line(const conceg_box &box, const AxonLaw &law, double length, conceg_rng &rng, Axon &axon) {
  axon.direction = draw_direction(law.direction, rng);
  for (int axis = 0; axis < 3; axis++) {
    const double margin = box.periodic[axis] ? 0.0 : length;
    const double range = conceg_box_side(&box, axis) + 2.0 * margin;
    axon.start[axis] = box.lo[axis] - margin + range * conceg_rng_uniform(&rng);
  }
  const double left = cut_at_open_sides(box, axon.direction, length, axon.start);
  for (int axis = 0; axis < 3; axis++) {
    const double last = box.hi[axis] - (box.periodic[axis] ? CONCEG_LATTICE_STEP_UM : 0.0);
    axon.start[axis] = std::clamp(conceg_snap(axon.start[axis]), box.lo[axis], last);
  }
  return left;
}

void check_law(const conceg_box &box, const AxonLaw &law, double length, const char *name) {
  const GammaLaw &radius = law.radius;
  if (!(length >= kLeastLength && length < kMostLength))
    fail(CONCEG_E_RANGE, "%s.length_um: expected %g to %g um, got %g", name, kLeastLength, kMostLength,
         length);
  if (!(radius.mean > 0.0 && radius.sd >= 0.0 && radius.sd <= radius.mean))
    fail(CONCEG_E_RANGE, "%s.radius_um.sd: expected 0 to the mean, %g um, got %g um", name, radius.mean,
         radius.sd);
  if (!(radius.minimum > 0.0 && radius.minimum <= radius.mean))
    fail(CONCEG_E_RANGE,
         "%s.radius_um.minimum: expected more than 0 and at most the mean, %g um, got %g um; raise the mean",
         name, radius.mean, radius.minimum);
  if (!(law.cable_density * volume(box) / std::min(length, shortest_side(box)) < kMostAxons))
    fail(CONCEG_E_RANGE, "%s: expected fewer than %g axons; raise length_um, or lower the box or the density",
         name, kMostAxons);
}

double draw_radius(const conceg_box &box, const AxonLaw &law, std::uint64_t id, std::uint64_t seed,
                   const char *name) {
  conceg_rng rng = conceg_rng_stream(seed, "place.axon.radius", id);
  const double radius = draw_gamma(law.radius, rng);
  if (!(radius < kWidest * shortest_side(box)))
    fail(CONCEG_E_RANGE,
         "%s.radius_um: expected radii below a quarter of the box's shortest side, %g um, got one of %g um; "
         "lower mean or sd, or enlarge domain.size_um",
         name, kWidest * shortest_side(box), radius);
  return radius;
}

} // namespace

double default_length(const conceg_box &box) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; axis++)
    if (box.periodic[axis]) shortest = std::min(shortest, conceg_box_side(&box, axis));
  return shortest < std::numeric_limits<double>::infinity() ? shortest : glm::length(side(box));
}

std::vector<Axon> draw_axons(const conceg_box &box, const AxonLaw &law, const Somas &somas,
                             std::uint64_t first_id, std::uint64_t id_step, std::uint64_t seed,
                             const char *name, const Progress &progress) {
  const double length = std::isnan(law.length) ? default_length(box) : law.length;
  check_law(box, law, length, name);
  const Outside outside(box, somas, kWidest * shortest_side(box));
  const double asked = law.cable_density * volume(box);
  std::vector<Axon> axons;
  for (double missing = asked; missing >= kShortest; missing -= axons.back().length) {
    Axon axon = {};
    axon.id = first_id + id_step * axons.size();
    axon.radius = draw_radius(box, law, axon.id, seed, name);
    conceg_rng rng = conceg_rng_stream(seed, "place.axon", axon.id);
    int trials = 0;
    do {
      if (trials++ == kTrials)
        fail(CONCEG_E_RANGE,
             "%s: no place outside the somas was found for the start of an axon; lower length_um, or the "
             "density of cells",
             name);
      axon.length = draw_line(box, law, length, rng, axon);
    } while (axon.length < kShortest || !outside.holds(axon.start, axon.radius));
    axon.length = std::min(axon.length, missing);
    axons.push_back(axon);
    report(progress, "axons", static_cast<std::uint64_t>(asked - missing), static_cast<std::uint64_t>(asked));
  }
  return axons;
}

void append_axon(const Axon &axon, double min_radius_um, Bars &bars) {
  bars.tree.push_back(0);
  bars.parent.push_back(-1);
  bars.neurite.push_back(CONCEG_SWC_AXON);
  bars.start.push_back(0.0);
  bars.end.push_back(axon.length);
  bars.attractor.push_back(axon.start + axon.length * axon.direction);
  bars.angle.push_back(0.0);
  bars.radius.push_back(axon.radius);
  bars.taper.push_back(0.0);
  bars.radius_floor.push_back(min_radius_um);
  bars.cell_offset.push_back(bars.tree.size());
}

} // namespace conceg::place
